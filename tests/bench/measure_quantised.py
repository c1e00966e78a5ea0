#!/usr/bin/env python3
"""Known systems whose outputs are rounded: bias and stated uncertainty with intervals and with the Gaussian likelihood (make quantised).

  measure_quantised.py build/modebank [--seeds 50] [--first 0] [--jobs N] [--modes 1,2] [--quanta 0.3,1,3] [--scale 1] [--rows FILE]

Systems have one state without measurement noise, and one mode or two modes that differ in A, B and noise. Six of twelve runs
of 400 samples train. Outputs are multiples of a quantum, given in innovation standard deviations. mixture.components is the
number of modes. The files of each seed are learned from in two or three ways:
- interval: data.quantum = the quantum
- Gaussian: data.quantum = none
- exact (on request): data.quantum = none, and R fixed at almost zero

Bias: mean over seeds of theta minus the truth, in the bank's stated errors, with the standard error of that mean. It is given
for the parameter with the largest bias, over seeds whose bank has the true number of modes. Tails: of the held-out runs.
Prints a Markdown table.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import sys
import tempfile
import time

import h5py
import numpy as np

from switching_system import SD, Switching, run_program

RUNS, SAMPLES, STAY = 12, 400, 100
MODES = [([[-.15]], [[-.15, .15]], 1.0), ([[-.5]], [[.3, .1]], 1.0)]


def settings(likelihood, quantum):
    """interval: likelihood of intervals; Gaussian: values as recorded, R learned; exact: values taken as exact."""
    if likelihood == "interval":
        return ["--data.quantum", f"{quantum:.9g}"]
    return ["--data.quantum", "none"] + (["--bank.measurement_variance", f"{1e-9 * SD ** 2:.9g}"] if likelihood == "exact" else [])


def learned(program, runs, folder, modes, options):
    start = time.monotonic()
    done = run_program(program, runs, folder, options + ["--window.model", "linear", "--mixture.components", str(modes), "--filter.smooth", "false"])
    if done.returncode != 0:
        return {"failed": done.stderr.strip().splitlines()[-1:]}
    with h5py.File(folder / "out.h5") as file:
        bank = file["bank"]
        rows = file["evaluation/summary"][:]
        pooled = [r for r in rows if (r["filter"], r["role"], r["run"]) == (b"bank", b"test", b"*")][0]
        return {"theta": np.concatenate([bank["A"][:].reshape(len(bank["A"]), -1), bank["B"][:].reshape(len(bank["A"]), -1)], axis=1).tolist(),
                "packed": bank["parameters"][:].tolist(), "error": bank["parameter_standard_error"][:].tolist(),
                "Q": bank["Q"][:].ravel().tolist(), "too_far": float(pooled["too_far"]), "too_close": float(pooled["too_close"]),
                "log_score": float(pooled["log_score"]), "seconds": time.monotonic() - start}


def trial(program, likelihoods, scale, modes, deviations, seed):
    g = np.random.default_rng([seed, modes])
    chosen = MODES[:modes]
    system = Switching([np.array(A) for A, _, _ in chosen], [scale * np.array(B) for _, B, _ in chosen], [SD * s for _, _, s in chosen], 0.0, STAY)
    quantum = deviations * SD
    runs = [(u, np.round(y / quantum) * quantum) for u, y in (system.simulate(g, run, SAMPLES) for run in range(RUNS))]
    result = {"scale": scale, "modes": modes, "deviations": deviations, "seed": seed}
    with tempfile.TemporaryDirectory() as path:
        for likelihood in likelihoods:
            result[likelihood] = learned(program, runs, pathlib.Path(path), modes, settings(likelihood, quantum))
    return result


def standardised(said, modes, scale):
    """Errors of theta in standard errors, mode by mode in the true order; None if the number of modes differs."""
    if "failed" in said or len(said["theta"]) != modes:
        return None
    truth = np.array([np.concatenate([np.ravel(A), scale * np.ravel(B)]) for A, B, _ in MODES[:modes]])
    theta, error = np.array(said["theta"]), np.array(said["error"])
    nearest = [int(np.argmin(((truth - row) ** 2).sum(1))) for row in theta]
    if sorted(nearest) != list(range(modes)):
        return None
    z = np.zeros_like(theta)
    for j, t in enumerate(nearest):
        z[t] = (theta[j] - truth[t]) / error[j]  # one state: theta is archived as (A, B), too
    return z.ravel()


def row(results, likelihood):
    modes, deviations = results[0]["modes"], results[0]["deviations"]
    said = [r[likelihood] for r in results if "failed" not in r[likelihood]]
    z = [v for v in (standardised(s, modes, results[0]["scale"]) for s in said) if v is not None]
    if z:
        mean, count = np.mean(z, axis=0), len(z)
        worst = int(np.argmax(np.abs(mean)))
        bias = f"{mean[worst]:+.2f} ± {np.std(z, axis=0, ddof=1)[worst] / np.sqrt(count) if count > 1 else np.nan:.2f}"
        spread = f"{np.sqrt(np.mean(np.var(z, axis=0))):.2f}"
    else:
        bias = spread = "–"
    far, close = np.array([s["too_far"] for s in said]), np.array([s["too_close"] for s in said])
    both = ((far >= 0.01) & (far <= 0.04) & (close >= 0.01) & (close <= 0.04)).sum()
    return (f"| {modes} | {deviations:g} | {likelihood} | {len(results)} | {len(z)} | {bias} | {spread} | {100 * far.mean():.1f} | {100 * close.mean():.1f} | "
            f"{both} | {np.median([s['seconds'] for s in said]):.1f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--modes", default="1,2")
    parser.add_argument("--quanta", default="0.3,1,3")
    parser.add_argument("--likelihoods", default="interval,Gaussian", help="and exact")
    parser.add_argument("--scale", type=float, default=1.0, help="of B: a small one keeps the signal within few quanta")
    parser.add_argument("--rows", help="one line of JSON per seed goes here")
    options = parser.parse_args()
    likelihoods = options.likelihoods.split(",")
    print("| modes | quantum / sd | likelihood | seeds | right number | largest mean error in stated errors | spread in stated errors | too far % | "
          "too close % | both 1 to 4 % | s |\n|" + "---|" * 11)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for modes in map(int, options.modes.split(",")):
            for deviations in map(float, options.quanta.split(",")):
                seeds = range(options.first, options.first + options.seeds)
                results = list(pool.map(lambda seed, m=modes, d=deviations: trial(options.program, likelihoods, options.scale, m, d, seed), seeds))
                if options.rows:
                    with open(options.rows, "a", encoding="utf-8") as rows:
                        rows.writelines(json.dumps(r) + "\n" for r in results)
                for likelihood in likelihoods:
                    print(row(results, likelihood), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
