"""`export --to regimes`, compared with the archive by json, h5py and numpy; gates by the standard normal's quantiles."""
import json
import os
import pathlib
import statistics
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

import modebank
from simulated import COLUMNS, QUICK, frames


class Regimes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.path = pathlib.Path(scratch.name) / "ice.h5"
        lags = {**QUICK, "window.model": "varx", "window.state_lags": 2, "mixture.components": [2], "archive.output": cls.path}
        modebank.run(frames(), **COLUMNS, **lags)
        cls.page = json.loads(cls.exported())
        file = h5py.File(cls.path)
        cls.addClassCleanup(file.close)
        cls.bank = {name: file["bank"][name][:] for name in ("C", "Q", "R", "transition", "initial_probability")}
        cls.dt = file["bank"].attrs["dt_s"]

    @classmethod
    def exported(cls, *options):
        return subprocess.run([os.environ["MODEBANK_PROGRAM"], "export", cls.path, "--to", "regimes", "--force", *options],
                              check=True, capture_output=True, text=True).stdout

    def test_arrays_are_the_archives(self):
        C = self.bank["C"]
        self.assertGreater(len(self.bank["Q"]), 1)
        self.assertEqual(self.bank["Q"].shape[1], 2, "two lags, one measured state")
        for regime, Q in zip(self.page["regimes"], self.bank["Q"], strict=True):
            np.testing.assert_allclose(regime["Q"]["value"], C @ Q @ C.T, rtol=1e-15)
            np.testing.assert_allclose(regime["Q_per_s"]["value"], C @ Q @ C.T / self.dt, rtol=1e-15)
        np.testing.assert_array_equal(self.page["R"]["value"], self.bank["R"])
        np.testing.assert_array_equal(self.page["transition"]["T"], self.bank["transition"])
        np.testing.assert_array_equal(self.page["transition"]["initial_probability"], self.bank["initial_probability"])
        self.assertEqual(self.page["dt_s"], self.dt)

    def test_covariances_are_symmetric_and_positive_definite(self):
        for covariance in [self.page["R"], *(regime["Q"] for regime in self.page["regimes"])]:
            matrix = np.array(covariance["value"])
            np.testing.assert_array_equal(matrix, matrix.T)
            self.assertGreater(np.linalg.eigvalsh(matrix).min(), 0.0)

    def test_rows_of_transitions_sum_to_one_and_give_the_stay(self):
        T = np.array(self.page["transition"]["T"])
        np.testing.assert_allclose(T.sum(axis=1), 1.0, rtol=1e-12)
        self.assertAlmostEqual(sum(self.page["transition"]["initial_probability"]), 1.0, 12)
        self.assertAlmostEqual(sum(regime["used"] for regime in self.page["regimes"]), 1.0, 9)
        for i, regime in enumerate(self.page["regimes"]):
            self.assertEqual(regime["index"], i)
            np.testing.assert_allclose(regime["stay_s"], self.dt / (1.0 - T[i, i]), rtol=1e-12)

    def test_gates_are_quantiles_of_chi_square(self):
        gates = self.page["gates"]
        self.assertEqual([(gate["signals"], gate["share"]) for gate in gates], [(1, 0.95), (1, 0.99), (1, 0.999)])
        for gate in gates:
            self.assertAlmostEqual(gate["nis"], statistics.NormalDist().inv_cdf((1 + gate["share"]) / 2) ** 2, 9)

    def test_units_follow_from_the_states(self):
        self.assertEqual(self.page["signals"], [{"name": "wz", "unit": ""}])
        named = modebank.run(frames(), **COLUMNS, **QUICK, **{"data.state_unit": "rad/s", "archive.output": self.path.with_name("named.h5")})
        page = json.loads(subprocess.run([os.environ["MODEBANK_PROGRAM"], "export", named.path, "--to", "regimes", "--force"],
                                         check=True, capture_output=True, text=True).stdout)
        self.assertEqual(page["R"]["unit"], [["(rad/s)^2"]])
        self.assertEqual(page["regimes"][0]["Q"]["unit"], [["(rad/s)^2"]])
        self.assertEqual(page["regimes"][0]["Q_per_s"]["unit"], [["(rad/s)^2/s"]])

    def test_a_competitor_is_one_regime_without_use(self):
        page = json.loads(self.exported("--track.filter", "baseline"))
        self.assertEqual([regime["used"] for regime in page["regimes"]], [None])
        self.assertEqual(page["source"]["filter"], "baseline")
        self.assertIsNone(page["regimes"][0]["stay_s"], "it is never left")


if __name__ == "__main__":
    unittest.main()
