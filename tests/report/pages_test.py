#!/usr/bin/env python3
"""The report's pages in headless Chromium: pages_test.py PROGRAM SOURCE_FOLDER WORK_FOLDER

Makes pages of every kind and checks that each section draws without a console error or a request, that zoom, hover,
click-through, sorting and filtering work, and that the numbers shown are the archive's. Screenshots stay in WORK_FOLDER.
"""
import json
import math
import os
import pathlib
import shutil
import sys
import time
import unittest


def leave(reason):
    """Skips loudly, or fails where everything must be there."""
    print(f"SKIPPED: {reason}")
    sys.exit(1 if os.environ.get("CI") == "true" else 77)


try:
    import h5py
    import selenium  # noqa: F401
except ImportError as error:
    leave(f"{error.name} is missing (Debian packages python3-h5py, python3-selenium)")
if not (os.path.exists("/usr/bin/chromium") and os.path.exists("/usr/bin/chromedriver")):
    leave("Chromium is missing (Debian packages chromium, chromium-driver)")

import archives  # noqa: E402
from browser import Browser  # noqa: E402

RUN_SECTIONS = ["origin", "verdict", "data", "windows", "selection", "bank", "filter"]
STUDY_SECTIONS = ["origin", "verdict", "runs", "parallel", "effects", "heatmap", "pareto", "coverage"]
COMPARE_SECTIONS = ["differences", "verdict", "data", "windows", "selection", "bank", "filter"]
PROGRAM, SOURCE, WORK = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]) / "pages"

modebank = browser = data = None
made = {}  # name -> archive


def setUpModule():
    global modebank, browser, data
    shutil.rmtree(WORK, ignore_errors=True)
    WORK.mkdir(parents=True)
    modebank = archives.Modebank(PROGRAM, SOURCE, WORK)
    data = archives.demo_data(modebank)
    made["demo"] = archives.demo(modebank, data, "demo", "--mixture.components", "1..4")
    made["one_mode"] = archives.demo(modebank, data, "one_mode", "--mixture.components", "1")
    made["no_truth"] = archives.demo(modebank, data, "no_truth", "--data.truth=", "--mixture.components", "2")
    made["hostile"] = archives.hostile(modebank)
    if archives.real_data():
        made["ice"] = archives.ice(modebank)
    elif os.environ.get("CI") == "true":
        raise AssertionError("real data is absent: set MODEBANK_DATA (CI requires it)")
    else:
        print("SKIPPED: the page of ICE, real data is absent: set MODEBANK_DATA")
    made["study"] = archives.study(modebank, data)
    browser = Browser(WORK)


def tearDownModule():
    if browser:
        browser.close()


class PageTest(unittest.TestCase):
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
        return browser.run("return document.querySelector(arguments[0] + ' div.plot')._fullLayout.xaxis.range", f"#{section}")

    def plot_area(self, section, index=0):
        """The inside of a drawn plot, in the window."""
        return browser.run("""
            const plot = document.querySelectorAll(arguments[0] + ' div.plot')[arguments[1]];
            plot.scrollIntoView({block: 'center'});
            const box = plot.getBoundingClientRect(), size = plot._fullLayout._size, y = plot._fullLayout.yaxis, x = plot._fullLayout.xaxis;
            return {left: box.x + x._offset, top: box.y + y._offset, width: x._length, height: y._length};""", f"#{section}", index)

    def same(self, shown, stored):
        """A page's exact value and the archive's; what is not finite is null there."""
        if shown is None:
            self.assertFalse(math.isfinite(stored))
        else:
            self.assertEqual(shown, stored)


def pooled(archive):
    with h5py.File(archive) as file:
        return {(row["filter"].decode(), row["role"].decode()): row for row in file["evaluation/summary"][:] if row["run"].decode() == "*"}


