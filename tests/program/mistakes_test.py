"""Wrong inputs: exit status (2: before any sample is read, 1: content), one line with the culprit, and no file."""
import json
import shutil

from program import ProgramTest, learn, main, modebank, write_runs

RUN = ("run", "test.ini", "--archive.output", "out.h5")
STILL = ["time,wz,left,right", *(f"{k / 10},0.3,{k % 7},{k % 5}" for k in range(80))]  # the state is constant
# Each mistake: exit status, a datum of the line, words of the command, and what is wrong: file, line (0: all), text.
MISTAKES = [
    (2, "rnu", ("rnu", "test.ini"), None),
    (2, "none.ini", ("run", "none.ini"), None),
    (2, "window.length", (*RUN, "--window.lenght", "20"), None),
    (2, "test.ini:9", RUN, ("test.ini", 9, "what is this")),
    (2, "test.ini:10", RUN, ("test.ini", 9, "[window]\nlen = 20")),
    (2, "test.ini:9", RUN, ("test.ini", 9, "components = 3")),
    (2, "bank.stay = '1.5'", (*RUN, "--bank.stay", "1.5"), None),
    (2, "window.state_lags", (*RUN, "--window.state_lags", "3"), None),
    (2, "nothing_*.csv", (*RUN, "--data.inputs", "nothing_*.csv"), None),
    (2, "imu_00.csv", (*RUN, "--data.states", "imu_*.csv"), None),
    (2, "wzz", (*RUN, "--data.state", "wzz"), None),
    (2, "RED", RUN, ("run_01.csv", 1, "time,w\x1b[31mRED\x07,left,right")),
    (2, "07", (*RUN, "--data.train", "00, 07"), None),
    (2, "run_01.csv", RUN, ("run_01.csv", 0, "")),
    (2, "none/out.h5", (*RUN[:-1], "none/out.h5"), None),
    (2, "init run_00.csv", ("check", "run_00.csv"), None),
    (2, "none.h5", ("show", "none.h5"), None),
    (1, "run_01.csv", RUN, ("run_01.csv", 0, STILL[0])),
    (1, "abc", RUN, ("run_01.csv", 5, "0.3,abc,0,0")),
    (1, "run_01.csv:5: column wz", RUN, ("run_01.csv", 5, "0.3,nan,0,0")),
    (1, "run_01.csv:6", RUN, ("run_01.csv", 6, "0.1,0,0,0")),
    (1, "run_01.csv:42: column wz", RUN, ("run_01.csv", 42, "4.0,1e30,0,0")),
    (1, "wz", RUN, ("run_00.csv", 0, "\n".join(STILL))),
    (1, "run_00.csv:81", ("check", "test.ini"), ("run_00.csv", 81, "1e9,0,0,0")),
    (1, "100", (*RUN, "--window.length", "100"), None),
    (1, "filter.horizon = 5000", (*RUN, "--filter.horizon", "1,5000"), None),
    (1, "run_x.h5", ("show", "run_x.h5"), ("run_x.h5", 0, "this is no HDF5 file")),
]


class Mistakes(ProgramTest):
    def content(self):
        return {path.relative_to(self.folder): path.read_bytes() for path in self.folder.rglob("*") if path.is_file()}

    def refused(self, status, datum, words):
        before = self.content()
        done = modebank(*words, cwd=self.folder, status=status)
        *progress, line = said = done.stderr.splitlines()
        self.assertTrue(line.startswith("modebank: ") and done.stderr.count("modebank: ") == 1, said)
        self.assertTrue(datum in done.stderr and "\x1b" not in done.stderr and (status == 1 or not progress), said)
        said = json.loads(modebank(*words, "--json", cwd=self.folder, status=status).stdout)
        self.assertTrue(datum in said["error"] and said["status"] == status, said)
        self.assertEqual((done.stdout, before), ("", self.content()))

    def test_each_is_refused_by_one_line_and_leaves_no_file(self):
        for status, datum, words, damage in MISTAKES:
            with self.subTest(datum=datum, words=words):
                write_runs(self.folder, 80)
                if damage:
                    name, line, text = damage
                    lines = (self.folder / name).read_text().splitlines() if line else []
                    lines[max(line - 1, 0):line] = [text]
                    (self.folder / name).write_text("\n".join(lines))
                self.refused(status, datum, words)

    def test_commands_on_an_archive_replace_neither_what_they_read_nor_files_of_another_form(self):
        learn(self.folder, "--archive.output", "a.h5", samples=80)
        shutil.copy(self.folder / "run_01.csv", self.folder / "log.csv")
        for words, outputs in (("predict a.h5 --data.inputs log.csv --samples 5 -o", ("log.csv", "a.h5", "test.ini")),
                               ("report a.h5 -o", ("a.h5", "test.ini")),
                               ("init log.csv --force -o", ("log.csv", "a.h5")),
                               ("init log.csv -o", ("test.ini",)),
                               ("export a.h5 --force --to json -o", ("a.h5", "log.csv")),
                               ("run test.ini --force --archive.output", ("test.ini", "run_01.csv", "log.csv"))):
            for output in outputs:
                with self.subTest(words=words, output=output):
                    self.refused(2, output, (*words.split(), output))
        self.refused(2, "--samples", ("predict", "a.h5"))
        self.refused(1, "sample", ("predict", "a.h5", "--samples", "80"))
        write_runs(self.folder, 90)  # an archive of other data
        self.refused(1, "a.h5", (*RUN[:-1], "a.h5"))


if __name__ == "__main__":
    main()
