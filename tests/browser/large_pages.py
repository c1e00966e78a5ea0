"""Large pages: a study of 200 runs, a run of a million samples (`make pages-large`)."""
import os
import pathlib
import sys
import unittest.mock

import accessible
import h5py
import numpy
import session
from run_pages import RUN_SECTIONS
from session import PageTest
from study_page import STUDY_SECTIONS

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench"))
import page_drag  # noqa: E402

# Smallest and largest of the measurements drawn in a part of the time.
EXTREMES = """
    const [span, done] = arguments, it = document.querySelector('#data div.plot').timePlot;
    it.state.zoom(span).then(() => it.contents(it.rows(), it.plot.clientWidth)).then(([{content}]) => {
      const {y} = content.traces.find(({name}) => name === 'measured');
      done([y.reduce((a, b) => Math.min(a, b)), y.reduce((a, b) => Math.max(a, b)), y.length]);
    });"""


class LargePages(PageTest):
    def test_a_study_of_200_runs(self):
        page = session.modebank.page("large_study", session.made["large_study"], options=("--report.runs", "1"))
        self.assert_whole(page, STUDY_SECTIONS)
        session.browser.screenshot("large_study")
        with h5py.File(session.made["large_study"] / "study.h5") as file:
            stored = file["study"][:]
        self.assertEqual(len(stored), 200)
        self.assertIn("200 of 200 runs in 50 settings", session.browser.run("return document.getElementById('run-count').textContent"))
        settings = {}
        for row in stored:
            settings.setdefault(tuple(row[key].item() for key in ("window.length", "mixture.components", "mixture.covariance")), []).append(row)
        means = {setting: numpy.mean([row["bank_test_log_score"] for row in rows]) for setting, rows in settings.items()}
        ranked = sorted(means, key=means.get, reverse=True)
        # The verdict's best run is first in the table, and no rival is ahead of it.
        first = session.browser.run("return [...document.querySelectorAll('#study-table tbody tr:first-child td')].slice(0, 3).map((td) => td.textContent)")
        self.assertEqual(first, [f"{ranked[0][0]:g}", f"{ranked[0][1]:g}", ranked[0][2].decode()])
        rivals = self.table("The next best settings")
        for rival, setting in zip(rivals, ranked[1:9], strict=True):
            self.assertAlmostEqual(rival["Best is ahead by [nats/sample]"][1], means[ranked[0]] - means[setting], places=9)
            self.assertIn("and 4 repeats", rival["error from"][0])
        told = sum("worse" not in rival["It is"][0] for rival in rivals)
        said = session.browser.run("return document.querySelector('#better .verdict').textContent")
        self.assertIn(f"{told} cannot be told" if told else "better than the next 8", said)
        points = session.browser.run("return document.querySelector('#effects div.plot').drawing.panels[0].marks[0].x.length")
        self.assertEqual(points, 200)
        accessible.assert_accessible(self)

    def test_a_million_samples(self):
        with unittest.mock.patch.dict(os.environ):
            os.environ.pop("MODEBANK_DATA", None)  # for its own log
            page = page_drag.make_page(session.modebank.program, session.work / "million")
        self.assert_whole(page, RUN_SECTIONS)
        session.browser.screenshot("million", whole=False)
        with h5py.File(session.work / "million/big.h5") as file:
            self.assertEqual(len(file["data/runs"]), 1)
            state, times = file["data/state"][:, 0], file["data/time"][:]
        self.assertEqual(len(state), page_drag.SAMPLES)
        self.assertEqual(self.plot_range("data"), [times[0], times[-1]])
        low, high, points = session.browser.driver.execute_async_script(EXTREMES, [float(times[0]), float(times[-1])])
        self.assertEqual((low, high), (numpy.float32(state.min()), numpy.float32(state.max())))
        self.assertLess(points, 10_000)
        first = 2 * page_drag.SAMPLES // 3
        last = first + 99
        low, high, points = session.browser.driver.execute_async_script(EXTREMES, [float(times[first]), float(times[last])])
        seen = numpy.float32(state[first - 2:last + 3])  # lines continue to the edge
        self.assertEqual((low, high, points), (seen.min(), seen.max(), len(seen)))
        self.assert_quiet()
