#!/usr/bin/python3
"""Time and memory of long recordings and of many runs: a table for docs/results/speed.md.

scale.py MODEBANK FOLDER [--rows N] [--runs N] [--page N]

Measures three cases:
- one run of N rows (--rows) and three channels, cut into twenty blocks (data.split), with bank.refine = none and with the
  default, and its report
- the page of one whole run (--page)
- N runs (--runs) of six rows in one file (data.run): run, show, verify and report

Data are simulated with a fixed seed: two motions that change every 50 samples on average. The model has one lag, without a
search for more. So the figures are those of reading, filtering and writing, and can be compared with older programs.
"""

import argparse
import os
import platform
import subprocess
import time
from pathlib import Path

import h5py
import numpy as np

BLOCK = """[data]
inputs = {data}
state = wz
input = velL, velR
state_unit = rad/s
{split}
[window]
model = linear
terms = none
length = {length}
[mixture]
components = 1..2
restarts = 2
"""


def simulate(rows):
    """Columns time, wz, velL, velR."""
    draw = np.random.default_rng(0)
    inputs = np.repeat(draw.uniform(-0.5, 0.5, (rows // 8 + 1, 2)), 8, 0)[:rows]
    slow = np.cumsum(draw.random(rows) < 0.02) % 2 == 0
    step = np.where(slow, 0.21, 0.72) * (inputs[:, 1] - inputs[:, 0]) + draw.normal(0, np.where(slow, 0.02, 0.01))
    decay = np.where(slow, 0.7, 0.4)
    state = np.zeros(rows)
    for k in range(rows - 1):
        state[k + 1] = decay[k] * state[k] + step[k]
    return np.column_stack([np.arange(rows) * 0.1, state, inputs])


def write_rows(path, rows):
    if not path.exists():
        np.savetxt(path, simulate(rows), fmt="%.10g", delimiter=",", header="time,wz,velL,velR", comments="")


def write_runs(path, runs, rows=6):
    if path.exists():
        return
    table = np.column_stack([simulate(runs * rows), np.repeat(np.arange(runs), rows)])
    table[:, 0] = np.tile(np.arange(rows) * 0.1, runs)
    np.savetxt(path, table, fmt=["%.10g"] * 4 + ["%05d"], delimiter=",", header="time,wz,velL,velR,id", comments="")


def processor_seconds(pid):
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measure(command, folder):
    """Wall-clock and processor seconds, those since the last evaluation, largest resident memory in MB, and standard
    error."""
    start, evaluated, text = time.monotonic(), 0.0, ""
    with open(folder / "stdout.txt", "w") as output:
        process = subprocess.Popen(command, cwd=folder, stdout=output, stderr=subprocess.PIPE, text=True)
        for line in process.stderr:
            text += line
            if line.startswith("evaluation:"):
                evaluated = processor_seconds(process.pid)
        _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{' '.join(map(str, command))}: status {status}\n{text}")
    processor = usage.ru_utime + usage.ru_stime
    return time.monotonic() - start, processor, processor - evaluated, usage.ru_maxrss / 1024, text


def row(command, folder, archive=None):
    wall, processor, written, memory, text = measure(command, folder)
    size = f"{(folder / archive).stat().st_size / 1e6:.0f}" if archive else ""
    shown = " ".join(["modebank", *map(str, command[1:])])
    print(f"| `{shown}` | {wall:.1f} | {processor:.1f} | {memory:.0f} | {size} |", flush=True)
    return [line for line in text.splitlines() if "learned from" in line], written


def check_readable(path):
    """Checks that every dataset of the layout opens in h5py."""
    with h5py.File(path) as archive:
        samples = archive["data/runs"]["samples"].sum()
        assert archive["evaluation/bank/prediction"].shape[0] == archive["data/time"].shape[0] == samples
        assert np.isfinite(archive["evaluation/bank/prediction"][-1]).all()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("modebank", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--rows", type=int, default=5_000_000)
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--page", type=int, default=1_000_000)
    options = parser.parse_args()
    folder, program = options.folder.resolve(), options.modebank.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    print(f"{options.rows} rows in one run, {options.runs} runs of 6 rows in one file; {platform.processor() or platform.machine()}, "
          f"{os.cpu_count()} processors, load average {os.getloadavg()[0]:.1f} at the start\n")
    print("| command | s | processor s | MB | archive MB |\n|---|---|---|---|---|")
    write_rows(folder / "rows.csv", options.rows)
    (folder / "rows.ini").write_text(BLOCK.format(data="rows.csv", split="split = blocks 20", length=10))
    row([program, "run", "rows.ini", "--bank.refine", "none", "--archive.output", "none.h5"], folder, "none.h5")
    said, _ = row([program, "run", "rows.ini", "--archive.output", "rows.h5"], folder, "rows.h5")
    check_readable(folder / "rows.h5")
    row([program, "report", "rows.h5", "-o", "rows.html"], folder)
    write_rows(folder / "page.csv", options.page)
    (folder / "page.ini").write_text(BLOCK.format(data="page.csv", split="", length=10))
    row([program, "run", "page.ini", "--bank.refine", "none", "--archive.output", "page.h5"], folder, "page.h5")
    row([program, "report", "page.h5", "-o", "page.html"], folder)
    write_runs(folder / "runs.csv", options.runs)
    (folder / "runs.ini").write_text(BLOCK.format(data="runs.csv", split="run = id", length=5))
    _, written = row([program, "run", "runs.ini", "--bank.refine", "none", "--archive.output", "runs.h5"], folder, "runs.h5")
    check_readable(folder / "runs.h5")
    for command in (["show", "runs.h5"], ["verify", "runs.h5"], ["report", "runs.h5", "-o", "runs.html"]):
        row([program, *command], folder)
    print(f"\n{options.runs / written:.0f} runs written per processor second, hash and summary included", *said, sep="\n")


if __name__ == "__main__":
    main()
