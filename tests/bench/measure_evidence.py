#!/usr/bin/env python3
"""How often modes of motion are claimed: where there are none, and where there are some (make evidence).

  measure_evidence.py build/modebank [--seeds 100] [--first 0] [--jobs N] [--only NAME,NAME] [--quantum auto]

Every system is simulated here, by numpy, as twelve runs of 400 samples with inputs redrawn or held; six train and six
are held out, as `modebank run` divides them by default, and the program runs with nothing but [data] configured. Counted is
the answer of /evaluation/evidence. Of systems with modes those count that the filter with the true parameters, written here,
finds: its gain over each competitor exceeds twice that competitor's margin. Prints a Markdown table.
"""
import argparse
import concurrent.futures
import math
import os
import pathlib
import sys
import tempfile

import h5py
import numpy as np

from switching_system import SD, Switching, inputs, run_program, sticky

RUNS, SAMPLES = 12, 400
A, B = -0.3, np.array([-0.2, 0.2])


def one_state(g, noise=None, a=None, b=None, drive=lambda v: v):
    """Runs of x[k+1] = x[k] + a x[k] + drive(b u[k]) + w[k]; noise(run) and a, b per sample where given."""
    runs = []
    for run in range(RUNS):
        u, x = inputs(g, run, SAMPLES), np.zeros(SAMPLES)
        w = noise(run) if noise else SD * g.standard_normal(SAMPLES)
        a_k, b_k = (a(run) if a else np.full(SAMPLES, A)), (b(run) if b else np.tile(B, (SAMPLES, 1)))
        for k in range(SAMPLES - 1):
            x[k + 1] = x[k] + a_k[k] * x[k] + drive(b_k[k] @ u[k]) + w[k]
        runs.append((u, x[:, None]))
    return runs


def student(g):
    return one_state(g, lambda run: SD * g.standard_t(4, SAMPLES) / math.sqrt(2.0))


def two_noises(g):
    return one_state(g, lambda run: SD * np.array([0.4, 1.6])[sticky(g, 2, 80, SAMPLES)] * g.standard_normal(SAMPLES))


def noise_by_run(g):
    sizes = SD * np.exp(0.5 * g.standard_normal(RUNS))
    return one_state(g, lambda run: sizes[run] * g.standard_normal(SAMPLES))


def coloured(g):
    def noise(run):
        w = SD * g.standard_normal(SAMPLES)
        for k in range(1, SAMPLES):
            w[k] += 0.6 * w[k - 1]
        return w
    return one_state(g, noise)


def drift(g):
    phase = g.uniform(0, 2 * np.pi, (RUNS, 3))
    time = [2 * np.pi * np.arange(SAMPLES) / g.uniform(300, 900) for _ in range(RUNS)]
    return one_state(g, a=lambda r: -0.3 + 0.15 * np.sin(time[r] + phase[r, 0]),
                     b=lambda r: B + 0.12 * np.sin(time[r][:, None] + phase[r, 1:]))


def lag_too_few(g):
    runs = []
    for run in range(RUNS):
        u, x = inputs(g, run, SAMPLES), np.zeros(SAMPLES)
        for k in range(1, SAMPLES - 1):
            x[k + 1] = 1.1 * x[k] - 0.4 * x[k - 1] + B @ u[k] + SD * g.standard_normal()
        runs.append((u, x[:, None]))
    return runs


def quantised(g):
    quantum = SD * g.uniform(1 / 3, 1.0)
    return [(u, quantum * np.round(x / quantum)) for u, x in one_state(g)]


def no_input(g):
    return one_state(g, b=lambda run: np.zeros((SAMPLES, 2)))


def constant(g):
    return [(inputs(g, run, SAMPLES), np.full((SAMPLES, 1), 0.25)) for run in range(RUNS)]


def saturating(g):
    return one_state(g, drive=lambda v: 0.1 * math.tanh(v / 0.05))


