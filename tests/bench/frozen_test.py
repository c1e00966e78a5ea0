#!/usr/bin/env python3
"""Tests what frozen.py reports and refuses, with made-up tables, and with archives that a small program makes up."""
import contextlib
import io
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import frozen

HEAD = ",".join(frozen.COLUMNS) + "\n"
ROWS = {"bank": "ice,bank,1,0,2.00000,0.10000,0.9500,,,,,,,\n", "rival": "ice,drifting,1,0,1.90000,0.1,0.94,,,,,,,\n",
        "free": "ice,bank,0,0,,0,,,,,,,,\n", "answer": "ice,answer,,,,,,evidence,3,4,2;1,0.1,0.02,9\n",
        "paper": "salvi,bank,1,0,1.00000,0.050000,0.9990,,,,,,,\n"}
EXTRA = "dart,bank,1,0,nan,0.1,0.9500,,,,,,,\n"
OFFENCES = """bank 2.00000 1.99400|bank 2.00000 2.00600|bank 2.00000 nan|bank 2.00000 -|bank 0.10000 0.09940
bank 0.10000 nan|bank 0.10000 inf|bank 0.9500 nan|bank 0.9500 -|free 0,0,,0 0,0,,0.1|free 0,0,,0 0,0,1.5,0
answer evidence one|answer 3,4 2,4|answer 3,4 3,5|answer 3,4 3,-|answer 2;1 1;2|answer 0.02,9 nan,9|answer 0.02,9 0.02,-
paper 1.00000 1.00002|paper 0.050000 0.050001|paper 0.9990 0.9989""".replace("\n", "|").split("|")
# Its archives are the same but where runs are swapped. If the configuration has "crash", it fails after writing.
PROGRAM = '''#!/usr/bin/python3
import os, sys, h5py, numpy as np
path = sys.argv[4] if sys.argv[1] == "run" else sys.argv[3] + "/demo.h5"
os.makedirs(os.path.dirname(path), exist_ok=True)
with h5py.File(path, "w") as f:
    s = h5py.string_dtype()
    f["data/runs"] = np.array([("r1", "train", 0.), ("r2", "test", 0.)], [("name", s), ("role", s), ("lag_s", float)])
    f["data/state"], f["data/input"], f["mixture/weights"] = np.zeros((9, 2)), np.zeros((9, 1)), np.ones(4)
    row = ("bank", "*", "test", [.2 if "--data.train" in sys.argv else .1, .3])
    columns = [("filter", s), ("run", s), ("role", s), ("rmse", float, 2)]
    f["evaluation/summary"] = np.array([row + ([.95, .9],)], columns + [("coverage_95", float, 2)])
    f["evaluation/horizon"] = np.array([row + (1, 1.5)], columns + [("horizon", int), ("log_score", float)])
    f["evaluation/free_run"] = np.array([row], columns)
    f.create_group("evaluation/evidence").attrs["answer"] = "evidence"
    f["bank/weight"], f["bank/A"], f["bank/B"], f["bank/R"] = [1] * 3, np.ones((3, 4, 4)), np.ones((3, 4, 2)), np.eye(2)
sys.exit(7 if sys.argv[1] == "run" and "crash" in open(sys.argv[2]).read() else 0)
'''


def changed(name, old, new):
    return {name: ROWS[name].replace(old, new)}


