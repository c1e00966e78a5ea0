"""A study on a real Slurm of two nodes, which this test starts and ends."""
import os
import shutil
import subprocess
import sys
import time

from program import SOURCE, ProgramTest, differing, main, modebank, write_runs

TOOLS = ("sbatch", "scontrol", "squeue", "slurmctld", "slurmd", "munged")
if not all(shutil.which(tool, path=os.environ["PATH"] + ":/usr/sbin") for tool in TOOLS):
    print("SKIPPED: Slurm is absent: apt-get install slurmctld slurmd slurm-client munge")
    sys.exit(os.environ.get("CI") == "true" or 77)
SCRIPTS = SOURCE / "tests/support"
TRIALS = 24
VARIED = ("mixture.components = 1 | 2", "filter.variant = imm | salvi2025", "window.length = {12..17}")
STILL_TO_COME = {"PENDING", "CONFIGURING", "RUNNING", "COMPLETING", "SUSPENDED"}


class Slurm(ProgramTest):
    def setUp(self):
        super().setUp()
        cluster = self.folder / "cluster"
        port = 12000 + 16 * (os.getpid() % 1000)  # below the kernel's dynamic ones, and of no other test's cluster
        self.addCleanup(subprocess.run, ["sh", SCRIPTS / "slurm_down.sh", cluster])
        with open(self.folder / "log", "w") as log:  # no pipe, which the daemons would keep open
            up = subprocess.run(["sh", SCRIPTS / "slurm_up.sh", cluster, str(port)], stdout=log, stderr=log)
        self.assertEqual(up.returncode, 0, (self.folder / "log").read_text())
        self.environment = {"SLURM_CONF": str(cluster / "slurm.conf")}

    def slurm(self, *words):
        return subprocess.run(words, env=dict(os.environ, **self.environment), check=True, capture_output=True,
                              text=True).stdout

    def wait_for(self, right):
        """What `right` finds in the tasks, {id: [state, node]}, those that have ended, too."""
        for _ in range(18000):
            told = self.slurm("squeue", "-h", "-r", "-t", "all", "-O", "JobArrayID:30,State:20,NodeList:20")
            if found := right({task: state for task, *state in map(str.split, told.splitlines())}):
                return found
            time.sleep(0.1)
        self.fail(told)

    def test_a_requeued_task_changes_no_number(self):
        """24 trials are three tasks, then a merge. One stops at work and starts again, as if its node were lost."""
        write_runs(self.folder)
        whole, other = self.folder / "whole", self.folder / "other"
        varied = [word for keys in VARIED for word in ("--study.vary", keys)]
        words = ("study", self.folder / "test.ini", *varied, "--mixture.restarts", 60, "--study.output")
        modebank(*words, whole)
        modebank(*words, other, "--study.stage", "submit", env=self.environment)
        made = lambda study: sorted((study / "trials").glob("*.h5"))
        running = self.wait_for(lambda tasks: made(other) and [key for key, of in tasks.items() if of[0] == "RUNNING"])
        self.assertLess(len(made(other)), TRIALS)
        self.slurm("scontrol", "requeue", running[0])
        ended = self.wait_for(lambda tasks: not STILL_TO_COME & {state for state, *_ in tasks.values()} and tasks)
        self.assertEqual(set(map(tuple, ended.values())), {("COMPLETED", "n1"), ("COMPLETED", "n2")}, ended)
        self.assertEqual((other / "study.csv").read_bytes(), (whole / "study.csv").read_bytes())
        self.assertEqual([differing(*two) for two in zip(made(whole), made(other), strict=True)], [[]] * TRIALS)


if __name__ == "__main__":
    main()
