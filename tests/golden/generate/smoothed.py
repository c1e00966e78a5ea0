#!/usr/bin/python3
"""Smoothed states of one mode, by the smoother that the program had at 6a013144.

    /usr/bin/python3 tests/golden/generate/smoothed.py PROGRAM        PROGRAM: modebank at revision 6a013144

writes data/smoothed.csv: per line the name of an array of the archive and its numbers, row by row. tests/program/
recipes_test.py compares the recipe for smoothed states with it.
"""
import os
import pathlib
import sys
import tempfile

os.environ["MODEBANK_PROGRAM"] = sys.argv[1]
sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "program"))
import program  # noqa: E402
import recipes_test  # noqa: E402

with tempfile.TemporaryDirectory() as folder:
    numbers = program.arrays(recipes_test.of_one_mode(pathlib.Path(folder)))
names = [*(f"bank/{name}" for name in "ABcQR"), "evaluation/bank/smoothed_state", "evaluation/bank/smoothed_covariance"]
text = "".join(",".join([name, *(repr(float(x)) for x in numbers[name].ravel())]) + "\n" for name in names)
(pathlib.Path(__file__).parents[1] / "data/smoothed.csv").write_text(text)
