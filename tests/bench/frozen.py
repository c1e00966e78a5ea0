#!/usr/bin/env python3
"""Every score of every shipped configuration in one table, and what has moved between two tables.

frozen.py run PROGRAM CONFIGS DATA OUT [SET...]       learns every set afresh in one thread; 17 minutes of a processor
frozen.py table OUT                                   prints the rows of the archives in OUT as CSV
frozen.py compare OLD NEW [--reasons FILE] [--only SET...]
    prints what moved; OLD, NEW: a folder of archives, or a CSV such as tests/golden/data/frozen_b1317748.csv
frozen.py quick PROGRAM PARENT CONFIGS DATA OUT [--reasons FILE] [--parent-configs FOLDER]
    compares demo and one half of ICE, learned by both programs; two minutes

A set is a shipped configuration (config), its [data] section alone (default), or the configuration with bank.refine =
none (plain); half b exchanges the training and the held-out runs. Columns: horizon in samples ahead (0: free run),
log_score in nats per sample, coverage_95 one sample ahead. The row of the filter "answer" has answer, modes, clusters
(K by BIC), lags, lag_s, R, seconds of processor time. The rule, in either direction:
- A log score moves by at most .005 nats, an RMSE by .5 %, the bank's gain over a rival (not combined) by .005 nats.
- answer, modes, clusters and lags are equal. No set, row or number is gone or new, and each number is finite.
- salvi's bank, baseline and noise_only, which docs/results/salvi2025.md prints, move in the last printed digit only.
- coverage_95, lag_s, R and seconds are not bounded otherwise; a coverage that moves by more than .01 is noted.
Exit status 1: a run failed, a name stands for nothing, or a row breaks the rule without a reason. FILE has a line
"SET FILTER HORIZON reason" for each row that is meant to move (patterns such as ice_*; * for the answer's horizon).
Such rows are listed. They fall short if a number is gone or not finite, or worse by more than .02 nats or 2 %.
"""
import argparse
import csv
import fnmatch
import hashlib
import os
import re
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

SETS = {"ice": "husky_ice.ini", "flooring": "flooring.ini", "drive": "drive_husky.ini", "dart": "dart.ini",
        "tanks": "cascaded_tanks.ini", "arm": "robot_arm.ini", "buck": "buck_converter.ini", "hybrid": "hybrid.ini",
        "bag": "husky_outdoor.ini", "salvi": "salvi2025.ini"}
SWAPPED, PLAIN = ("ice", "flooring", "drive", "dart", "bag"), ("ice", "flooring", "drive")
SAME_ANYWHERE = {"OMP_NUM_THREADS": "1", "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX2_Usable,-FMA_Usable"}
PLACE, SCORES = ["set", "filter", "horizon", "output"], ["log_score", "rmse", "coverage_95"]
COUNTS, FACTS = ["answer", "modes", "clusters", "lags"], ["lag_s", "R", "seconds"]
COLUMNS = PLACE + SCORES + COUNTS + FACTS
NATS, SHARE, LARGE, COVERAGE = .005, .005, 4, .01
PRINTED, DIGIT = ("bank", "baseline", "noise_only"), 1.01e-5  # five decimals of a log score, six digits of an RMSE


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def call(*command, data=""):
    environment = {**os.environ, **SAME_ANYWHERE} | ({"MODEBANK_DATA": data} if data else {})
    done = subprocess.run([str(word) for word in command], env=environment, capture_output=True, text=True, check=False)
    return "" if done.returncode == 0 else f"FAILED, status {done.returncode}: {done.stderr.strip()[-200:]}"


def learn(program, ini, archive, data, *options):
    """Whether the program learned the archive. A failed run leaves none, so that no row of it is compared."""
    archive.unlink(missing_ok=True)
    before = os.times().children_user
    failure = call(program, "run", ini, "--archive.output", archive, "--job.threads", 1, "--filter.horizon", "1,10",
                   *options, data=data)
    seconds = f"{os.times().children_user - before:.1f}"
    archive.with_suffix(".seconds").write_text(seconds)
    if failure:
        archive.unlink(missing_ok=True)
    print(archive.name, seconds, "s", failure if failure or archive.exists() else "FAILED: no archive", flush=True)
    return archive.exists()


def swapped(archive):
    """Options that exchange the training and the held-out runs of an archive."""
    with h5py.File(archive) as file:  # NAME.1: the part of a run after a gap
        runs = {re.sub(r"\.\d+$", "", text(row["name"])): text(row["role"]) for row in file["data/runs"][...]}
    test = ",".join(name for name, role in runs.items() if role == "test")
    train = ",".join(name for name, role in runs.items() if role != "test")
    return ["--data.train", test, "--data.test", train]