class RunPages(PageTest):
    def test_every_section_of_every_page_draws(self):
        for name in ("demo", "one_mode", "no_truth", "hostile", "ice"):
            if name not in made:
                continue
            with self.subTest(name):
                plots = self.assert_whole(modebank.page(name, made[name]), RUN_SECTIONS)
                self.assertGreaterEqual(plots, 6)

    def test_numbers_are_the_archives(self):
        for name in ("demo", "ice"):
            if name not in made:
                continue
            with self.subTest(name):
                self.open(modebank.page(name, made[name]))
                self.check_scores(made[name])
                self.check_bank(made[name])
                self.check_candidates(made[name])

    def check_scores(self, archive):
        rows = pooled(archive)
        shown = browser.run("return [...document.querySelectorAll('#verdict .numbers .big span')].map((s) => JSON.parse(s.dataset.value))")
        bank = rows["bank", "test"]
        self.assertEqual(shown, [bank["log_score"], float(bank["rmse"].ravel()[0]), bank["tail_above"], bank["tail_below"]])
        names = {"bank": "bank", "baseline": "baseline", "noise only": "noise_only"}
        table = self.table("Scores, all runs together")
        self.assertEqual(len(table), len(rows))
        for line in table:
            row = rows[names[line["Filter"][0]], "test" if line["Runs"][0] == "held out" else "train"]
            for heading, key in (("Samples", "samples"), ("Log score [nats]", "log_score"), ("NIS above", "nis_above"), ("NIS below", "nis_below"),
                                 ("PIT above", "tail_above"), ("PIT below", "tail_below"), ("mean NIS", "nis_mean")):
                self.same(line[heading][1], row[key])

    def check_bank(self, archive):
        with h5py.File(archive) as file:
            theta, error, weight = (file[f"bank/{name}"][:] for name in ("parameters", "parameter_standard_error", "weight"))
            transition = file["bank/transition"][:]
        table = self.table("Modes")
        for k, line in enumerate(table[:len(theta)]):
            cells = list(line.values())
            exact = [value for _, value in cells]
            self.assertIn(float(weight[k]), exact)
            for value in theta[k]:
                self.assertIn(float(value), exact)
        shown = browser.run("""
            return [...document.querySelectorAll('#bank [data-value]')].map((e) => JSON.parse(e.dataset.value)).filter((v) => typeof v === 'number');""")
        if len(theta) > 1:
            for value in transition.ravel():
                self.assertIn(float(value), shown)

    def check_candidates(self, archive):
        with h5py.File(archive) as file:
            candidates = file["mixture/candidates"][:]
        table = self.table("Candidates")
        self.assertEqual(len(table), len(candidates))
        for line, row in zip(table, candidates):
            self.assertEqual(int(line["K"][0]), row["components"])
            self.assertEqual(line["Status"][0] == "chosen", bool(row["selected"]))
            for heading, key in (("BIC", "bic"), ("ICL", "icl"), ("AIC", "aic"), ("held out", "heldout"), ("log likelihood", "log_likelihood")):
                self.same(line[heading][1], row[key])

    def test_zoom_is_shared_and_undone(self):
        self.open(modebank.page("demo", made["demo"]))
        browser.draw_all()
        whole = self.plot_range("data")
        area = self.plot_area("data")
        middle = area["top"] + area["height"] / 2
        browser.drag(area["left"] + 0.3 * area["width"], middle, area["left"] + 0.5 * area["width"], middle)
        browser.wait("const r = document.querySelector('#data div.plot')._fullLayout.xaxis.range; return r[1] - r[0] < 0.5 * arguments[0]", whole[1] - whole[0],
                     what="the drag to zoom")
        zoomed = self.plot_range("data")
        self.assertAlmostEqual((zoomed[1] - zoomed[0]) / (whole[1] - whole[0]), 0.2, delta=0.02)
        browser.wait("const r = document.querySelector('#filter div.plot')._fullLayout.xaxis.range; return Math.abs(r[0] - arguments[0]) < 1e-6 && Math.abs(r[1] - arguments[1]) < 1e-6",
                     *zoomed, what="the filter's plot to follow")
        browser.run("[...document.querySelectorAll('#data .controls button')].find((b) => b.textContent === 'All').click()")
        browser.wait("const r = document.querySelector('#data div.plot')._fullLayout.xaxis.range; return Math.abs(r[1] - arguments[0]) < 1e-6", whole[1], what="the whole run again")
        self.assert_quiet()

    def window_point(self):
        """Where some window of the flat cloud is drawn, in the window's pixels, and which one it is."""
        return browser.run("""
            const plot = [...document.querySelectorAll('#windows div.plot')].at(-1);
            plot.scrollIntoView({block: 'center'});
            const box = plot.getBoundingClientRect(), x = plot._fullLayout.xaxis, y = plot._fullLayout.yaxis;
            let best = null;
            for (const trace of plot._fullData) {
              if (trace.xaxis !== 'x' || trace.mode !== 'markers' || !Number.isInteger(trace.customdata?.[0]) || trace.customdata[0] < 0) continue;
              for (let i = 0; i < trace.x.length; ++i) {
                const px = x.l2p(trace.x[i]), py = y.l2p(trace.y[i]);
                if (px < 20 || py < 20 || px > x._length - 20 || py > y._length - 20) continue;
                // The loneliest of some: nothing else may be nearer to the pointer.
                if (!best || px < best.px) best = {px, py, left: box.x + x._offset + px, top: box.y + y._offset + py, window: trace.customdata[i]};
              }
            }
            return best;""")

    def test_hover_names_a_window_and_a_click_goes_to_its_data(self):
        self.open(modebank.page("demo", made["demo"]))
        browser.draw_all()
        point = self.window_point()
        before = browser.run("return document.getElementById('window-info').textContent")
        time.sleep(0.2)
        browser.move(point["left"] + 3, point["top"])
        browser.move(point["left"], point["top"])
        browser.wait("return document.getElementById('window-info').textContent !== arguments[0]", before, what="hover to tell of the window")
        told = browser.run("return document.getElementById('window-info').textContent")
        self.assertRegex(told, r"Window in run \w+, [\d.]+ to [\d.]+ s: A = ")
        browser.click(point["left"], point["top"])
        browser.wait("const m = document.querySelector('#data div.plot')._fullLayout.shapes; return m.some((s) => s.xref === 'x' && s.type === 'rect')",
                     what="the click to mark the window's stretch of the data")
        mark = browser.run("return document.querySelector('#data div.plot')._fullLayout.shapes.filter((s) => s.xref === 'x').map((s) => [s.x0, s.x1])[0]")
        begin, end = (float(word) for word in told.split(", ")[1].split(" s")[0].split(" to "))
        self.assertAlmostEqual(mark[0], begin, places=2)
        self.assertAlmostEqual(mark[1], end, places=2)
        shown = self.plot_range("data")
        self.assertTrue(shown[0] <= begin and end <= shown[1])
        self.assert_quiet()

    def test_hover_over_the_data_shows_values(self):
        self.open(modebank.page("demo", made["demo"]))
        browser.draw_all()
        point = browser.run("""
            const plot = document.querySelector('#data div.plot');
            plot.scrollIntoView({block: 'center'});
            const box = plot.getBoundingClientRect(), x = plot._fullLayout.xaxis, y = plot._fullLayout.yaxis;
            const trace = plot._fullData.find((t) => t.name === 'measured'), i = Math.floor(trace.x.length / 2);
            return [box.x + x._offset + x.l2p(trace.x[i]), box.y + y._offset + y.l2p(trace.y[i])];""")
        time.sleep(0.2)
        browser.move(point[0] + 2, point[1])
        browser.move(*point)
        browser.wait("return document.querySelector('#data div.plot .hoverlayer').children.length > 0", what="a hover label")

    def test_light_dark_phone_and_print(self):
        page = modebank.page("demo", made["demo"])
        for scheme in ("light", "dark"):
            browser.scheme(scheme)
            self.open(page)
            browser.draw_all()
            browser.screenshot(f"demo_{scheme}")
            self.assertEqual(browser.run("return getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)", scheme == "light")
        browser.scheme("light")
        browser.run("document.getElementById('theme').click()")
        self.assertEqual(browser.run("return document.documentElement.dataset.theme"), "dark")
        browser.size(390, 800)
        try:
            self.open(page)
            browser.draw_all()
            browser.screenshot("demo_phone")
            self.assertLessEqual(browser.run("return document.documentElement.scrollWidth"), 390)
        finally:
            browser.size(1200, 900)
        self.open(page)
        browser.draw_all()
        pdf = browser.cdp("Page.printToPDF", printBackground=True)["data"]
        self.assertGreater(len(pdf), 100_000)
        self.assert_quiet()

    def test_keyboard_and_names_for_screen_readers(self):
        self.open(modebank.page("demo", made["demo"]))
        browser.draw_all()
        browser.key("Tab")
        self.assertEqual(browser.run("return document.activeElement.className"), "skip")
        browser.key("Enter")
        self.assertEqual(browser.run("return document.activeElement.id"), "main")
        self.assertEqual(browser.run("return [...document.querySelectorAll('div.plot')].filter((p) => !p.getAttribute('aria-label')).length"), 0)
        self.assertEqual(browser.run("return [...document.querySelectorAll('select, input, textarea')].filter((e) => !e.labels?.length && !e.getAttribute('aria-label')).length"), 0)
        self.assertEqual(browser.run("return document.querySelectorAll('h1').length"), 1)
        self.assertEqual(browser.run("return [...document.querySelectorAll('section')].every((s) => document.getElementById(s.getAttribute('aria-labelledby')))"), True)

    def test_the_configuration_is_copied_whole(self):
        self.open(modebank.page("demo", made["demo"]))
        with h5py.File(made["demo"]) as file:
            config = file["config"][()].decode()
        browser.run("""
            window.copied = null;
            Object.defineProperty(navigator, 'clipboard', {value: {writeText: (text) => { window.copied = text; return Promise.resolve(); }}});
            [...document.querySelectorAll('button')].find((b) => b.textContent.includes('Copy the configuration')).click();""")
        self.assertEqual(browser.run("return window.copied"), config)

    def test_hostile_names_are_text(self):
        self.open(modebank.page("hostile", made["hostile"]))
        browser.draw_all()
        self.assertIsNone(browser.run("return window.hostile ?? null"))
        self.assertEqual(browser.run("return document.querySelectorAll('main script, main img, main b, main i').length"), 0)
        text = browser.run("return document.body.textContent")
        self.assertIn(archives.HOSTILE_STATE, text)
        self.assertIn("漢 ${x} {{data}}", text)
        # Plotly draws texts of its own: they hold the name as well, as text.
        drawn = browser.run("return [...document.querySelectorAll('#data div.plot svg text')].map((t) => t.textContent).join(' | ')")
        self.assertIn(archives.HOSTILE_STATE, drawn)
        browser.screenshot("hostile")
        self.assert_quiet()

    def test_what_an_archive_lacks_is_said(self):
        made["windows_only"] = archives.demo(modebank, data, "windows_only", command="identify")
        plots = self.assert_whole(modebank.page("windows_only", made["windows_only"]), RUN_SECTIONS)
        self.assertGreaterEqual(plots, 2)
        for section in ("selection", "bank", "filter"):
            self.assertRegex(browser.run("return document.getElementById(arguments[0]).textContent", section), "holds no|nothing|no ")


class StudyPage(PageTest):
    def page(self):
        return modebank.page("study", made["study"], options=("--report.runs", "2"))

    def stored(self):
        with h5py.File(made["study"] / "study.h5") as file:
            return file["study"][:]

    def column(self, name):
        return [row[name][1] for row in self.rows()]

    def rows(self):
        table = self.table("Every run")
        return [{heading.rstrip(" ▴▾"): cell for heading, cell in row.items()} for row in table]

    def sort_by(self, name):
        browser.run("[...document.querySelectorAll('#study-table th button')].find((b) => b.textContent.startsWith(arguments[0])).click()", name)

    def filter(self, name, text):
        browser.run("""
            const input = document.querySelector(`#study-table input[data-column="${arguments[0]}"]`);
            input.value = arguments[1];
            input.dispatchEvent(new Event('input', {bubbles: true}));""", name, text)

    def test_every_section_draws_in_light_and_dark(self):
        page = self.page()
        for scheme in ("dark", "light"):
            browser.scheme(scheme)
            self.assert_whole(page, STUDY_SECTIONS)
            browser.screenshot(f"study_{scheme}")

    def test_numbers_are_the_tables(self):
        self.open(self.page())
        browser.run("document.querySelectorAll('#runs details input[type=checkbox]').forEach((box) => { if (!box.checked) box.click(); })")
        stored = self.stored()
        rows = self.rows()
        self.assertEqual(len(rows), len(stored))
        scores = [name for name in stored.dtype.names if name.startswith(("bank_", "baseline_", "noise_only_")) or name == "modes"]
        self.assertGreater(len(scores), 20)
        for line, row in zip(rows, stored):
            self.assertEqual(line["status"][0], row["status"].decode())
            self.assertEqual(line["window.length"][1], row["window.length"])
            self.assertEqual(line["mixture.covariance"][0], row["mixture.covariance"].decode())
            for name in scores:
                self.same(line[name][1], row[name])

    def test_sorting(self):
        self.open(self.page())
        self.sort_by("bank_test_log_score")
        self.assertEqual(self.column("bank_test_log_score"), sorted(self.stored()["bank_test_log_score"]))
        self.sort_by("bank_test_log_score")
        self.assertEqual(self.column("bank_test_log_score"), sorted(self.stored()["bank_test_log_score"], reverse=True))
        self.assertEqual(browser.run("return document.querySelectorAll('#study-table th[aria-sort=descending]').length"), 1)

    def test_filtering_and_what_follows_it(self):
        self.open(self.page())
        browser.draw_all()
        stored = self.stored()
        points = "return document.querySelector('#pareto div.plot')._fullData[0].x.length"
        self.assertEqual(browser.run(points), len(stored))
        self.filter("mixture.components", ">= 2")
        self.assertEqual(len(self.rows()), sum(stored["mixture.components"] >= 2))
        self.filter("mixture.covariance", "diag")
        wanted = (stored["mixture.components"] >= 2) & (stored["mixture.covariance"] == b"diagonal")
        self.assertEqual(sorted(self.column("bank_test_log_score")), sorted(stored["bank_test_log_score"][wanted]))
        browser.wait(points + " === arguments[0]", int(sum(wanted)), what="the Pareto plot to follow")
        self.filter("mixture.components", "1 | 3")
        self.assertEqual({row["mixture.components"][1] for row in self.rows()}, {1, 3})
        self.filter("mixture.components", "")
        self.filter("mixture.covariance", "")
        self.assertEqual(len(self.rows()), len(stored))
        # What is dragged along an axis of the parallel coordinates filters, too: here the first two values of the first key.
        browser.run("return Plotly.restyle(document.querySelector('#parallel div.plot'), {'dimensions[1].constraintrange': [[0.5, 1.5]]}, [0])")
        browser.wait("return document.querySelectorAll('#study-table tbody tr').length === arguments[0]", int(sum(stored["mixture.components"] == 2)),
                     what="the dragged range to filter the table")
        self.assert_quiet()

    def test_main_effects_heat_map_and_front(self):
        self.open(self.page())
        browser.draw_all()
        stored = self.stored()
        means = browser.run("return document.querySelector('#effects div.plot')._fullData.filter((t) => t.meta === 'main effect').map((t) => t.y)")
        keys = ["window.length", "mixture.components", "mixture.covariance"]
        for key, shown in zip(keys, means):
            levels = list(dict.fromkeys(stored[key].tolist()))
            levels = levels if key == "mixture.covariance" else sorted(levels)
            for level, mean in zip(levels, shown):
                self.assertAlmostEqual(mean, float(stored["bank_test_log_score"][stored[key] == level].mean()), places=10)
        cells = browser.run("return document.querySelector('#heatmap div.plot')._fullData[0].z")
        for a, length in enumerate((15, 25)):
            for b, components in enumerate((1, 2, 3)):
                here = (stored["window.length"] == length) & (stored["mixture.components"] == components)
                self.assertAlmostEqual(cells[b][a], float(stored["bank_test_log_score"][here].mean()), places=10)
        front = browser.run("return document.querySelector('#pareto div.plot')._fullData[1].customdata")
        beaten = lambda i: any((stored["modes"][j] <= stored["modes"][i]) and (stored["bank_test_log_score"][j] > stored["bank_test_log_score"][i]) for j in range(len(stored)))
        for i in front:
            self.assertFalse(beaten(i))

    def test_samples_outside_over_the_number_of_components(self):
        self.open(self.page())
        browser.draw_all()
        stored = self.stored()
        shown = browser.run("return Object.fromEntries(document.querySelector('#coverage div.plot').data.map((t) => [t.meta, t.y]))")
        for role in ("train", "test"):
            for side, sign in (("above", 1), ("below", -1)):
                wanted = [stored[f"{name}_{role}_nis_{side}"].mean() for name in ("baseline", "noise_only")]
                wanted += [stored[f"bank_{role}_nis_{side}"][stored["mixture.components"] == k].mean() for k in (1, 2, 3)]
                for value, mean in zip(shown[f"{role} {side}"], wanted):
                    self.assertAlmostEqual(value, sign * 100 * mean, places=9)

    def test_a_run_is_a_click_away(self):
        self.open(self.page())
        browser.draw_all()
        browser.run("document.getElementById('show-best').click()")
        detail = browser.run("return document.getElementById('run-detail').textContent")
        stored = self.stored()
        best = stored[stored["bank_test_log_score"].argmax()]
        self.assertIn(best["key"].decode(), detail)
        self.assertIn("mixture.components", detail)
        link = browser.run("return document.getElementById('run-page').href")
        browser.driver.get(link)
        browser.wait("return document.documentElement.dataset.ready === 'true'", what="the best run's page")
        shown = browser.run("return JSON.parse(document.querySelector('#verdict .numbers .big span').dataset.value)")
        self.assertEqual(shown, best["bank_test_log_score"])
        self.open(self.page())
        browser.run("document.querySelector('#study-table tbody tr').click()")
        self.assertIn(stored[0]["key"].decode(), browser.run("return document.getElementById('run-detail').textContent"))
        self.assert_quiet()


class ComparePage(PageTest):
    def test_two_runs(self):
        plots = self.assert_whole(modebank.page("compare", made["demo"], made["one_mode"]), COMPARE_SECTIONS)
        self.assertGreaterEqual(plots, 6)
        browser.screenshot("compare_light")
        differing = {row["Setting"][0]: (row["A"][0], row["B"][0]) for row in self.table("Settings that differ")}
        self.assertEqual(differing, {"mixture.components": ("1..4", "1")})
        first, second = pooled(made["demo"]), pooled(made["one_mode"])
        rows = [row for row in self.table("Scores side by side") if row["Score"][0].startswith("log score") and row["Filter"][0] == "bank"]
        self.assertEqual(len(rows), 2)
        for row in rows:
            role = "test" if row["Runs"][0] == "held-out runs" else "train"
            a, b = first["bank", role]["log_score"], second["bank", role]["log_score"]
            self.assertEqual((row["A"][1], row["B"][1]), (a, b))
            self.assertEqual(row["B − A"][1], b - a)
        browser.scheme("dark")
        self.assert_whole(WORK / "compare.html", COMPARE_SECTIONS)
        browser.screenshot("compare_dark")
        browser.scheme("light")

    def test_runs_of_other_data(self):
        if "ice" in made:
            self.assert_whole(modebank.page("compare_other", made["demo"], made["ice"]), COMPARE_SECTIONS)
            self.assertIn("different data", browser.run("return document.getElementById('verdict').textContent"))


class Refusals(unittest.TestCase):
    """A broken, foreign or partial archive: what is wrong is said and nothing is written."""

    def refuse(self, path, status, *words):
        page = WORK / "refused.html"
        result = modebank("report", path, "-o", page, status=status)
        for word in words:
            self.assertIn(word, result.stderr)
        self.assertEqual(result.stdout, "")
        self.assertFalse(page.exists())

    def test_files(self):
        whole = made["demo"].read_bytes()
        broken = WORK / "broken.h5"
        broken.write_bytes(whole[:len(whole) // 2] + bytes([whole[len(whole) // 2] ^ 1]) + whole[len(whole) // 2 + 1:])
        self.refuse(broken, 1, "broken.h5", "SHA-256")
        broken.write_bytes(whole[:len(whole) // 3])
        self.refuse(broken, 1, "broken.h5")
        foreign = WORK / "foreign.h5"
        with h5py.File(foreign, "w") as file:
            file["x"] = [1, 2, 3]
        self.refuse(foreign, 1, "foreign.h5", "modebank")
        foreign.write_text("time,wz\n0,1\n")
        self.refuse(foreign, 1, "foreign.h5")
        self.refuse(WORK / "absent.h5", 2, "absent.h5")
        empty = WORK / "no_study"
        empty.mkdir()
        self.refuse(empty, 2, "no_study")

    def test_a_partial_archive(self):
        partial = WORK / "partial.h5"
        shutil.copy(made["demo"], partial)
        with h5py.File(partial, "a") as file:
            del file["bank/A"]
        self.refuse(partial, 1, "partial.h5")

    def test_a_page_that_cannot_be_written(self):
        modebank("report", made["demo"], "-o", WORK / "no" / "folder.html", status=2)
        modebank("report", made["demo"], "-o", made["demo"], status=2)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2)