NOTHING = {"one linear motion": one_state, "Student's t, 4 degrees": student, "two noise levels that switch": two_noises,
           "noise that differs by run": noise_by_run, "coloured noise": coloured, "drifting coefficients": drift,
           "one lag too few": lag_too_few, "output quantised": quantised, "no input effect": no_input,
           "constant state": constant}
NAMED = {"one saturating motion (tanh)": saturating}


def margins(folder):
    with h5py.File(folder / "out.h5") as file:
        evidence = file["evaluation/evidence"]
        quantile = {row["competitor"].decode(): row["margin"] / max(row["standard_error"], 1e-300) for row in evidence["gains"]}
        densities = {name: [file[f"evaluation/{name}/{run}/log_density"][:] for run in file["data"] if file[f"data/{run}"].attrs["role"] == b"test"]
                     for name in quantile}
        return evidence.attrs["answer"].decode(), evidence.attrs["text"].decode(), quantile, densities


def truth_passes(system, runs, quantile, densities):
    """Twice the threshold: the truth's own paired gains and margins, clustered by run as the program does; `quantile`: Student's."""
    held_out = [system.log_density(*runs[i]) for i in range(1, RUNS, 2)]
    for name in quantile:
        d = [a - b for a, b in zip(held_out, densities[name])]
        keep = [x[~np.isnan(x)] for x in d]
        N, G = sum(map(len, keep)), len(keep)
        m = sum(x.sum() for x in keep) / N
        error = math.sqrt(G / (G - 1) * sum((x.sum() - m * len(x)) ** 2 for x in keep)) / N
        if not m > 2 * quantile[name] * error:
            return False
    return True


def trial(program, quantum, name, seed):
    with tempfile.TemporaryDirectory() as path:
        folder = pathlib.Path(path)
        system = None
        g = np.random.default_rng([seed, sum(map(ord, name))])
        if name == "modes":
            system = Switching.drawn(g)
            runs = [system.simulate(g, run, SAMPLES) for run in range(RUNS)]
        else:
            runs = {**NOTHING, **NAMED}[name](g)
        done = run_program(program, runs, folder, ["--data.quantum", quantum])
        if done.returncode != 0:
            return name, "refused" if done.returncode in (1, 2) else "crash", done.stderr.strip().splitlines()[-1:], None
        answer, text, quantile, densities = margins(folder)
        return name, answer, text, truth_passes(system, runs, quantile, densities) if system else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", default="")
    parser.add_argument("--quantum", default="none", help="data.quantum: with auto readings that come in steps count as intervals")
    options = parser.parse_args()
    wanted = options.only.split(",") if options.only else [*NOTHING, *NAMED, "modes"]
    seeds = range(options.first, options.first + options.seeds)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        results = list(pool.map(lambda job: trial(options.program, options.quantum, *job), [(name, seed) for name in wanted for seed in seeds]))
    answers = ["evidence", "cannot tell", "no evidence", "one mode", "not comparable", "not yet", "refused", "crash"]
    print("| system | " + " | ".join(answers) + " |\n|---|" + "---|" * len(answers))
    claimed = 0
    for name in [name for name in wanted if name != "modes"]:
        counts = [sum(r[0] == name and r[1] == answer for r in results) for answer in answers]
        print(f"| {name} | " + " | ".join(map(str, counts)) + " |")
        claimed += counts[0] if name in NOTHING else 0
    nothing = [name for name in wanted if name in NOTHING]
    if nothing:
        print(f"\nevidence is claimed in {claimed} of {len(nothing) * options.seeds} systems without modes")
    found = [r for r in results if r[0] == "modes" and r[3]]
    if "modes" in wanted:
        print(f"systems with modes that the true filter finds at twice the threshold: {len(found)} of {options.seeds}; "
              f"of these the learned bank passes in {sum(r[1] == 'evidence' for r in found)}")
        for r in found:
            if r[1] != "evidence":
                print(f"  {r[1]}: {r[2]}")
    for r in results:
        if r[1] == "crash" or (r[1] == "evidence" and r[0] in NOTHING):
            print(f"  {r[0]}: {r[2]}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
