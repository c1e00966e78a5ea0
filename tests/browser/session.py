"""Common parts of all page tests: the program, the archives, the browser, and functions that read a page."""
import json
import math
import os
import shutil
import unittest

import archives
import h5py
from browser import Browser

modebank = browser = data = work = None
# Pairs of texts in a figure that overlap. Tilted texts are left out, because their boxes are too large.
OVERLAPS = """
    const over = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 2;
    return [...document.querySelectorAll('.chart svg')].flatMap((svg) => {
      const texts = [...svg.querySelectorAll('text:not([transform^="rotate(-45"])')].map((it) => [it.textContent, it.getBoundingClientRect()]);
      return texts.flatMap(([a, p], i) => texts.slice(i + 1).filter(([, q]) => over(p, q)).map(([b]) => [a, b]));
    });"""
# A computed colour in bytes.
BYTES = "const bytes = (colour) => { const v = colour.match(/[\\d.]+/g).slice(0, 3).map(Number); return v.map((x) => Math.round(colour.startsWith('color') ? 255 * x : x)); };"


class Made(dict):
    """Archives by name, each made on first use."""

    recipes = {
        "demo": lambda name: archives.demo(modebank, data, name, "--mixture.components", "1..4"),
        "one_mode": lambda name: archives.demo(modebank, data, name, "--mixture.components", "1"),
        "many_modes": lambda name: archives.demo(modebank, data, name, "--mixture.components", "20"),
        "no_truth": lambda name: archives.demo(modebank, data, name, "--data.truth=", "--mixture.components", "2", "--filter.simulate", "10"),
        "none_held_out": lambda name: archives.demo(modebank, data, name, "--data.train", ",".join(f"{run:02d}" for run in range(12))),
        "windows_only": lambda name: archives.demo(modebank, data, name, "--until", "windows"),
        "hostile": lambda _: archives.hostile(modebank),
        "study": lambda _: archives.study(modebank, data),
        "large_study": lambda _: archives.large_study(modebank),
    }

    def __missing__(self, name):
        self[name] = self.recipes[name](name)
        return self[name]

    def __contains__(self, name):
        return name in self.recipes


made = Made()


def start(program, source, folder):
    global modebank, browser, data, work
    work = folder
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    modebank = archives.Modebank(program, source, work)
    data = archives.demo_data(modebank)
    if archives.real_data():
        made.recipes["ice"] = lambda _: archives.ice(modebank)
        made.recipes["drive"] = lambda _: archives.drive(modebank)
    elif os.environ.get("CI") == "true":
        raise AssertionError("real data are absent: set MODEBANK_DATA (CI requires them)")
    else:
        print("SKIPPED: real data are absent: set MODEBANK_DATA to a folder that holds borealtc/ICE")
    browser = Browser(work)


def stop():
    if browser:
        browser.close()


class PageTest(unittest.TestCase):
    def needs(self, present, absence):
        """Skips the test if a tool is missing; with CI=true it fails."""
        if not present:
            (self.fail if os.environ.get("CI") == "true" else self.skipTest)(absence)

    def open(self, page):
        seconds = browser.open(page)
        self.assertIsNone(browser.run("return document.querySelector('.failure')?.textContent ?? null"))
        return seconds

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

    def assert_legible(self, *widths):
        """Labels of figures do not overlap on pages of these widths."""
        for width in widths:
            browser.size(width, 900)
            browser.wait("return [...document.querySelectorAll('.chart')].every((plot) => !plot.layout || plot.layout.width === plot.clientWidth)", what="figures to fit")
            self.assertEqual(browser.run(OVERLAPS), [], width)
        browser.size(1200, 900)

    def table(self, caption):
        """Rows of the table with this caption: {heading: (text, exact value)}."""
        found = browser.run("""
            const table = [...document.querySelectorAll('table')].find((t) => t.caption && t.caption.textContent.startsWith(arguments[0]));
            if (!table) return null;
            const names = [...table.querySelectorAll('thead tr:first-child th')].map((th) => th.textContent);
            return [...table.querySelectorAll('tbody tr')].map((tr) => [...tr.children].map((td, i) => [names[i], td.textContent, td.dataset.value ?? null]));""", caption)
        self.assertIsNotNone(found, f"no table {caption}")
        return [{name: (text, json.loads(value) if value is not None else None) for name, text, value in row} for row in found]

    def plot_range(self, section):
        """The visible range of a time plot: from and to."""
        return browser.run("return [...document.querySelector(arguments[0] + ' div.plot').timePlot.range]", f"#{section}")

    def plot_area(self, section):
        """The inside of its first panel, in pixels of the window."""
        return browser.run("""
            const plot = document.querySelector(arguments[0] + ' div.plot'), canvas = plot.querySelector('canvas');
            canvas.scrollIntoView({block: 'center'});
            const box = canvas.getBoundingClientRect(), scale = plot.timePlot.scale(), [from, to] = scale.range.map(scale.to);
            return {left: box.x + from, top: box.y, width: to - from, height: box.height};""", f"#{section}")

    def same(self, shown, stored):
        """Compares a page's exact value with the archive's; values that are not finite are null on the page."""
        if shown is None:
            self.assertFalse(math.isfinite(stored))
        else:
            self.assertEqual(shown, stored)


def pooled(archive):
    with h5py.File(archive) as file:
        return {(row["filter"].decode(), row["role"].decode()): row for row in file["evaluation/summary"][:] if row["run"].decode() == "*"}
