"""Every command that writes on a disk that runs full (tests/support/small_disk.c, preloaded): files that stood there
stay as they were, new ones are whole or absent, and the message names the reason."""
import shutil
import struct
import subprocess
import unittest

from program import SOURCE, ProgramTest, learn, main, modebank

RUN = ("run", "test.ini", "--archive.output", "out.h5")
COMMANDS = (RUN, (*RUN[:-1], "test.h5", "--force"), ("report", "test.h5", "-o", "page.html"),
            ("init", "run_00.csv", "-o", "log.ini"), ("predict", "test.h5", "--samples", "5", "-o", "said.csv"),
            ("export", "test.h5", "--to", "c", "-o", "robot.c", "--force"),
            ("simulate", SOURCE / "configs/simulate_demo.ini", "--simulate.output", "data", "--simulate.runs", "2"),
            ("study", "test.ini", "--study.vary", "mixture.components = 1 | 2", "--study.output", "s",
             "--study.jobs", "1"))


@unittest.skipUnless(shutil.which("gcc"), "gcc is absent: apt-get install gcc")
class FullDisk(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        (cls.place / "whole").mkdir()
        learn(cls.place / "whole", "--bank.refine=none", samples=80)
        subprocess.run(["gcc", "-shared", "-fPIC", "-o", cls.place / "small_disk.so",
                        SOURCE / "tests/support/small_disk.c", "-ldl"], check=True)

    def content(self):
        return {path.relative_to(self.other): path.read_bytes() for path in self.other.rglob("*") if path.is_file()}

    def left_of(self, words, space, status):
        """The bytes that are left of this space after the command, its messages, and the files of its folder."""
        self.other = self.folder / "other"
        shutil.rmtree(self.other, ignore_errors=True)
        shutil.copytree(self.place / "whole", self.other)
        (self.folder / "left").write_bytes(struct.pack("q", space))
        done = modebank(*words, cwd=self.other, status=status, env={
            "LD_PRELOAD": str(self.place / "small_disk.so"), "SMALL_DISK_COUNTER": str(self.folder / "left")})
        return struct.unpack("q", (self.folder / "left").read_bytes())[0], done.stderr, self.content()

    def test_files_are_whole_or_absent(self):
        plenty = 1 << 40
        for words in COMMANDS:
            left, _, after = self.left_of(words, plenty, 0)
            self.assertLess(left, plenty)
            for share in (0, 0.4, 0.9):
                with self.subTest(words=words, share=share):
                    _, told, now = self.left_of(words, int(share * (plenty - left)), 1)
                    self.assertIn("No space left on device", told)
                    for path in (self.place / "whole").iterdir():
                        self.assertEqual(now.pop(path.relative_to(self.place / "whole")), path.read_bytes())
                    for name, content in now.items():
                        self.assertNotIn(".tmp", name.name)
                        if name.suffix == ".h5":
                            modebank("verify", self.other / name)
                        elif name.name != "log.csv":  # it grows by whole lines
                            self.assertEqual(content, after[name], name)


if __name__ == "__main__":
    main()
