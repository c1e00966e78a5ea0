#!/usr/bin/env python3
"""The gyro is lost: how wrong is the heading after 2, 5 and 10 s, by the wheels, by one Kalman filter, by the named forecast?"""
import collections
import csv
import io
import json
import os
import subprocess

import h5py
import numpy as np

from benchmark import SOURCES, Arguments, Failed, head, line, rows_of_runs

PROTOCOL = """The shipped configurations, one thread; both halves of the runs train in turn. Up to the start moment a predictor has gyro and wheels, from then on the wheels alone. Heading
error [degrees]: integral of the predicted less that of the measured yaw rate. Median / 90th percentile over the start moments of held-out runs, the first half a second or the lags after the start of a run, then every 5 s (DRIVE 1 s, bag 2 s). Wheels: a factor on the difference of the wheel
speeds (bag: on the yaw rate of the odometry) and a delay, by least squares on the training runs. Named: the filter that the program names for forecasts 5 s ahead, by training runs alone."""
SECONDS = (2, 5, 10)
LARGEST_DELAY = 10  # samples


def difference(inputs):
    """Speed of the right wheel minus that of the left."""
    return inputs[:, 1] - inputs[:, 0]


def odometry(inputs):
    """The yaw rate from the robot's wheel odometry."""
    return inputs[:, 1]


# Title, configuration, samples in 5 s, seconds between start moments, function of the inputs that turns the robot.
SETS = [("ICE", "husky_ice", 33, 5, difference), ("FLOORING", "flooring", 33, 5, difference),
        ("DRIVE", "drive_husky", 100, 1, difference), ("Husky bag", "husky_outdoor", 50, 2, odometry)]


def command(program, *words):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    if done.returncode != 0:
        raise Failed(done.stderr.strip().splitlines()[-1])
    return done.stdout


def learned(given, name, archive, ahead, roles):
    """Runs the chain; returns the named filter for forecasts this many samples ahead."""
    options = [text for key, value in roles.items() for text in (f"--data.{key}", ",".join(value))]
    screen = command(given.program, "run", SOURCES / "configs" / f"{name}.ini", "--archive.output", archive, "--filter.horizon", f"1,{ahead}",
                     "--job.threads", 1, "--force", "--json", *options)
    return next(f["filter"] for f in json.loads(screen)["summary"]["forecasts"] if f["steps"] == ahead)


def delayed(turning, delay):
    """The value `delay` samples earlier; at the start of a run, the first value."""
    return np.concatenate([np.full(min(delay, len(turning)), turning[0]), turning[:max(0, len(turning) - delay)]])


def wheels_of(training):
    """Factor and delay that fit the training runs best, from pairs (turning, yaw rate)."""
    def fit(delay):
        u, y = (np.concatenate(column) for column in zip(*((delayed(u, delay), y) for u, y in training)))
        factor = u @ y / (u @ u)
        return np.sum((y - factor * u) ** 2), factor, delay
    return min(map(fit, range(LARGEST_DELAY + 1)))[1:]


def predicted(given, archive, name, first, steps):
    """Predictions of every run from its sample `first` on."""
    text = command(given.program, "predict", archive, "--filter", name, "--samples", first, "--horizon", steps, "--job.threads", 1)
    runs = collections.defaultdict(list)
    for row in csv.reader(list(io.StringIO(text))[1:]):
        runs[row[0]].append(float(row[2]))
    return runs


def errors_of(given, archive, named, every, turning):
    """Heading errors [degrees] by predictor and seconds, and the wheels' factor and delay."""
    with h5py.File(archive) as file:
        of_filters = [dict(file[group].attrs) for group in file if "dt_s" in file[group].attrs]
        state, u = file["data/state"][:, 0], turning(file["data/input"][:])
        training, held_out = ([(name, state[at], u[at]) for name, at in rows_of_runs(file, role).items()] for role in ("train", "test"))
    dt = of_filters[0]["dt_s"]
    lags = max(max(a["state_lags"], a["input_lags"] + max(a["input_delay"])) for a in of_filters)
    factor, delay = wheels_of([(u, y) for _, y, u in training])
    errors = collections.defaultdict(list)
    for moment in np.arange(0, max(len(y) for _, y, _ in held_out) * dt - SECONDS[0], every):
        first = max(round(0.5 / dt), lags + 1) + round(moment / dt)
        steps = round(SECONDS[-1] / dt)
        of = {name: predicted(given, archive, name, first, steps) for name in {"baseline", "bank", named}}
        for name, y, u in held_out:
            by = {"wheels": factor * delayed(u, delay)[first:first + steps], **{f: runs.get(name, []) for f, runs in of.items()}}
            for seconds in SECONDS:
                n = round(seconds / dt)
                if first + n <= len(y):
                    for f, yaw_rate in by.items():
                        errors[f, seconds].append(np.degrees(abs(np.sum(yaw_rate[:n] - y[first:first + n]) * dt)))
    return errors, factor, delay


def main():
    given = Arguments(__doc__)
    os.environ["MODEBANK_DATA"] = str(given.data)
    head(given.program, "Heading after the gyro is lost", PROTOCOL, ["data, what trains", "seconds", "starts", "wheels", "one Kalman filter",
                                                                   "bank", "named"])
    for title, name, ahead, every, turning in SETS:
        first = given.out / f"{title.replace(' ', '_')}.h5"
        for archive, half in ((first, "even"), (first.with_stem(first.stem + "_odd"), "odd")):
            roles = {}
            if half == "odd":
                with h5py.File(first) as file:
                    roles = {"train": rows_of_runs(file, "test"), "test": rows_of_runs(file, "train")}
            named = learned(given, name, archive, ahead, roles)
            errors, factor, delay = errors_of(given, archive, named, every, turning)
            for seconds in SECONDS:
                if errors["wheels", seconds]:
                    cells = [f"{np.median(e):.1f} / {np.percentile(e, 90):.1f}" for e in (errors[f, seconds] for f in ("wheels", "baseline", "bank", named))]
                    line(f"{title}, {half}", seconds, len(errors["wheels", seconds]), *cells[:3], f"{cells[3]} ({named})")
            print(f"<!-- {title}, {half}: wheels {factor:.4f}, {delay} samples late -->", flush=True)


if __name__ == "__main__":
    main()