class Frozen(unittest.TestCase):
    def setUp(self):
        self.enterContext(contextlib.chdir(self.enterContext(tempfile.TemporaryDirectory())))

    def call(self, words):  # exit status and output
        with mock.patch("sys.argv", ["frozen.py", *words.split()]), contextlib.redirect_stdout(io.StringIO()) as output:
            try:
                return 0 if frozen.main() else 1, output.getvalue()
            except SystemExit as end:
                return 1 if isinstance(end.code, str) else end.code, str(end.code)

    def compared(self, changes, reasons="", old="", only=""):
        """The comparison of ROWS, and the rows `old` behind them, with ROWS after the changes."""
        Path("old").write_text(HEAD + "".join(ROWS.values()) + old)
        Path("new").write_text(HEAD + "".join((ROWS | changes).values()))
        Path("reasons").write_text(reasons)
        return self.call(f"compare old new --reasons reasons {only}")

    def test_small_moves_keep_the_rule(self):
        for move in ("bank 2.00000 2.00400", "bank 0.10000 0.10040", "answer 0.02,9 0.03,19"):
            self.assertEqual(self.compared(changed(*move.split()))[0], 0)
        self.assertIn("noted:", self.compared(changed("bank", "0.9500", "0.8000"))[1])

    def test_each_offence_needs_a_reason(self):
        lost, finite = [{"rival": ""}, {"paper": ""}], {"dart": EXTRA.replace("nan", "1")}
        for change in [changed(*offence.replace("-", "").split(" ")) for offence in OFFENCES] + lost + [finite]:
            with self.subTest(change=change):
                self.assertEqual(self.compared(change)[0], 1)
                self.assertEqual(self.compared(change, "* * * meant to move\n")[0], 0)
        self.assertEqual([self.compared(new, "", EXTRA)[0] for new in ({"dart": EXTRA}, finite)], [1, 1])

    def test_a_reason_excuses_its_row_alone_and_no_large_loss(self):
        both = changed("bank", "2.00000", "1.99700") | changed("rival", "0,1.9", "0,1.903")
        self.assertEqual([self.compared(both, why)[0] for why in ("", "ice bank 1 x", "ice drifting 1 x")], [1, 1, 0])
        worse, gain = changed("bank", "2.00000", "1.97000"), "ice drifting 1 x\n"
        self.assertEqual([self.compared(worse, gain + why)[0] for why in ("", "ice bank 10 x", "* * *")], [1, 1, 1])
        self.assertRegex(str(self.compared(worse, gain + "ice bank 1 x")), r"^\(0, .*short: +ice bank")

    def test_names_without_a_row_and_rows_that_stand_twice(self):
        self.assertEqual([self.compared({}, only="--only " + names)[0] for names in ("salvi", "salvi drive")], [0, 1])
        twice = self.compared({}, "", ROWS["bank"])
        self.assertEqual([twice[0], self.call("compare old absent")[0], self.call("table .")[0]], [1, 1, 1])

    def test_a_failed_run_leaves_no_row(self):
        Path("configs").mkdir()
        Path("program").write_text(PROGRAM)
        Path("program").chmod(0o755)
        Path("configs/dart.ini").write_text("[filter]\na = 1\n[data]\nb = 2\n[bank]\nc = 3\n")
        run, quick = "run ./program configs data out dart", "quick ./program ./program configs data out"
        self.assertEqual([self.call(run + " drat")[0], self.call(run)[0]], [1, 0])
        self.assertEqual(Path("out/dart_default.ini").read_text(), "[data]\nb = 2\n")
        Path("old").write_text(self.call("table out")[1])
        for row in ("a,bank,1,1,1.50000,0.3,0.9000", "b,bank,0,0,,0.2", "b,answer,,,,,,evidence,3,4,2;2,"):
            self.assertIn("dart_config_" + row, Path("old").read_text())
        self.assertEqual(self.call("compare old out")[0], 0)
        Path("configs/dart.ini").write_text("[filter]\na = crash\n[data]\nb = 2\n")
        Path("out/tanks_config_a.h5").touch()  # made with other configurations
        self.assertEqual([self.call(run)[0], self.call("compare old out")[0]], [1, 1])
        self.assertEqual(sorted(p.name for p in Path("out").glob("*.h5")), ["dart_default_a.h5", "dart_default_b.h5"])
        for text, status in (("[data]", 0), ("crash", 1)):
            Path("configs/husky_ice.ini").write_text(text)
            self.assertEqual(self.call(quick)[0], status)


if __name__ == "__main__":
    unittest.main()
