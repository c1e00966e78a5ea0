"""The demo in Python: a run of its configuration file, its archive read by h5py, and its filter."""
import os
import pathlib
import signal
import tempfile
import unittest
import warnings

import h5py
import numpy as np
import pandas

import modebank
from simulated import COLUMNS, QUICK, SOURCE, folder, frames


class Demo(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.lines = []
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.archive = modebank.run(SOURCE / "configs/demo.ini", progress=cls.lines.append, **QUICK,
                                   **{"data.root": folder(), "archive.output": cls.scratch.name + "/demo.h5"})
        cls.file = h5py.File(cls.archive.path)  # from here on both have the file open
        cls.addClassCleanup(cls.file.close)

    def test_the_demo_in_ten_lines(self):
        runs = frames()
        archive = modebank.run(runs, **COLUMNS, **QUICK)
        step = modebank.Filter(archive).step
        inputs, states = runs["01"]
        wz = np.interp(inputs.time, states.time, states.wz)
        inside = 0
        for t, left, right, y in zip(inputs.time, inputs.cmd_velL, inputs.cmd_velR, wz):
            e = step(t, (left, right), y)
            inside += abs(e.innovation[0]) < 2 * e.innovation_covariance[0, 0] ** 0.5
        self.assertGreater(inside / len(wz), 0.85)
        self.assertGreaterEqual(archive.modes, 2)

    def test_progress_is_said(self):
        self.assertTrue(any(line.startswith("import: 4 runs") for line in self.lines), self.lines)

    def test_every_array_is_what_h5py_reads(self):
        def compare(path, item):
            if not isinstance(item, h5py.Dataset):
                return
            ours, theirs = self.archive[path], item[()]
            if isinstance(ours, pandas.DataFrame):
                self.compare_table(path, ours, theirs)
            elif theirs.dtype.kind == "S" if isinstance(theirs, np.ndarray) else isinstance(theirs, bytes):
                self.assertEqual(ours, np.char.decode(theirs, "utf-8").tolist(), path)
            else:
                np.testing.assert_array_equal(ours, theirs, path)
                self.assertEqual(ours.dtype, theirs.dtype, path)

        self.file.visititems(compare)

    def compare_table(self, path, ours, theirs):
        self.assertEqual(len(ours), len(theirs), path)
        for name in theirs.dtype.names:
            column = theirs[name]
            if column.ndim == 2:
                states = self.archive.state_names
                labels = states if len(states) == column.shape[1] else range(column.shape[1])
                np.testing.assert_array_equal(ours[[f"{name}[{label}]" for label in labels]].to_numpy(), column, path)
            elif column.dtype.kind == "S":
                self.assertEqual(ours[name].tolist(), np.char.decode(column, "utf-8").tolist(), path)
            else:
                np.testing.assert_array_equal(ours[name], column, path)

    def test_attributes_are_what_h5py_reads(self):
        bank = self.archive.attributes("/bank")
        self.assertEqual(bank["dt_s"], self.file["bank"].attrs["dt_s"])
        self.assertEqual(bank["state_names"], ["wz"])
        self.assertEqual(self.archive.attributes()["data_hash"], self.file.attrs["data_hash"].decode())

    def test_arrays_have_names(self):
        self.assertEqual(self.archive.B.names, (None, ["wz"], ["cmd_velL", "cmd_velR"]))
        self.assertEqual(self.archive["/windows/parameters"].names[1], ["wz <- wz", "wz <- cmd_velL", "wz <- cmd_velR"])
        self.assertIsNone(self.archive.B[0].names)

    def test_evidence_and_verdict_are_the_archives(self):
        self.assertEqual(self.archive.evidence["text"], self.file["evaluation/evidence"].attrs["text"].decode())
        self.assertIn(self.archive.verdict, str(self.archive))
        self.assertIn("[window]", self.archive.config)
        self.assertTrue({"filter", "run", "log_score"} <= set(self.archive.summary.columns))

    def test_motions_hold_every_mode_once(self):
        motions = self.archive.motions
        self.assertEqual(sorted(k for motion in motions for k in motion["modes"]), list(range(self.archive.modes)))
        uses = [motion["use"] for motion in motions]
        self.assertEqual(uses, sorted(uses, reverse=True))
        self.assertAlmostEqual(sum(uses), 1.0, 9)
        for motion in motions:
            self.assertEqual(motion["gain"].shape, (1, 2))

    def test_the_bank_is_the_archives(self):
        bank = self.archive.bank
        for name in ("A", "B", "c", "Q", "C", "R", "transition"):
            np.testing.assert_array_equal(getattr(bank, name), self.file["bank"][name][()], name)

    def test_filter_steps_as_the_evaluation_did(self):
        for which in ("bank", "baseline"):
            step = modebank.Filter(self.archive, which=which).step
            data = self.archive.run("01")
            said = data[which]
            for k, (t, u, y) in enumerate(zip(data["time"], data["input"], data["state"])):
                estimate = step(t, u, y)
                for name in ("prediction", "innovation_covariance", "state", "covariance", "mode_probability"):
                    np.testing.assert_allclose(getattr(estimate, name), said[name][k], rtol=1e-12, atol=1e-300,
                                               err_msg=f"{which} {name} {k}")

    def test_a_run_is_its_rows(self):
        table = self.file["data/runs"][:]
        for row in table:
            run = self.archive.run(row["name"].decode())
            rows = slice(row["first"], row["first"] + row["samples"])
            self.assertEqual((run.role, run.lag_s, run.file), (row["role"].decode(), row["lag_s"], row["file"].decode()))
            for name in ("time", "state", "input"):
                np.testing.assert_array_equal(run[name], self.file["data"][name][rows], name)
            for filter in ("bank", "baseline"):
                self.assertEqual(sorted(run[filter]), sorted(self.file["evaluation"][filter]))
                for name, values in run[filter].items():
                    np.testing.assert_array_equal(values, self.file["evaluation"][filter][name][rows], name)
        self.assertEqual(self.archive.runs, [name.decode() for name in table["name"]])
        self.assertIn("bank", self.archive.run("01").keys())
        with self.assertRaisesRegex(KeyError, "no run 'x'"):
            self.archive.run("x")
        with self.assertRaisesRegex(KeyError, "velocity is none of"):
            self.archive.run("01")["velocity"]

    def test_what_is_missing_is_said(self):
        with self.assertRaises(KeyError):
            self.archive["/bank/nothing"]
        self.assertNotIn("/bank/nothing", self.archive)
        self.assertIn("/bank/A", self.archive)

    def test_a_damaged_archive_is_refused(self):
        content = bytearray(pathlib.Path(self.archive.path).read_bytes())
        content[len(content) // 2] ^= 1
        damaged = pathlib.Path(self.scratch.name) / "damaged.h5"
        damaged.write_bytes(content)
        with self.assertRaisesRegex(modebank.DataError, "damaged"):
            modebank.Archive(damaged)

    def test_mistakes_are_exceptions_that_name_the_key(self):
        with self.assertRaisesRegex(ValueError, "window.length"):
            modebank.run(SOURCE / "configs/demo.ini", window={"length": "long"})
        with self.assertRaisesRegex(modebank.ConfigurationError, "did you mean window.length"):
            modebank.run(SOURCE / "configs/demo.ini", **{"window.lenght": 3})
        with self.assertRaises(modebank.ConfigurationError):
            modebank.run("no_such_file.ini")

    def test_ctrl_c_ends_the_run(self):
        signal.signal(signal.SIGINT, signal.default_int_handler)  # background processes of a shell ignore it
        output = self.scratch.name + "/interrupted.h5"
        with self.assertRaises(KeyboardInterrupt):
            modebank.run(SOURCE / "configs/demo.ini", progress=lambda line: os.kill(os.getpid(), signal.SIGINT), **QUICK,
                         **{"data.root": folder(), "archive.output": output})
        self.assertFalse(os.path.exists(output))


if __name__ == "__main__":
    warnings.simplefilter("ignore", UserWarning)  # warning on few candidates
    unittest.main()
