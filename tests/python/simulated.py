"""A robot on ice and grip as `modebank demo` has it, shorter: files of runs, simulated once per test program."""
import atexit
import functools
import os
import pathlib
import shutil
import subprocess
import tempfile

import pandas

SOURCE = pathlib.Path(os.environ["MODEBANK_SOURCE"])
# Options that shorten the demo's chain to seconds.
QUICK = {"window.model": "linear", "window.step": 5, "mixture.components": [1, 2], "mixture.restarts": 2, "bank.refine": "none"}


@functools.lru_cache
def folder():
    """A folder with pro_NN.csv (inputs) and imu_NN.csv (states) of four runs."""
    path = pathlib.Path(tempfile.mkdtemp(prefix="modebank-python-test-"))
    atexit.register(shutil.rmtree, path)
    subprocess.run([os.environ["MODEBANK_PROGRAM"], "simulate", SOURCE / "configs/simulate_demo.ini", "--simulate.output",
                    path, "--simulate.runs", "4"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return path


def frames():
    """The same runs as {name: (inputs, states)}."""
    names = sorted(file.stem.removeprefix("pro_") for file in folder().glob("pro_*.csv"))
    return {name: (pandas.read_csv(folder() / f"pro_{name}.csv", float_precision="round_trip"),
                   pandas.read_csv(folder() / f"imu_{name}.csv", float_precision="round_trip")) for name in names}


COLUMNS = {"state": "wz", "input": ["cmd_velL", "cmd_velR"]}
