"""Frames and files with the same data, roles, resampling, lags and missing values give the same archive."""
import os
import tempfile
import unittest
import warnings

import h5py
import numpy as np
import pandas
from numpy.lib.recfunctions import repack_fields

import modebank
from simulated import COLUMNS, QUICK, SOURCE, folder, frames


def content(archive):
    """Every array, without its provenance."""
    found = {}

    def take(path, item):
        if isinstance(item, h5py.Dataset) and path != "config" and not path.startswith("provenance"):
            found[path] = np.asarray(item[()])
        if path == "data/runs":
            found[path] = repack_fields(found[path][["name", "role", "first", "samples", "lag_s"]])  # except for the file name

    with h5py.File(archive.path) as file:
        file.visititems(take)
    return found


class Frames(unittest.TestCase):
    def same(self, ours, theirs):
        """Bit by bit: NaN is NaN, in tables too."""
        self.assertEqual(set(ours), set(theirs))
        for path, values in theirs.items():
            self.assertEqual(ours[path].dtype, values.dtype, path)
            self.assertEqual(ours[path].shape, values.shape, path)
            self.assertEqual(ours[path].tobytes(), values.tobytes(), path)

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.scratch = scratch.name

    def from_files(self, keys, root=None):
        ini = os.path.join(self.scratch, "files.ini")
        with open(ini, "w", encoding="utf-8") as file:
            file.write("[data]\ninputs = pro_*.csv\nstates = imu_*.csv\nstate = wz\ninput = cmd_velL, cmd_velR\n")
        return modebank.run(ini, **{**QUICK, "data.root": root or folder(),
                                    "archive.output": os.path.join(self.scratch, "files.h5"), **keys})

    def compare(self, keys, runs=None, root=None):
        ours = content(modebank.run(runs or frames(), **COLUMNS, **{**QUICK, **keys}))
        theirs = content(self.from_files(keys, root))
        self.same(ours, theirs)

    def test_as_they_stand(self):
        self.compare({})

    def test_names_with_commas_and_quotes(self):
        names = {"wz": "wz, filtered", "cmd_velL": "'left' [m/s]", "cmd_velR": "right, m/s"}
        plain = {name: pair for name, pair in frames().items()}
        renamed = {name: tuple(frame.rename(columns=names) for frame in pair) for name, pair in plain.items()}
        ours = modebank.run(renamed, state=[names["wz"]], input=[names["cmd_velL"], names["cmd_velR"]], **QUICK)
        theirs = modebank.run(plain, **COLUMNS, **QUICK)
        self.assertEqual(ours.state_names, [names["wz"]])
        for path in ("/data/state", "/data/input", "/bank/A", "/bank/B"):
            np.testing.assert_array_equal(ours[path], theirs[path], path)

    def test_a_list_of_derived_channels(self):
        derive = ["turn = 2 * wz", "both = max(cmd_velL, cmd_velR)"]
        archive = modebank.run(frames(), state=["turn"], input=["both"], **QUICK, **{"data.derive": derive})
        wheels, gyro = frames()["01"]
        run = archive.run("01")["input"]
        np.testing.assert_array_equal(run[:, 0], np.fmax(wheels.cmd_velL, wheels.cmd_velR)[:len(run)])

    def test_roles_rate_lag_and_units(self):
        self.compare({"data.train": ["02", "03"], "data.test": "00", "data.rate_hz": 5, "data.lag_s": 0.1,
                      "data.state_unit": "rad/s"})

    def test_missing_values(self):
        runs = frames()
        for inputs, states in runs.values():
            states.loc[200:230, "wz"] = np.nan
        for name, (inputs, states) in runs.items():
            inputs.to_csv(os.path.join(self.scratch, f"pro_{name}.csv"), index=False)
            states.to_csv(os.path.join(self.scratch, f"imu_{name}.csv"), index=False)
        self.compare({"data.missing": "predict"}, runs, self.scratch)
        with self.assertRaisesRegex(modebank.DataError, r"00 \(states\):200: column wz: missing value"):
            modebank.run(runs, **COLUMNS, **QUICK)

    def test_one_frame_per_run_with_times_as_index(self):
        joined = {}
        for name, (inputs, states) in frames().items():
            both = inputs[["time", "cmd_velL", "cmd_velR"]].copy()
            both["wz"] = np.interp(both.time, states.time, states.wz)
            joined[name] = both
        by_column = modebank.run(joined, **COLUMNS, **QUICK)
        by_index = modebank.run({name: run.set_index("time") for name, run in joined.items()}, **COLUMNS, **QUICK)
        by_other_name = modebank.run({name: run.rename(columns={"time": "t"}) for name, run in joined.items()},
                                     time="t", **COLUMNS, **QUICK)
        dated = {name: run.set_index(pandas.to_datetime((run.time * 1e9).round().astype("int64"))).drop(columns="time")
                 for name, run in joined.items()}
        by_date = modebank.run(dated, **COLUMNS, **QUICK)
        expected = content(by_column)
        for archive in (by_index, by_other_name):
            self.same(content(archive), expected)
        np.testing.assert_allclose(by_date["/data/time"], expected["data/time"], atol=1e-9)
        self.assertEqual(by_column.attributes()["data_hash"], by_index.attributes()["data_hash"])

    def test_runs_in_one_frame(self):
        parts = []
        for name, (inputs, states) in frames().items():
            part = inputs[["time", "cmd_velL", "cmd_velR"]].copy()
            part["wz"] = np.interp(part.time, states.time, states.wz)
            part["drive"] = "drive_" + name
            parts.append(part)
        archive = modebank.run({"all": pandas.concat(parts)}, **COLUMNS, **{**QUICK, "data.run": "drive"})
        self.assertEqual(archive.runs, ["drive_00", "drive_01", "drive_02", "drive_03"])

    def test_the_hash_is_of_the_content(self):
        runs = frames()
        columns = {**COLUMNS, **QUICK}
        first = modebank.run(runs, **columns).attributes()["data_hash"]
        self.assertEqual(modebank.run(runs, **columns).attributes()["data_hash"], first)
        runs["00"][1].loc[5, "wz"] += 1e-9
        self.assertNotEqual(modebank.run(runs, **columns).attributes()["data_hash"], first)

    def test_an_archive_of_frames_says_that_no_file_holds_them(self):
        archive = modebank.run(frames(), **COLUMNS, **QUICK)
        with tempfile.TemporaryDirectory() as scratch:
            config = os.path.join(scratch, "again.ini")
            with open(config, "w", encoding="utf-8") as file:
                file.write(archive.config)
            with self.assertRaisesRegex(modebank.ConfigurationError, "call modebank.run with the same frames again"):
                modebank.run(config, **{"archive.output": os.path.join(scratch, "again.h5")})

    def test_mistakes(self):
        with self.assertRaisesRegex(modebank.ConfigurationError, 'no column "wy", did you mean wz'):
            modebank.run(frames(), state="wy", input=["cmd_velL"])
        with self.assertRaisesRegex(modebank.ConfigurationError, "no runs"):
            modebank.run({}, **COLUMNS)

    def test_a_temporary_archive_goes_with_its_object(self):
        archive = modebank.run(frames(), **COLUMNS, **QUICK)
        path = archive.path
        self.assertTrue(os.path.exists(path))
        del archive
        self.assertFalse(os.path.exists(path))

    def test_warnings_are_pythons(self):
        with warnings.catch_warnings(record=True) as heard:
            warnings.simplefilter("always")
            runs = frames()
            for inputs, states in runs.values():
                states.loc[200:230, "wz"] = np.nan
            modebank.run(runs, **COLUMNS, **{**QUICK, "data.missing": "gap"})
        self.assertTrue(any("has gaps" in str(warning.message) for warning in heard))


