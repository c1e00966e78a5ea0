"""Files that people bring, read rightly or refused by name: what `init` proposes and what `run` makes of it.

Every log moves by v(k+1) = 0.9 v(k) + 0.1 u(k), so a pair of numbers shows whether rows, names and times are right.
"""
import re
import sqlite3
import struct
import subprocess
import sys

from program import ProgramTest, h5py, main, modebank, np, proposal

HEAD, TIMES = "time,speed,throttle", ["%.2f" % (0.05 * k) for k in range(400)]


def drive(seed):
    """Speed and throttle of 400 samples."""
    draw = np.random.default_rng(seed)
    u, v = np.repeat(draw.uniform(-1, 1, 40), 10), np.zeros(400)
    for k in range(1, 400):
        v[k] = 0.9 * v[k - 1] + 0.1 * u[k - 1] + 0.01 * draw.standard_normal()
    return v, u


def rows(times, seed):
    return ["%s,%.6f,%.6f" % row for row in zip(times, *drive(seed))]


def joint_state(ns, names, velocities):
    """A sensor_msgs/JointState of ROS 2, without positions and efforts."""
    data = b"\0\1\0\0" + struct.pack("<iI", ns // 10**9, ns % 10**9)
    for word in ("", names, *names):
        text = word.encode() + b"\0" if isinstance(word, str) else b""
        data += bytes(-len(data) % 4) + struct.pack("<I", len(text or word)) + text
    data += bytes(-len(data) % 4) + struct.pack("<II", 0, len(velocities))
    return data + bytes((4 - len(data)) % 8) + struct.pack(f"<{len(velocities)}d", *velocities) + struct.pack("<I", 0)


class Fields(ProgramTest):
    def modebank(self, *words, status=0):
        return modebank(*words, status=status, cwd=self.folder)

    def write(self, name, *lines):
        (self.folder / name).write_text("\n".join([*lines, ""]))

    def learned(self):
        """Rows of each run and the median step of the configuration's data, whose motion must be the drive's."""
        self.modebank("run", "x.ini", "--until", "windows", "--archive.output", "out.h5", "--force",
                      "--window.model", "linear", "--data.missing", "gap")
        with h5py.File(self.folder / "out.h5") as file:
            data = {name: file["data"][name][()] for name in ("runs", "time", "state", "input")}
        runs = [slice(run["first"], run["first"] + run["samples"]) for run in data["runs"]]
        old = np.vstack([np.c_[data["state"][run], data["input"][run]][:-1] for run in runs])
        new = np.vstack([data["state"][run][1:] for run in runs])
        np.testing.assert_allclose(np.linalg.lstsq(old, new, rcond=None)[0][:, 0], [0.9, 0.1], atol=0.02)
        steps = np.concatenate([np.diff(data["time"][run]) for run in runs])
        return [run.stop - run.start for run in runs], np.median(steps)

    def expect(self, file, step, fewest, state="speed", throttle="throttle"):
        """That init reads a log rightly: its channels, the step, and at least so many rows."""
        keys, doubts, tables = proposal(self.folder, file)
        self.assertEqual((keys["state"], keys["input"]), (state, throttle))
        lengths, period = self.learned()
        self.assertAlmostEqual(period, step, delta=0.02 * step)
        self.assertGreaterEqual(sum(lengths), fewest)
        return keys, doubts, tables[0]

    def refused(self, file, module, *names, status=1):
        """That a refusal names these objects, and that its lines of Python run, if the module is there."""
        message = self.modebank("init", file, "-o", "x.ini", status=status).stderr
        for name in names:
            self.assertIn(name, message)
        if subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True, check=False).returncode != 0:
            self.skipTest(f"Python has no module {module}")
        subprocess.run([sys.executable, "-c", re.search(r'python3 -c "(.*)"', message, re.S)[1]], cwd=self.folder,
                       check=True)

    def test_a_clock_that_starts_again_begins_a_run(self):
        time = ["%.4f" % t for t in 0.05 * np.arange(400) + np.random.default_rng(1).uniform(0, 0.001, 400)]
        self.write("log.csv", HEAD, *rows(time, 1), *rows(time, 2))
        keys, doubts, _ = self.expect("log.csv", 0.05, 740)
        self.assertNotIn("disorder", keys)
        self.assertIn("401", doubts)
        self.write("x.ini", "[data]", "inputs = log.csv", "state = speed", "input = throttle", "disorder = sort")
        self.assertGreaterEqual(sum(self.learned()[0]), 740)

    def test_counters_of_32_bits_are_counted_on(self):
        for start, turn in ((2**32 - 2_000_000, 0), (2**31 - 2_000_000, 2**31)):
            count = (start + turn + 10_000 * np.arange(400)) % 2**32 - turn
            self.write("log.csv", "micros,speed,throttle", *rows(count, 3))
            self.expect("log.csv", 0.01, 370)

    def test_microseconds_since_boot_are_no_milliseconds(self):
        self.write("log.csv", "timestamp,speed,throttle", *rows(500_000_000 + 4_000 * np.arange(400), 4))
        self.expect("log.csv", 0.004, 370)

    def test_numbers_of_windows_and_quoted_words_are_missing(self):
        lines = rows(TIMES, 5)
        for k, word in {50: "-nan(ind)", 51: "1.#QNAN", 52: "-1.#IND", 200: "1.#INF"}.items():
            lines[k] = re.sub(",.*?,", f",{word},", lines[k])
        self.write("log.csv", HEAD, *lines)
        _, _, table = self.expect("log.csv", 0.05, 360)
        self.assertEqual([channel["missing"] for channel in table["channels"]], [0, 4, 0])
        self.write("log.csv", HEAD, *[line.replace("1.#QNAN", "#void") for line in lines])
        self.write("x.ini", "[data]", "inputs = log.csv", "state = speed", "input = throttle", 'na = "#void"',
                   "split = last 20 %")
        self.learned()

    def test_a_repeated_header_is_refused_with_its_line(self):
        lines = rows(TIMES, 6)
        self.write("log.csv", HEAD, *lines[:200], "time,speed,throttle ", *lines[200:])
        self.refused("log.csv", "sys", "log.csv:202")
        self.assertEqual(self.expect("one.csv", 0.05, 370)[2]["rows"], 400)

    def test_separators_at_the_end_cost_nothing(self):
        for mark in ",;\t|":
            for ends in ("header", "rows", "header rows", "units", "header units rows"):
                end = {part: mark if part in ends.split() else "" for part in ("header", "units", "rows")}
                units = [mark.join(("s", "m/s", "-")) + end["units"]] if "units" in ends else []
                self.write("log.csv", HEAD.replace(",", mark) + end["header"], *units,
                           *[line.replace(",", mark) + end["rows"] for line in rows(TIMES, 7)])
                with self.subTest(mark=mark, ends=ends):
                    self.expect("log.csv", 0.05, 370)
        for end in ("\t", "\t\t"):
            lines = [line.replace(",", "\t") + end for line in rows(TIMES, 8)]
            self.write("log.tsv", "time\tspeed\tthrottle\tnote", *lines)
            self.expect("log.tsv", 0.05, 370)

    def test_packed_values_are_unpacked_and_other_arrays_refused(self):
        v, u = drive(9)
        with h5py.File(self.folder / "packed.nc", "w") as file:
            file["time"], file["throttle"] = 0.05 * np.arange(400), u
            raw = np.round((v - 0.5) / 0.0001).astype("i2")
            raw[100:102] = -32767
            file["speed"] = raw
            file["speed"].attrs.update(scale_factor=0.0001, add_offset=0.5, _FillValue=np.array([-32767], "i2"))
        self.expect("packed.nc", 0.05, 370)
        for array in (np.c_[0.05 * np.arange(400), v, u].T, np.zeros((400, 2, 3))):
            with h5py.File(self.folder / "arrays.h5", "w") as file:
                file["log"] = array
            self.refused("arrays.h5", "h5py", "log", status=2)
            self.assertEqual(len(np.loadtxt(self.folder / "log_0.csv", delimiter=",")), 400)

    def test_signals_with_their_own_times_are_refused(self):
        lines = [line + ("," + line.split(",")[0] if k < 40 else ",") for k, line in enumerate(rows(TIMES, 12))]
        self.write("log.csv", "time_speed,speed,throttle,time_2", *lines)
        self.refused("log.csv", "pandas", "time_2")

    def test_vectors_in_cells_are_refused(self):
        lines = [re.sub(",(.*),(.*)", r',"[\1 0.5]","[\2; 1]",\2', line) for line in rows(range(400), 13)]
        self.write("log.csv", "step,observation,action,reward", *lines)
        self.refused("log.csv", "pandas", "observation", "action")
        self.assertIn("observation_0", (self.folder / "flat.csv").read_text().split("\n")[0])

    def test_signals_of_one_value_column_are_refused(self):
        lines = [f"{time},{name},{x[k]:.6f},{name[0]}" for k, time in enumerate(TIMES)
                 for name, x in zip(("speed", "throttle"), drive(14))]
        self.write("log.csv", "time,name,value,unit", *lines)
        self.refused("log.csv", "pandas", "value", "name")
        self.expect("wide.csv", 0.05, 370)

    def test_episodes_are_refused(self):
        with h5py.File(self.folder / "demos.hdf5", "w") as file:
            for i in range(4):
                file[f"data/demo_{i}/obs/velocity"], file[f"data/demo_{i}/actions"] = drive(20 + i)
        self.refused("demos.hdf5", "h5py", "demo_0")
        self.assertEqual(len(list(self.folder.glob("run_demo_*.csv"))), 4)

    def test_results_of_modelica_are_refused(self):
        v, u = drive(31)
        names = np.array([[ord(c) for c in name.ljust(5)] for name in ("time", "speed", "u")]).T
        info = [[0, 2, 2], [1, 2, -3], [0, 0, 0], [-1, -1, -1]]
        with open(self.folder / "log.mat", "wb") as file:
            for name, values, kind, form in (("name", names, 51, "u1"), ("dataInfo", info, 20, "<i4"),
                                             ("data_2", [0.05 * np.arange(400), v, -u], 0, "<f8")):
                file.write(struct.pack("<5i", kind, *np.shape(values), 0, len(name) + 1) + name.encode() + b"\0" +
                           np.array(values, form).tobytes(order="F"))
        self.refused("log.mat", "scipy.io", "Modelica", status=2)
        self.expect("log.mat.csv", 0.05, 370, "speed", "u")

    def test_structs_cells_and_rows_of_matlab_are_refused(self):
        try:
            import scipy.io
        except ImportError:
            self.skipTest("Python has no module scipy")
        runs = np.empty(3, [("speed", object), ("throttle", object)])
        runs[:] = [drive(40 + i) for i in range(3)]
        scipy.io.savemat(self.folder / "structs.mat", {"log": runs})
        self.refused("structs.mat", "scipy.io", "log[0]")
        self.assertEqual(len(list(self.folder.glob("run_*.mat"))), 3)
        cells = np.empty(3, object)
        cells[:] = [np.c_[run["speed"], run["throttle"]] for run in runs]
        scipy.io.savemat(self.folder / "cells.mat", {"trials": cells})
        self.refused("cells.mat", "scipy", "trials", status=2)
        matrix = np.c_[0.05 * np.arange(400), np.transpose(drive(44))]
        scipy.io.savemat(self.folder / "rows.mat", {"log": matrix.T})
        self.refused("rows.mat", "scipy", "log", status=2)
        scipy.io.savemat(self.folder / "resultID.mat", {"resultID": matrix[:, 1:]})
        self.expect("resultID.mat", 1, 370, "resultID[0]", "resultID[1]")

    def test_a_unit_that_contradicts_the_name_is_said(self):
        self.write("log.csv", "time_ms,speed,throttle", "s,m/s,-", *rows(TIMES, 15))
        doubts = self.expect("log.csv", 0.05, 370)[1]
        self.assertRegex(doubts, "time_ms.*milliseconds.*seconds")

    def bag(self, *topics):
        """A bag of ROS 2 with topics of the type JointState."""
        base = sqlite3.connect(self.folder / "log.db3")
        base.executescript("CREATE TABLE topics(id, name, type, serialization_format);"
                           "CREATE TABLE messages(topic_id, timestamp, data);")
        for number, topic in enumerate(topics, 1):
            base.execute("INSERT INTO topics VALUES(?, ?, 'sensor_msgs/msg/JointState', 'cdr')", (number, topic))
        return base

    def test_topics_of_two_robots_are_not_joined(self):
        base = self.bag("/a/joint_states", "/a/command", "/b/joint_states", "/b/command")
        for k, (v, u) in enumerate(zip(*drive(31))):
            ns = 1_700_000_000 * 10**9 + 50_000_000 * k
            for number, value in enumerate((v, 1.0, 0.5, u), 1):
                base.execute("INSERT INTO messages VALUES(?, ?, ?)", (number, ns, joint_state(ns, ["arm"], [value])))
        base.commit()
        base.close()
        message = self.modebank("init", "log.db3", "-o", "log.ini", status=1).stderr
        self.assertRegex(message, "/a/joint_states.*/b/command.*data.input")

    def test_joints_are_found_by_name(self):
        base = self.bag("/joint_states")
        for k, (v, u) in enumerate(zip(*drive(30))):
            ns = 1_700_000_000 * 10**9 + 50_000_000 * k
            order = [("left", v), ("right", u)][::1 if k < 200 else -1]  # the controller restarts
            for joints in (order, [("pan", np.sin(k))]):
                base.execute("INSERT INTO messages VALUES(1, ?, ?)", (ns, joint_state(ns, *zip(*joints))))
        base.commit()
        self.write("x.ini", "[data]", "inputs = log.db3", "state = /joint_states.velocity{left}",
                   "input = /joint_states.velocity{right}", "split = last 20 %")
        self.assertGreaterEqual(sum(self.learned()[0]), 370)
        base.execute("DELETE FROM messages WHERE rowid % 2 = 0")
        base.commit()
        base.close()
        self.assertRegex(proposal(self.folder, "log.db3")[0]["derive"], "velocity{(left|right)}")


if __name__ == "__main__":
    main()
