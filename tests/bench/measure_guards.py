#!/usr/bin/env python3
"""State-dependent transition probabilities (bank.transition = logit) on known systems, over seeds (make guards).

  measure_guards.py build/modebank [DATA] [--seeds 50] [--hybrid-seeds 10] [--first 1] [--jobs N] [--only NAME] [--system NAME] [--rows FILE]

- hybrid: the three systems of DATA/hybrid/simulate.py (default of DATA: MODEBANK_DATA), compared with the true parameters
  and the true border
- soft: a known multinomial logit draws two modes; prints the errors of the weights in their stated errors
- hard: the mode is u > 0.4, and no input lies within 0.1 of 0.4; prints whether the border lies in that gap and no error
  is stated
- markov: a constant T with three modes; prints how often the logit is chosen, and its loss on held-out runs

The last three have four training runs of 500 samples and four held-out runs, with default settings. Prints a Markdown table
for each.
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

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "benchmarks"))
from benchmark import Failed, held_out, run  # noqa: E402
from hybrid_systems import seed_scores, simulator  # noqa: E402

RUNS, SAMPLES = 8, 500
CONFIG = """[data]
inputs = run_*.csv
state = x
input = u
time = time
train = 0, 1, 2, 3
test = 4, 5, 6, 7
[bank]
transition = logit
"""
A, B, SD = np.array([-.5, -.1, -.3]), np.array([.4, -.3, .05]), np.array([.05, .1, .08])
WEIGHTS, STAY = np.array([0.6, 1.5]), np.array([-1.5, 0.5])  # soft: log odds of mode 1 after mode i: STAY[i] + WEIGHTS (x, u)
BORDER, GAP, DWELL = 0.4, 0.1, 40.0


def next_mode(kind, g, mode, x, u):
    if kind == "hard":
        return int(u > BORDER)
    if kind == "soft":
        return int(g.random() < 1 / (1 + np.exp(-STAY[mode] - WEIGHTS @ [x, u])))
    return mode if g.random() > 1 / DWELL else int((mode + g.integers(1, 3)) % 3)


def inputs(kind, g):
    u = g.normal(0, 1, SAMPLES)
    inside = np.abs(u - BORDER) < GAP
    return np.where(inside, u + np.where(u > BORDER, GAP, -GAP), u) if kind == "hard" else u


def simulate(kind, seed, folder):
    g = np.random.default_rng([seed, ("soft", "hard", "markov").index(kind)])
    for r in range(RUNS):
        u, x, mode = inputs(kind, g), np.zeros(SAMPLES), 0
        for k in range(SAMPLES - 1):
            mode = next_mode(kind, g, mode, x[k], u[k])
            x[k + 1] = x[k] + A[mode] * x[k] + B[mode] * u[k] + SD[mode] * g.normal()
        np.savetxt(folder / f"run_{r}.csv", np.c_[0.1 * np.arange(SAMPLES), x, u], "%.9g", ",", header="time,x,u", comments="")
    (folder / "guards.ini").write_text(CONFIG, encoding="utf-8")


def order_of(bank):
    """Position in the bank of each true mode; None if the numbers of modes differ."""
    found = np.c_[bank["A"][:, 0, 0], bank["B"][:, 0, 0]]
    distance = ((found[:, None] - np.c_[A, B][None]) ** 2).sum(2)
    nearest = distance.argmin(1)
    return [int(np.where(nearest == m)[0][0]) for m in range(len(found))] if sorted(nearest) == list(range(len(found))) else None


def learned_guard(bank, kind):
    """Estimates of the border between modes, in the order of the true modes."""
    order = order_of(bank)
    if order is None or len(order) != 2 or "transition_weights" not in bank:
        return {}
    weights = bank["transition_weights"][:][0][order]  # the same after every mode
    error = bank["transition_weight_standard_error"][:][order]
    stated = bool(np.isfinite(error).all())
    if kind == "soft":
        true = np.outer([-0.5, 0.5], WEIGHTS)
        return {"stated": stated, "z": ((weights - true) / error).ravel().tolist() if stated else None}
    T, slope, reference = bank["transition"][:][np.ix_(order, order)], weights[1] - weights[0], bank["transition_reference"][:]
    borders = [float(reference[1] - np.log(T[i, 1] / T[i, 0]) / slope[1]) for i in range(2)]  # in u, at the mean of x
    return {"stated": stated, "inside": bool(all(abs(b - BORDER) < GAP for b in borders)), "borders": borders}


def trial(program, kind, seed):
    with tempfile.TemporaryDirectory() as path:
        folder = pathlib.Path(path)
        simulate(kind, seed, folder)
        try:
            archive = run(program, folder / "guards.ini", folder / "logit.h5")
            with h5py.File(archive) as file:
                bank = file["bank"]
                result = {"kind": kind, "seed": seed, "modes": len(bank["A"]), "logit": "transition_weights" in bank, **learned_guard(bank, kind)}
            if kind == "markov" and result["logit"]:
                constant = run(program, folder / "guards.ini", folder / "labels.h5", bank__transition="labels")
                result["cost"] = float(held_out(constant, "summary", filter="bank")["log_score"] - held_out(archive, "summary", filter="bank")["log_score"])
            return result
        except Failed as error:
            return {"kind": kind, "seed": seed, "failed": str(error)}


def hybrid_trial(program, system, simulator_, seed):
    with tempfile.TemporaryDirectory() as path:
        try:
            return seed_scores(program, simulator_, system, seed, pathlib.Path(path))
        except Failed as error:
            return {"system": system.name, "seed": seed, "failed": str(error)}


def hybrid_row(name, results):
    done = [r for r in results if "failed" not in r]
    lost = np.array([r["truth"] - r["score"] for r in done])
    gap = np.array([np.max((np.array(r["free"]) - r["free_truth"]) / r["sd"]) for r in done])
    right = np.array([r["accuracy"] for r in done])
    return (f"| {name} | {len(results)} | {np.median(lost):.4f}, {lost.max():.4f} | {np.median(gap):.4f}, {gap.max():.4f} | "
            f"{100 * np.median(right):.2f}, {100 * right.min():.2f} | {sum(r['modes'] == r['true_modes'] for r in done)} | {sum(r['logit'] for r in done)} | "
            f"{sum(r['stated'] for r in done)} | {len(results) - len(done)} |")


def kind_row(kind, results):
    done = [r for r in results if "failed" not in r]
    text = f"| {kind} | {len(results)} | {sum(r['modes'] == (3 if kind == 'markov' else 2) for r in done)} | {sum(r['logit'] for r in done)} | "
    stated = [r for r in done if r.get("stated")]
    text += f"{len(stated)} | "
    z = np.concatenate([r["z"] for r in stated]) if kind == "soft" and stated else np.array([])
    text += f"{100 * np.mean(np.abs(z) < 2):.1f} %, rms {np.sqrt(np.mean(z ** 2)):.2f} | " if len(z) else "| "
    text += f"{sum(r.get('inside', False) for r in done)} | " if kind == "hard" else "| "
    cost = [r.get("cost", 0.0) for r in done]
    return text + (f"{np.mean(cost):.4f}, {np.max(cost):.4f} | " if kind == "markov" else "| ") + f"{len(results) - len(done)} |"


def show(pool, options, jobs, row):
    results = list(pool.map(lambda job: job(), jobs))
    if options.rows:
        with open(options.rows, "a", encoding="utf-8") as file:
            file.writelines(json.dumps(r) + "\n" for r in results)
    print(row(results), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("data", nargs="?", default=os.environ.get("MODEBANK_DATA", ""))
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--hybrid-seeds", type=int, default=10)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", default="", help="hybrid, soft, hard or markov")
    parser.add_argument("--system", default="", help="of the hybrid ones this alone: deadzone, contact or yaw")
    parser.add_argument("--rows", help="one line of JSON per seed goes here")
    options = parser.parse_args()
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        if options.only in ("", "hybrid"):
            made = simulator(pathlib.Path(options.data))
            print("| system | seeds | nats lost to the true guard: median, most | free run, RMSE above the true guard's in sd: median, most | filtered modes right, %: median, "
                  "least | right number of modes | logit chosen | errors stated | failed |\n|" + "---|" * 9, flush=True)
            for system in [s for s in made.SYSTEMS if options.system in ("", s.name)]:
                seeds = range(options.first, options.first + options.hybrid_seeds)
                show(pool, options, [lambda s=seed, y=system: hybrid_trial(options.program, y, made, s) for seed in seeds],
                     lambda results, y=system: hybrid_row(y.name, results))
        if options.only != "hybrid":
            print("\n| switches | seeds | right number of modes | logit chosen | errors stated | weights within two of them | border in the gap | nats lost held out: mean, most | "
                  "failed |\n|" + "---|" * 9, flush=True)
        for kind in ("soft", "hard", "markov"):
            if options.only in ("", kind):
                seeds = range(options.first, options.first + options.seeds)
                show(pool, options, [lambda s=seed, y=kind: trial(options.program, y, s) for seed in seeds],
                     lambda results, y=kind: kind_row(y, results))
    return 0


if __name__ == "__main__":
    sys.exit(main())
