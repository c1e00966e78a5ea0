#!/usr/bin/env python3
"""The cascaded tanks of nonlinearbenchmark.org: one step ahead and in free run, all choices made on the estimation record.

usage: cascaded_tanks.py MODEBANK OUT_FOLDER [SHARED_DATA]

Number of lags, number of modes and how far learning looks ahead are chosen by cross-validation over the four quarters of the estimation
record, each left out in turn: once by the one-step log score, once by the free run's RMSE (eight samples measured). Prints that table, and
then what either choice scores on the validation record, which chooses nothing (protocol: arXiv:2405.10779): learned from the first 700
samples of the estimation record, as that protocol has it, and from all of it. SHARED_DATA: the folder that holds
cascaded_tanks/est.csv and val.csv, else MODEBANK_DATA. Needs Python 3 alone.
"""
import itertools
import json
import math
import os
import pathlib
import subprocess
import sys

CONFIG = pathlib.Path(__file__).resolve().parents[3] / "configs" / "cascaded_tanks.ini"
TRAINING, QUARTERS = 700, 4  # samples that the protocol learns from; parts of the cross-validation
LAGS, MODES, AHEAD = (2, 3), (1, 2, 3), (1, 10, 30)
FILTERS = ("bank", "one_motion")


def prepare(data, folder):
    head, *estimation = (data / "cascaded_tanks" / "est.csv").read_text().splitlines()
    parts = {"est700": estimation[:TRAINING], "rest": estimation[TRAINING:], "est": estimation,
             "val": (data / "cascaded_tanks" / "val.csv").read_text().splitlines()[1:]}
    for i in range(QUARTERS):
        parts[f"quarter{i}"] = estimation[len(estimation) * i // QUARTERS:len(estimation) * (i + 1) // QUARTERS]
    for name, lines in parts.items():
        (folder / f"tanks_{name}.csv").write_text("\n".join([head, *lines]) + "\n")


def scored(program, folder, choice, train, test):
    """Of each filter: one-step RMSE, log score and shares too far and too close, and the free run's RMSE, on the one test record."""
    lags, modes, ahead = choice
    archive = folder / f"tanks_{test}_{'_'.join(train)}_{lags}_{modes}_{ahead}.h5"
    done = subprocess.run([program, "run", CONFIG, "--data.root", folder, "--data.train", ",".join(train), "--data.test", test,
                           "--window.state_lags", str(lags), "--window.input_lags", str(lags), "--mixture.components", str(modes),
                           "--bank.look_ahead", str(ahead), "--archive.output", archive], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)

    def row(table, name):
        text = subprocess.run([program, "show", archive, "/evaluation/" + table, "--json"], capture_output=True, text=True, check=True).stdout
        found = next(r for r in json.loads(text)["value"] if r["filter"] == name and r["run"] == test)
        return found | {"rmse": found["rmse"][0] if isinstance(found["rmse"], list) else found["rmse"]}

    return {name: row("summary", name) | {"free": row("free_run", name)["rmse"]} for name in FILTERS}


def cross_validated(program, folder, choice):
    """Of each filter: pooled RMSE, mean log score and pooled RMSE of the free run over the quarters, which are equally long."""
    names = [f"quarter{i}" for i in range(QUARTERS)]
    left_out = [scored(program, folder, choice, [n for n in names if n != test], test) for test in names]

    def pooled(name, key):
        return math.sqrt(sum(scores[name][key] ** 2 for scores in left_out) / QUARTERS)

    return {name: (pooled(name, "rmse"), sum(scores[name]["log_score"] for scores in left_out) / QUARTERS, pooled(name, "free"))
            for name in FILTERS}


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    program, folder = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve() / "cascaded_tanks"
    data = pathlib.Path(sys.argv[3] if len(sys.argv) == 4 else os.environ.get("MODEBANK_DATA", ".")).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    prepare(data, folder)
    print("Estimation record, its quarters left out in turn\n\n"
          "| lags | components | look_ahead | bank: one step, RMSE [V] / nats | free run [V] | one_motion: one step | free run |\n"
          "|---|---|---|---|---|---|---|")
    results = {}
    for choice in itertools.product(LAGS, MODES, AHEAD):
        if choice[1] == 1 and choice[2] > 1:
            continue  # nothing switches
        results[choice] = cross_validated(program, folder, choice)
        cells = [f"{rmse:.4f} / {nats:.3f} | {free:.3f}" for rmse, nats, free in results[choice].values()]
        print(f"| {' | '.join(map(str, choice))} | {' | '.join(cells)} |", flush=True)
    by_step = max(results, key=lambda choice: results[choice]["bank"][1])
    by_free = min(results, key=lambda choice: results[choice]["bank"][2])
    print("\nValidation record: the bank chosen by one step (log score), the bank chosen by free run\n\n"
          "| chosen by | lags, components, look_ahead | learned from | filter | one step: RMSE [V] | nats | too far, too close [%] | free run: RMSE [V] |\n"
          "|---|---|---|---|---|---|---|---|")
    for (why, choice), train in itertools.product((("one step", by_step), ("free run", by_free)), ("est700", "est")):
        for name, row in scored(program, folder, choice, [train], "val").items():
            print(f"| {why} | {', '.join(map(str, choice))} | {train} | {name} | {row['rmse']:.4f} | {row['log_score']:.3f} | "
                  f"{100 * row['too_far']:.1f}, {100 * row['too_close']:.1f} | {row['free']:.3f} |", flush=True)


if __name__ == "__main__":
    main()
