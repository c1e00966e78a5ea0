"""The index of a folder that `modebank report` writes, opened from disk: table, page, the command that compares."""
import shlex
import shutil
import subprocess

import accessible
import session
from session import PageTest, pooled

HOSTILE_NAME = "<img src=x onerror='window.hostile=9'> & 50 %.h5"


class IndexPage(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.folder, cls.site = session.work / "results", session.work / "site"
        (cls.folder / "older").mkdir(parents=True)
        shutil.copy(session.made["demo"], cls.folder / "demo.h5")
        shutil.copy(session.made["one_mode"], cls.folder / "older/one mode.h5")
        shutil.copy(session.made["hostile"], cls.folder / HOSTILE_NAME)
        shutil.copytree(session.made["study"], cls.folder / "study")
        (cls.folder / "broken.h5").write_text("time,wz\n0,1\n", encoding="utf-8")
        session.modebank("report", cls.folder, "-o", cls.site, "--report.runs", "1")

    def setUp(self):
        self.open(self.site / "index.html")

    def names(self):
        return session.browser.run("return [...document.querySelectorAll('#archives tbody tr')].map((row) => row.children[1].textContent)")

    def press(self, selector):
        session.browser.run("document.querySelector(arguments[0]).click()", selector)

    def tick(self, name):
        session.browser.run("[...document.querySelectorAll('#archives tbody input')].find((box) => box.getAttribute('aria-label') === arguments[0]).click()", f"Compare {name}")

    def command(self):
        return session.browser.run("return document.getElementById('compare').textContent")

    def filter(self, column, text):
        session.browser.run("""const field = document.querySelector(`[aria-label="Filter ${arguments[0]}"]`);
                               field.value = arguments[1]; field.dispatchEvent(new Event('input'));""", column, text)

    def test_the_table_is_of_the_archives(self):
        browser = session.browser
        self.assertEqual(sorted(self.names()), sorted(["demo.h5", "older/one mode.h5", HOSTILE_NAME, "study", "broken.h5"]))
        self.assertIsNone(browser.run("return window.hostile ?? null"))
        rows = {row["Name"][0]: row for row in self.table("Archives of the folder")}
        stored = pooled(self.folder / "demo.h5")["bank", "test"]
        self.assertEqual(rows["demo.h5"]["Log score"][1], stored["log_score"])
        self.assertEqual(rows["demo.h5"]["In the 95 % band"][1], stored["coverage_95"])
        self.assertIn("not a modebank archive", rows["broken.h5"]["Answer"][0])
        self.assertEqual(rows["study"]["Answer"][0], "study")
        self.assert_quiet()
        accessible.assert_accessible(self)
        for width, height, scheme, name in ((1200, 900, "light", "index"), (390, 844, "light", "index_phone"), (1200, 900, "dark", "index_dark")):
            browser.size(width, height)
            browser.scheme(scheme)
            browser.screenshot(name)
        browser.scheme("light")

    def test_sorting_and_filtering(self):
        self.press("#archives thead th:nth-child(2) button")
        self.assertEqual(session.browser.run("return document.querySelector('#archives [aria-sort]').getAttribute('aria-sort')"), "ascending")
        ascending = self.names()
        self.press("#archives thead th:nth-child(2) button")
        self.assertEqual(self.names(), ascending[::-1])
        self.filter("Name", "one mode")
        self.assertEqual(self.names(), ["older/one mode.h5"])
        self.filter("Name", "")
        self.filter("Modes", "> 1")
        self.assertIn("demo.h5", self.names())
        self.assertNotIn("older/one mode.h5", self.names())
        self.filter("Modes", "")
        self.assertEqual(len(self.names()), 5)

    def test_each_link_leads_to_a_page(self):
        browser = session.browser
        addresses = browser.run("return [...document.querySelectorAll('#archives tbody a')].map((a) => [a.textContent, a.href])")
        self.assertEqual(len(addresses), 4)
        for name, address in addresses:
            browser.driver.get(address)
            browser.wait("return document.documentElement.dataset.ready === 'true' || document.querySelector('.failure')", what=name)
            self.assertIsNone(browser.run("return document.querySelector('.failure')?.textContent ?? null"))
            self.assertIsNone(browser.run("return window.hostile ?? null"))
        self.assert_quiet()

    def test_the_command_compares(self):
        self.assertIn("Tick two to 6", self.command())
        self.tick("older/one mode.h5")
        self.assertIn("Tick two to 6", self.command())
        self.tick(HOSTILE_NAME)
        words = shlex.split(self.command())
        self.assertEqual(words[:2], ["modebank", "report"])
        self.assertEqual(set(words[2:4]), {str(self.folder / "older/one mode.h5"), str(self.folder / HOSTILE_NAME)})
        subprocess.run([session.modebank.program, *words[1:]], cwd=session.work, check=True, capture_output=True)
        self.open(session.work / words[-1])
        self.assert_quiet()

    def test_what_is_no_run_cannot_be_ticked(self):
        disabled = session.browser.run("return [...document.querySelectorAll('#archives tbody input:disabled')].map((box) => box.getAttribute('aria-label'))")
        self.assertEqual(sorted(disabled), ["Compare broken.h5", "Compare study"])

    def test_it_prints(self):
        browser = session.browser
        browser.cdp("Emulation.setEmulatedMedia", media="print")
        self.assertTrue(browser.run("return [...document.querySelectorAll('.filters, .controls')].every((part) => !part.offsetParent)"))
        self.assertEqual(len(self.names()), 5)
        browser.screenshot("index_print")
        browser.cdp("Emulation.setEmulatedMedia", media="")
