#!/usr/bin/python3
"""Which features of windows with many lags separate the modes: the table of docs/results/simulated.md.

measure_features.py MODEBANK FOLDER [SEEDS]

Systems of one or two states switch between known modes, or have one mode per run. They are fitted with four and eight lags
and windows of 1.5 and 3 transitions per regressor. Each column has its own `mixture.features` and `mixture.covariance`, and the true
number of components. Figures are adjusted Rand indices of the labels of windows without a switch (every fifth window), averaged
over seeds. 1 means equal to the truth, 0 means chance.
"""

import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

WAYS = [("parameters+noise", "full"), ("parameters+noise", "diagonal"), ("one_lag", "full"), ("one_lag", "diagonal")]
SAMPLES, RUNS = 500, 12


def motion(A, B, sd=0.02):
    return np.atleast_2d(A), np.atleast_2d(B), sd


SYSTEMS = {  # stay in samples (0: one mode per run), measurement variance, modes
    "four modes": (60, 0.0, [motion([0.8], [-0.1, 0.1]), motion([0.5], [-0.3, 0.3]), motion([0.7], [-0.6, 0.2]), motion([0.3], [-0.2, 0.6])]),
    "measured": (80, 4e-4, [motion([0.8], [-0.1, 0.15]), motion([0.4], [-0.5, 0.5])]),
    "by run": (0, 0.0, [motion([0.8], [-0.2, 0.2]), motion([0.6], [-0.4, 0.4]), motion([0.7], [-0.6, 0.2])]),
    "near": (120, 0.0, [motion([0.75], [-0.2, 0.2]), motion([0.6], [-0.2, 0.2])]),
    "three inputs": (80, 0.0, [motion([0.8], [-0.2, 0.2, 0.1]), motion([0.5], [-0.5, 0.3, 0.4])]),
    "resonance": (80, 0.0, [motion([1.6, -0.8], [-0.1, 0.1]), motion([1.2, -0.8], [-0.1, 0.1])]),
    "second order": (80, 0.0, [motion([1.2, -0.4], [-0.1, 0.1]), motion([0.9, -0.2], [-0.25, 0.25])]),
    "integrates": (80, 0.0, [motion([1.0], [-0.1, 0.1]), motion([1.0], [-0.3, 0.2])]),
    "noise alone": (80, 0.0, [motion([0.7], [-0.2, 0.2], 0.01), motion([0.7], [-0.2, 0.2], 0.03)]),
    "two states": (80, 0.0, [motion([[0.8, 0.05], [0, 0.6]], [[-0.2, 0.2], [0.1, 0.1]]), motion([[0.6, 0.05], [0, 0.8]], [[-0.4, 0.4], [0.1, 0.2]])]),
}


def modes_of(draw, count, stay, run):
    if stay == 0:
        return np.full(SAMPLES, run // 2 % count)
    z, k, mode = np.zeros(SAMPLES, int), 0, int(draw.integers(count))
    while k < SAMPLES:
        last = k + max(1, int(draw.exponential(stay)))
        z[k:last] = mode
        mode, k = int(draw.choice([m for m in range(count) if m != mode])), last
    return z


def commands(draw, inputs, run):
    """Inputs: drawn at each sample in two of four runs, held for 3 to 24 samples in the others."""
    u, k = np.zeros((SAMPLES, inputs)), 0
    while k < SAMPLES:
        held = 1 if run // 2 % 2 else int(draw.integers(3, 25))
        u[k:k + held] = draw.uniform(-0.5, 0.5, inputs)
        k += held
    return u


def write(folder, name, seed):
    stay, R, motions = SYSTEMS[name]
    n, m = motions[0][1].shape
    x_names, u_names = [f"x{i + 1}" for i in range(n)], [f"u{i + 1}" for i in range(m)]
    modes = {}
    for run in range(RUNS):
        draw = np.random.default_rng([seed, run, sum(map(ord, name))])
        z, u, x = modes_of(draw, len(motions), stay, run), commands(draw, m, run), np.zeros((SAMPLES, n))
        for k in range(SAMPLES - 1):
            A, B, sd = motions[z[k]]
            past = np.concatenate([x[max(k - i, 0)] for i in range(A.shape[1] // n)])
            x[k + 1] = A @ past + B @ u[k] + sd * draw.standard_normal(n)
        y = x + np.sqrt(R) * draw.standard_normal(x.shape)
        np.savetxt(folder / f"{run:02d}.csv", np.column_stack([0.1 * np.arange(SAMPLES), y, u]), fmt="%.9g", delimiter=",",
                   header=",".join(["time", *x_names, *u_names]), comments="")
        modes[f"{run:02d}"] = z
    (folder / "data.ini").write_text("[data]\ninputs = *.csv\nstate = " + ", ".join(x_names) + "\ninput = " + ", ".join(u_names) + "\n")
    return n + m, len(motions), modes


def adjusted_rand(a, b):
    """Adjusted Rand index (Hubert & Arabie 1985)."""
    table = np.zeros((a.max() + 1, b.max() + 1))
    np.add.at(table, (a, b), 1)
    pairs = lambda counts: (counts * (counts - 1) / 2).sum()
    same, in_a, in_b, all_pairs = pairs(table), pairs(table.sum(1)), pairs(table.sum(0)), pairs(np.array([table.sum()]))
    expected = in_a * in_b / all_pairs
    return (same - expected) / max((in_a + in_b) / 2 - expected, 1e-300)


def score(program, folder, lags, length, components, modes, features, covariance):
    subprocess.run([program, "run", "data.ini", "--until", "mixture", "--archive.output", "c.h5", "--force",
                    "--window.model", "varx", "--window.state_lags", str(lags),
                    "--window.input_lags", str(lags), "--window.length", str(length),
                    "--mixture.components", str(components), "--mixture.features", features,
                    "--mixture.covariance", covariance], cwd=folder, check=True, capture_output=True)
    with h5py.File(folder / "c.h5") as archive:
        runs = [name.decode() for name in archive["windows/run"][()]]
        starts, labels = archive["windows/start"][()], archive["mixture/labels"][()]
    spans = [modes[run][start:start + length] for run, start in zip(runs, starts)]
    use = [i for i in range(0, len(spans), 5) if labels[i] >= 0 and (spans[i] == spans[i][0]).all()]
    return adjusted_rand(labels[use], np.array([spans[i][0] for i in use])) if len(use) > 20 else np.nan


def main():
    program, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    seeds = int(sys.argv[3]) if len(sys.argv) > 3 else 2
    folder.mkdir(parents=True, exist_ok=True)
    print("| system | " + " | ".join(f"`{features}`, {covariance}" for features, covariance in WAYS) + " |\n|---|" + "---|" * len(WAYS))
    every = []
    for name in SYSTEMS:
        rows = []
        for seed in range(seeds):
            regressors, components, modes = write(folder, name, seed)
            for lags in (4, 8):
                for share in (1.5, 3):
                    length = max(25, int(share * regressors * lags))
                    rows.append([score(program, folder, lags, length, components, modes, *way) for way in WAYS])
        every += rows
        print(f"| {name} | " + " | ".join(f"{v:.2f}" for v in np.nanmean(rows, 0)) + " |", flush=True)
    print("| all | " + " | ".join(f"{v:.2f}" for v in np.nanmean(every, 0)) + " |")


if __name__ == "__main__":
    main()
