#!/usr/bin/env python3
"""The configurations that `modebank init` proposes for every log of ../shared/data and ../shared/cases.

usage: proposals.py PROGRAM [SHARED] [--compare FILE]

Prints for each log the exit status and the settings of the proposal, without its words. With --compare it prints the
differences from FILE instead (tests/golden/data/proposals.txt, which this script printed), and ends with status 1 if
there are any; a log that FILE does not contain is named only. SHARED: the folder of data and cases; default: beside
$MODEBANK_DATA or the checkout. Where it is absent, status 77, or 1 if CI=true.

A log is a file with a suffix of SUFFIXES, or all files of a folder whose names differ in digits alone, or a folder
with several such groups. In a case gen.py first writes its files; it may need numpy and h5py, nothing else. A case
without such files (configurations and shell scripts alone) has no log.
"""
import argparse
import difflib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SUFFIXES = {".csv", ".txt", ".dat", ".bag", ".mcap", ".db3", ".mat", ".h5", ".hdf5", ".nc"}
OTHER_MODULES = re.compile(r"\b(?:import|from) .*?\b(scipy|pandas)\b")  # not on every machine that runs the tests
ROOT = pathlib.Path(__file__).resolve().parents[2]


def logs(folder):
    """The arguments of `init` for each log below a folder, with the name of each."""
    for place in sorted([folder, *(path for path in folder.rglob("*") if path.is_dir())]):
        groups = {}
        for path in sorted(place.iterdir()):
            if path.suffix in SUFFIXES:
                groups.setdefault(re.sub(r"\d+", "#", path.stem) + path.suffix, []).append(path)
        for pattern, files in groups.items():
            yield place / (pattern if len(files) > 1 else files[0].name), files
        if len(groups) > 1:
            yield place, [place]


def settings(program, files, work):
    """Exit status and settings of the configuration that `init` writes."""
    ini = work / "proposal.ini"
    ini.unlink(missing_ok=True)
    done = subprocess.run([program, "init", *files, "-o", ini], cwd=work, capture_output=True, check=False)
    lines = [f"status {done.returncode}"]
    if ini.exists():
        text = ini.read_text(encoding="utf-8", errors="backslashreplace").replace(f"{work}/", "")
        lines += [re.sub(r"  +# .*", "", line) for line in text.splitlines() if re.match(r"\w+ *=|\[", line)]
    return "\n".join(lines)


def cases(shared, work):
    """Copies the cases and lets each write its files. Yields each folder, or why it is left out."""
    for source in sorted((shared / "cases").iterdir()):
        folder = work / "cases" / source.name
        shutil.copytree(source, folder)
        folder.chmod(0o700)  # the copy of a folder that nobody may write, too
        script = folder / "gen.py"
        needed = OTHER_MODULES.search(script.read_text(encoding="utf-8")) if script.exists() else None
        if needed:
            yield folder, f"left out: gen.py needs {needed[1]}"
            continue
        if script.exists():
            subprocess.run([sys.executable, "gen.py"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        yield folder, ""


def proposals(program, shared):
    """The text of each log by its heading."""
    found = {}
    with tempfile.TemporaryDirectory() as temporary:
        work = pathlib.Path(temporary).resolve()
        shutil.copytree(shared / "data", work / "data")
        for folder, reason in [(work / "data", ""), *cases(shared, work)]:
            if reason:
                found[f"[{folder.relative_to(work)}]"] = reason
            for name, files in [] if reason else logs(folder):
                found[f"[{name.relative_to(work)}]"] = settings(program, files, work)
    return found


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program", type=os.path.abspath)
    parser.add_argument("shared", nargs="?", type=pathlib.Path)
    parser.add_argument("--compare", type=pathlib.Path)
    given = parser.parse_args()
    shared = given.shared or pathlib.Path(os.environ.get("MODEBANK_DATA") or ROOT / "../shared/data").parent
    if not (shared / "data").is_dir() or not (shared / "cases").is_dir():
        print(f"SKIPPED: the logs of ../shared/data and ../shared/cases are absent: {shared}")
        return 1 if os.environ.get("CI") == "true" else 77
    found = proposals(given.program, shared)
    if not given.compare:
        print("\n\n".join(f"{name}\n{text}" for name, text in found.items()))
        return 0
    wanted = dict(block.split("\n", 1) for block in given.compare.read_text(encoding="utf-8").strip().split("\n\n"))
    differing = [name for name in wanted if wanted[name] != found.get(name)]
    for name in differing:
        print(name, *difflib.ndiff(wanted[name].split("\n"), found.get(name, "no such log").split("\n")), "", sep="\n")
    for name in sorted(set(found) - set(wanted)):
        print("not compared, because the file does not contain it:", name)
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
