#!/usr/bin/env python3
"""Checks that the reference has every key, command, term, dataset of an archive and public header, and that pages agree.

Usage: reference.py BUILD_FOLDER. What the program has is asked of it by other ways than the pages are made by.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import h5py

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv[1]).resolve()
os.environ["MODEBANK_BUILD"] = str(BUILD)
sys.path.insert(0, str(ROOT / "docs/_ext"))
import archive_layout  # noqa: E402  its folder is added above
import program  # noqa: E402

SMALL_DEMO = ["--data.label=mode", "--simulate.runs=4", "--simulate.samples=80", "--mixture.components=1..2", "--mixture.restarts=1",
              "--filter.horizon=1,2", "--filter.simulate=5"]
README_LINES = 100
problems = []


def expect(condition, problem):
    if not condition:
        problems.append(problem)


def modebank(*words):
    return subprocess.run([str(BUILD / "modebank"), *words], capture_output=True, text=True)


def page(name):
    text = (ROOT / "docs/reference" / name).read_text(encoding="utf-8")
    for what, make in program.PAGES.items():
        text = text.replace(f"<!-- modebank: {what} -->", make())
    return text


def keys():
    """As an archive's resolved configuration names them."""
    with h5py.File(archive()) as file:
        config = file["config"][()]
    section = ""
    for line in (config.decode() if isinstance(config, bytes) else str(config)).splitlines():
        if re.match(r"\[\w+\]", line):
            section = line.strip("[]")
        elif "=" in line and not line.startswith("#"):
            yield f"{section}.{line.split('=')[0].strip()}"


def archive():
    if not hasattr(archive, "path"):
        folder = tempfile.mkdtemp(prefix="modebank-reference-")
        done = modebank("demo", "-o", f"{folder}/demo", *SMALL_DEMO)
        if done.returncode != 0:
            sys.exit(f"the demo fails: {done.stderr}")
        archive.path = f"{folder}/demo/demo.h5"
    return archive.path


def dataset_names():
    names = set()
    with h5py.File(archive()) as file:
        file.visit(lambda path: names.update(path.split("/")))
        file.visititems(lambda path, thing: names.update(thing.dtype.names or ()) if isinstance(thing, h5py.Dataset) else None)
    return names


def sample_arrays():
    """Arrays over the samples of all runs: by name the number of extents after the samples'."""
    with h5py.File(archive()) as file:
        samples = int(file["data/runs"]["samples"].sum())
        return {name: item.ndim - 1 for group in ("data", "evaluation/bank") for name, item in file[group].items() if item.shape[0] == samples}


def has_words(name, text):
    return re.search(rf"(?<![A-Za-z0-9]){re.escape(name)}(?![A-Za-z0-9])", text) is not None


def check_names():
    text = page("keys.md")
    for key in set(keys()):
        expect(f"{{confval}} {key}\n" in text, f"docs/reference/keys.md has no key {key}")
    text = page("commands.md")
    for command in re.search(r"commands are (.*)", modebank("no-such-command").stderr)[1].split(", "):
        expect(f"{{command}} {command.strip()}" in text, f"docs/reference/commands.md has no command {command}")
    text = page("glossary.md")
    for entry in program.terms():
        expect(f"\n{entry['term']}\n" in text and entry["means"] in text, f"docs/reference/glossary.md has no term {entry['term']}")
        said = modebank("help", entry["term"]).stdout
        expect(entry["means"] in said or said.startswith("["), f"modebank help {entry['term']} says something else")  # unless a section has this name, which takes precedence
    text = page("cpp.md")
    for header in subprocess.run(["git", "-C", ROOT, "ls-files", "*/include/*.hpp"], capture_output=True, text=True).stdout.split():
        expect(header in text, f"docs/reference/cpp.md has no {header}")
    text = page("archive.md")
    for name in archive_layout.Layout().unused():
        expect(False, f"io/archive describes {name}, which its function does not exchange")
    for name in dataset_names():
        expect(has_words(name, text), f"docs/reference/archive.md has no {name}")
    for name, extents in sample_arrays().items():
        letters = "S" + r",\w+" * extents
        expect(re.search(rf"\b{name} \({letters}\W", text), f"docs/reference/archive.md has {name} without its shape")


def check_files():
    lines = (ROOT / "README.md").read_text(encoding="utf-8").count("\n")
    expect(lines <= README_LINES, f"README.md has {lines} lines, more than {README_LINES}")
    made = subprocess.run([sys.executable, str(ROOT / "docs/reference_ini.py")], capture_output=True, text=True).stdout
    expect(made == (ROOT / "configs/reference.ini").read_text(encoding="utf-8"), "configs/reference.ini is not what the program says: make reference-ini")
    version = re.search(r"project\(modebank VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    expect(f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text(), f"CITATION.cff is not of version {version}")
    expect(f"\n## {version}" in (ROOT / "CHANGELOG.md").read_text(), f"CHANGELOG.md has no version {version}")


check_names()
check_files()
print("\n".join(problems))
sys.exit(1 if problems else 0)
