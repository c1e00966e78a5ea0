"""A study: its trials are single runs to the bit, whatever stops, shares, damages or submits it."""
import csv
import os
import re
import signal
import subprocess
import time

from program import PROGRAM, ProgramTest, arrays, differing, main, modebank, rows, write_runs

KEYS = ("mixture.components", "filter.variant")
QUIET = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
VARIED = ("--study.vary", KEYS[0] + " = 1 | 2", "--study.vary", KEYS[1] + " = imm | salvi2025")


def lines(file):
    return list(csv.reader(file.read_text().splitlines()))


def trials(study):
    return sorted((study / "trials").glob("*.h5"))


def identities(study):
    """Of its archives. One that is made again has another."""
    return {path: (path.stat().st_ino, path.stat().st_mtime_ns) for path in trials(study)}


class Study(ProgramTest):
    """Something disturbs the study `other` in each test. Its table and archives must be those of `whole`."""
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        write_runs(cls.place)
        cls.whole = cls.place / "whole"
        modebank(*cls.words(cls.whole))

    def setUp(self):
        super().setUp()
        self.other = self.folder / "other"

    @classmethod
    def words(cls, study, *options):
        return ("study", cls.place / "test.ini", *VARIED, "--study.output", study, "--bank.refine", "none", *options)

    def study(self, *options, **more):
        modebank(*self.words(self.other, *options), **more)

    def start(self, *options):
        return subprocess.Popen([PROGRAM, *self.words(self.other, *options)], start_new_session=True, **QUIET)

    def check(self):
        self.assertEqual(lines(self.other / "study.csv"), lines(self.whole / "study.csv"))
        for one, other in zip(trials(self.other), trials(self.whole), strict=True):
            self.assertEqual(differing(one, other), [])
        modebank("verify", *trials(self.other))

    def test_trials_are_single_runs(self):
        run, (header, *table) = self.folder / "run.h5", lines(self.whole / "study.csv")
        for trial in (dict(zip(header, line)) for line in table):
            keys = [f"--{key}={trial[key]}" for key in KEYS]
            modebank("run", self.place / "test.ini", "--bank.refine=none", *keys, "--archive.output", run, "--force")
            self.assertEqual(differing(run, self.whole / "trials" / (trial["key"] + ".h5")), [])
            for row in rows(arrays(run, "/evaluation")["summary"], run="*"):
                name = f"{row['filter'].decode()}_{row['role'].decode()}_log_score"
                self.assertEqual(float(trial[name]), row["log_score"], name)
        modebank("run", self.whole / "study.best.ini", "--archive.output", run, "--force")
        score = rows(arrays(run, "/evaluation")["summary"], filter="bank", role="test", run="*")["log_score"]
        self.assertEqual(score, max(float(line[header.index("bank_test_log_score")]) for line in table))

    def test_goes_on_after_a_kill_and_makes_nothing_twice(self):
        """A trial that was damaged meanwhile is told by `verify` and is made again, alone."""
        killed = self.start("--study.jobs", "1")
        while not trials(self.other):
            self.assertIsNone(killed.poll(), "the study ended without a trial")
            time.sleep(0.001)
        os.killpg(killed.pid, signal.SIGKILL)
        killed.wait()
        before = identities(self.other)
        self.study()
        whole, damaged = identities(self.other), trials(self.other)[1]
        self.assertLessEqual(before.items(), whole.items())
        content = bytearray(damaged.read_bytes())
        content[5000] ^= 16
        damaged.write_bytes(content)
        modebank("verify", damaged, status=1)
        self.study()
        self.assertEqual({path for path, _ in whole.items() - identities(self.other).items()}, {damaged})
        self.check()

    def test_processes_share_the_work(self):
        processes = [self.start("--job.threads", "2") for _ in range(3)]
        self.assertEqual([process.wait() for process in processes], [0, 0, 0])
        made = [line[3] for line in lines(self.other / "log.csv") if line[4] == "done"]
        self.assertEqual(sorted(made), [path.stem for path in trials(self.whole)])
        self.check()

    def test_slurm_gets_an_array_and_a_merge(self):
        """In a folder whose name a shell or Slurm could read otherwise."""
        self.other = self.folder / "it's 100 %j \"odd\" $HOME"
        sbatch, environment = self.folder / "sbatch", {"PATH": f"{self.folder}:{os.environ['PATH']}"}
        submit = "--study.stage=submit", "--study.slurm_options=--time=60 --comment=a=b"
        self.study(*submit, env={"PATH": str(self.folder)}, status=2)  # no sbatch
        sbatch.write_text("#!/bin/sh\necho 'invalid partition' >&2\nexit 1\n")
        sbatch.chmod(0o700)
        told = modebank(*self.words(self.other, *submit), env=environment, status=1).stderr
        self.assertIn("invalid partition", told)
        self.study("--study.stage=submit", "--study.slurm_options=--arr=0-5%2", env=environment, status=2)
        sbatch.write_text('#!/bin/sh\nprintf "%s\\n" "$@" >> "$0.words"\necho Welcome to node 7\necho "Job 41;c2"\n')
        self.study(*submit, env=environment)
        array, merge = re.findall(r"(?s)--parsable\n.*?\.sh\n", (self.folder / "sbatch.words").read_text())
        self.assertIn("--array=1-1\n--time=60\n--comment=a=b\n", array)
        self.assertIn("--dependency=afterany:41\n--time=60\n--comment=a=b\n", merge)
        for words in (array, merge):
            self.assertIn("--output=" + str(self.other).replace("%", "%%"), words)
            self.assertRegex(words, r"--job-name=[\w-]+\n")
        self.study("--study.stage", "merge", status=1)
        self.assertEqual(trials(self.other), [])  # nothing is made here
        for words in (array, merge):
            subprocess.run(["bash", words.splitlines()[-1]], check=True, **QUIET)
        self.check()
        for name in ("new\ntouch pwned", "back\\slash"):
            self.other = self.folder / name
            self.study(*submit, env=environment, status=2)
            self.assertFalse(self.other.exists())


if __name__ == "__main__":
    main()
