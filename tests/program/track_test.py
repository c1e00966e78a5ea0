"""The live filter says of each sample what `evaluate` said: of lines, objects and files, late, missing, resumed."""
import csv
import json

import numpy as np

import program
from program import ProgramTest, arrays, attributes, demo, modebank, rows, write_runs

FLAGS = ("alarm", "warming_up", "input_beyond_training", "unlike_any_mode", "stamp_late")
FILTERS = ("bank", "baseline", "noise_only", "one_motion")


def columns(text):
    """Lines of `track` as {column: values}. A missing value is NaN."""
    header, *lines = csv.reader(text.splitlines())
    return dict(zip(header, np.array([[field or "nan" for field in line] for line in lines], float).T))


def cut(archive, group, run):
    """The rows of one run in the arrays of a group."""
    place = rows(arrays(archive, "/data")["runs"], name=run)[0]
    return {name: values[place["first"]:][:place["samples"]] for name, values in arrays(archive, group).items()
            if values.ndim and values.dtype.names is None}


def evaluated(archive, which, run):
    """What the archive says of a run, as columns of `track`."""
    said = cut(archive, f"/evaluation/{which}", run)
    found = {name: said[name] for name in ("nis", "log_density")}
    for i, name in enumerate(attributes(archive, "/data")["state_names"]):
        name = name.decode()
        half = 1.959963984540054 * np.sqrt(said["innovation_covariance"][:, i, i])
        found |= {name: said["state"][:, i], name + "_sd": np.sqrt(said["covariance"][:, i, i]),
                  name + "_predicted": said["prediction"][:, i], name + "_lower": said["prediction"][:, i] - half,
                  name + "_upper": said["prediction"][:, i] + half}
    return found | {f"p{mode}": values for mode, values in enumerate(said["mode_probability"].T)}


