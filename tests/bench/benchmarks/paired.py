#!/usr/bin/env python3
"""What the bank gains over each competitor on held-out runs, one and more samples ahead, with the standard error over runs.

usage: paired.py ARCHIVE...

Differences of log score [nats per sample] and of mean squared error are taken run by run (same samples), weighted by the runs'
samples; their standard error is that of such a weighted mean over runs (ratio estimator), so a handful of runs gives a rough one.
"""
import sys

import numpy as np

from benchmark import decoded, filters, line, numbers, rows


def by_run(archive, table, **wanted):
    return {row["run"]: row for row in rows(archive, table, role="test", **wanted) if row["run"] != "*"}


def mean_and_error(differences, samples):
    weight = samples / samples.sum()
    mean = (weight * differences).sum()
    return mean, np.sqrt((weight**2 * (differences - mean) ** 2).sum() * len(weight) / (len(weight) - 1))


def signed(differences, samples, digits):
    mean, error = mean_and_error(differences, samples)
    return f"{mean:+.{digits}f} +- {error:.{digits}f}"


def cells(bank, other):
    samples = np.array([row["samples"] for row in bank.values()], float)
    scores = np.array([bank[run]["log_score"] - other[run]["log_score"] for run in bank])
    squares = np.array([np.mean(np.square(bank[run]["rmse"])) - np.mean(np.square(other[run]["rmse"])) for run in bank])
    return signed(scores, samples, 3), signed(squares, samples, 5)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    print("| archive | ahead | filter | log score | RMSE | bank's log score above it | bank's mean square above it |\n|" + "---|" * 7)
    for archive in sys.argv[1:]:
        ahead = sorted({int(row["horizon"]) for row in rows(archive, "horizon")})
        for horizon in [1] + [h for h in ahead if h > 1]:
            table = ("summary", {}) if horizon == 1 else ("horizon", {"horizon": horizon})
            of = {name: by_run(archive, table[0], filter=name, **table[1]) for name in filters(archive)}
            for name in of:
                pooled = rows(archive, table[0], role="test", run="*", filter=name, **table[1])
                if pooled and of[name]:
                    gain = ("", "") if name == "bank" else cells(of["bank"], of[name])
                    line(decoded(archive.rsplit("/", 1)[-1]), horizon, name, f"{pooled[0]['log_score']:.3f}", numbers(pooled[0]["rmse"], 4), *gain)


if __name__ == "__main__":
    main()
