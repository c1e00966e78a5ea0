#!/usr/bin/env python3
"""How often modes of motion are reported: without modes, with one nonlinear motion, and with modes (make evidence).

  measure_evidence.py build/modebank [--table build/evidence.csv] [--seeds N] [--first 0] [--jobs N] [--only NAME,NAME] [--quantum auto]

This script simulates every system with numpy: twelve runs of 400 samples, with inputs drawn at each sample or held. Six runs
train and six are held out, the default division of `modebank run`. Only [data] is configured. The script counts the answers
in /evaluation/evidence.

Each system and seed adds a row to the table. Rows of the same revision that the table already has are skipped, so several
calls add up. Rules are fixed before their seeds are run. Prints a Markdown table of all rows of the revision.
"""
import argparse
import collections
import concurrent.futures
import csv
import os
import pathlib
import sys
import tempfile

import h5py
import numpy as np

from one_motion_systems import BENT, LINEAR
from switching_system import Switching, run_program

RUNS, SAMPLES = 12, 400
ANSWERS = ["evidence", "cannot tell", "no evidence", "one mode", "not comparable", "not yet", "refused", "crash"]
COLUMNS = ["group", "system", "seed", "answer", "description", "modes", "modes_true", "seconds", "revision"]


def modes_apart(g, dwell=None):
    """Two to four modes; predictions of each pair differ by at least its noise, root mean square."""
    while True:
        system = Switching.drawn(g)
        u, x = system.simulate(np.random.default_rng(1), 0, 2000)
        z = np.c_[x, u]
        apart = [np.sqrt((((system.A[i] - system.A[j]) @ x.T + (system.B[i] - system.B[j]) @ u.T) ** 2).mean(1)).max() / max(system.sd[i], system.sd[j])
                 for i in range(system.K) for j in range(i)]
        if np.isfinite(z).all() and min(apart) > 1:
            system.dwell = dwell(g) if dwell else system.dwell
            return system


MODES = {"modes": modes_apart, "modes that stay 3 to 10 samples": lambda g: modes_apart(g, lambda h: float(h.uniform(3, 10)))}
GROUPS = {"one linear motion": LINEAR, "one bent motion": BENT, "modes": MODES}
SEEDS = collections.defaultdict(lambda: 12, zip(MODES, (60, 20)))


def trial(program, quantum, revision, group, name, seed):
    g = np.random.default_rng([seed, sum(map(ord, name))])
    made = GROUPS[group][name](g)
    runs = [made.simulate(g, run, SAMPLES) for run in range(RUNS)] if isinstance(made, Switching) else made
    row = dict.fromkeys(COLUMNS, "") | {"group": group, "system": name, "seed": seed, "revision": revision,
                                        "modes_true": made.K if isinstance(made, Switching) else 1}
    with tempfile.TemporaryDirectory() as path:
        folder = pathlib.Path(path)
        before = os.times()
        done = run_program(program, runs, folder, ["--data.quantum", quantum])
        row["seconds"] = f"{os.times().elapsed - before.elapsed:.1f}"
        if done.returncode != 0:
            print(done.stderr.strip()[-300:], file=sys.stderr)
            return row | {"answer": "refused" if done.returncode in (1, 2) else "crash"}
        with h5py.File(folder / "out.h5") as file:
            found = file["evaluation/evidence"].attrs
            text = {key: found[key].decode() for key in ("answer", "description")}
            return row | text | {"modes": int(found["modes"])}


def table_of(rows):
    lines = ["| system | " + " | ".join(ANSWERS) + " |", "|---|" + "---|" * len(ANSWERS)]
    for group, systems in GROUPS.items():
        of_group = [r for r in rows if r["group"] == group]
        for name in [n for n in systems if any(r["system"] == n for r in of_group)]:
            counts = collections.Counter(r["answer"] for r in of_group if r["system"] == name)
            lines.append(f"| {name} | " + " | ".join(str(counts[a]) for a in ANSWERS) + " |")
        if of_group:
            lines.append(f"| **{group}**, {len(of_group)} | " + " | ".join(str(sum(r["answer"] == a for r in of_group)) for a in ANSWERS) + " |")
    counted = [r for r in rows if r["system"] == "modes"]
    if counted:
        right = sum(r["answer"] == "evidence" and r["modes"] == r["modes_true"] for r in counted)
        lines.append(f"\nThe right number of modes in {right} of {len(counted)}.")
    described = collections.Counter(r["description"] for r in rows if r["group"] == "one bent motion")
    if described:
        lines.append("Bent motions are called " + ", ".join(f"{name} ({count})" for name, count in described.most_common()) + ".")
    return "\n".join(lines)


def read(path):
    return list(csv.DictReader(path.open())) if path.exists() else []


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--table", type=pathlib.Path)
    parser.add_argument("--revision", default="")
    parser.add_argument("--seeds", type=int, help="of each system; default: 12, of those with modes 60 and 20")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--only", default="")
    parser.add_argument("--quantum", default="none", help="data.quantum: with auto R is at least the rounding of readings that come in steps")
    options = parser.parse_args()
    wanted = options.only.split(",") if options.only else [name for systems in GROUPS.values() for name in systems]
    known = {(r["system"], int(r["seed"])) for r in read(options.table) if r["revision"] == options.revision} if options.table else set()
    jobs = [(group, name, seed) for seed in range(options.first, options.first + (options.seeds or max(SEEDS[name] for name in wanted)))
            for group, systems in GROUPS.items() for name in systems
            if name in wanted and (name, seed) not in known and seed < options.first + (options.seeds or SEEDS[name])]
    rows = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for row in pool.map(lambda job: trial(options.program, options.quantum, options.revision, *job), jobs):
            rows.append({key: str(value) for key, value in row.items()})
            if options.table:
                new = not options.table.exists()
                with options.table.open("a", newline="") as file:
                    writer = csv.DictWriter(file, COLUMNS)
                    if new:
                        writer.writeheader()
                    writer.writerow(row)
    print(table_of([r for r in (read(options.table) if options.table else rows) if r["revision"] == options.revision]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
