"""What `modebank view` serves, in the browser: overview, page, comparison."""
import pathlib
import shutil
import sys

import accessible
import session
from session import PageTest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "app/view"))
from server import Server  # noqa: E402

HOSTILE_NAME = "<img src=x onerror='window.hostile=9'>.h5"


class ViewPages(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.folder = session.work / "view"
        (cls.folder / "older").mkdir(parents=True)
        shutil.copy(session.made["demo"], cls.folder / "demo.h5")
        shutil.copy(session.made["one_mode"], cls.folder / "older/one_mode.h5")
        shutil.copy(session.made["hostile"], cls.folder / HOSTILE_NAME)
        cls.server = Server(session.modebank.program, cls.folder)

    @classmethod
    def tearDownClass(cls):
        cls.server.stop()

    def names(self):
        return session.browser.run("return [...document.querySelectorAll('#archives tbody a')].map((a) => a.textContent)")

    def wait_for_archives(self, count):
        session.browser.wait("""return document.querySelectorAll('#archives tbody input:not([disabled])').length === arguments[0]""", count)

    def wait_for_page(self):
        session.browser.wait("return document.documentElement.dataset.ready === 'true' || document.querySelector('.failure')")
        self.assertIsNone(session.browser.run("return document.querySelector('.failure')?.textContent ?? null"))

    def press(self, selector):
        session.browser.run("document.querySelector(arguments[0]).click()", selector)

    def test_overview_page_comparison(self):
        browser = session.browser
        browser.messages()
        browser.driver.get(f"http://{self.server.host}/?token={self.server.token}")
        self.wait_for_page()
        self.assertEqual(browser.driver.current_url, f"http://{self.server.host}/")
        self.assertEqual(browser.run("return document.cookie"), "")
        self.wait_for_archives(3)
        self.assertEqual(sorted(self.names()), sorted(["demo.h5", "older/one_mode.h5", HOSTILE_NAME]))
        self.assertIsNone(browser.run("return window.hostile ?? null"))
        browser.screenshot("view_overview")
        accessible.assert_accessible(self)
        for width, height, scheme, name in ((390, 844, "light", "view_phone"), (1200, 900, "dark", "view_dark")):
            browser.size(width, height)
            browser.scheme(scheme)
            browser.screenshot(name)
        browser.scheme("light")

        self.press("#archives thead th:nth-child(2) button")
        self.assertEqual(browser.run("return document.querySelector('#archives [aria-sort]').getAttribute('aria-sort')"), "ascending")
        ascending = self.names()
        self.press("#archives thead th:nth-child(2) button")
        self.assertEqual(self.names(), ascending[::-1])
        browser.run("""const field = document.querySelector('[aria-label="Filter Name"]');
                       field.value = 'one_mode'; field.dispatchEvent(new Event('input'));""")
        self.assertEqual(self.names(), ["older/one_mode.h5"])
        browser.run("""const field = document.querySelector('[aria-label="Filter Name"]');
                       field.value = ''; field.dispatchEvent(new Event('input'));""")
        shutil.copy(session.made["no_truth"], self.folder / "new.h5")
        self.wait_for_archives(4)
        self.assertIn("new.h5", self.names())

        self.assertTrue(browser.run("return document.getElementById('compare').disabled"))
        for name in ("demo.h5", "older/one_mode.h5"):
            self.press(f'[aria-label="Compare {name}"]')
        self.assertFalse(browser.run("return document.getElementById('compare').disabled"))
        self.assertEqual(browser.messages()[0], [])
        self.press("#compare")
        browser.wait("return location.pathname.startsWith('/compare/')")
        self.wait_for_page()
        self.assertIn("one_mode", browser.run("return document.title + document.body.textContent"))
        browser.draw_all()
        browser.driver.back()
        self.wait_for_page()
        self.wait_for_archives(4)
        browser.run("[...document.querySelectorAll('#archives tbody a')].find((a) => a.textContent === 'demo.h5').click()")
        browser.wait("return location.pathname.startsWith('/archive/')")
        self.wait_for_page()
        browser.draw_all()
        self.assertEqual(browser.messages()[0], [])