class Logs(unittest.TestCase):
    def test_a_csv_is_one_frame(self):
        tables = modebank.read(folder() / "imu_00.csv")
        self.assertEqual(list(tables), [""])
        pandas.testing.assert_frame_equal(tables[""], frames()["00"][1], check_dtype=False)

    def test_chosen_columns_alone(self):
        log = folder() / "imu_00.csv"
        chosen = modebank.read(log, columns=["wz"])[""]
        self.assertEqual(list(chosen.columns), ["wz"])
        np.testing.assert_array_equal(chosen["wz"], modebank.read(log)[""]["wz"])
        with self.assertRaisesRegex(modebank.ConfigurationError, "did you mean wz"):
            modebank.read(log, columns=["wy"])

    def test_text_columns_are_text(self):
        with tempfile.TemporaryDirectory() as scratch:
            path = os.path.join(scratch, "mixed.csv")
            with open(path, "w", encoding="utf-8") as file:
                file.write("time,ground,v\n0,ice,1\n1,grip,\n")
            frame = modebank.read(path)[""]
        self.assertEqual(frame["ground"].tolist(), ["ice", "grip"])
        np.testing.assert_array_equal(frame["v"], [1.0, np.nan])

    def test_a_broken_row_is_an_error(self):
        with tempfile.TemporaryDirectory() as scratch:
            path = os.path.join(scratch, "broken.csv")
            with open(path, "w", encoding="utf-8") as file:
                file.write("time,v\n0,1\n1,2,3\n")
            with self.assertRaisesRegex(modebank.DataError, "broken.csv:3"):
                modebank.read(path)

    def test_mcap_of_the_reference_implementation(self):
        """Messages as tests/golden/generate/mcap_core.mjs wrote them."""
        k = np.arange(40)
        for form in ("none", "lz4", "zstd", "unchunked", "bare"):
            tables = modebank.read(SOURCE / f"tests/golden/data/mcap_core_{form}.mcap")
            self.assertEqual(list(tables), ["/golden"])
            found = tables["/golden"].rename(columns=lambda name: name.removeprefix("/golden."))
            for name, first_s in (("stamp", 1_700_000_000), ("receive_time", 1_700_000_001)):
                np.testing.assert_array_equal(found[name].astype("int64"), first_s * 10**9 + 25_000_000 * k)
            self.assertEqual(found["s"].tolist(), [f"m{i}" for i in k])
            for name, values in (("x", k / 4), ("n", -k), ("pair[0]", k), ("pair[1]", k + 0.5)):
                np.testing.assert_array_equal(found[name], values, name)

    def test_what_is_no_log_is_an_error(self):
        with self.assertRaises(modebank.ConfigurationError):
            modebank.read("no_such_file.csv")


if __name__ == "__main__":
    warnings.simplefilter("ignore", UserWarning)  # warning on few candidates
    unittest.main()
