#!/usr/bin/env python3
"""Tests of .ci/check-words on a small repository: which added lines it reports, and which not."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

CI = pathlib.Path(__file__).resolve().parent.parent / ".ci"
BEFORE = {
    "old.cpp": "/// Of what was there before the change.\nint badness(int x);\n",
    "page.md": "The bank says what the run did.\n",
}


class Words(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / ".ci").mkdir()
        for name in ("base", "check-words", "words"):
            shutil.copy(CI / name, self.root / ".ci")
        self.git("init", "-q")
        self.write(BEFORE)
        self.commit()
        self.commit()

    def git(self, *arguments):
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *arguments], cwd=self.root, check=True)

    def commit(self):
        self.git("add", "-A")
        self.git("commit", "-qm", "c", "--allow-empty")

    def write(self, files):
        for name, text in files.items():
            (self.root / name).write_text(text, encoding="utf-8")
        self.git("add", "-A")

    def found(self):
        """FILE:LINE of what is found."""
        run = subprocess.run([self.root / ".ci/check-words"], cwd=self.root, capture_output=True, text=True, check=False,
                             env={name: value for name, value in os.environ.items() if name not in ("CI", "TIDY_BASE")})
        self.assertEqual(run.stderr, "")
        self.assertEqual(run.returncode, 1 if run.stdout else 0)
        return [":".join(line.split(":")[:2]) for line in run.stdout.splitlines()]

    def test_finds_each_kind_of_pattern(self):
        self.write({
            "new.cpp": "// The archive knows its hash.\n/// What it returns.\nint a = 1;  // that is no number\nint open_door();\n"
                       "throw Error(\"the badness of the filter\");\n",
            "new.md": "# Filters\n- Of the runs, two.\n\nA twin of a mode.\n",
            "new.py": "# Who reads this\n",
        })
        self.assertEqual(self.found(), ["new.cpp:1", "new.cpp:2", "new.cpp:3", "new.cpp:4", "new.cpp:5", "new.md:2", "new.md:4", "new.py:1"])

    def test_leaves_plain_lines_alone(self):
        self.write({
            "new.cpp": "// The archive contains its hash.\nauto t = std::chrono::steady_clock::now();\nint b = badness(2);\nbool is_open = file.open();\n",
            "new.md": "# What is a bank?\n\nThe key is no longer read. `door` is a name. Of course.\n",
            "new.txt": "The bank says it.\n",
        })
        self.assertEqual(self.found(), [])

    def test_leaves_moved_and_indented_lines_alone(self):
        (self.root / "old.cpp").unlink()
        self.write({"moved.cpp": "int first;\n  " + BEFORE["old.cpp"], "page.md": "\n  " + BEFORE["page.md"]})
        self.assertEqual(self.found(), [])

    def test_compares_with_the_merge_base_of_main(self):
        self.git("update-ref", "refs/remotes/origin/main", "HEAD")
        self.write({"new.md": "The bank says it.\n"})
        self.commit()
        self.commit()
        self.assertEqual(self.found(), ["new.md:1"])


if __name__ == "__main__":
    unittest.main()
