#!/usr/bin/env python3
"""How often modes of motion are reported: without modes, with one nonlinear motion, and with modes (make evidence).

  measure_evidence.py build/modebank [--table build/evidence.csv] [--seeds N] [--first 0] [--jobs N] [--only NAME,NAME] [--quantum auto]

--seeds: of each system, else 12, of those with modes 60 and 20. --quantum: data.quantum of the program.

Every system has twelve runs of 400 samples, with inputs drawn at each sample or held. Six train and six are held out, the
default of `modebank run`, which has only [data] configured. Answers are those in /evaluation/evidence.

Each system and seed adds a row to the table. Rows of the same revision that are there are skipped, so calls add up. Rules
are fixed before their seeds are run. Prints a Markdown table of all rows of the revision.
"""
import collections
import concurrent.futures
import csv
import os
import pathlib
import sys
import tempfile
import time

import h5py
import numpy as np

from one_motion_systems import BENT, LINEAR
from switching_system import Switching, options_of, run_program

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
        start = time.monotonic()
        done = run_program(program, runs, folder, ["--data.quantum", quantum])
        row["seconds"] = f"{time.monotonic() - start:.1f}"
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
        parts = {name: [r for r in of_group if r["system"] == name] for name in systems}
        for name, part in (parts | {f"**{group}**, {len(of_group)}": of_group}).items():
            counts = collections.Counter(r["answer"] for r in part)
            lines += [f"| {name} | " + " | ".join(str(counts[a]) for a in ANSWERS) + " |"] * bool(part)
    counted = [r for r in rows if r["system"] == "modes"]
    if counted:
        right = sum(r["answer"] == "evidence" and r["modes"] == r["modes_true"] for r in counted)
        lines.append(f"\nThe right number of modes in {right} of {len(counted)}.")
    described = collections.Counter(r["description"] for r in rows if r["group"] == "one bent motion")
    if described:
        lines.append("Bent motions are called " + ", ".join(f"{name} ({count})" for name, count in described.most_common()) + ".")
    return "\n".join(lines)


def main():
    options = options_of(__doc__, "program", table=pathlib.Path(os.devnull), revision="", seeds=0, first=0,
                         jobs=os.cpu_count(), only="", quantum="none")
    wanted = options.only.split(",") if options.only else [name for systems in GROUPS.values() for name in systems]
    options.table.touch()
    rows = [r for r in csv.DictReader(options.table.open()) if r["revision"] == options.revision]
    known = {(r["system"], int(r["seed"])) for r in rows}
    jobs = [(group, name, seed) for seed in range(options.first, options.first + (options.seeds or max(SEEDS[name] for name in wanted)))
            for group, systems in GROUPS.items() for name in systems
            if name in wanted and (name, seed) not in known and seed < options.first + (options.seeds or SEEDS[name])]
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for row in pool.map(lambda job: trial(options.program, options.quantum, options.revision, *job), jobs):
            rows.append({key: str(value) for key, value in row.items()})
            with options.table.open("a", newline="") as file:
                writer = csv.DictWriter(file, COLUMNS)
                if file.tell() == 0:
                    writer.writeheader()
                writer.writerow(row)
    print(table_of(rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
