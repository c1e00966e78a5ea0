#!/usr/bin/env python3
"""All data sets by nothing but their [data]: every filter one and ten samples ahead, the one that the program names, what it finds, what it costs."""
import configparser
import json
import re
import resource
import subprocess

import h5py
import numpy as np

from benchmark import SOURCES, Arguments, decoded, filters, head, held_out, line, modes, rows_of_runs, significant
from hybrid_systems import INPUTS, simulator

PROTOCOL = """[data] of the configuration of each data set alone, defaults otherwise, one thread; either half of the runs trains. Held-out log score [nats/sample] / RMSE. `named`: the filter
that the screen names to predict with, by training runs alone, and what it loses against the best of all filters here. DRIVE's runs are the blocks of one drive; hybrid: seed 1 of DATA/hybrid/simulate.py."""
FLOORING = {"inputs": "borealtc/FLOORING/pro_*.csv", "states": "borealtc/FLOORING/imu_*.csv"}
SETS = [("ICE", "husky_ice", {}, True), ("FLOORING", "husky_ice", FLOORING, True), ("DRIVE", "drive_husky", {}, True), ("DART", "dart", {}, True),
        ("tanks", "cascaded_tanks", {}, True), ("robot arm", "robot_arm", {}, False), ("buck converter", "buck_converter", {}, False),
        ("Husky bag", "husky_outdoor", {}, False)]
SHOWN = ["bank", "baseline", "noise_only", "one_motion", "drifting", "nonlinear", "combined"]
TEN = 10


def data_section(name, data):
    config = configparser.ConfigParser(strict=False, inline_comment_prefixes="#", interpolation=None)
    config.optionxform = str
    text = (SOURCES / "configs" / f"{name}.ini").read_text(encoding="utf-8")
    derived = re.findall(r"(?m)^derive\s*=\s*([^#\n]*)", text)  # a key that may stand more than once
    config.read_string(text)
    return {**config["data"], "root": str(data)}, derived


def write(path, keys, derived):
    lines = ["[data]", *(f"{key} = {value}" for key, value in keys.items() if key != "derive"), *(f"derive = {text}" for text in derived)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def run(program, config, archive, *options):
    """The summary of its JSON and its processor time."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([program, "run", config, "--archive.output", archive, "--job.threads", "1", "--force", "--json", *options], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise SystemExit(done.stderr.strip().splitlines()[-1])
    return json.loads(done.stdout)["summary"], after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def runs_of(archive, role):
    with h5py.File(archive) as file:
        names = rows_of_runs(file, role)
    return ", ".join(dict.fromkeys(name.split(".")[0] for name in names))  # a recording's parts, NAME.1, NAME.2, go with it


def named(summary, steps):
    """What the summary names for so many steps."""
    return next(forecast for forecast in summary["forecasts"] if forecast["steps"] == steps)


def scores(archive, steps):
    """Held-out rows by filter."""
    found = {f: held_out(archive, "horizon", filter=f, horizon=steps) for f in filters(archive)}
    return {f: row for f, row in found.items() if row}


def size(row):
    return np.linalg.norm(row["rmse"])


def forecasts(title, archive, summary):
    for steps in (1, TEN):
        of = scores(archive, steps)
        if not of:
            continue
        name = named(summary, steps)["filter"]
        loss = max(row["log_score"] for row in of.values()) - of[name]["log_score"]
        more = size(of[name]) / min(map(size, of.values())) - 1
        line(title, steps, *(f"{of[f]['log_score']:.3f} / {significant(of[f]['rmse'])}" if f in of else "–" for f in SHOWN),
             f"{name}: {loss:.3f}, {100 * more:.1f} %")


def findings(title, archive, summary, seconds):
    with h5py.File(archive) as file:
        found, bank = file["evaluation/evidence"].attrs, file["bank"].attrs
        says = f"{decoded(found['answer'])}, {decoded(found['description'])}"
        keys = ("state_lags", "input_lags", "input_delay")
        lags = ", ".join(" ".join(map(str, np.unique(bank[key]))) for key in keys)
    covered = {f: held_out(archive, "summary", filter=f)["coverage_95"] for f in dict.fromkeys(["bank", named(summary, 1)["filter"]])}
    line(title, modes(archive), lags, says, "; ".join(f"{f} {100 * share:.1f} %" for f, share in covered.items()), f"{seconds:.1f}")


def configurations(given):
    """Title, configuration and archive of each set; the archive of one half is read for the other's runs."""
    for title, name, other, folds in SETS:
        keys, derived = data_section(name, given.data)
        first = given.out / f"{title.replace(' ', '_')}.h5"
        for part in ("one half", "the other") if folds else ("",):
            archive = first.with_stem(first.stem + "_2") if part == "the other" else first
            swap = {"train": runs_of(first, "test"), "test": runs_of(first, "train")} if part == "the other" else {}
            write(archive.with_suffix(".ini"), {**keys, **other, **swap}, derived)
            yield (f"{title}, {part}".rstrip(", "), archive.with_suffix(".ini"), archive)
    simulate = simulator(given.data)
    for system in simulate.SYSTEMS:
        simulate.write(system, [simulate.simulate(system, 1500, 1, i) for i in range(12)], given.out, False)
        config, archive = given.out / f"{system.name}.ini", given.out / f"{system.name}.h5"
        write(config, {"inputs": f"{given.out / system.name}/run_*.csv", "state": ", ".join(system.states), "input": INPUTS[system.name], "time": "time"}, [])
        yield (f"hybrid, {system.name}", config, archive)


def main():
    given = Arguments(__doc__)
    done = []
    head(given.program, "Forecasts by name", PROTOCOL, ["data, what trains", "ahead", *SHOWN, "named: loses"])
    for title, config, archive in configurations(given):
        summary, seconds = run(given.program, config, archive)
        forecasts(title, archive, summary)
        done.append((title, archive, summary, seconds))
    print("\n| data, what trains | modes | bank's lags, delay | finding | 95 % band holds | seconds |\n|---|---|---|---|---|---|")
    for each in done:
        findings(*each)


if __name__ == "__main__":
    main()
