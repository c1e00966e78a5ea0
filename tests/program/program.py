"""The program as its users type it, and its archives as h5py reads them: what the whole-program tests share.

MODEBANK_PROGRAM is the program, MODEBANK_SOURCE the source tree, MODEBANK_DATA real data. MODEBANK_DEMO is the folder
of `modebank demo`, which CTest makes once (`program.py FOLDER`); without it each test program makes its own. Tests do
not write into that folder.
"""
import atexit
import collections
import functools
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

REQUIRED = os.environ.get("CI") == "true" or os.environ.get("MODEBANK_NIGHTLY") == "1"  # nothing may be absent
try:
    import h5py
    import numpy as np
except ImportError as missing:
    if REQUIRED:
        raise
    print(f"SKIPPED: Python has no module {missing.name} (Debian: python3-h5py, python3-numpy)")
    sys.exit(77)

PROGRAM = os.environ["MODEBANK_PROGRAM"]
SOURCE = pathlib.Path(os.environ.get("MODEBANK_SOURCE", pathlib.Path(__file__).resolve().parents[2]))
DATA = pathlib.Path(os.environ.pop("MODEBANK_DATA", SOURCE.parent / "shared/data"))  # the program is told by data.root
TIMEOUT_S = 200
Done = collections.namedtuple("Done", "out err status")


def modebank(*words, cwd=None, input=None, status=0, env=None):
    """Runs the program: its output, its messages and its exit status, which must be `status` (None: any)."""
    done = subprocess.run([PROGRAM, *map(str, words)], cwd=cwd, input=input, env=dict(os.environ, **env or {}),
                          capture_output=True, text=True, timeout=TIMEOUT_S)
    if status is not None and done.returncode != status:
        raise AssertionError(f"{words}: exit status {done.returncode}, not {status}\n{done.stdout}{done.stderr}")
    return Done(done.stdout, done.stderr, done.returncode)


def facts(*words, **options):
    """The JSON object that the command prints with --json."""
    return json.loads(modebank(*words, "--json", **options).out)


def make_demo(parent):
    """The folder `demo` in `parent`, and beside it what the command printed, demo.json."""
    pathlib.Path(parent, "demo.json").write_text(modebank("demo", "-o", pathlib.Path(parent, "demo"), "--json").out)
    return pathlib.Path(parent, "demo")


@functools.lru_cache
def demo():
    """The folder of the demo: demo.h5, demo.ini, simulate_demo.ini and data/."""
    if "MODEBANK_DEMO" in os.environ:
        return pathlib.Path(os.environ["MODEBANK_DEMO"])
    parent = tempfile.mkdtemp(prefix="modebank-program-test-")
    atexit.register(shutil.rmtree, parent)
    return make_demo(parent)


def arrays(archive, path="/"):
    """Every dataset below the path as {name: array}. Tables are structured arrays."""
    found = {}
    with h5py.File(archive, "r") as file:
        file[path].visititems(lambda name, item: found.update({name: item[()]} if hasattr(item, "dtype") else {}))
    return found


def attributes(archive, path="/"):
    """Attributes of an object as {name: value}, with text as str."""
    with h5py.File(archive, "r") as file:
        return {name: value.decode() if isinstance(value, bytes) else value for name, value in file[path].attrs.items()}


def write_runs(folder, samples=120, states=("wz",)):
    """Two runs of a vehicle that slips at times, run_00.csv and (held out) run_01.csv, and their test.ini."""
    for run in (0, 1):
        draw = np.random.default_rng(run + 1)
        u, x = draw.uniform(-0.5, 0.5, (samples, 2)), np.zeros((samples, len(states)))
        for k in range(samples - 1):
            grip = 0.2 if k // 20 % 2 else 0.6
            x[k + 1] = 0.6 * x[k] + grip * (u[k, 1] - u[k, 0]) + draw.uniform(-0.005, 0.005, len(states))
        lines = [",".join(map(repr, (k / 10, *x[k].tolist(), *u[k].tolist()))) for k in range(samples)]
        header = ",".join(("time", *states, "left", "right"))
        pathlib.Path(folder, f"run_{run:02}.csv").write_text("\n".join([header, *lines, ""]))
    pathlib.Path(folder, "test.ini").write_text(
        f"[data]\ninputs = run_*.csv\nstate = {', '.join(states)}\ninput = left, right\n"
        "[window]\nmodel = linear\n[mixture]\ncomponents = 1..2\n")


def differing(first, second):
    """Names of the arrays of two archives that differ in any bit, but for the configuration and the list of files."""
    a, b = arrays(first), arrays(second)
    return [name for name in sorted((a.keys() | b.keys()) - {"config", "provenance/inputs"})
            if np.asarray(a.get(name)).tobytes() != np.asarray(b.get(name)).tobytes()]


def rows(table, **values):
    """Rows of a table whose columns have these values: rows(summary, filter="bank", run="*")."""
    keep = np.ones(len(table), bool)
    for column, value in values.items():
        keep &= table[column] == (value.encode() if isinstance(value, str) else value)
    return table[keep]


class ProgramTest(unittest.TestCase):
    """A test with a folder of its own, `self.folder`, which goes afterwards."""
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="modebank-program-test-"))
        self.addCleanup(shutil.rmtree, self.folder)


def main():
    unittest.main(verbosity=2)  # prints the reasons of skipped tests


if __name__ == "__main__":
    os.makedirs(sys.argv[1], exist_ok=True)
    make_demo(sys.argv[1])
