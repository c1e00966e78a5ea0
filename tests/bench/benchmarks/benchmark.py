"""Common parts of the benchmarks: arguments, one run of the program, scores from its archive, tables with their provenance.

Every script of this folder is called NAME.py MODEBANK OUT_FOLDER [SHARED_DATA] and prints one Markdown table; the archives stay in
OUT_FOLDER. The data are those of SHARED_DATA (else of MODEBANK_DATA), whose README files say where they come from and what others got.
"""
import datetime
import os
import pathlib
import platform
import subprocess
import sys

import h5py
import numpy as np

SOURCES = pathlib.Path(__file__).resolve().parents[3]


class Arguments:
    """Arguments of a script's command line."""

    def __init__(self, doc):
        if not 3 <= len(sys.argv) <= 4:
            sys.exit(doc.strip() + "\n\nusage: NAME.py MODEBANK OUT_FOLDER [SHARED_DATA]")
        data = sys.argv[3] if len(sys.argv) == 4 else os.environ.get("MODEBANK_DATA", "")
        if not data:
            sys.exit("give the folder of the data as third argument or in MODEBANK_DATA")
        self.program, self.data = os.path.abspath(sys.argv[1]), pathlib.Path(data).resolve()
        self.out = pathlib.Path(sys.argv[2]).resolve() / pathlib.Path(sys.argv[0]).stem
        self.out.mkdir(parents=True, exist_ok=True)


def run(program, config, archive, **options):
    """One `modebank run` on one thread. A double underscore in an option name stands for the dot."""
    flags = [text for key, value in options.items() for text in ("--" + key.replace("__", "."), str(value))]
    done = subprocess.run([program, "run", config, "--archive.output", archive, "--job.threads", "1", *flags], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr.strip().splitlines()[-1])
    return archive


def decoded(value):
    return value.decode() if isinstance(value, bytes) else value


def filters(archive, *but):
    """The filters scored in the archive except the given ones, the bank first and `combined` last."""
    with h5py.File(archive) as file:
        return [name for name in map(decoded, file["evaluation"].attrs["filters"]) if name not in but]


def rows_of_runs(file, role):
    """Names of an archive's runs of one role, and their rows in arrays over samples."""
    return {decoded(row["name"]): slice(row["first"], row["first"] + row["samples"]) for row in file["data/runs"][:] if decoded(row["role"]) == role}


def title_of(name):
    """Name of a filter's row among rows of banks."""
    return "all of them combined" if name == "combined" else f"competitor: {name}"


def rows(archive, table, **wanted):
    """Rows of a table of the archive as dictionaries, those with the wanted values."""
    with h5py.File(archive) as file:
        data = file[f"evaluation/{table}"][:]
    every = [{name: decoded(row[name]) for name in data.dtype.names} for row in data]
    return [row for row in every if all(row[key] == value for key, value in wanted.items())]


def held_out(archive, table, **wanted):
    """The one pooled row of the held-out runs."""
    found = rows(archive, table, role="test", run="*", **wanted)
    return found[0] if found else None


def numbers(value, digits):
    return " ".join(f"{v:.{digits}f}" for v in np.atleast_1d(value))


def modes(archive):
    with h5py.File(archive) as file:
        return len(file["bank/A"])


def output(command):
    return subprocess.run(command, capture_output=True, text=True, cwd=SOURCES).stdout.strip()


def provenance(program):
    command = " ".join(["python3", os.path.relpath(sys.argv[0], SOURCES), "MODEBANK", "OUT_FOLDER", "DATA"])
    models = [line.split(":", 1)[1].strip() for line in open("/proc/cpuinfo", encoding="utf-8") if line.startswith("model name")]
    machine = f"{models[0] if models else platform.machine()}, {len(os.sched_getaffinity(0))} cores, one thread"
    return (f"`{command}`; program {output([program, '--version'])}, scripts {output(['git', 'rev-parse', '--short=12', 'HEAD'])}; "
            f"{datetime.datetime.now(datetime.timezone.utc):%Y-%m-%d}; {machine}")


def head(program, title, protocol, columns):
    """Prints title, protocol, provenance and the head of the table."""
    print(f"## {title}\n\n{protocol.strip()}\n\n{provenance(program)}\n")
    print("| " + " | ".join(columns) + " |\n|" + "---|" * len(columns), flush=True)


def line(*cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)
