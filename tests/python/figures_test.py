"""Figures for papers of a small archive and a small study: their fonts, and their numbers compared with h5py's."""
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

import modebank
from simulated import COLUMNS, QUICK, SOURCE, folder, frames

DRAWS = all(importlib.util.find_spec(name) for name in ("matplotlib", "scipy"))
if DRAWS:
    from modebank import figures

NORMAL_975 = 1.959963984540054  # quantile of the standard normal distribution (any table)
CHI_SQUARE_2_95 = 5.991464547107979  # -2 ln 0.05
RUN_FIGURES = {"local_models", "selection", "estimates", "pit", "coverage", "transition"}


def line(axes, label):
    (found,) = [line for line in axes.lines if line.get_label() == label]
    return found


@unittest.skipUnless(DRAWS, "needs matplotlib and scipy: apt-get install python3-matplotlib python3-scipy")
class Figures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.scratch = pathlib.Path(scratch.name)
        cls.archive = modebank.run(SOURCE / "configs/demo.ini", **QUICK, **{"data.root": folder(), "archive.output": cls.scratch / "demo.h5"})
        cls.file = h5py.File(cls.archive.path)
        cls.addClassCleanup(cls.file.close)
        (row,) = [row for row in cls.file["data/runs"][:] if row["name"] == b"01"]  # the first held-out run
        assert row["role"] == b"test"
        cls.rows = slice(row["first"], row["first"] + row["samples"])
        cls.bank = {name: values[cls.rows] for name, values in cls.file["evaluation/bank"].items()}

    def draw(self, *arguments):
        return subprocess.run([sys.executable, "-m", "modebank.figures", *map(str, arguments)], capture_output=True, text=True)

    def check_files(self, target, names):
        self.assertEqual({file.name for file in target.iterdir()}, {f"{name}.{ending}" for name in names for ending in ("pdf", "svg")} | {"figures.tex"})
        for name in names:
            pdf = (target / f"{name}.pdf").read_bytes()
            self.assertIn(b"/FontFile2", pdf, name)  # the file contains a TrueType font
            self.assertNotIn(b"/Type3", pdf, name)
            self.assertIn("<text", (target / f"{name}.svg").read_text(encoding="utf-8"), name)
            self.assertIn(f"{{{name}}}", (target / "figures.tex").read_text(encoding="utf-8"))

    def test_every_figure_of_a_run_is_written(self):
        done = self.draw(self.archive.path, "-o", self.scratch / "run")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.check_files(self.scratch / "run", RUN_FIGURES)
        self.assertIn("with its 95 \\% band", (self.scratch / "run/figures.tex").read_text(encoding="utf-8"))
        self.assertIn("wz [rad/s]", (self.scratch / "run/estimates.svg").read_text(encoding="utf-8"))

    def test_lines_over_time_are_the_archives_numbers(self):
        drawn, left_out = figures.draw(self.archive)
        self.assertEqual((set(drawn), left_out), (RUN_FIGURES, {}))
        time, state = self.file["data/time"][self.rows], self.file["data/state"][self.rows, 0]
        half = NORMAL_975 * np.sqrt(self.bank["innovation_covariance"][:, 0, 0])
        axes = drawn["estimates"].axes[0]
        np.testing.assert_array_equal(line(axes, "measured").get_xdata(), time)
        np.testing.assert_array_equal(line(axes, "measured").get_ydata(), state)
        (band,) = axes.collections
        low, high = (np.nanmin(band.get_paths()[0].vertices[:, 1]), np.nanmax(band.get_paths()[0].vertices[:, 1]))
        np.testing.assert_allclose([low, high], [np.nanmin(self.bank["prediction"][:, 0] - half), np.nanmax(self.bank["prediction"][:, 0] + half)], rtol=1e-12)

    def test_mode_probabilities_are_stacked_in_order_of_use(self):
        figure = figures.draw(self.archive)[0]["estimates"]
        told, others = figures.modes_by_use(self.archive)
        use = self.bank["mode_probability"]
        table = self.file["evaluation/diagnostics"][:]
        table = table[(table["filter"] == b"bank") & (table["role"] == b"test") & (table["mode"] >= 0)]
        self.assertEqual(told + others, list(table["mode"][np.argsort(-table["usage"], kind="stable")]))
        lowest = figure.axes[1].collections[0].get_paths()[0].vertices[:, 1]
        self.assertAlmostEqual(lowest.max(), use[:, told[0]].max(), places=12)

    def test_scores_are_the_archives(self):
        drawn = figures.draw(self.archive)[0]
        summary = self.file["evaluation/summary"][:]
        (row,) = [row for row in summary if (row["filter"], row["role"], row["run"]) == (b"bank", b"test", b"*")]
        bars = drawn["coverage"].axes[0].containers  # training above and below, held-out above and below; the bank is last
        np.testing.assert_allclose([bars[2][-1].get_height(), -bars[3][-1].get_height()], [100 * row["nis_above"], 100 * row["nis_below"]])
        candidates = self.file["mixture/candidates"][:]
        np.testing.assert_array_equal(line(drawn["selection"].axes[0], "BIC").get_ydata(), candidates["bic"])
        held_out = [row for row in self.file["data/runs"][:] if row["role"] == b"test"]
        pit = np.concatenate([self.file["evaluation/bank/pit"][row["first"]:row["first"] + row["samples"], 0] for row in held_out])
        pit = pit[np.isfinite(pit)]
        bank = drawn["pit"].axes[0].patches[-1].get_data()
        np.testing.assert_allclose(bank.values[0], 20 * np.mean(pit < 0.05))
        np.testing.assert_allclose(bank.values.sum(), 20)

    def test_ellipses_hold_95_percent(self):
        axes = figures.draw(self.archive)[0]["local_models"].axes[0]
        used = [0, list(self.file["windows"].attrs["parameter_names"]).index(b"B1")]
        ellipses = [line.get_xydata() for line in axes.lines if len(line.get_xdata()) == 97 and line.get_color() != "white"]
        self.assertEqual(len(ellipses), len(self.file["mixture/weights"]))
        for ellipse, k in zip(ellipses, np.argsort(-self.file["mixture/weights"][:], kind="stable")):
            away = ellipse - self.file["mixture/means"][k][used]
            inverse = np.linalg.inv(self.file["mixture/covariances"][k][np.ix_(used, used)])
            np.testing.assert_allclose(np.einsum("ni,ij,nj->n", away, inverse, away), CHI_SQUARE_2_95, rtol=1e-6)

    def test_a_studys_figures_are_its_answers(self):
        study = self.scratch / "study"
        subprocess.run([os.environ["MODEBANK_PROGRAM"], "study", SOURCE / "configs/demo.ini", "--data.root", folder(), "--window.step", "10", "--window.model", "linear",
                        "--mixture.restarts", "1", "--bank.refine", "none", "--study.vary", "mixture.components = 1 | 2", "--study.vary", "window.length = 20 | 30",
                        "--study.output", study], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        done = self.draw(study, "-o", self.scratch / "of_study")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.check_files(self.scratch / "of_study", {"effects"})
        drawn = figures.draw(modebank.Archive(study / "study.h5"))[0]
        with h5py.File(study / "study.h5") as file:
            effects, runs = file["answers/main_effects"][:], file["study"][:]
        of = {(row["key"], row["value"], row["score"]): row for row in effects}
        best = [of[b"window.length", value, b"bank_test_log_score"]["best"] for value in (b"20", b"30")]
        axes = drawn["effects"].axes[1]
        np.testing.assert_array_equal(line(axes, "best").get_ydata(), best)
        for value, run in zip(line(axes, "runs").get_xdata(), runs):
            self.assertEqual((20, 30)[int(value)], float(run["window.length"]))

    def test_colours_are_the_pages(self):
        palette = json.loads((SOURCE / "app/report/web/palette.json").read_text(encoding="utf-8"))
        self.assertEqual(figures.MODES, palette["modes"])
        for name, colour in figures.FILTERS.items():
            self.assertEqual(palette["filters"][name], colour, name)

    def test_names_are_text(self):
        state = "_$\\frac{<w>$&%"
        runs = {name: [part.rename(columns={"wz": state}) for part in parts] for name, parts in frames().items()}
        archive = modebank.run(runs, state=state, input=COLUMNS["input"], **QUICK)
        figure = figures.draw(archive)[0]["estimates"]
        figure.savefig(self.scratch / "names.svg")
        self.assertIn("_$\\frac{&lt;w&gt;$&amp;%", (self.scratch / "names.svg").read_text(encoding="utf-8"))

    def test_what_is_missing_is_named(self):
        only_windows = self.scratch / "windows.h5"
        subprocess.run([os.environ["MODEBANK_PROGRAM"], "run", SOURCE / "configs/demo.ini", "--until", "windows",
                        "--data.root", folder(), "--archive.output", only_windows],
                       check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        drawn, left_out = figures.draw(modebank.Archive(only_windows))
        self.assertEqual(drawn, {})
        self.assertEqual(left_out["local_models"], "the archive holds no mixture")
        self.assertEqual(left_out["estimates"], "the archive holds no evaluation of a bank")
        self.assertEqual(left_out["coverage"], "the archive holds no scores")
        unknown = self.draw(self.archive.path, "-o", self.scratch / "none", "--run", "17")
        self.assertEqual(unknown.returncode, 1)
        self.assertIn("no run '17'; its runs are 00, 01", unknown.stderr)
        self.assertFalse((self.scratch / "none").exists())


if __name__ == "__main__":
    unittest.main()
