#!/usr/bin/env python3
"""Draws README's picture from an archive: readme_picture.py ARCHIVE PICTURE.png

Left: local models, coloured by mode, with the modes' 95 % ellipses. Right: a held-out run with the filter's one-step
95 % band, and the probability of each mode under it. Needs python3-h5py and python3-matplotlib.
"""
import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Ellipse

# Okabe & Ito's colour-blind safe palette.
COLOURS = ["#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#F0E442", "#000000"]
CHI2_95_2DOF = 5.991
NORMAL_95 = 1.96


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def colour(k):
    return COLOURS[k % len(COLOURS)]


def draw_local_models(axis, archive, first, second):
    parameters, labels = archive["windows/parameters"][:], archive["mixture/labels"][:]
    names = [text(name) for name in archive["windows"].attrs["parameter_names"]]
    means, covariances = archive["mixture/means"][:], archive["mixture/covariances"][:]
    for k in range(len(means)):
        points = parameters[labels == k]
        axis.plot(points[:, first], points[:, second], ".", ms=2, alpha=0.35, color=colour(k), label=f"mode {k}")
        values, vectors = np.linalg.eigh(covariances[k][np.ix_([first, second], [first, second])])
        width, height = 2 * np.sqrt(CHI2_95_2DOF * np.maximum(values, 0))
        angle = np.degrees(np.arctan2(vectors[1, 0], vectors[0, 0]))
        axis.add_patch(Ellipse(means[k][[first, second]], width, height, angle=angle, fill=False, lw=1.5, color=colour(k)))
    axis.set_xlabel(names[first] + " [1/step]")
    axis.set_ylabel(names[second])
    axis.set_title("Local models of all windows")


def draw_run(data_axis, strip_axis, archive, run, samples):
    data, evaluation = archive[f"data/{run}"], archive[f"evaluation/bank/{run}"]
    time, state = data["time"][:samples], data["state"][:samples, 0]
    prediction = evaluation["prediction"][:samples, 0]
    band = NORMAL_95 * np.sqrt(evaluation["innovation_covariance"][:samples, 0, 0])
    data_axis.fill_between(time, prediction - band, prediction + band, color="0.8", label="one-step 95 % band")
    data_axis.plot(time, state, lw=0.9, color="black", label="measured")
    unit = data["state"].attrs.get("units", b"")
    data_axis.set_ylabel("state [" + text(unit) + "]")
    data_axis.set_title(f"Held-out run {run}: prediction and mode probabilities")
    data_axis.legend(loc="upper right", fontsize=7)
    probability = evaluation["mode_probability"][:samples]
    strip_axis.stackplot(time, probability.T, colors=[colour(k) for k in range(probability.shape[1])])
    strip_axis.set_ylim(0, 1)
    strip_axis.set_ylabel("P(mode)")
    strip_axis.set_xlabel("time [s]")


def main():
    source, target = sys.argv[1:3]
    with h5py.File(source, "r") as archive:
        run = next(name for name in archive["data"] if text(archive[f"data/{name}"].attrs["role"]) == "test")
        figure = plt.figure(figsize=(10, 4))
        grid = figure.add_gridspec(2, 2, width_ratios=[1, 1.5], height_ratios=[2, 1])
        draw_local_models(figure.add_subplot(grid[:, 0]), archive, 0, 1)
        data_axis = figure.add_subplot(grid[0, 1])
        draw_run(data_axis, figure.add_subplot(grid[1, 1], sharex=data_axis), archive, run, 400)
        figure.tight_layout()
        figure.savefig(target, dpi=110)


if __name__ == "__main__":
    main()
