"""Files that people bring, read rightly or refused by name: what `init` proposes and what `identify` makes of it.

Every log moves by v(k+1) = 0.9 v(k) + 0.1 u(k), so a pair of numbers shows whether rows, names and times are right.
"""
import json
import os
import pathlib
import re
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import unittest

try:
    import h5py
    import numpy as np
except ImportError as missing:
    if os.environ.get("CI") == "true" or os.environ.get("MODEBANK_NIGHTLY") == "1":
        raise
    print(f"SKIPPED: Python has no module {missing.name} (Debian: python3-h5py, python3-numpy)")
    sys.exit(77)

PROGRAM = os.environ["MODEBANK_PROGRAM"]


def drive(seed, n=400):
    """Speed and throttle of a drive, one column each."""
    draw = np.random.default_rng(seed)
    u = np.repeat(draw.uniform(-1, 1, n // 10), 10)
    v = np.zeros(n)
    for k in range(1, n):
        v[k] = 0.9 * v[k - 1] + 0.1 * u[k - 1] + 0.01 * draw.standard_normal()
    return v, u


def message(ns, names, velocities):
    """A sensor_msgs/JointState of ROS 2, without positions and efforts."""
    data = b"\0\1\0\0" + struct.pack("<iI", ns // 10**9, ns % 10**9)
    for word in ("", names, *names):
        data += bytes(-len(data) % 4)
        text = word.encode() + b"\0" if isinstance(word, str) else b""
        data += struct.pack("<I", len(text or word)) + text
    data += bytes(-len(data) % 4) + struct.pack("<II", 0, len(velocities))
    data += bytes((4 - len(data)) % 8) + struct.pack(f"<{len(velocities)}d", *velocities)
    return data + struct.pack("<I", 0)


def rows(*columns):
    return ["%s,%.6f,%.6f" % row for row in zip(*columns)]


class Fields(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="modebank-fields-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def modebank(self, *words):
        return subprocess.run([PROGRAM, *map(str, words)], cwd=self.folder, capture_output=True, text=True, timeout=200)

    def write(self, name, *lines, end="\n"):
        (self.folder / name).write_text(end.join([*lines, ""]))

    def proposal(self, *files):
        """The keys of init's proposal, what it doubts, and its tables."""
        done = self.modebank("init", *files, "-o", "log.ini", "--yes", "--force", "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        told = json.loads(done.stdout)
        keys = {key["key"]: key["value"] for key in told["keys"]}
        return keys, " ".join(told["doubts"]), [table for file in told["files"] for table in file["tables"]]

    def learned(self, *words):
        """Rows of each run, the median step, and the motion of the proposal's data."""
        done = self.modebank("identify", "log.ini", "--archive.output", "log.h5", "--force", "--window.model", "linear",
                             "--data.missing", "gap", *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(self.folder / "log.h5") as file:
            data = {name: file["data"][name][()] for name in ("runs", "time", "state", "input")}
        runs = [slice(run["first"], run["first"] + run["samples"]) for run in data["runs"]]
        old = np.vstack([np.c_[data["state"][run], data["input"][run]][:-1] for run in runs])
        new = np.vstack([data["state"][run][1:] for run in runs])
        motion = np.linalg.lstsq(old, new, rcond=None)[0]
        step = np.median(np.concatenate([np.diff(data["time"][run]) for run in runs]))
        return [run.stop - run.start for run in runs], step, motion[:, 0]

    def expect(self, files, count, step, lengths=None, names=("speed", "throttle")):
        """That a log is read as `count` runs of this step and of the motion above."""
        keys, doubts, tables = self.proposal(*files)
        self.assertEqual((keys["state"], keys["input"]), names)
        found, period, motion = self.learned()
        self.assertEqual(len(found), count)
        self.assertAlmostEqual(period, step, delta=0.02 * step)
        np.testing.assert_allclose(motion, [0.9, 0.1], atol=0.02)
        if lengths:
            self.assertEqual(sorted(set(found)), lengths)
        return keys, doubts, tables

    def refused(self, file, *names):
        """The message of a refusal, which names these objects."""
        done = self.modebank("init", file, "-o", "log.ini", "--yes")
        self.assertNotEqual(done.returncode, 0, done.stdout)
        for name in names:
            self.assertIn(name, done.stderr)
        return done.stderr

    def run_line(self, message, module):
        """Runs the line of Python in a message, if the module is there."""
        if subprocess.run(["/usr/bin/python3", "-c", f"import {module}"], capture_output=True).returncode != 0:
            self.skipTest(f"Python has no module {module}")
        code = re.search(r'python3 -c "(.*?)"', message, re.S)[1]
        subprocess.run(["/usr/bin/python3", "-c", code], cwd=self.folder, check=True)

    def test_a_clock_that_starts_again_begins_a_run(self):
        time = 0.05 * np.arange(400) + np.random.default_rng(1).uniform(0, 0.001, 400)
        for i in range(2):
            lines = [line for part in (0, 1) for line in rows(["%.4f" % t for t in time], *drive(2 * i + part))]
            self.write(f"log_{i}.csv", "time,speed,throttle", *lines)
        keys, doubts, _ = self.expect(["log_0.csv", "log_1.csv"], 4, 0.05, [400])
        self.assertNotIn("disorder", keys)
        self.assertIn("401", doubts)

    def test_counters_of_32_bits_are_counted_on(self):
        for name, start, turn in (("unsigned", 2**32 - 2_000_000, 0), ("signed", 2**31 - 2_000_000, 2**31)):
            count = (start + turn + 10_000 * np.arange(400)) % 2**32 - turn
            self.write(f"{name}.csv", "micros,speed,throttle", *rows(count, *drive(3)))
            self.expect([f"{name}.csv"], 2, 0.01)

    def test_microseconds_since_boot_are_no_milliseconds(self):
        self.write("log.csv", "timestamp,speed,throttle", *rows(500_000_000 + 4_000 * np.arange(400), *drive(4)))
        self.expect(["log.csv"], 2, 0.004)

    def test_numbers_of_windows_are_missing(self):
        v, u = drive(5)
        lines = rows(["%.2f" % (0.05 * k) for k in range(400)], v, u)
        for k, word in {50: "-nan(ind)", 51: "1.#QNAN", 52: "-1.#IND", 200: "1.#INF", 201: "NOT"}.items():
            lines[k] = f"{0.05 * k:.2f},{word},{u[k]:.6f}"
        self.write("log.csv", "time,speed,throttle", *lines[:201], *lines[202:])
        _, _, tables = self.expect(["log.csv"], 4, 0.05)
        self.assertEqual([channel["missing"] for channel in tables[0]["channels"]], [0, 4, 0])
        self.write("log.csv", "time,speed,throttle", *[line.replace("1.#QNAN", "#void") for line in lines])
        ini = (self.folder / "log.ini").read_text()
        (self.folder / "log.ini").write_text(ini.replace("state =", 'na = "#void,NOT"\nstate ='))
        self.learned()

    def test_a_repeated_header_is_left_out(self):
        head = "time,speed,throttle"
        for restart, count in ((400, 2), (200, 3)):  # of the two drives, the split takes the end of the second
            lines = rows(["%.2f" % (0.05 * (k % restart)) for k in range(400)], *drive(6))
            self.write("log.csv", head, *lines[:200], head, *lines[200:])
            _, _, tables = self.expect(["log.csv"], count, 0.05)
            self.assertEqual(tables[0]["rows"], 400)

    def test_separators_at_the_end_cost_nothing(self):
        v, u = drive(7)
        for mark in ",;\t|":
            for ends in ("header", "rows", "header rows", "units", "header units rows"):
                lines = [line.replace(",", mark) for line in rows(["%.2f" % (0.05 * k) for k in range(400)], v, u)]
                end = {part: mark if part in ends.split() else "" for part in ("header", "units", "rows")}
                units = [mark.join(("s", "m/s", "-")) + end["units"]] if "units" in ends else []
                self.write("log.csv", mark.join(("time", "speed", "throttle")) + end["header"], *units,
                           *[line + end["rows"] for line in lines])
                with self.subTest(mark=mark, ends=ends):
                    self.expect(["log.csv"], 2, 0.05)

    def test_an_empty_last_cell_is_a_missing_value(self):
        v, u = drive(8)
        lines = ["%.2f\t%.6f\t%.6f\t" % (0.05 * k, v[k], u[k]) for k in range(400)]
        self.write("log.tsv", "time\tspeed\tthrottle\tnote", *lines)
        self.expect(["log.tsv"], 2, 0.05)

    def test_packed_values_are_unpacked(self):
        v, u = drive(9)
        with h5py.File(self.folder / "log.nc", "w") as file:
            file["time"] = 0.05 * np.arange(400)
            for name, values, offset in (("speed", v, 0.5), ("throttle", u, 0.0)):
                raw = np.round((values - offset) / 0.0001).astype("i2")
                raw[100:102] = -32767 if name == "speed" else raw[100:102]
                data = file.create_dataset(name, data=raw)
                data.attrs.update(scale_factor=0.0001, add_offset=offset, _FillValue=np.array([-32767], "i2"))
        _, _, tables = self.expect(["log.nc"], 3, 0.05)
        self.assertEqual([channel["missing"] for channel in tables[0]["channels"] if channel["name"] == "speed"], [2])

    def test_dimensions_of_length_one_are_dropped_and_others_named(self):
        v, u = drive(10)
        with h5py.File(self.folder / "log.h5", "w") as file:
            file["time"] = 0.05 * np.arange(400)
            file["speed"] = v.reshape(400, 1, 1)
            file["throttle"] = u.reshape(1, 400, 1)
            file["image"] = np.zeros((400, 2, 3))
        self.expect(["log.h5"], 2, 0.05)
        self.assertIn("image", self.modebank("init", "log.h5", "-o", "b.ini", "--yes").stdout)

    def test_a_matrix_by_rows_is_turned(self):
        with h5py.File(self.folder / "log.h5", "w") as file:
            file["log"] = np.c_[0.05 * np.arange(400), np.c_[drive(11)]].T
        keys, _, tables = self.proposal("log.h5")
        self.assertEqual((keys["time"], len(tables[0]["channels"]), tables[0]["rows"]), ("log[0]", 3, 400))

    def test_signals_with_their_own_times_are_refused(self):
        v, u = drive(12)
        lines = ["%.2f,%.6f," % (0.05 * k, v[k]) + ("%.3f,%.6f" % (0.5 * k, u[10 * k]) if k < 40 else ",")
                 for k in range(400)]
        self.write("log.csv", "time_speed,speed,time_throttle,throttle", *lines)
        self.run_line(self.refused("log.csv", "time_throttle"), "pandas")
        self.assertEqual(len((self.folder / "table_2.csv").read_text().split()), 41)

    def test_vectors_in_cells_are_refused(self):
        v, u = drive(13)
        lines = ['%d,"[%.6f %.6f]","[%.6f, 0.5]",%.6f' % (k, v[k], 2 * v[k], u[k], -v[k] ** 2) for k in range(400)]
        self.write("log.csv", "step,observation,action,reward", *lines)
        self.run_line(self.refused("log.csv", "observation", "action"), "pandas")
        self.assertIn("observation_0", (self.folder / "flat.csv").read_text().split("\n")[0])

    def test_signals_of_one_value_column_are_refused(self):
        v, u = drive(14)
        lines = [f"{0.05 * k:.2f},{name},{x[k]:.6f}" for k in range(400) for name, x in (("speed", v), ("throttle", u))]
        self.write("log.csv", "time,name,value", *lines)
        self.run_line(self.refused("log.csv", "value", "name"), "pandas")
        self.expect(["wide.csv"], 2, 0.05)

    def test_episodes_are_refused_and_written_apart(self):
        with h5py.File(self.folder / "demos.hdf5", "w") as file:
            for i in range(4):
                v, u = drive(20 + i)
                file[f"data/demo_{i}/actions"], file[f"data/demo_{i}/obs/velocity"] = np.c_[u, u], v
        self.run_line(self.refused("demos.hdf5", "demo_0"), "h5py")
        self.assertEqual(len(list(self.folder.glob("run_demo_*.csv"))), 4)

    def test_joints_are_found_by_name(self):
        v, u = drive(30)
        base = sqlite3.connect(self.folder / "log.db3")
        base.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format)")
        base.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data)")
        base.execute("INSERT INTO topics VALUES(1, '/joint_states', 'sensor_msgs/msg/JointState', 'cdr')")
        for k in range(400):
            ns = 1_700_000_000 * 10**9 + 50_000_000 * k
            joints = {"speed": v[k], "throttle": u[k]}
            order = sorted(joints, reverse=k >= 200)  # the controller restarts
            for names, values in ((order, [joints[name] for name in order]), (["pan"], [np.sin(k)])):
                base.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(1, ?, ?)",
                             (ns, message(ns, names, values)))
        base.commit()
        base.close()
        self.write("log.ini", "[data]", "inputs = log.db3", "state = /joint_states.velocity{speed}",
                   "input = /joint_states.velocity{throttle}", "split = last 20 %")
        lengths, step, motion = self.learned()
        self.assertEqual((sum(lengths) > 380, round(step, 6)), (True, 0.05))
        np.testing.assert_allclose(motion, [0.9, 0.1], atol=0.02)
        self.assertNotIn("[", self.proposal("log.db3")[0]["state"])

    def test_a_result_of_modelica_and_cells_are_refused(self):
        def matrix(name, values, kind, types={0: "<f8", 20: "<i4", 51: "u1"}):
            values = np.atleast_2d(values)
            head = struct.pack("<5i", kind, *values.shape, 0, len(name) + 1) + name.encode() + b"\0"
            return head + values.astype(types[kind]).tobytes(order="F")

        v, u = drive(31)
        names = np.array([[ord(c) for c in name.ljust(5)] for name in ("time", "speed", "u")])
        (self.folder / "log.mat").write_bytes(
            matrix("name", names.T, 51) + matrix("dataInfo", [[0, 2, 2], [1, 2, -3], [0, 0, 0], [-1, -1, -1]], 20) +
            matrix("data_2", [0.05 * np.arange(400), v, -u], 0))
        self.run_line(self.refused("log.mat", "Modelica"), "scipy.io")
        self.expect(["log.mat.csv"], 2, 0.05, names=("speed", "u"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
