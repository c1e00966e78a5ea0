#!/usr/bin/env python3
"""What each feature of a configuration is worth on held-out runs, both ways round.

usage: ablation.py MODEBANK CONFIG [--key value ...]     (a data root is taken from MODEBANK_DATA)

Runs CONFIG as it is and with one feature at a time taken back, each once as configured and once with training and test
runs swapped, and prints a Markdown table of held-out scores: log score [nats/sample], RMSE and PIT tails of each fold.
Nothing is chosen here: every choice is made by the program inside the training runs. Needs Python 3 alone.
"""
import json
import os
import subprocess
import sys
import tempfile

# name, options that take the feature back; None: the configuration as it is
FEATURES = [
    ("all of it", {}),
    ("without the adaptive noise scale", {"filter.noise": "gaussian"}),
    ("without refinement", {"bank.refine": "none"}),
    ("without either", {"bank.refine": "none", "filter.noise": "gaussian"}),
    ("without lagged states (linear)", {"window.model": "linear", "window.state_lags": "1"}),
    ("without cross-validation", {"bank.folds": "1"}),
    ("without restarts", {"bank.restarts": "0"}),
    ("without screening", {"bank.screen": "false"}),
    ("without measurement noise (R = 1e-12)", {"bank.measurement_variance": "1e-12"}),
    ("modes share what cross-validation likes most", {"bank.share": "best"}),
    ("modes share theta", {"bank.share": "theta"}),
    ("modes share Q", {"bank.share": "noise"}),
    ("with parameter noise", {"filter.parameter_noise": "true"}),
    ("without switching of parameters in mixing (mmae)", {"filter.variant": "mmae"}),
    ("at most 5 modes", {"bank.modes": "5"}),
]


def run(program, config, options, archive):
    arguments = [program, "run", config, "--archive.output", archive]
    for key, value in options.items():
        arguments += ["--" + key, value]
    done = subprocess.run(arguments, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "failed")
    shown = subprocess.run([program, "show", archive, "/evaluation/summary", "--json"], capture_output=True, text=True,
                           check=True)
    return json.loads(shown.stdout)["value"]


def pooled(rows, filter_name):
    return next(r for r in rows if r["filter"] == filter_name and r["role"] == "test" and r["run"] == "*")


def rmse(row):
    value = row["rmse"]
    return value[0] if isinstance(value, list) else value


def cells(folds, filter_name):
    scores = [pooled(rows, filter_name) for rows in folds]
    mean = sum(s["log_score"] for s in scores) / len(scores)
    mean_rmse = sum(rmse(s) for s in scores) / len(scores)
    text = [f"{mean:.3f} / {mean_rmse:.4f}"]
    for s in scores:
        text.append(f"{s['log_score']:.3f} / {rmse(s):.4f}")
        text.append(f"{100 * s['tail_above']:.1f} / {100 * s['tail_below']:.1f}")
    return " | ".join(text)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    program, config = sys.argv[1], sys.argv[2]
    given = dict(zip((a.removeprefix("--") for a in sys.argv[3::2]), sys.argv[4::2]))
    with tempfile.TemporaryDirectory() as folder:
        archive = os.path.join(folder, "run.h5")
        first = run(program, config, given, archive)
        names = {role: sorted({r["run"] for r in first if r["role"] == role and r["run"] != "*"})
                 for role in ("train", "test")}
        swapped = {"data.train": ",".join(names["test"]), "data.test": ",".join(names["train"])}
        print("| held out | mean score / RMSE | fold 1 | tails % above / below | fold 2 | tails % above / below |")
        print("|---|---|---|---|---|---|")
        for name, options in FEATURES:
            try:
                folds = [run(program, config, {**given, **options}, archive),
                         run(program, config, {**given, **options, **swapped}, archive)]
            except RuntimeError as error:
                print(f"| {name} | {error} |")
                continue
            print(f"| {name} | {cells(folds, 'bank')} |", flush=True)
            if not options:
                print(f"| competitor: noise_only | {cells(folds, 'noise_only')} |")
                print(f"| competitor: baseline | {cells(folds, 'baseline')} |", flush=True)


if __name__ == "__main__":
    main()
