"""The live filter says of each sample what `run` said: of lines and files, in Python, late and missing."""
import csv
import re
import subprocess

from program import (PROGRAM, ProgramTest, arrays, attributes, demo, learn, main, modebank, np, rows, slices,
                     write_runs)


def columns(text):
    """Lines of `track` as {column: values}. A missing value is NaN."""
    header, *lines = csv.reader(text.splitlines())
    return dict(zip(header, np.array([[field or "nan" for field in line] for line in lines], float).T))


def evaluated(archive, which, run):
    """What the archive says of a run, as columns of `track`."""
    at, said = slices(archive)[run], arrays(archive, f"/evaluation/{which}")
    found = {name: said[name] for name in ("nis", "log_density")}
    for i, name in enumerate(np.char.decode(attributes(archive, "/data")["state_names"], "utf-8")):
        half = 1.959963984540054 * np.sqrt(said["innovation_covariance"][:, i, i])
        found |= {name: said["state"][:, i], name + "_sd": np.sqrt(said["covariance"][:, i, i]),
                  name + "_predicted": said["prediction"][:, i], name + "_lower": said["prediction"][:, i] - half,
                  name + "_upper": said["prediction"][:, i] + half}
    found |= {f"p{mode}": values for mode, values in enumerate(said["mode_probability"].T)}
    return {name: values[at] for name, values in found.items()}


