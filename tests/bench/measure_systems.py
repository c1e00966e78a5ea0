#!/usr/bin/env python3
"""Known systems by the default configuration: regret, number of modes and stated errors (make systems).

  measure_systems.py build/modebank [--seeds 50] [--first 0] [--jobs N] [--only NAME,NAME] [--rows FILE]

Twenty runs of 800 samples each, ten of which train: the three modes of one state and the three of two states below, without measurement
noise and with R = Q / 4, stays of 100 to 400 samples on average (a seed's own) or of 20 windows; the program runs with nothing but
[data] configured. Regret: held-out log score of the filter with the true parameters minus the bank's. Stated errors: theta of each
mode minus the true mode that it is nearest to, in the mode's own errors, where the number of modes is right. Prints a Markdown table.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import sys
import tempfile

import h5py
import numpy as np

from switching_system import SD, Switching, run_program

RUNS, SAMPLES, WINDOW = 20, 800, 25
ONE = [([[-.15]], [[-.15, .15]]), ([[-.40]], [[-.15, .30]]), ([[-.05]], [[.10, .02]])]
TWO = [([[-.2, .05], [0, -.3]], [[.1, .1], [-.2, .2]]), ([[-.4, 0], [.1, -.1]], [[.25, .1], [-.1, .1]]),
       ([[-.1, 0], [-.1, -.5]], [[.05, .2], [-.3, .15]])]
SYSTEMS = {f"{n}, {r}, {stay}": (modes, share, windows)
           for n, modes in (("n = 1", ONE), ("n = 2", TWO)) for r, share in (("R = 0", 0.0), ("R = Q/4", 0.25))
           for stay, windows in (("stays of 4 to 16 windows", None), ("stays of 20 windows", 20))}


def free_parameters(system):
    K, n = system.K, system.n
    return K * (n * (n + 2) + n * (n + 1) // 2) + K * (K - 1) + (n * (n + 1) // 2 if system.R else 0)


def errors(bank, system):
    """theta of each mode less its nearest truth's, in stated errors of the mode; each truth once, else None."""
    theta, stated = bank["parameters"][:], bank["parameter_standard_error"][:]
    names = np.concatenate([np.concatenate([A.ravel(), B.ravel()])[None] for A, B in zip(system.A, system.B)])
    estimated = np.concatenate([bank["A"][:].reshape(len(theta), -1), bank["B"][:].reshape(len(theta), -1)], axis=1)
    nearest = [int(np.argmin(((names - row) ** 2).sum(1))) for row in estimated]
    if sorted(nearest) != list(range(system.K)):
        return None
    # theta is archived row by row as (A, B) of a state; A and B hold the same numbers, by which the order is found.
    order = [int(np.argmin(np.abs(estimated[0] - value))) for value in theta[0]]
    return ((theta - names[nearest][:, order]) / stated).ravel().tolist()


def trial(program, name, seed):
    modes, share, windows = SYSTEMS[name]
    g = np.random.default_rng([seed, len(modes[0][0]), int(4 * share), windows or 0])
    dwell = WINDOW * windows if windows else float(g.uniform(100, 400))
    system = Switching([np.array(A) for A, _ in modes], [np.array(B) for _, B in modes], [SD] * len(modes), share * SD ** 2, dwell)
    runs = [system.simulate(g, run, SAMPLES) for run in range(RUNS)]
    with tempfile.TemporaryDirectory() as path:
        folder = pathlib.Path(path)
        done = run_program(program, runs, folder)
        if done.returncode != 0:
            return {"name": name, "seed": seed, "failed": done.stderr.strip().splitlines()[-1:]}
        with h5py.File(folder / "out.h5") as file:
            ours = [file[f"evaluation/bank/{run}/log_density"][:] for run in file["data"] if file[f"data/{run}"].attrs["role"] == b"test"]
            truth = [system.log_density(*runs[i]) for i in range(1, RUNS, 2)]
            regret = float(np.nanmean(np.concatenate([t - o for t, o in zip(truth, ours)])))
            bank = file["bank"]
            found = len(bank["parameters"])
            return {"name": name, "seed": seed, "regret": regret, "modes": found,
                    "bound": free_parameters(system) / (RUNS // 2 * SAMPLES) + 0.002, "R": float(bank["R"][0, 0] / max(system.R, 1e-12)),
                    "z": errors(bank, system) if found == system.K else None}


def row(name, results):
    done = [r for r in results if "failed" not in r]
    regret = np.array([r["regret"] for r in done])
    right = [r for r in done if r["z"]]
    z = np.concatenate([r["z"] for r in right]) if right else np.array([np.nan])
    return (f"| {name} | {len(results)} | {np.median(regret):.4f} ({done[0]['bound']:.4f}) | {(regret > 0.05).sum()} | "
            f"{sum(r['modes'] == 3 for r in done)} ({sum(r['modes'] < 3 for r in done)}, {sum(r['modes'] > 3 for r in done)}) | "
            f"{np.sqrt(np.mean(z ** 2)):.2f} | {len(results) - len(done)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", default="")
    parser.add_argument("--rows", help="one line of JSON per seed goes here")
    options = parser.parse_args()
    wanted = [name for name in SYSTEMS if options.only in name]
    seeds = range(options.first, options.first + options.seeds)
    print("| system | seeds | regret, median (bound) | above 0.05 | right number (fewer, more) | rms error in stated errors | failed |\n|" + "---|" * 7)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for name in wanted:
            results = list(pool.map(lambda seed, name=name: trial(options.program, name, seed), seeds))
            if options.rows:
                with open(options.rows, "a", encoding="utf-8") as rows:
                    rows.writelines(json.dumps(r) + "\n" for r in results)
            print(row(name, results), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
