#!/usr/bin/env python3
"""Gain of each feature of a configuration on held-out runs, with either half of the runs training.

usage: ablation.py MODEBANK CONFIG [--sets ICE,FLOORING] [--cache FILE.json] [--jobs 2] [--only TEXT] [--key value ...]

Runs CONFIG unchanged, then with one feature at a time removed, changed or added. Each of these runs twice, with either half
of the runs training. Prints a Markdown table per data set: held-out log score [nats/sample], one-step RMSE, and the shares
of samples too far and too close, of each fold.

--sets A,B   CONFIG's data paths contain A; makes the table for A, then with B in place of A
--only       rows whose name contains TEXT, in addition to the first row
Other options are passed to the program. The data root is taken from MODEBANK_DATA.

The cache stores every finished run under a hash of the program, the configuration, the options and the sizes and times of
the data files. A second call continues where the first one stopped. If all runs are finished, it only prints the table.
This script makes no choice: the program makes every choice inside the training runs. Needs only Python 3.
"""
import concurrent.futures
import glob
import hashlib
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import threading

# name, options that change the feature; "bank:" before them means the first row's bank with these options
FEATURES = [
    ("all of it", {}),
    ("noise as learned (gaussian), refined for it", {"filter.noise": "gaussian"}),
    ("the same bank, noise as learned", {"bank:filter.noise": "gaussian"}),
    ("without refinement", {"bank.refine": "none"}),
    ("without refinement, noise as learned", {"bank.refine": "none", "filter.noise": "gaussian"}),
    ("mixture: 5 restarts, 2 moves", {"mixture.restarts": "5", "mixture.split_merge": "2"}),
    ("without measurement noise (R = 1e-12)", {"bank.measurement_variance": "1e-12"}),
    ("measurement noise given (R = 1e-6)", {"bank.measurement_variance": "1e-6"}),
    ("one lag", {"window.model": "linear", "window.state_lags": "1"}),
    ("two lags", {"window.state_lags": "2"}),
    ("four lags", {"window.state_lags": "4"}),
    ("windows by least squares (no Huber)", {"window.loss": "trivial"}),
    ("mixture over parameters alone", {"mixture.features": "parameters"}),
    ("diagonal mixture", {"mixture.covariance": "diagonal"}),
    ("the same bank in salvi2025", {"bank:filter.variant": "salvi2025"}),
    ("one Kalman filter (kf)", {"filter.variant": "kf"}),
]


class Failed(RuntimeError):
    pass


class Bench:
    """The program, the configuration and the results so far."""

    def __init__(self, program, config, cache):
        self.program, self.config, self.cache_file = program, config, cache
        self.lock = threading.Lock()
        self.cache = {}
        if os.path.exists(cache):
            with open(cache) as file:
                self.cache = json.load(file)
        with open(program, "rb") as file:
            self.program_hash = hashlib.sha256(file.read()).hexdigest()
        with open(config) as file:
            self.text = file.read()

    def call(self, *arguments):
        done = subprocess.run([self.program, *arguments], capture_output=True, text=True)
        if done.returncode != 0:
            raise Failed((done.stderr.strip().splitlines() or ["failed"])[-1])
        return done.stdout

    def key(self, options):
        identity = [self.program_hash, self.text, sorted(options.items()), os.environ.get("MODEBANK_DATA", ""),
                    data_files(self.text, options)]
        return hashlib.sha256(json.dumps(identity).encode()).hexdigest()

    def store(self, key, value):
        with self.lock:
            self.cache[key] = value
            new = self.cache_file + ".new"
            with open(new, "w") as file:
                json.dump(self.cache, file)
            os.replace(new, self.cache_file)


def configured(text, key):
    """Value of a key in [data]; used for paths only."""
    found = re.search(r"^\s*%s\s*=\s*([^#\n]*)" % key, text, re.M)
    return found.group(1).strip() if found else ""


def data_files(text, options):
    root = options.get("data.root") or configured(text, "root") or os.environ.get("MODEBANK_DATA", "")
    files = []
    for key in ("inputs", "states"):
        pattern = options.get("data." + key) or configured(text, key)
        for path in sorted(glob.glob(os.path.join(root, pattern))) if pattern else []:
            state = os.stat(path)
            files.append([path, state.st_size, state.st_mtime_ns])
    return files


