#!/usr/bin/env python3
"""The cascaded tanks of nonlinearbenchmark.org: one step ahead and in free run, all choices made on the estimation record.

usage: cascaded_tanks.py MODEBANK OUT_FOLDER [SHARED_DATA]

Number of lags, number of modes and the knee above which the pump is a further input (the static gain bends, and the upper tank overflows)
are chosen by cross-validation over the four quarters of the estimation record, each left out in turn: once by the bank's one-step log
score, once by the RMSE of one_motion's free run (eight samples measured); of what the quarters do not tell apart the fewest modes.
Prints that table, and then what either choice scores on the validation record, which chooses nothing (protocol:
arXiv:2405.10779): learned from the first 700
samples of the estimation record, as that protocol has it, and from all of it. SHARED_DATA: the folder that holds
cascaded_tanks/est.csv and val.csv, else MODEBANK_DATA. Needs Python 3 alone.
"""
import collections
import itertools
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys

CONFIG = pathlib.Path(__file__).resolve().parents[3] / "configs" / "cascaded_tanks.ini"
TRAINING, QUARTERS = 700, 4  # training samples of the protocol; parts of the cross-validation
Choice = collections.namedtuple("Choice", "knee, lags, modes")
CHOICES = [Choice(*choice) for choice in itertools.product((None, 3, 3.5, 4, 4.5), (2, 3), (1, 2))]
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
    """For each filter on the held-out record: one-step RMSE, log score, shares too far and too close, and RMSE of the free run."""
    archive = folder / f"tanks_{test}_{'_'.join(train)}_{'_'.join(map(str, choice))}.h5"
    derived = ["--data.derive", f"pump_over=max(pump - {choice.knee}, 0)"] if choice.knee else ["--data.derive", "", "--data.input", "pump"]
    done = subprocess.run([program, "run", CONFIG, "--data.root", folder, "--data.inputs", "tanks_*.csv", "--data.train", ",".join(train), "--data.test", test,
                           "--window.state_lags", str(choice.lags), "--window.input_lags", str(choice.lags), *derived,
                           "--mixture.components", str(choice.modes), "--archive.output", archive], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)

    def row(table, name):
        text = subprocess.run([program, "show", archive, "/evaluation/" + table, "--json"], capture_output=True, text=True, check=True).stdout
        found = next(r for r in json.loads(text)["value"] if r["filter"] == name and r["run"] == test)
        return found | {"rmse": found["rmse"][0] if isinstance(found["rmse"], list) else found["rmse"]}

    return {name: row("summary", name) | {"free": row("free_run", name)["rmse"]} for name in FILTERS}


def cross_validated(program, folder, choice):
    """Results of `scored` for each filter in every quarter, learned from the other quarters."""
    names = [f"quarter{i}" for i in range(QUARTERS)]
    left_out = [scored(program, folder, choice, [n for n in names if n != test], test) for test in names]
    return {name: [scores[name] for scores in left_out] for name in FILTERS}


def pooled(quarters, key):
    return math.sqrt(sum(scores[key] ** 2 for scores in quarters) / QUARTERS)


def mean_log_score(quarters):
    return sum(scores["log_score"] for scores in quarters) / QUARTERS


def fewest_as_good(results, name, losses):
    """The best candidate with the fewest modes as good as the best over quarters (one standard error: Breiman et al. 1984)."""
    mean = {choice: statistics.mean(losses(of[name])) for choice, of in results.items()}
    best = min(mean, key=mean.get)

    def as_good(choice):
        more = [own - least for own, least in zip(losses(results[choice][name]), losses(results[best][name]))]
        return choice == best or statistics.mean(more) <= statistics.stdev(more) / math.sqrt(QUARTERS)

    return min(filter(as_good, results), key=lambda choice: (choice.modes, mean[choice]))


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    program, folder = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve() / "cascaded_tanks"
    data = pathlib.Path(sys.argv[3] if len(sys.argv) == 4 else os.environ.get("MODEBANK_DATA", ".")).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    prepare(data, folder)
    print("Estimation record, its quarters left out in turn\n\n"
          "| knee [V] | lags | components | bank: one step, RMSE [V] / nats | free run [V] | one_motion: one step | free run |\n"
          "|---|---|---|---|---|---|---|")
    results = {}
    for choice in CHOICES:
        results[choice] = cross_validated(program, folder, choice)
        cells = [f"{pooled(q, 'rmse'):.4f} / {mean_log_score(q):.3f} | {pooled(q, 'free'):.3f}" for q in results[choice].values()]
        print(f"| {' | '.join(str(c or '-') for c in choice)} | {' | '.join(cells)} |", flush=True)
    by_step = fewest_as_good(results, "bank", lambda quarters: [-scores["log_score"] for scores in quarters])
    by_free = fewest_as_good(results, "one_motion", lambda quarters: [scores["free"] ** 2 for scores in quarters])
    print("\nValidation record: chosen by the bank one step ahead (log score), and by one_motion in free run\n\n"
          "| chosen by | knee, lags, components | learned from | filter | one step: RMSE [V] | nats | too far, too close [%] | free run: RMSE [V] |\n"
          "|---|---|---|---|---|---|---|---|")
    for (why, choice), train in itertools.product((("one step", by_step), ("free run", by_free)), ("est700", "est")):
        for name, row in scored(program, folder, choice, [train], "val").items():
            print(f"| {why} | {', '.join(str(c or '-') for c in choice)} | {train} | {name} | {row['rmse']:.4f} | {row['log_score']:.3f} | "
                  f"{100 * row['too_far']:.1f}, {100 * row['too_close']:.1f} | {row['free']:.3f} |", flush=True)


if __name__ == "__main__":
    main()
