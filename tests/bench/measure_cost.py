#!/usr/bin/python3
"""Processor time of `modebank run` as a function of states, lags and samples: the table of docs/results/speed.md.

measure_cost.py MODEBANK FOLDER [--only NAME,NAME] [--seconds N]

Systems:
- n = m = 1, 2, 4, 6, 8 states and inputs, and two states with 2, 4, 8 lags: 4 runs of 400 samples, every other one held out
- one state and one input with 30 lags each: 8 runs of 1000 samples
- one state and two inputs: one run of 1e5 and one of 1e6 samples

All systems switch between two motions. Settings are the defaults, on one thread. The time of a stage is the wall time that
the program prints; on one thread it equals processor time. A run that takes longer than N seconds (1200) is stopped.
"""

import os
import platform
import re
import resource
import subprocess

import numpy as np

from switching_system import options_of, switched, write_runs

STAGES = ["structure", "windows", "mixture", "drifting", "bank", "one_motion", "evaluation"]


def system(draw, states, inputs, lags):
    """Two motions x[k+1] = sum_i A_i x[k+1-i] + B u[k] with different poles and inputs."""
    first = np.diag(draw.uniform(0.3, 0.8, states)) + 0.03 * draw.standard_normal((states, states))
    gain = 0.2 * draw.standard_normal((states, inputs))
    older = [0.15 ** (i + 1) * (-1) ** i * np.eye(states) for i in range(lags - 1)]
    return [(np.hstack([first * scale, *older]), gain * factor) for scale, factor in ((1.0, 1.0), (0.6, 1.6))]


def simulate(draw, motions, samples, stay=80.0, sd=0.02):
    states, inputs = motions[0][1].shape
    commands = np.repeat(draw.uniform(-0.5, 0.5, (samples // 4 + 1, inputs)), 4, 0)[:samples]
    mode = np.cumsum(draw.random(samples) < 1.0 / stay) % 2
    return commands, switched(motions, mode, commands, sd * draw.standard_normal((samples, states)))


def write(folder, runs, samples, states, inputs, lags, settings):
    draw = np.random.default_rng([states, inputs, lags, samples])
    motions = system(draw, states, inputs, lags)
    split = "split = last 30 %" if runs == 1 else "test = " + ", ".join(f"{r:02d}" for r in range(1, runs, 2))
    write_runs(folder, [simulate(draw, motions, samples) for _ in range(runs)], split, *settings)


def stages_of(text):
    """Seconds per stage; a line of progress begins with the stage's name."""
    lines = re.findall(r"^(\w+): .* in ([0-9.]+) s", text, re.M)
    return {stage: sum(float(seconds) for name, seconds in lines if name == stage) for stage in STAGES}


def measure(program, folder, most_s):
    limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (most_s, most_s))
    command = [program, "run", "system.ini", "--job.threads", "1", "--archive.output", "out.h5", "--force"]
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, preexec_fn=limit)
    text = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    stopped = os.WIFSIGNALED(status)
    if status != 0 and not stopped:
        raise SystemExit(f"{folder}: status {status}\n{text}")
    processor = f"over {most_s}" if stopped else f"{usage.ru_utime + usage.ru_stime:.1f}"
    return processor, stages_of(text), usage.ru_maxrss / 1024


def lagged(count, *more):
    return ["[window]", "model = varx", f"state_lags = {count}", f"input_lags = {count}", *more]


CASES = [(f"n{n}", f"n = m = {n}", 4, 400, n, n, 1, []) for n in (1, 2, 4, 6, 8)]
CASES += [(f"lags{p}", f"two states, two inputs, {p} lags", 4, 400, 2, 2, p, lagged(p)) for p in (2, 4, 8)]
CASES += [("lags30", "one state, one input, 30 lags", 8, 1000, 1, 1, 30, lagged(30, "length = 100")),
          ("samples5", "one state, two inputs, 1e5 samples", 1, 100_000, 1, 2, 1, []),
          ("samples6", "one state, two inputs, 1e6 samples", 1, 1_000_000, 1, 2, 1, [])]


def main():
    options = options_of(__doc__, "modebank", "folder", only="", seconds=1200)
    folder, program = options.folder.resolve(), options.modebank.resolve()
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} processors, load average {os.getloadavg()[0]:.1f} at the start\n")
    print("| data | processor s | " + " | ".join(STAGES) + " | MB |\n|---|" + "---|" * (len(STAGES) + 2))
    for name, words, runs, samples, states, inputs, lags, settings in CASES:
        if options.only and name not in options.only.split(","):
            continue
        write(folder / name, runs, samples, states, inputs, lags, settings)
        processor, stages, memory = measure(program, folder / name, options.seconds)
        print(f"| {words} | {processor} | " + " | ".join(f"{stages[s]:.1f}" for s in STAGES) + f" | {memory:.0f} |", flush=True)


if __name__ == "__main__":
    main()
