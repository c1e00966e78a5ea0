"""Common parts of all page tests: the program, the archives, the browser, and functions that read a page."""
import json
import math
import shutil
import unittest

import archives
import h5py
from browser import Browser

modebank = browser = data = work = None


class Made(dict):
    """Archives by name, each made on first use."""

    recipes = {
        "demo": lambda name: archives.demo(modebank, data, name, "--mixture.components", "1..4"),
        "one_mode": lambda name: archives.demo(modebank, data, name, "--mixture.components", "1"),
        "windows_only": lambda name: archives.demo(modebank, data, name, "--until", "windows"),
        "hostile": lambda _: archives.hostile(modebank),
        "study": lambda _: archives.study(modebank, data),
    }

    def __missing__(self, name):
        self[name] = self.recipes[name](name)
        return self[name]


made = Made()


def start(program, source, folder):
    global modebank, browser, data, work
    work = folder
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    modebank = archives.Modebank(program, source, work)
    data = archives.demo_data(modebank)
    browser = Browser(work)


def stop():
    if browser:
        browser.close()


class PageTest(unittest.TestCase):
    def open(self, page):
        browser.open(page)
        self.assertIsNone(browser.run("return document.querySelector('.failure')?.textContent ?? null"))

    def assert_quiet(self):
        """No console error, no request, no other file since the page was opened."""
        errors, requests = browser.messages()
        self.assertEqual(errors, [])
        self.assertEqual(requests, [])
        self.assertEqual(browser.files_requested(), [])

    def assert_whole(self, page, sections):
        self.open(page)
        self.assertEqual(browser.run("return [...document.querySelectorAll('main > section')].map((s) => s.id)"), sections)
        plots = browser.draw_all()
        self.assert_quiet()
        return plots

    def table(self, caption):
        """Rows of the table with this caption: {heading: (text, exact value)}."""
        found = browser.run("""
            const table = [...document.querySelectorAll('table')].find((t) => t.caption && t.caption.textContent.startsWith(arguments[0]));
            if (!table) return null;
            const names = [...table.querySelectorAll('thead tr:first-child th')].map((th) => th.textContent);
            return [...table.querySelectorAll('tbody tr')].map((tr) => [...tr.children].map((td, i) => [names[i], td.textContent, td.dataset.value ?? null]));""", caption)
        self.assertIsNotNone(found, f"no table {caption}")
        return [{name: (text, json.loads(value) if value is not None else None) for name, text, value in row} for row in found]

    def same(self, shown, stored):
        """Compares a page's exact value with the archive's; values that are not finite are null on the page."""
        if shown is None:
            self.assertFalse(math.isfinite(stored))
        else:
            self.assertEqual(shown, stored)


def pooled(archive):
    with h5py.File(archive) as file:
        return {(row["filter"].decode(), row["role"].decode()): row for row in file["evaluation/summary"][:] if row["run"].decode() == "*"}