def run(program, configs, data, out, *names):
    if unknown := set(names) - set(SETS):
        sys.exit(f"unknown: {', '.join(sorted(unknown))}; the sets are {', '.join(SETS)}")
    out, good = Path(out), True
    out.mkdir(parents=True, exist_ok=True)
    files, mark = [Path(program), *sorted(Path(configs).glob("*.ini"))], out / "made_by"
    made_by = " ".join([os.path.abspath(data)] + [hashlib.sha256(file.read_bytes()).hexdigest() for file in files])
    if not mark.exists() or mark.read_text() != made_by:  # archives of another program, configuration or data folder
        for archive in out.glob("*_*_[ab].h5"):
            archive.unlink()
    mark.write_text(made_by)
    for name in names or SETS:
        for kind in ("config", "default", "plain"):
            if name == "salvi" and kind != "config" or kind == "plain" and name not in PLAIN:
                continue
            config, ini = (Path(configs) / SETS[name]).read_text(), out / f"{name}_{kind}.ini"
            if kind == "default":
                config = "".join(s for s in re.split(r"^(?=\[)", config, flags=re.M) if s.startswith("[data]"))
            ini.write_text(config)
            options = ["--bank.refine", "none"] if kind == "plain" else []
            first, second = (out / f"{name}_{kind}_{half}.h5" for half in "ab")
            second.unlink(missing_ok=True)
            done = learn(program, ini, first, data, *options)
            good &= done and (name not in SWAPPED or learn(program, ini, second, data, *options, *swapped(first)))
    return good


def pooled(evaluation, table):
    """The rows of a table over all held-out runs, as dictionaries."""
    rows = [dict(zip(row.dtype.names, row)) for row in (evaluation[table][...] if table in evaluation else [])]
    return [row for row in rows if text(row["run"]) == "*" and text(row["role"]) == "test"]


