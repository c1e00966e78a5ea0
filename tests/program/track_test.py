"""The live filter says of each sample what `run` said: of lines and files, in Python, late and missing."""
import csv
import re

from program import ProgramTest, arrays, attributes, demo, learn, main, modebank, np, rows, slices


def columns(text):
    """Lines of `track` as {column: values}. A missing value is NaN."""
    header, *lines = csv.reader(text.splitlines())
    return dict(zip(header, np.array([[field or "nan" for field in line] for line in lines], float).T))


def evaluated(archive, which, run):
    """What the archive says of a run, as columns of `track`."""
    at, said = slices(archive)[run], arrays(archive, f"/evaluation/{which}")
    found = {name: said[name] for name in ("nis", "log_density")}
    for i, name in enumerate(attributes(archive, "/data")["state_names"].astype(str)):
        half = 1.959963984540054 * np.sqrt(said["innovation_covariance"][:, i, i])
        found |= {name: said["state"][:, i], name + "_sd": np.sqrt(said["covariance"][:, i, i]),
                  name + "_predicted": said["prediction"][:, i], name + "_lower": said["prediction"][:, i] - half,
                  name + "_upper": said["prediction"][:, i] + half}
    found |= {f"p{mode}": values for mode, values in enumerate(said["mode_probability"].T)}
    return {name: values[at] for name, values in found.items()}


class Track(ProgramTest):
    def track(self, archive, lines, *words, status=0):
        return modebank("track", archive, *words, input="\n".join([*lines, ""]), status=status)

    def check(self, text, expected):
        said = columns(text)
        for name, values in expected.items():
            np.testing.assert_allclose(said[name], values, 1e-12, 1e-12, err_msg=name)

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
