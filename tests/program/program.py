"""The program as its users type it, and its archives as h5py reads them: what the whole-program tests share.

MODEBANK_PROGRAM is the program, MODEBANK_SOURCE the source tree, MODEBANK_DATA real data. MODEBANK_DEMO is the folder
of `modebank demo`, which CTest makes once (`program.py FOLDER`); without it each test program makes its own. Tests do
not write into that folder.
"""
import atexit
import functools
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

try:
    import h5py
    import numpy as np
except ImportError as missing:
    if os.environ.get("CI") == "true":  # nothing may be absent
        raise
    print(f"SKIPPED: Python has no module {missing.name} (Debian: python3-h5py, python3-numpy)")
    sys.exit(77)

PROGRAM = os.environ["MODEBANK_PROGRAM"]
SOURCE = pathlib.Path(os.environ.get("MODEBANK_SOURCE", pathlib.Path(__file__).resolve().parents[2]))
DATA = pathlib.Path(os.environ.pop("MODEBANK_DATA", SOURCE.parent / "shared/data"))  # the program is told by data.root


def modebank(*words, cwd=None, input=None, status=0, env=None):
    """Runs the program, whose exit status must be `status`. Its output and its messages are stdout and stderr."""
    done = subprocess.run([PROGRAM, *map(str, words)], cwd=cwd, input=input, env=dict(os.environ, **env or {}),
                          capture_output=True, text=True, timeout=200)
    if done.returncode != status:
        raise AssertionError(f"{words}: exit status {done.returncode}, not {status}\n{done.stdout}{done.stderr}")
    return done


def facts(*words, **options):
    """The JSON object that the command prints with --json."""
    return json.loads(modebank(*words, "--json", **options).stdout)


def proposal(folder, *files):
    """The proposal of `init` for logs, in x.ini: its keys of [data], its doubts, and the tables of the first file."""
    told = facts("init", *files, "-o", "x.ini", "--force", cwd=folder)
    keys = {entry["key"].removeprefix("data."): entry["value"] for entry in told["keys"]}
    return keys, "\n".join(told["doubts"]), told["files"][0]["tables"]


def new_folder(cleanup):
    """An empty folder, which `cleanup` is told to remove."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="modebank-program-test-"))
    cleanup(shutil.rmtree, folder)
    return folder


def make_demo(parent):
    """The folder `demo` in `parent`, and beside it what the command printed, demo.json."""
    pathlib.Path(parent, "demo.json").write_text(modebank("demo", "-o", pathlib.Path(parent, "demo"), "--json").stdout)
    return pathlib.Path(parent, "demo")


@functools.lru_cache
def demo():
    """The folder of the demo: demo.h5, demo.ini, simulate_demo.ini and data/."""
    made = os.environ.get("MODEBANK_DEMO")
    return pathlib.Path(made) if made else make_demo(new_folder(atexit.register))


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


def write_csv(path, header, *columns, separator=",", decimal="."):
    lines = [header, *zip(*(np.asarray(column).tolist() for column in columns))]
    path.write_text("".join(separator.join(str(x).replace(".", decimal) for x in line) + "\n" for line in lines))


def write_runs(folder, samples=120, states=("wz",), memory=0.6, grips=(0.6, 0.2), stretch=20, holes=False):
    """Two runs of a vehicle that slips at times, run_00.csv and (held out) run_01.csv, and their test.ini."""
    for run in (0, 1):
        draw, k = np.random.default_rng(run + 1), np.arange(samples)
        u, x = draw.uniform(-0.5, 0.5, (samples, 2)), np.zeros((samples, len(states)))
        for i, grip in enumerate(np.take(grips, k[:-1] // stretch % len(grips))):
            x[i + 1] = memory * x[i] + grip * (u[i, 1] - u[i, 0]) + draw.uniform(-0.005, 0.005, len(states))
        values = [np.where(holes & (k > 9) & (k % 7 == place), "", column.astype(str))
                  for place, column in enumerate([*x.T, *u.T])]
        write_csv(folder / f"run_{run:02}.csv", ("time", *states, "left", "right"), k / 10, *values)
    (folder / "test.ini").write_text(f"[data]\ninputs = run_*.csv\nstate = {', '.join(states)}\ninput = left, right\n"
                                     "[window]\nmodel = linear\n[mixture]\ncomponents = 1..2\n")


def learn(folder, *words, **options):
    """The archive of such runs."""
    write_runs(folder, **options)
    modebank("run", "test.ini", "--force", *words, cwd=folder)
    return folder / "test.h5"


def differing(first, second):
    """Names of the arrays of two archives that differ in any bit, but for the configuration and the list of files."""
    a, b = arrays(first), arrays(second)
    return [name for name in sorted((a.keys() | b.keys()) - {"config", "provenance/inputs"})
            if np.asarray(a.get(name)).tobytes() != np.asarray(b.get(name)).tobytes()]


def rows(table, **values):
    """Rows of a table whose columns have these values: rows(summary, filter="bank", run="*")."""
    return table[[all(value in (row[name], row[name].decode()) for name, value in values.items()) for row in table]]


def slices(archive, **values):
    """{run: its samples} of an archive, as rows() chooses them: slices(archive, role="test")."""
    return {run["name"].decode(): slice(run["first"], run["first"] + run["samples"])
            for run in rows(arrays(archive, "/data")["runs"], **values)}


class ProgramTest(unittest.TestCase):
    """A test with a folder of its own, `self.folder`, and one of its class, `self.place`, which go afterwards."""
    @classmethod
    def setUpClass(cls):
        cls.place = new_folder(cls.addClassCleanup)

    def setUp(self):
        self.folder = new_folder(self.addCleanup)


main = functools.partial(unittest.main, verbosity=2)  # prints the reasons of skipped tests


if __name__ == "__main__":
    make_demo(sys.argv[1])
