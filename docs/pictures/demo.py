#!/usr/bin/env python3
"""Draws docs/pictures/demo.svg, the picture of docs/index.md: a held-out run of the demo, what was predicted, the modes, and the true ground.

Usage: demo.py ARCHIVE [RUN] > demo.svg, of `modebank demo`; `make picture` does it. Without RUN it is the held-out run whose
most frequent ground has the fewest samples.
"""
import sys

import h5py
import numpy as np

WIDTH, LEFT, RIGHT = 900, 70, 20
PLOT = WIDTH - LEFT - RIGHT
BAND_SD = 1.96
COLOURS = {"grip": "#5d9c3f", "ice": "#3b6ea5"}
PALE = {"grip": "#b9d8a6", "ice": "#a9c7e4"}


def polyline(x, y, style):
    return f'<polyline fill="none" {style} points="{" ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y))}"/>'


def area(x, low, high, style):
    points = list(zip(x, high)) + list(zip(x[::-1], low[::-1]))
    return f'<polygon {style} points="{" ".join(f"{a:.1f},{b:.1f}" for a, b in points)}"/>'


def text(x, y, content, more=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" {more}>{content}</text>'


def stretches(values):
    """(value, first, one past the last) of each stretch of equal values."""
    borders = [0, *(np.flatnonzero(np.diff(values)) + 1), len(values)]
    return [(values[a], a, b) for a, b in zip(borders, borders[1:])]


def words(values):
    return [value.decode() if isinstance(value, bytes) else value for value in values]


def rows_of(run):
    return slice(run["first"], run["first"] + run["samples"])


def chosen_run(data, name):
    runs = [run for run in data["runs"][:] if run["role"] == b"test" and name in (None, run["name"].decode())]
    return min(runs, key=lambda run: np.bincount(data["label"][rows_of(run)]).max())


def grounds_of_modes(archive, modes):
    """The ground that most held-out samples of each mode were driven on."""
    rows = [row for row in archive["evaluation/confusion"][:] if row["filter"] == b"bank" and row["role"] == b"test"]
    return [max((row for row in rows if row["mode"] == mode), key=lambda row: row["samples"])["label"].decode() for mode in range(modes)]


def main():
    archive = h5py.File(sys.argv[1])
    data, bank = archive["data"], archive["evaluation/bank"]
    run = chosen_run(data, sys.argv[2] if len(sys.argv) > 2 else None)
    rows = rows_of(run)
    time, measured = data["time"][rows], data["state"][rows, 0]
    prediction, sd = bank["prediction"][rows, 0], np.sqrt(bank["innovation_covariance"][rows, 0, 0])
    probability, label = bank["mode_probability"][rows], data["label"][rows]
    names = words(data.attrs["label_names"])
    grounds = grounds_of_modes(archive, probability.shape[1])

    keep = np.isfinite(prediction)
    x = LEFT + PLOT * (time - time[0]) / (time[-1] - time[0])
    top, height = 34, 150
    scale = height / 2 / np.nanmax(np.abs(np.concatenate([measured, prediction[keep]])) * 1.15)
    y = lambda value: top + height / 2 - scale * value
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} 380" font-family="Helvetica, Arial, sans-serif" font-size="13" fill="#222">',
           f'<rect width="{WIDTH}" height="380" fill="#fff"/>',
           text(LEFT, 20, f"Held-out run {run['name'].decode()}: turn rate [rad/s], measured (dots), predicted one step ahead with its 95 % band"),
           area(x[keep], y(prediction - BAND_SD * sd)[keep], y(prediction + BAND_SD * sd)[keep], 'fill="#d9d9d9"'),
           polyline(x[keep], y(prediction[keep]), 'stroke="#555" stroke-width="1"')]
    out += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="1.5" fill="#b03a2e"/>' for a, b in zip(x, y(measured))]
    tick = 0.5 if np.nanmax(np.abs(measured)) > 0.6 else 0.2
    out += [text(LEFT - 8, y(value) + 4, f"{value:g}", 'text-anchor="end"') for value in (-tick, 0, tick)]

    top, height = 222, 62
    out.append(text(LEFT, top - 9, "Probability of each mode that modebank found: " +
                    " and ".join(f"mode {k} ({'green' if ground == 'grip' else 'blue'})" for k, ground in enumerate(grounds))))
    order = sorted(range(len(grounds)), key=lambda k: grounds[k])
    low = np.zeros(len(time))
    for k in order:
        high = low + np.nan_to_num(probability[:, k])
        out.append(area(x, top + height * (1 - low), top + height * (1 - high), f'fill="{COLOURS[grounds[k]]}"'))
        low = high
    top = 322
    out.append(text(LEFT, top - 9, "The ground under the robot, which modebank did not use: grip (green), ice (blue)"))
    for value, first, end in stretches(label):
        colour = PALE[names[value]] if value >= 0 else "#eee"
        out.append(f'<rect x="{x[first]:.1f}" y="{top}" width="{x[min(end, len(x) - 1)] - x[first]:.1f}" height="18" fill="{colour}"/>')
    for second in range(0, int(time[-1] - time[0]) + 1, 5):
        at = LEFT + PLOT * second / (time[-1] - time[0])
        out.append(text(at, 362, f"{second} s", 'text-anchor="middle"'))
    print("\n".join([*out, "</svg>"]))


if __name__ == "__main__":
    main()
