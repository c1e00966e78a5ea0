"""Headless Chromium for the report's tests. Every page is checked for console errors and requests."""
import base64
import json
import pathlib
import time

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service

CHROMIUM = "/usr/bin/chromium"
DRIVER = "/usr/bin/chromedriver"
PATIENCE_S = 600  # a page that takes longer is broken, even on a slow machine


class Browser:
    def __init__(self, artefacts, width=1200, height=900):
        self.artefacts = pathlib.Path(artefacts)
        self.artefacts.mkdir(parents=True, exist_ok=True)
        options = Options()
        options.binary_location = CHROMIUM
        for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
                         "--disable-dev-shm-usage", "--force-prefers-reduced-motion", f"--window-size={width},{height}"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"performance": "ALL", "browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service(DRIVER), options=options)
        self.driver.set_script_timeout(PATIENCE_S)
        self.size(width, height)

    def close(self):
        self.driver.quit()

    def size(self, width, height):
        """Sets the size of the window's inside, for example that of a phone."""
        self.cdp("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def cdp(self, command, **parameters):
        return self.driver.execute_cdp_cmd(command, parameters)

    def scheme(self, name):
        self.cdp("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": name}])

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def wait(self, script, *arguments, seconds=PATIENCE_S, what=None):
        """Waits until the script's value is true and returns it."""
        end = time.monotonic() + seconds
        while True:
            value = self.run(script, *arguments)
            if value:
                return value
            if time.monotonic() > end:
                raise AssertionError(f"waited {seconds} s for: {what or script}")
            time.sleep(0.05)

    def open(self, page, seconds=PATIENCE_S):
        """Opens a file and waits until the page is drawn."""
        self.messages()
        self.driver.get(pathlib.Path(page).resolve().as_uri())
        self.wait("return document.documentElement.dataset.ready === 'true' || document.querySelector('.failure')", seconds=seconds,
                  what=f"{page} to draw itself")

    def draw_all(self, within="main", seconds=PATIENCE_S):
        """Scrolls through the page, or one part of it, until every plot is drawn; plots are drawn near the window. Returns their number."""
        end = time.monotonic() + seconds
        while True:
            pending = self.run("""
                const pending = [...document.querySelectorAll(arguments[0] + ' div.plot')].filter((p) => p.offsetParent && !p.dataset.failed && !p.dataset.drawn);
                if (pending.length) pending[0].scrollIntoView({block: 'center'});
                return pending.length;""", within)
            if not pending or time.monotonic() > end:
                break
            time.sleep(0.1)
        failed = self.run("return [...document.querySelectorAll('div.plot[data-failed]')].map((p) => p.getAttribute('aria-label'))")
        assert not failed, f"plots that failed: {failed}"
        assert not pending, f"{pending} plots were never drawn"
        return self.run("return [...document.querySelectorAll('div.plot')].filter((p) => p.dataset.drawn).length")

    def messages(self):
        """Console errors, and requests to anything except this file, since the last call."""
        errors = [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]
        requests = []
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                url = message["params"]["request"]["url"]
                if not url.startswith(("file:", "data:", "blob:", "about:", "chrome:")):
                    requests.append(url)
        return errors, requests

    def files_requested(self):
        """Other files to which the page refers."""
        return self.run("return performance.getEntriesByType('resource').map((e) => e.name).filter((n) => !/^(data|blob):/.test(n))")

    def screenshot(self, name):
        shot = self.cdp("Page.captureScreenshot", format="png", captureBeyondViewport=True)
        (self.artefacts / f"{name}.png").write_bytes(base64.b64decode(shot["data"]))

    # Mouse events go through the protocol, like a user's.
    def mouse(self, kind, x, y, **more):
        self.cdp("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def move(self, x, y):
        self.mouse("mouseMoved", x, y)

    def drag(self, x, y, to_x, to_y):
        self.move(x, y)
        self.mouse("mousePressed", x, y, button="left", clickCount=1, buttons=1)
        for step in range(1, 6):
            self.mouse("mouseMoved", x + (to_x - x) * step / 5, y + (to_y - y) * step / 5, button="left", buttons=1)
        self.mouse("mouseReleased", to_x, to_y, button="left", clickCount=1)