class Stages:
    """The first row's bank of each fold, made once, at its first use."""

    def __init__(self, bench, folder):
        self.bench, self.folder = bench, folder
        self.lock = threading.Lock()
        self.locks = {}

    def made(self, key, make):
        path = os.path.join(self.folder, key + ".h5")
        with self.lock:
            mine = self.locks.setdefault(key, threading.Lock())
        with mine:
            if not os.path.exists(path):
                make(path)
        return path

    def learned(self, options):
        return self.made("bank_" + self.bench.key(options)[:16], lambda path: self.evaluate(options, path))

    def evaluate(self, options, path):
        self.bench.call("run", self.bench.config, *flags(options), "--archive.output", path)

    def rows(self, given, feature):
        """Held-out rows of the summary, by filter."""
        key = self.bench.key({**given, **feature})
        if key in self.bench.cache:
            return self.bench.cache[key]
        changed = {k.removeprefix("bank:"): v for k, v in feature.items()}
        if not feature:
            rows = self.summary(self.learned(given))
        else:
            with tempfile.TemporaryDirectory(dir=self.folder) as folder:
                path = os.path.join(folder, "run.h5")
                if any(k.startswith("bank:") for k in feature):
                    self.bench.call("run", self.bench.config, *flags({**given, **changed}), "--archive.bank",
                                    self.learned(given), "--archive.output", path)
                else:
                    self.evaluate({**given, **changed}, path)
                rows = self.summary(path)
        self.bench.store(key, rows)
        return rows

    def summary(self, path):
        table = json.loads(self.bench.call("show", path, "/evaluation/summary", "--json"))["value"]
        return {r["filter"]: r for r in table if r["role"] == "test" and r["run"] == "*"}


def flags(options):
    return [text for key, value in {**options, "job.threads": "1"}.items() for text in ("--" + key, value)]


def halves(bench, given):
    """Options of the two folds: as configured, and with training and held-out runs exchanged."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "runs.h5")
        early = {k: v for k, v in given.items() if k.startswith(("data.", "window."))}
        bench.call("run", bench.config, *flags({**early, "window.step": "100"}), "--until", "windows",
                   "--archive.output", path)
        runs = json.loads(bench.call("show", path, "/data/runs", "--json"))["value"]
        roles = {run["name"]: run["role"] for run in runs}
    chosen = {role: ",".join(name for name in roles if roles[name] == role) for role in ("train", "test")}
    return [given, {**given, "data.train": chosen["test"], "data.test": chosen["train"]}]


def rmse(row):
    value = row["rmse"]
    return value[0] if isinstance(value, list) else value


def cells(folds, name):
    scores = [rows[name] for rows in folds]
    mean = sum(s["log_score"] for s in scores) / len(scores)
    text = [f"{mean:.3f} / {sum(map(rmse, scores)) / len(scores):.4f}"]
    for s in scores:
        text.append(f"{s['log_score']:.3f} / {rmse(s):.4f}")
        text.append(f"{100 * s['too_far']:.1f}, {100 * s['too_close']:.1f}")
    return " | ".join(text)


def outcome(future):
    try:
        return future.result()
    except Failed as error:
        return str(error)


def table(stages, title, folds, features, pool):
    running = [(name, [pool.submit(stages.rows, fold, feature) for fold in folds]) for name, feature in features]
    print(f"\n| {title} | mean score / RMSE | first half trains | tails | second half trains | tails |")
    print("|---|---|---|---|---|---|", flush=True)
    for name, futures in running:
        results = [outcome(future) for future in futures]
        errors = [r for r in results if isinstance(r, str)]
        print(f"| {name} | " + (errors[0] if errors else cells(results, "bank")) + " |", flush=True)
        if name == features[0][0] and not errors:
            for competitor in [name for name in results[0] if name != "bank" and all(name in rows for rows in results)]:
                print(f"| competitor: {competitor} | {cells(results, competitor)} |", flush=True)


def replaced(text, given, old, new):
    paths = {"data." + key: given.get("data." + key) or configured(text, key) for key in ("inputs", "states")}
    return {**given, **{key: path.replace(old, new) for key, path in paths.items() if path}}


def main():
    if len(sys.argv) < 3 or len(sys.argv) % 2 == 0:
        sys.exit(__doc__)
    program, config = os.path.abspath(sys.argv[1]), sys.argv[2]
    given = dict(zip((a.removeprefix("--") for a in sys.argv[3::2]), sys.argv[4::2]))
    sets = [name.strip() for name in given.pop("sets", "").split(",")]
    cache, jobs, only = given.pop("cache", "ablation.json"), int(given.pop("jobs", "2")), given.pop("only", "")
    features = FEATURES[:1] + [f for f in FEATURES[1:] if only in f[0]]
    bench = Bench(program, config, cache)
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        stages = Stages(bench, folder)
        for name in sets:
            options = given if name == sets[0] else replaced(bench.text, given, sets[0], name)
            table(stages, name or "held out", halves(bench, options), features, pool)
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"\n{used.ru_utime + used.ru_stime:.0f} s of CPU time in this call", file=sys.stderr)


if __name__ == "__main__":
    try:
        main()
    except Failed as error:
        sys.exit(str(error))
