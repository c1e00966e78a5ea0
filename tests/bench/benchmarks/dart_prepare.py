#!/usr/bin/env python3
"""The DART recordings with the product of speed and steering as a column of its own, for configs/dart.ini.

  dart_prepare.py FOLDER_OF_DART OUTPUT_FOLDER

Reads every RUN.csv of a folder (columns time, yaw_rate, speed, steering, ...) and writes it with the column v_steer =
speed * steering: what turns a car, and what no column says. Both factors are held between sensor messages, so the
product commutes with resampling. Digits are those of the input; v_steer has 9.
"""
import csv
import pathlib
import sys

KEPT = ("time", "yaw_rate", "speed", "steering")


def prepare(source, target):
    with open(source, newline="") as read, open(target, "w", newline="") as write:
        rows = csv.DictReader(read)
        missing = [name for name in KEPT if name not in rows.fieldnames]
        if missing:
            sys.exit(f"{source}: no column {', '.join(missing)}")
        out = csv.writer(write, lineterminator="\n")
        out.writerow((*KEPT, "v_steer"))
        for row in rows:
            out.writerow((*(row[name] for name in KEPT), f"{float(row['speed']) * float(row['steering']):.9g}"))


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    runs = sorted(pathlib.Path(sys.argv[1]).glob("*.csv"))
    if not runs:
        sys.exit(f"{sys.argv[1]}: no .csv file")
    target = pathlib.Path(sys.argv[2])
    target.mkdir(parents=True, exist_ok=True)
    for run in runs:
        prepare(run, target / run.name)
    print(f"{len(runs)} runs with v_steer in {target}")


if __name__ == "__main__":
    main()
