#!/usr/bin/env python3
"""Checks that the tables of docs/results belong to the present commands, configurations and data.

Each table stands under a block that says how it was made:

    ```{made} make uncertainty
    :revision: 3245912
    :date: 2026-11-21
    :machine: Intel Xeon, 2 cores
    :reads: tests/bench/measure_coverage.cpp      what the command is made of, beside the program
    :data: borealtc/ICE                           folders of the data folder
    :hash: of the command and of what it reads
    :data_hash: of the data's names and contents
    ```

Usage: check_results.py [--record] [--data FOLDER] FILE... Prints a line for each block that no longer fits and has no `:older:`, which
says what the reader should know; exit status 1 if there is any. Data are checked where they are. --record writes the hashes, those of
what the revision of the block had; run it where a table was made anew.
"""
import argparse
import hashlib
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BLOCK = re.compile(r"^```\{made\} (?P<command>.+)\n(?P<fields>(?::\w+:.*\n)*)```$", re.M)


def fields_of(block):
    return dict(re.findall(r"^:(\w+):[ ]*(.*)$", block["fields"], re.M))


def content(path, revision=None):
    if revision is None:
        return (ROOT / path).read_bytes() if (ROOT / path).is_file() else b""
    shown = subprocess.run(["git", "-C", ROOT, "show", f"{revision}:{path}"], capture_output=True)
    return shown.stdout


def code_only(path, data):
    """The text without comments, which do not affect results."""
    return b"\n".join(line for line in (re.sub(rb"(^|\s)#.*", b"", line).rstrip() for line in data.split(b"\n")) if line) \
        if path.endswith(".ini") else data


def hash_of(command, reads, revision=None):
    digest = hashlib.sha256(command.encode())
    for path in reads.split():
        digest.update(b"\0" + path.encode() + b"\0" + code_only(path, content(path, revision)))
    return digest.hexdigest()[:12]


def data_hash(folder, names):
    digest = hashlib.sha256()
    for name in names.split():
        for file in sorted(path for path in (folder / name).rglob("*") if path.is_file() and path.suffix != ".md"):
            digest.update(str(file.relative_to(folder)).encode() + b"\0" + hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()[:12]


def has_data(folder, names):
    return folder is not None and all((folder / name).is_dir() for name in names.split())


def recorded(block, folder):
    fields = fields_of(block)
    fields["hash"] = hash_of(block["command"], fields.get("reads", ""), fields["revision"])
    if "data" in fields and has_data(folder, fields["data"]):
        fields["data_hash"] = data_hash(folder, fields["data"])
    lines = "".join(f":{name}: {value}\n" for name, value in fields.items())
    return f"```{{made}} {block['command']}\n{lines}```"


def complaints(block, folder):
    fields = fields_of(block)
    for name in ("revision", "date", "machine", "hash"):
        if name not in fields:
            yield f"has no {name}"
    if fields.get("hash") != hash_of(block["command"], fields.get("reads", "")):
        yield f"the command or what it reads ({fields.get('reads', 'nothing')}) has changed since {fields.get('revision')}"
    if "data" in fields and has_data(folder, fields["data"]) and fields.get("data_hash") != data_hash(folder, fields["data"]):
        yield f"the data ({fields['data']}) are not those it was made with"


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--record", action="store_true")
    arguments.add_argument("--data", type=pathlib.Path)
    arguments.add_argument("files", nargs="+", type=pathlib.Path)
    given = arguments.parse_args()
    bad = 0
    for file in given.files:
        text = file.read_text(encoding="utf-8")
        if given.record:
            file.write_text(BLOCK.sub(lambda block: recorded(block, given.data), text), encoding="utf-8")
            continue
        for block in BLOCK.finditer(text):
            for complaint in complaints(block, given.data):
                if "older" in fields_of(block):
                    continue
                print(f"{file}:{text.count(chr(10), 0, block.start()) + 1}: {block['command']}: {complaint}")
                bad += 1
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