class Track(ProgramTest):
    def track(self, archive, lines, *words, status=0):
        return modebank("track", archive, *words, input="\n".join([*lines, ""]), status=status)

    def check(self, text, expected):
        said = columns(text)
        for name, values in expected.items():
            np.testing.assert_allclose(said[name], values, 1e-12, 1e-12, err_msg=name)

    def learn(self, *words, states=("wz",), change=str):
        """An archive of two small runs whose lines `change` changed, and the lines of the held-out run."""
        write_runs(self.folder, states=states)
        for path in self.folder.glob("run_*.csv"):
            header, *lines = path.read_text().splitlines()
            path.write_text("\n".join([header, *map(change, lines), ""]))
        modebank("run", "test.ini", "--archive.output", "out.h5", "--force", *words, cwd=self.folder)
        return self.folder / "out.h5", (self.folder / "run_01.csv").read_text().splitlines()

    def test_the_demos_held_out_runs(self):
        archive = demo() / "demo.h5"
        summary = arrays(archive, "/evaluation")["summary"]
        for row in rows(summary, filter="combined", role="test"):
            run = row["run"].decode()
            if run == "*":
                continue
            data = cut(archive, "/data", run)
            samples = np.column_stack([data["time"], data["state"], data["input"]]).tolist()
            lines = ["time,wz,cmd_velL,cmd_velR", *(",".join(map(repr, sample)) for sample in samples)]
            for which in FILTERS:
                self.check(self.track(archive, lines, "--track.filter", which).out, evaluated(archive, which, run))
            said = columns(self.track(archive, lines, "--track.filter", "combined").out)
            self.assertAlmostEqual(np.nanmean(said["log_density"]), row["log_score"], delta=1e-9)

    def test_other_archives(self):
        """Two states under noise; inputs that come early or late; empty cells; lags."""
        def holes(line):
            fields = line.split(",")
            k = round(10 * float(fields[0]))
            return ",".join("" if k > 9 and k % 7 == place else field for place, field in enumerate(fields, -1))

        for words, options in ((("--bank.measurement_variance", "1e-5"), {"states": ("wz", "vx")}),
                               (("--data.lag_s", "0.25"), {}), (("--data.lag_s", "-0.25"), {}),
                               (("--data.missing", "predict"), {"change": holes}),
                               (("--window.model", "varx", "--window.state_lags", "4"), {})):
            archive, lines = self.learn(*words, **options)
            for which in FILTERS[:2]:
                with self.subTest(words=words, which=which):
                    live = self.track(archive, lines, "--track.filter", which)
                    self.check(live.out, evaluated(archive, which, "01"))
                    read = ("--data.inputs", self.folder / "run_01.csv", "--track.filter", which)
                    self.assertEqual(live.out, modebank("track", archive, *read).out)
        self.assertEqual(np.flatnonzero(columns(live.out)["warming_up"]).tolist(), [*range(14)])  # ten after four lags

    def test_objects_and_checkpoints(self):
        archive, lines = self.learn()
        whole = self.track(archive, lines).out
        names, expected = lines[0].split(","), columns(whole)
        objects = [json.dumps(dict(zip(names, map(float, line.split(","))))) for line in lines[1:]]
        said = [json.loads(line) for line in self.track(archive, objects, "--json").out.splitlines()]
        self.assertEqual([line["wz"]["estimate"] for line in said], expected["wz"].tolist())
        self.assertEqual([line["probability"][-1] for line in said], [*expected.values()][-1].tolist())
        self.assertEqual([line["nis"] for line in said][1:], expected["nis"].tolist()[1:])
        kept = ("--track.checkpoint", self.folder / "state")
        for which in (*FILTERS, "drifting"):
            whole = self.track(archive, lines, "--track.filter", which).out.splitlines()
            self.track(archive, lines[:20], "--track.filter", which, *kept)
            rest = self.track(archive, lines[:1] + lines[20:], "--track.filter", which, "--track.resume", kept[1]).out
            self.assertEqual(rest.splitlines()[1:], whole[20:])
        self.track(archive, lines, "--track.resume", kept[1], status=1)  # of another filter
        self.track(archive, lines, "--track.filter", "combined", *kept, status=2)

    def test_bad_lines(self):
        """Each is skipped and told by its number. Without any sample the status is 1, with a wrong column 2."""
        archive, lines = self.learn()
        bad = ["0.6,abc,0,0", "0.6,0.1", "0.1,0.1,0,0", ",0.1,0,0", '{"time": 3}', "1e308,0,0,0", "x" * 2_000_000]
        done = self.track(archive, lines[:7] + bad + lines[7:])
        self.assertEqual(done.out, self.track(archive, lines).out)
        for number in range(8, 15):
            self.assertIn(f"line {number}:", done.err)
        start = "\n".join(lines[:3])
        for wild, same in (("\n0.2,1e50,0,0", "\n0.2,,0,0"), ("\n0.2,0,1e200,0", "\n0.2,0,,0"), ("\n0.2,0.1", "")):
            self.assertEqual(*(modebank("track", archive, input=start + end).out for end in (wild, same)))
        self.track(archive, lines[:1] + bad[:2], status=1)
        for header in ("time,yaw,left,right", "time,wz,wz,left,right"):
            self.assertEqual(self.track(archive, [header, *lines[1:]], status=2).out, "")

    def test_flags(self):
        archive, lines = self.learn()
        most = cut(archive, "/data", "00")["input"][:, 0].max()
        lines[13:] = [f"1.2,,{most},0.1", f"1.3,,{most + 1e-9},0.1", "1.4,100,0.1,0.1", "1.5,,0.1,0.1", "1.64,,0.1,",
                      "1.79,,0.1,0.1", "90,0.01,0.1,0.1"]
        said = columns(self.track(archive, lines).out)
        raised = {name: np.flatnonzero(said[name]).tolist() for name in FLAGS}
        self.assertEqual(raised, {"alarm": [14], "warming_up": [*range(11), 18], "input_beyond_training": [13],
                                  "unlike_any_mode": [14], "stamp_late": [17, 18]})

    def test_python_filter(self):
        try:
            import modebank as module
        except ImportError:
            self.skipTest("no Python module modebank: build with MODEBANK_PYTHON=ON and set PYTHONPATH")
        archive, lines = self.learn()
        live = module.Filter(str(archive))
        said = [live.step(time_s, u, [y]) for time_s, y, *u in (map(float, line.split(",")) for line in lines[1:])]
        expected = columns(self.track(archive, lines).out)
        self.assertEqual([estimate.state[0] for estimate in said], expected["wz"].tolist())
        self.assertEqual([estimate.mode_probability[-1] for estimate in said], [*expected.values()][-1].tolist())


if __name__ == "__main__":
    program.main()
