#!/usr/bin/python3
"""Which features of windows with many lags separate the modes: the table of docs/results/simulated.md.

measure_features.py MODEBANK FOLDER [--seeds 2]

Systems of one or two states switch between known modes, or have one mode per run. They are fitted with four and eight lags
and windows of 1.5 and 3 transitions per regressor. Each column has its own `mixture.features` and `mixture.covariance`, and the true
number of components. Figures are adjusted Rand indices of the labels of windows without a switch (every fifth window), averaged
over seeds. 1 means equal to the truth, 0 means chance.
"""

import subprocess

import h5py
import numpy as np

from switching_system import inputs, options_of, sticky, switched, write_runs

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


def write(folder, name, seed):
    stay, R, motions = SYSTEMS[name]
    n, m = motions[0][1].shape
    modes, runs = [], []
    for run in range(RUNS):
        draw = np.random.default_rng([seed, run, sum(map(ord, name))])
        modes.append(sticky(draw, len(motions), stay, SAMPLES) if stay else np.full(SAMPLES, run // 2 % len(motions)))
        u = inputs(draw, run // 2, SAMPLES, m)
        noise = np.array([sd for *_, sd in motions])[modes[-1][:-1], None] * draw.standard_normal((SAMPLES - 1, n))
        x = switched([(A, B) for A, B, _ in motions], modes[-1], u, noise)
        runs.append((u, x + np.sqrt(R) * draw.standard_normal(x.shape)))
    write_runs(folder, runs)
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
    subprocess.run([program, "run", "system.ini", "--until", "mixture", "--archive.output", "c.h5", "--force",
                    "--window.model", "varx", "--window.state_lags", str(lags),
                    "--window.input_lags", str(lags), "--window.length", str(length),
                    "--mixture.components", str(components), "--mixture.features", features,
                    "--mixture.covariance", covariance], cwd=folder, check=True, capture_output=True)
    with h5py.File(folder / "c.h5") as archive:
        runs = [name.decode() for name in archive["windows/run"][()]]
        starts, labels = archive["windows/start"][()], archive["mixture/labels"][()]
    spans = [modes[int(run)][start:start + length] for run, start in zip(runs, starts)]
    use = [i for i in range(0, len(spans), 5) if labels[i] >= 0 and (spans[i] == spans[i][0]).all()]
    return adjusted_rand(labels[use], np.array([spans[i][0] for i in use])) if len(use) > 20 else np.nan


def main():
    options = options_of(__doc__, "modebank", "folder", seeds=2)
    program, folder = options.modebank.resolve(), options.folder.resolve()
    print("| system | " + " | ".join(f"`{features}`, {covariance}" for features, covariance in WAYS) + " |\n|---|" + "---|" * len(WAYS))
    every = []
    for name in SYSTEMS:
        rows = []
        for seed in range(options.seeds):
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