class Track(ProgramTest):
    def track(self, archive, lines, *words, status=0):
        return modebank("track", archive, *words, input="\n".join([*lines, ""]), status=status)

    def check(self, text, expected, tolerance=1e-12):
        said = columns(text)
        for name, values in expected.items():
            np.testing.assert_allclose(said[name], values, tolerance, tolerance, err_msg=name)

    def learn(self, *words, **options):
        """An archive of two small runs, and the lines of the held-out one."""
        archive = learn(self.folder, *words, **options)
        return archive, (self.folder / "run_01.csv").read_text().splitlines()

    def test_files_of_the_demo(self):
        archive, data = demo() / "demo.h5", demo() / "data"
        words = ("track", archive, "--data.inputs", data / "pro_07.csv", "--data.states", data / "imu_07.csv")
        for which in ("bank", "baseline", "noise_only", "one_motion"):
            self.check(modebank(*words, "--track.filter", which).stdout, evaluated(archive, which, "07"))
        [row] = rows(arrays(archive, "/evaluation")["summary"], filter="combined", run="07")
        said = columns(modebank(*words, "--track.filter=combined").stdout)
        self.assertAlmostEqual(np.nanmean(said["log_density"]), row["log_score"], delta=1e-9)

    def test_lines(self):
        """Two states under noise; inputs that come early or late; empty cells; lags."""
        for words, options in ((("--bank.measurement_variance=1e-5",), {"states": ("wz", "vx")}),
                               (("--data.lag_s=0.25",), {}), (("--data.lag_s=-0.25",), {}),
                               (("--data.missing=predict",), {"holes": True}),
                               (("--window.model=varx", "--window.input_delay=1,4"), {}),
                               (("--window.model=varx", "--window.state_lags=4"), {})):
            archive, lines = self.learn(*words, **options)
            for which in ("bank", "baseline"):
                with self.subTest(words=words, which=which):
                    live = self.track(archive, lines, "--track.filter", which).stdout
                    self.check(live, evaluated(archive, which, "01"))
        warming_up = columns(live)["warming_up"]
        self.assertEqual(np.flatnonzero(warming_up).tolist(), [*range(14)])  # ten after four lags

    def rewritten(self, header, line, *words):
        """The archive of the small runs with their rows in another form, and the lines of the held-out one."""
        write_runs(self.folder)
        for path in self.folder.glob("run_*.csv"):
            rows = np.loadtxt(path, delimiter=",", skiprows=1)
            path.write_text(header + "".join(line(*row) + "\n" for row in rows.tolist()), encoding="latin-1")
        modebank("run", "test.ini", "--force", *words, cwd=self.folder)
        return self.folder / "test.h5", (self.folder / "run_01.csv").read_text(encoding="latin-1")

    def test_forms_that_run_reads(self):
        """Stamps, dialects and derived channels, of lines and of files."""
        comma = str.maketrans(",.", ";,")
        for header, line, words in (
                ("time,wz,left,right\n", lambda t, *v: "2024-05-01T23:59:{:06.3f}Z,{},{},{}".format(t, *v), ()),
                ("time,wz,left,right\n", lambda t, *v: "{},{},{},{}".format(5000 + round(1000 * t), *v), ()),
                ("secs,nsecs,wz,left,right\n", lambda t, *v: "{},{},{},{},{}".format(
                    1_700_000_000 + int(t + 1e-6), round(t % 1 * 10) % 10 * 10**8, *v), ("--data.time=secs, nsecs",)),
                ("time;wz;left;right\ns;rad/s;m/s;m/s\n",
                 lambda *v: "{},{},{},{}".format(*v).translate(comma), ()),
                ("", lambda *v: "{},{},{},{}".format(*v),
                 ("--data.time=c1", "--data.state=c2", "--data.input=c3, c4")),
                ('\ufeffright,note,"=a""b",time,left\r\n'.encode().decode("latin-1"),
                 lambda t, w, *v: '{1},"one, ""two""",{2},{3},"{0}"\r'.format(*v, w, t), ('--data.state==a"b',)),
                ("time,gr\xf6\xdfe,left,right\n", lambda *v: "{},{},{},{}".format(*v), ("--data.state=größe",)),
                ("time,wz_deg,left,right\n", lambda t, w, *v: "{},{},{},{}".format(t, np.degrees(w), *v),
                 ("--data.derive=turn = rad(wz_deg)", "--data.state=turn"))):
            with self.subTest(header=header):
                archive, text = self.rewritten(header, line, *words)
                said = subprocess.run([PROGRAM, "track", archive], input=text.encode("latin-1"), capture_output=True,
                                      check=True).stdout.decode()
                expected = evaluated(archive, "bank", "01")
                self.check(said, {name: expected[name] for name in ("nis", "log_density", "p1")})
                np.testing.assert_allclose(np.diff(columns(said)["time"]), 0.1, 1e-5)
                self.assertFalse(any(name.startswith("=") for name in columns(said)))
                of_file = modebank("track", archive, "--data.inputs", "run_01.csv", cwd=self.folder).stdout
                self.assertEqual(of_file, said)

    def test_faster_logs_are_brought_to_the_models_rate(self):
        """At 51.5 Hz; wz and left vibrate and are averaged, right is held and is picked."""
        def faster(stamp):
            return lambda t, w, left, right: "\n".join(
                f"{stamp(s)},{w + 0.05 * np.sin(283 * s)},{left + 0.05 * np.sin(283 * s)},{right}"
                for s in t + 0.0194 * np.arange(5))
        for stamp, lag in (str, "0"), (str, "0.17"), (str, "-0.23"), ("2024-05-01T10:00:{:09.6f}Z".format, "0"):
            with self.subTest(lag=lag, stamp=stamp):
                archive, text = self.rewritten("time,wz,left,right\n", faster(stamp), "--data.rate_hz=10",
                                               f"--data.lag_s={lag}")
                self.check(self.track(archive, text.splitlines()).stdout, evaluated(archive, "bank", "01"), 1e-9)

    def test_derivatives_go_on_from_line_to_line(self):
        heading = np.cumsum(np.random.default_rng(1).normal(0, 50, 120)) % 360
        archive, text = self.rewritten("time,heading,left,right\n",
                                       lambda t, *v: "{},{},{},{}".format(t, heading[round(10 * t)], *v[1:]),
                                       "--data.derive=angle = unwrap(rad(heading))", "--data.derive=turn = diff(angle)",
                                       "--data.state=turn")
        said, expected = columns(self.track(archive, text.splitlines()).stdout), evaluated(archive, "bank", "01")
        np.testing.assert_allclose(said["turn_predicted"][20:], expected["turn_predicted"][20:], 1e-6, 1e-6)

    def test_clocks(self):
        archive, lines = self.learn()
        plain, sample = self.track(archive, lines[:21]).stdout.splitlines(), "{},0.01,0.1,0.1".format
        ahead = self.track(archive, [*lines[:11], sample(1.7e9), *lines[11:21]]).stdout.splitlines()
        self.assertEqual(ahead[:11] + ahead[12:], plain)  # costs no more than its own sample
        jumps = [sample(900), sample(900.1), sample(1.0), "1.1,,0.1,0.1", "1.4,0.01,,"]
        said = columns(self.track(archive, [*lines[:11], *jumps]).stdout)
        self.assertEqual(said["steps"][10:].tolist(), [0, 1, 0, 1, 3])
        self.assertTrue(np.isnan(said["nis"][13]) and abs(said["wz"][13] - said["wz_predicted"][13]) < 1e-12)
        between = [line for row in lines[1:21] for line in [row, *(
            f"{float(row.split(',')[0]) + 0.01 * i},{row.split(',', 1)[1]}" for i in range(1, 10))]]
        fast = columns(self.track(archive, lines[:1] + between, "--data.rate_hz=10").stdout)
        slow = columns(self.track(archive, lines[:21], "--data.rate_hz=10").stdout)
        np.testing.assert_allclose(fast["wz"], slow["wz"], 1e-9, 1e-9)
        self.assertIn("--data.rate_hz 10", self.track(archive, [*lines[:2], sample(0.01), sample(0.02)]).stderr)
        jitter = [f"{0.1 * k + (0, 0.02, -0.01, 0.02, -0.02)[k % 5]},0.01,0.1,0.1" for k in range(30)]
        done = self.track(archive, lines[:1] + jitter)
        self.assertEqual((done.stdout.count("\n"), done.stderr), (31, ""))
        week = [f"{hour % 24:02}:30:00.25,0.1,0,0" for hour in range(11, 168, 2)]
        times = columns(self.track(archive, lines[:1] + week).stdout)["time"]
        self.assertEqual(times.tolist(), [3600 * hour + 1800.25 for hour in range(11, 168, 2)])

    def test_python_filter(self):
        try:
            from modebank import Filter
        except ImportError:
            self.skipTest("no Python module modebank: build with MODEBANK_PYTHON=ON and set PYTHONPATH")
        archive, (_, *lines) = self.learn()
        step = Filter(str(archive)).step
        said = [step(time_s, u, [y]) for time_s, y, *u in (map(float, line.split(",")) for line in lines)]
        for name, values in (("wz", [estimate.state[0] for estimate in said]),
                             ("p1", [estimate.mode_probability[1] for estimate in said])):
            np.testing.assert_allclose(values, evaluated(archive, "bank", "01")[name], 1e-12, 1e-12, err_msg=name)

    def test_bare_nan_in_json(self):
        archive, (header, *lines) = self.learn()
        plain = ["{" + ", ".join(map('"{}": {}'.format, header.split(","), line.split(","))) + "}" for line in lines]
        plain[5] = re.sub('"wz": [^,]*', '"wz": null', plain[5])
        bare = [line.replace("{", '{"a": "x\\\\", ').replace("null", "NaN") for line in plain]
        self.assertEqual(self.track(archive, bare).stdout, self.track(archive, plain).stdout)

    def test_bad_lines(self):
        """Each is skipped and told by its number. Without any sample the status is 1, with a wrong column 2."""
        archive, lines = self.learn()
        bad = ["0.6,abc,0,0", "0.6,0.1", "0.1,0.1,0,0", ",0.1,0,0", '{"time": 3}', "1e308,0,0,0", "x" * 2_000_000]
        done = self.track(archive, lines[:7] + bad + lines[7:])
        self.assertEqual(done.stdout, self.track(archive, lines).stdout)
        for number in range(8, 15):
            self.assertIn(f"line {number}:", done.stderr)
        for pair in ("0.2,1e50,0,0", "0.2,,0,0"), ("0.2,0,1e200,0", "0.2,0,,0"):  # too wild is as if missing
            self.assertEqual(*(self.track(archive, [*lines[:3], line]).stdout for line in pair))
        self.track(archive, lines[:1] + bad[:2], status=1)
        for header in ("time,yaw,left,right", "time,wz,wz,left,right"):
            self.assertEqual(self.track(archive, [header, *lines[1:]], status=2).stdout, "")

    def test_flags(self):
        archive, lines = self.learn()
        most = arrays(archive, "/data")["input"][slices(archive)["00"], 0].max()
        lines[13:] = [f"1.2,,{most},0.1", f"1.3,,{most + 1e-9},0.1", "1.4,100,0.1,0.1", "1.5,,0.1,0.1", "1.64,,0.1,",
                      "1.79,,0.1,0.1", "90,0.01,0.1,0.1"]
        said = columns(self.track(archive, lines).stdout)
        for name, raised in (("alarm", [14]), ("warming_up", [*range(11), 18]), ("input_beyond_training", [13]),
                             ("unlike_any_mode", [14]), ("stamp_late", [17, 18])):
            self.assertEqual(np.flatnonzero(said[name]).tolist(), raised, name)


if __name__ == "__main__":
    main()
