"""MATLAB's iddata objects as frames: tests/golden/generate/mat_objects.py."""
import importlib.util
import os
import unittest

import numpy as np

import modebank

GOLDEN = os.path.join(os.environ["MODEBANK_SOURCE"], "tests", "golden", "data")


@unittest.skipUnless(importlib.util.find_spec("scipy"), "needs scipy")
class Iddata(unittest.TestCase):
    def test_one_experiment(self):
        frames = modebank.read_iddata(os.path.join(GOLDEN, "mat_iddata.mat"))
        self.assertEqual(list(frames), ["Exp1"])
        frame = frames["Exp1"]
        self.assertEqual(list(frame), ["time", "speed", "throttle"])
        np.testing.assert_allclose(frame["time"], 0.1 * np.arange(20))
        np.testing.assert_array_equal(frame["speed"], np.arange(20))
        np.testing.assert_array_equal(frame["throttle"], 2 * np.arange(20))
        self.assertEqual(frame.attrs["units"], {"speed": "m/s", "throttle": "V"})

    def test_experiments_are_runs(self):
        frames = modebank.read_iddata(os.path.join(GOLDEN, "mat_iddata_two.mat"), "z")
        self.assertEqual(list(frames), ["Exp1", "Exp2"])
        self.assertEqual(list(frames["Exp2"]), ["time", "speed", "level", "throttle"])
        np.testing.assert_allclose(frames["Exp2"]["time"], 0.2 * np.arange(15))
        np.testing.assert_array_equal(frames["Exp2"]["level"], 3 * np.arange(15) + 1)
        np.testing.assert_array_equal(frames["Exp2"]["throttle"], 4 * np.arange(15))

    def test_a_file_without_one(self):
        with self.assertRaisesRegex(modebank.ConfigurationError, "holds 0 iddata objects"):
            modebank.read_iddata(os.path.join(GOLDEN, "mat_table.mat"))


if __name__ == "__main__":
    unittest.main()
