#!/usr/bin/env python3
"""Known systems with the default configuration: regret, number of modes and stated errors (make systems).

  measure_systems.py build/modebank [--seeds 50] [--first 0] [--jobs N] [--only NAME,NAME] [--rows FILE]

Ten of twenty runs of 800 samples train. The systems below have three modes and one or two states, without measurement noise
and with R = Q / 4. Mean stays are 100 to 400 samples (drawn per seed) or 20 windows. The program runs with only [data]
configured, apart from --window.model linear, because the structure is known here.

Regret: held-out log score of the filter with the true parameters minus that of the bank. Stated errors: theta of each mode minus
the nearest true mode, in the standard errors of the mode, if the number of modes is right. Prints a Markdown table, and
the share of stated 95 % intervals that contain the truth, over all systems, with 95 % intervals (Clopper-Pearson).
"""
import concurrent.futures
import json
import os
import pathlib
import sys
import tempfile

import h5py
import numpy as np
from scipy.stats import beta

from switching_system import DT_S, SD, Switching, options_of, run_program

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


def gains_at_rest(A, B):
    return np.linalg.solve(-A, B).ravel()


def time_constants(A):
    return np.sort([-DT_S / np.log(np.abs(np.linalg.eigvals(np.eye(len(A)) + A)))])


def stated(function, theta, covariance):
    """Standard errors of a function of theta to first order (the delta method), by central differences."""
    steps = 1e-6 * np.sqrt(np.diag(covariance))
    slope = np.array([(function(theta + step) - function(theta - step)).ravel() / (2 * size) for step, size in zip(np.diag(steps), steps)]).T
    return np.sqrt(np.diag(slope @ covariance @ slope.T))


def errors(bank, system):
    """Errors of theta, Q, gains and time constants in standard errors, each mode against the nearest true one. None unless each true mode is matched once."""
    n, q = system.n, system.n + system.B[0].shape[1]
    of = lambda theta: theta.reshape(n, q)  # noqa: E731  theta is archived row by row as (A, B) of a state
    theta, covariance = bank["parameters"][:], bank["parameter_covariance"][:]
    true = np.array([np.hstack([A, B]).ravel() for A, B in zip(system.A, system.B)])
    nearest = [int(np.argmin(((true - row) ** 2).sum(1))) for row in theta]
    if sorted(nearest) != list(range(system.K)):
        return None
    z = {"theta": [], "Q": [], "gain": [], "time constant": []}
    half = np.tril_indices(n)
    for row, P, Q, Q_error, k in zip(theta, covariance, bank["Q"][:], bank["Q_standard_error"][:], nearest):
        z["theta"] += ((row - true[k]) / np.sqrt(np.diag(P))).tolist()
        z["Q"] += ((Q - system.sd[k] ** 2 * np.eye(n))[half] / Q_error[half]).tolist()
        for name, function in (("gain", lambda t: gains_at_rest(of(t)[:, :n], of(t)[:, n:])), ("time constant", lambda t: time_constants(of(t)[:, :n]))):
            z[name] += ((function(row) - function(true[k])).ravel() / stated(function, row, P)).tolist()
    return z


def trial(program, name, seed):
    modes, share, windows = SYSTEMS[name]
    g = np.random.default_rng([seed, len(modes[0][0]), int(4 * share), windows or 0])
    dwell = WINDOW * windows if windows else float(g.uniform(100, 400))
    system = Switching([np.array(A) for A, _ in modes], [np.array(B) for _, B in modes], [SD] * len(modes), share * SD ** 2, dwell)
    runs = [system.simulate(g, run, SAMPLES) for run in range(RUNS)]
    with tempfile.TemporaryDirectory() as path:
        folder = pathlib.Path(path)
        done = run_program(program, runs, folder, ["--window.model", "linear"])
        if done.returncode != 0:
            return {"name": name, "seed": seed, "failed": done.stderr.strip().splitlines()[-1:]}
        with h5py.File(folder / "out.h5") as file:
            ours, bank = file["evaluation/bank/log_density"][:].reshape(RUNS, -1)[1::2], file["bank"]
            regret = float(np.nanmean([system.log_density(*run) for run in runs[1::2]] - ours))
            found = len(bank["parameters"])
            return {"name": name, "seed": seed, "regret": regret, "modes": found,
                    "bound": free_parameters(system) / (RUNS // 2 * SAMPLES) + 0.002, "R": float(bank["R"][0, 0] / max(system.R, 1e-12)),
                    "z": errors(bank, system) if found == system.K else None}


def row(name, results):
    done = [r for r in results if "failed" not in r]
    regret = np.array([r["regret"] for r in done])
    right = [r for r in done if r["z"]]
    z = np.concatenate([r["z"]["theta"] for r in right]) if right else np.array([np.nan])
    return (f"| {name} | {len(results)} | {np.median(regret):.4f} ({done[0]['bound']:.4f}) | {(regret > 0.05).sum()} | "
            f"{sum(r['modes'] == 3 for r in done)} ({sum(r['modes'] < 3 for r in done)}, {sum(r['modes'] > 3 for r in done)}) | "
            f"{np.sqrt(np.mean(z ** 2)):.2f} | {len(results) - len(done)} |")


def coverage(results):
    """Rows of the share of 95 % intervals that contain the true value."""
    right = [r["z"] for r in results if r.get("z")]
    lines = ["\n| 95 % intervals of | hold the truth | of |\n|---|---|---|"]
    for name in right[0] if right else []:
        z = np.abs(np.concatenate([r[name] for r in right]))
        held, count = int((z < 1.96).sum()), len(z)
        low, high = beta.ppf([0.025, 0.975], [held, held + 1], [count - held + 1, max(count - held, 1e-9)])
        lines.append(f"| {name} | {100 * held / count:.1f} % [{100 * low:.1f}, {100 * high:.1f}] | {count} |")
    return "\n".join(lines)


def main():
    options = options_of(__doc__, "program", seeds=50, first=0, jobs=os.cpu_count(), only="", rows=os.devnull)
    wanted = [name for name in SYSTEMS if options.only in name]
    seeds = range(options.first, options.first + options.seeds)
    print("| system | seeds | regret, median (bound) | above 0.05 | right number (fewer, more) | rms error in stated errors | failed |\n|" + "---|" * 7)
    every = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for name in wanted:
            results = list(pool.map(lambda seed, name=name: trial(options.program, name, seed), seeds))
            with open(options.rows, "a", encoding="utf-8") as rows:
                rows.writelines(json.dumps(r) + "\n" for r in results)
            print(row(name, results), flush=True)
            every += results
    print(coverage(every))
    return 0


if __name__ == "__main__":
    sys.exit(main())
