#!/usr/bin/env python3
"""What the forecasts of all filters combined are worth, one and ten samples ahead, against the best competitor in each figure."""
import h5py
import numpy as np

from benchmark import SOURCES, Arguments, decoded, filters, head, line, numbers, rows, run
from paired import by_run, mean_and_error

PROTOCOL = """ICE and FLOORING by configs/husky_ice.ini, DRIVE by configs/drive_husky.ini, DART by configs/dart.ini; either half of the runs trains. Held-out log score [nats/sample] / RMSE [rad/s];
behind the combination its log score less that of the best competitor and its mean square less that of the best, as multiples of the standard error over runs (positive: better). DRIVE's
runs are the blocks of one drive."""
FLOORING = {"data__inputs": "borealtc/FLOORING/pro_*.csv", "data__states": "borealtc/FLOORING/imu_*.csv"}


def of_role(archive, role):
    with h5py.File(archive) as file:
        names = [name for name, data in file["data"].items() if decoded(data.attrs["role"]) == role]
    return ",".join(dict.fromkeys(name.split(".")[0] for name in names))  # a recording's parts, NAME.1, NAME.2, go with it


def both_folds(given, name, config, **options):
    options = {"data__root": given.data, "filter__horizon": "1,10", **options}
    first = run(given.program, SOURCES / "configs" / config, given.out / f"{name}_1.h5", **options)
    swapped = {"data__train": of_role(first, "test"), "data__test": of_role(first, "train")}
    return first, run(given.program, SOURCES / "configs" / config, given.out / f"{name}_2.h5", **options, **swapped)


def differences(archive, horizon, ours, other):
    """Of log score and of mean square, each over its standard error; positive where ours is better."""
    a, b = (by_run(archive, "horizon", filter=name, horizon=horizon) for name in (ours, other))
    runs = [run for run in a if a[run]["samples"] > 0]
    samples = np.array([a[run]["samples"] for run in runs], float)
    scores = np.array([a[run]["log_score"] - b[run]["log_score"] for run in runs])
    squares = np.array([np.mean(np.square(b[run]["rmse"])) - np.mean(np.square(a[run]["rmse"])) for run in runs])
    return [mean / error for mean, error in (mean_and_error(scores, samples), mean_and_error(squares, samples))]


def table_row(name, archive, horizon):
    pooled = {f: rows(archive, "horizon", role="test", run="*", filter=f, horizon=horizon)[0] for f in filters(archive)}
    competitors = filters(archive, "bank", "combined")
    score = max(competitors, key=lambda f: pooled[f]["log_score"])
    rmse = min(competitors, key=lambda f: np.mean(np.square(pooled[f]["rmse"])))
    gain, less = differences(archive, horizon, "combined", score)[0], differences(archive, horizon, "combined", rmse)[1]
    cell = lambda f: f"{pooled[f]['log_score']:.3f} / {numbers(pooled[f]['rmse'], 4)}"  # noqa: E731
    line(name, horizon, cell("bank"), f"{pooled[score]['log_score']:.3f} ({score}) / {numbers(pooled[rmse]['rmse'], 4)} ({rmse})",
         cell("combined"), f"{gain:+.1f}, {less:+.1f}")


def main():
    given = Arguments(__doc__)
    head(given.program, "Combined forecasts", PROTOCOL, ["data, what trains", "ahead", "bank", "best competitor in each", "combined", "better by, in errors"])
    for name, config, options in (("ICE", "husky_ice.ini", {}), ("FLOORING", "husky_ice.ini", FLOORING), ("DRIVE", "drive_husky.ini", {}),
                                  ("DART", "dart.ini", {})):
        for part, archive in zip(("one half", "the other"), both_folds(given, name, config, **options)):
            for horizon in (1, 10):
                table_row(f"{name}, {part}", archive, horizon)


if __name__ == "__main__":
    main()
