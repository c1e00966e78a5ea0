#!/usr/bin/env python3
"""The ratchet in small repositories: a room that grows, a table that is raised, a table that is left slack."""
import contextlib
import io
import os
import pathlib
import subprocess
import tempfile
import unittest

import house

AIM = house.ROOMS["ident"][1]


class Ratchet(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        (self.root / "tests").mkdir()
        (self.root / "ident").mkdir()
        self.git("init", "-q")
        os.environ.pop("CI", None)

    def git(self, *arguments):
        identity = ["-c", "user.name=robot", "-c", "user.email=robot@example.org"]
        subprocess.run(["git", "-C", self.root, *identity, *arguments], check=True, capture_output=True)

    def commit(self, lines, table=None, name="ident/a.cpp", text="int a;\n"):
        """Commits a file of that many lines with a table: the true one, or `table` lines of ident."""
        (self.root / name).write_text(text * lines)
        (self.root / house.TABLE).touch()
        self.git("add", "-A")
        house.write(self.root)
        if table is not None:
            counts, _ = house.measure(self.root)
            counts["ident"]["lines"] = table
            (self.root / house.TABLE).write_text(house.text_of(counts))
        self.git("add", "-A")
        self.git("commit", "-q", "--allow-empty", "-m", "a change")

    def offences(self):
        with contextlib.redirect_stdout(io.StringIO()):  # what it skips here is no skipped test
            return house.offences(self.root)

    def test_a_room_that_shrinks_or_stays_under_its_aim_passes(self):
        for lines in (AIM + 90, AIM + 90, AIM + 20, 30, AIM):
            self.commit(lines)
            self.assertEqual(self.offences(), [])

    def test_a_room_that_grows_beyond_its_aim_fails_before_and_after_the_commit(self):
        self.commit(AIM + 1)
        (self.root / "ident/a.cpp").write_text("int a;\n" * (AIM + 2))
        house.write(self.root)
        self.assertIn("ident has", self.offences()[0])
        self.commit(AIM + 2)
        self.assertIn("ident has", self.offences()[0])

    def test_a_table_that_is_raised_fails_and_helps_no_later_commit(self):
        self.commit(AIM + 1)
        self.commit(AIM + 1, table=AIM + 500)
        self.assertIn("make house", self.offences()[0])

    def test_a_table_that_is_left_slack_fails(self):
        self.commit(AIM + 90)
        self.commit(AIM, table=AIM + 90)
        self.assertIn("make house", self.offences()[0])

    def test_more_files_and_longer_python_lines_fail(self):
        self.commit(1)
        self.commit(1, name="ident/long.py", text="a = 1" + " " * 120 + "\n")
        self.assertIn("long python lines", self.offences()[0])

    def test_joined_statements_and_files_in_no_room_fail(self):
        self.commit(1)
        self.commit(1, name="ident/a.py", text="a = 1; b = ';'\n")
        self.commit(1, name="stray.txt")
        self.assertEqual(self.offences(), ["ident/a.py:1: a semicolon", "stray.txt: in no room of tests/house.py"])

    def test_a_clone_without_the_parent_is_an_offence_in_ci_alone(self):
        self.commit(1)
        self.assertEqual(self.offences(), [])
        os.environ["CI"] = "true"
        self.assertIn("HEAD^1", self.offences()[0])


if __name__ == "__main__":
    unittest.main()
