#!/usr/bin/env python3
"""The cascaded tanks of nonlinearbenchmark.org: one step ahead and in free run, all choices made on the estimation record.

usage: cascaded_tanks.py MODEBANK OUT_FOLDER [SHARED_DATA]

Fits on the first 700 samples of the estimation record; the number of modes, whether switches see state and input, and how
far learning looks ahead are chosen on the other 324: once by the free run's RMSE, once by the one-step log score. Prints that table,
and then what either choice scores on the validation record, which chooses nothing (protocol: arXiv:2405.10779). SHARED_DATA: the folder that holds
cascaded_tanks/est.csv and val.csv, else MODEBANK_DATA. Needs Python 3 alone.
"""
import itertools
import json
import os
import pathlib
import subprocess
import sys

CONFIG = pathlib.Path(__file__).resolve().parents[3] / "configs" / "cascaded_tanks.ini"
TRAINING = 700  # samples of the protocol
MODES, SWITCHES, AHEAD = (1, 2, 3), ("labels", "logit"), (1, 10, 30)


def prepare(data, folder):
    estimation = (data / "cascaded_tanks" / "est.csv").read_text().splitlines()
    parts = {"est700": estimation[:TRAINING + 1], "rest": estimation[:1] + estimation[TRAINING + 1:],
             "val": (data / "cascaded_tanks" / "val.csv").read_text().splitlines()}
    for name, lines in parts.items():
        (folder / f"tanks_{name}.csv").write_text("\n".join(lines) + "\n")


def scored(program, folder, choice, test):
    """One-step and free-run RMSE and log score of the bank on one record."""
    modes, switches, ahead = choice
    archive = folder / f"tanks_{test}_{modes}_{switches}_{ahead}.h5"
    done = subprocess.run([program, "run", CONFIG, "--data.root", folder, "--data.test", test, "--mixture.components", str(modes),
                           "--bank.transition", switches, "--bank.look_ahead", str(ahead), "--archive.output", archive],
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)

    def row(table):
        text = subprocess.run([program, "show", archive, "/evaluation/" + table, "--json"], capture_output=True, text=True, check=True).stdout
        found = next(r for r in json.loads(text)["value"] if r["filter"] == "bank" and r["run"] == test)
        return found["rmse"][0] if isinstance(found["rmse"], list) else found["rmse"], found["log_score"]

    return row("summary"), row("free_run")


def line(choice, one_step, free):
    modes, switches, ahead = choice
    print(f"| {modes} | {switches} | {ahead} | {one_step[0]:.4f} | {one_step[1]:.3f} | {free[0]:.3f} |", flush=True)


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    program, folder = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve() / "cascaded_tanks"
    data = pathlib.Path(sys.argv[3] if len(sys.argv) == 4 else os.environ.get("MODEBANK_DATA", ".")).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    prepare(data, folder)
    head = "| components | switches | look_ahead | one step: RMSE [V] | log score | free run: RMSE [V] |\n|---|---|---|---|---|---|"
    print("Estimation record, samples 700 to 1023\n\n" + head)
    results = {}
    for choice in itertools.product(MODES, SWITCHES, AHEAD):
        if choice[0] == 1 and choice[1] == "logit":
            continue
        results[choice] = scored(program, folder, choice, "rest")
        line(choice, *results[choice])
    best_free = min(results, key=lambda choice: results[choice][1][0])
    best_step = max(results, key=lambda choice: results[choice][0][1])
    print("\nValidation record: the choice for free run, the choice for one step (log score), and one mode as one-step likelihood fits it\n\n" + head)
    for choice in dict.fromkeys((best_free, best_step, (1, "labels", 1))):
        line(choice, *scored(program, folder, choice, "val"))


if __name__ == "__main__":
    main()