def rows_of(path):
    with h5py.File(path) as file:
        evaluation, bank, place = file["evaluation"], file["bank"], {"set": path.stem}
        cover = {text(row["filter"]): np.ravel(row.get("coverage_95", np.nan)) for row in pooled(evaluation, "summary")}
        for row in pooled(evaluation, "horizon") + pooled(evaluation, "free_run"):
            name, ahead = text(row["filter"]), int(row.get("horizon", 0))
            covered = cover.get(name, [np.nan])
            for i, error in enumerate(np.ravel(row.get("rmse", np.nan))):
                yield place | {"filter": name, "horizon": ahead, "output": i, "rmse": f"{error:.6g}",
                               "log_score": f"{row['log_score']:.5f}" if ahead else "",
                               "coverage_95": f"{covered[min(i, len(covered) - 1)]:.4f}" if ahead == 1 else ""}
        seconds, lags = path.with_suffix(".seconds"), (bank["A"].shape[1] // file["data/state"].shape[1],
                                                       bank["B"].shape[2] // file["data/input"].shape[1])
        yield place | {"filter": "answer", "modes": len(bank["weight"]), "lags": "%d;%d" % lags,
                       "answer": text(evaluation["evidence"].attrs["answer"]) if "evidence" in evaluation else "",
                       "clusters": len(file["mixture/weights"]) if "mixture/weights" in file else "",
                       "lag_s": f"{np.mean(file['data/runs'][...]['lag_s']):.3f}", "R": f"{bank['R'][0, 0]:.3g}",
                       "seconds": seconds.read_text() if seconds.exists() else ""}


def read(source):
    """Rows by their places, from a CSV or a folder of archives. Each cell is a text."""
    if Path(source).is_file():
        found = csv.DictReader(Path(source).read_text().splitlines())
    else:
        found = [row for path in sorted(Path(source).glob("*.h5")) for row in rows_of(path)]
    rows = {}
    for one in found:
        row = {c: "" if one.get(c) is None else text(one[c]) for c in COLUMNS}
        place = tuple(row[column] for column in PLACE)
        if place in rows:
            sys.exit(f"{source}: two rows of {' '.join(place)}")
        rows[place] = row
    return rows or sys.exit(f"{source}: no rows")


def judged(column, old, new, exact):
    """Whether a cell breaks the rule, and whether it falls short where a reason names the row."""
    if column in COUNTS or "" in (old, new):
        return old != new, new == ""
    before, after = float(old), float(new)
    if not np.isfinite([before, after]).all():
        return True, not np.isfinite(after)
    if column in FACTS or column == "coverage_95" and not exact:
        return False, False
    loss, bound = before - after, NATS
    if column == "rmse":
        loss, bound = after / before - 1 if before else np.inf if after else 0., SHARE
    return abs(loss) > (DIGIT if exact else bound), loss > LARGE * bound


class Verdicts:
    """Prints and counts rows that break the rule. Those that a reason names are listed."""
    def __init__(self, reasons):
        lines = [line.split(None, 3) for line in reasons.read_text().splitlines() if line.strip()] if reasons else []
        if unclear := [line for line in lines if len(line) < 4]:
            sys.exit(f"{reasons}: no reason: {' '.join(unclear[0])}")
        self.reasons, self.beyond, self.short = lines, 0, 0

    def add(self, place, words, short):
        why = next((r[3] for r in self.reasons if all(map(fnmatch.fnmatchcase, place[:3], r[:3]))), "")
        self.beyond += not why
        self.short += bool(why) and short
        kind = "beyond:" if not why else "short: " if short else "listed:"
        print(kind, *place, words, why and f"({why})")


def compare_row(place, tables, verdicts):
    """Compares a row that both tables have, and the bank's gain over it if it is a rival's."""
    old, new = (table[place] for table in tables)
    exact = place[0].startswith("salvi") and place[1] in PRINTED
    found = {column: judged(column, old[column], new[column], exact) for column in COLUMNS[len(PLACE):]}
    if bad := [column for column in found if found[column][0]]:
        verdicts.add(place, ", ".join(f"{column} {old[column] or '-'} -> {new[column] or '-'}" for column in bad),
                     any(found[column][1] for column in bad))
    if place[1] == "answer":
        print("        ", place[0], "; ".join(f"{column} {old[column]} -> {new[column]}" for column in FACTS))
    if abs(float(new["coverage_95"] or 0) - float(old["coverage_95"] or 0)) > COVERAGE:
        print("noted:  ", *place, "coverage_95", old["coverage_95"], "->", new["coverage_95"])
    bank = (place[0], "bank", *place[2:])
    if place[1] not in ("bank", "combined", "answer") and all(bank in table for table in tables):
        a, b = (float(t[bank]["log_score"] or "nan") - float(t[place]["log_score"] or "nan") for t in tables)
        if abs(b - a) > NATS:  # never so for NaN, which the row has reported
            verdicts.add(place, f"the bank's gain over it {a:.4f} -> {b:.4f}", a - b > LARGE * NATS)


def compare(old, new, reasons, only=()):
    before, after, verdicts = read(old), read(new), Verdicts(reasons)
    if unknown := [name for name in only if not any(place[0].startswith(name) for place in before | after)]:
        sys.exit(f"--only: no set begins with {', '.join(unknown)}")
    places = [place for place in before | after if place[0].startswith(tuple(only or [""]))]
    for place in places:
        if place in before and place in after:
            compare_row(place, (before, after), verdicts)
        else:
            verdicts.add(place, "is gone" if place in before else "is new", place in before)
    print(f"{len(places)} rows compared, {verdicts.beyond} beyond the rule, {verdicts.short} listed that fall short")
    return verdicts.beyond == 0


def quick(program, parent, configs, data, out, reasons, parent_configs):
    good, folders = True, (Path(out) / "parent", Path(out) / "now")
    for folder, binary, inis in zip(folders, (parent, program), (parent_configs or configs, configs)):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "demo_config_a.h5").unlink(missing_ok=True)
        if failure := call(binary, "demo", "-o", folder / "demo", "--force"):
            print(folder.name, "demo", failure)
        else:
            (folder / "demo/demo.h5").rename(folder / "demo_config_a.h5")
        good &= learn(binary, Path(inis) / "husky_ice.ini", folder / "ice_config_a.h5", data) and not failure
    return compare(*folders, reasons) and good


def main():
    parser = argparse.ArgumentParser(usage=__doc__.replace("%", "%%"))
    parser.add_argument("command", choices=("run", "table", "compare", "quick"))
    parser.add_argument("words", nargs="+")
    parser.add_argument("--only", nargs="+", default=[])
    parser.add_argument("--reasons", type=Path)
    parser.add_argument("--parent-configs")
    given = parser.parse_args()
    if given.command == "run":
        return run(*given.words)
    if given.command == "table":
        csv.writer(sys.stdout, lineterminator="\n").writerows([COLUMNS, *map(dict.values, read(*given.words).values())])
        return True
    return (compare(*given.words, given.reasons, given.only) if given.command == "compare" else
            quick(*given.words, given.reasons, given.parent_configs))


if __name__ == "__main__":
    sys.exit(0 if main() else 1)
