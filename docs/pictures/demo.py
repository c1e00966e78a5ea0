#!/usr/bin/env python3
"""Draws docs/pictures/demo.svg, README's picture: a held-out run of the demo, what was predicted, the modes, and the true ground.

Usage: demo.py ARCHIVE [RUN] > demo.svg, of `modebank demo --data.label mode`; `make picture` does it.
"""
import sys

import h5py
import numpy as np

WIDTH, LEFT, RIGHT = 900, 70, 20
PLOT = WIDTH - LEFT - RIGHT
BAND_SD = 1.96
GROUNDS = {"0": ("#a9c7e4", "ice"), "1": ("#b9d8a6", "grip"), "ice": ("#a9c7e4", "ice"), "grip": ("#b9d8a6", "grip")}
GREYS_OF_ICE = ["#3b6ea5", "#5b8bbd", "#7ba6cf", "#9abfde", "#2b5480", "#88a8c4", "#aac9e2", "#c3d9ec"]
GRIP = "#5d9c3f"


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


def main():
    archive = h5py.File(sys.argv[1])
    run = sys.argv[2] if len(sys.argv) > 2 else "01"
    data, bank = archive["data"], archive["evaluation/bank"]
    (row,) = [row for row in data["runs"][:] if row["name"].decode() == run]
    rows = slice(row["first"], row["first"] + row["samples"])
    time, measured = data["time"][rows], data["state"][rows, 0]
    prediction, sd = bank["prediction"][rows, 0], np.sqrt(bank["innovation_covariance"][rows, 0, 0])
    probability, label = bank["mode_probability"][rows], data["label"][rows]
    names = [name.decode() if isinstance(name, bytes) else name for name in archive["data"].attrs["label_names"]]
    confusion = archive["evaluation/confusion"][:]
    grip = next(name for name in names if GROUNDS[name][1] == "grip")
    of_grip = [row for row in confusion if row["filter"] == b"bank" and row["role"] == b"test" and row["label"].decode() == grip]
    grip_mode = max(of_grip, key=lambda row: row["samples"])["mode"]

    keep = np.isfinite(prediction)
    x = LEFT + PLOT * (time - time[0]) / (time[-1] - time[0])
    top, height = 34, 150
    scale = height / 2 / np.nanmax(np.abs(np.concatenate([measured, prediction[keep]])) * 1.15)
    y = lambda value: top + height / 2 - scale * value
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} 380" font-family="Helvetica, Arial, sans-serif" font-size="13" fill="#222">',
           f'<rect width="{WIDTH}" height="380" fill="#fff"/>',
           text(LEFT, 20, f"Held-out run {run}: yaw rate [rad/s], measured (dots), predicted one step ahead with its 95 % band"),
           area(x[keep], y(prediction - BAND_SD * sd)[keep], y(prediction + BAND_SD * sd)[keep], 'fill="#d9d9d9"'),
           polyline(x[keep], y(prediction[keep]), 'stroke="#555" stroke-width="1"')]
    out += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="1.5" fill="#b03a2e"/>' for a, b in zip(x, y(measured))]
    tick = 0.5 if np.nanmax(np.abs(measured)) > 0.6 else 0.2
    out += [text(LEFT - 8, y(value) + 4, f"{value:g}", 'text-anchor="end"') for value in (-tick, 0, tick)]

    top, height = 222, 62
    out.append(text(LEFT, top - 9, f"Mode probabilities: mode {grip_mode} (green), the {probability.shape[1] - 1} others (blue)"))
    order = [grip_mode] + [k for k in range(probability.shape[1]) if k != grip_mode]
    low = np.zeros(len(time))
    for place, k in enumerate(order):
        high = low + np.nan_to_num(probability[:, k])
        colour = GRIP if k == grip_mode else GREYS_OF_ICE[(place - 1) % len(GREYS_OF_ICE)]
        out.append(area(x, top + height * (1 - low), top + height * (1 - high), f'fill="{colour}"'))
        low = high
    top = 322
    out.append(text(LEFT, top - 9, "The ground the robot was on, never shown to the program: grip (green), ice (blue)"))
    for value, first, end in stretches(label):
        colour = GROUNDS[names[value]][0] if value >= 0 else "#eee"
        out.append(f'<rect x="{x[first]:.1f}" y="{top}" width="{x[min(end, len(x) - 1)] - x[first]:.1f}" height="18" fill="{colour}"/>')
    for second in range(0, int(time[-1] - time[0]) + 1, 10):
        at = LEFT + PLOT * second / (time[-1] - time[0])
        out.append(text(at, 362, f"{second} s" if second % 20 == 0 else "", 'text-anchor="middle"'))
    print("\n".join([*out, "</svg>"]))


if __name__ == "__main__":
    main()
