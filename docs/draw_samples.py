#!/usr/bin/env python3
"""Prints what readers are asked to mark: one paragraph, message or comment per line, as `shuf` takes it (docs/results/words.md).

  draw_samples.py paragraphs|messages|comments | shuf -n 20 --random-source=<(openssl enc -aes-256-ctr -pass pass:SEED -nosalt -iter 1 </dev/zero 2>/dev/null)

paragraphs: of README.md and docs/, without code, tables, headings and what is made by commands. messages: text of at least four words
in the sources of the program and its libraries. comments: each block of consecutive comment lines of the sources and their tests.
"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def files(*patterns):
    listed = subprocess.run(["git", "ls-files", *patterns], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    return [(name, (ROOT / name).read_text(encoding="utf-8", errors="replace")) for name in listed]


def line_of(text, at):
    return text.count("\n", 0, at) + 1


def paragraphs():
    for name, text in files("README.md", "docs/*.md"):
        blank = re.sub(r"(?ms)^ *(`{3,}|:{3,}).*?^ *\1 *$|<!--.*?-->", lambda match: "\n" * match.group().count("\n"), text)
        for match in re.finditer(r"(?m)(?:^(?![#|:<\s]).+\n?)+", blank):
            if len(match.group().split()) >= 8:
                yield name, line_of(blank, match.start()), match.group()


def messages():
    for name, text in files("*.cpp", "*.hpp", ":!tests", ":!docs"):
        code = re.sub(r"(?m)//.*$|^ *#.*$", "", text)
        for match in re.finditer(r'(?:"(?:[^"\\\n]|\\.)*"\s*)+', code):
            words = re.sub(r'"\s*"', "", match.group().strip()).strip('"')
            if len(re.findall(r"[A-Za-z]{2,}", words)) >= 4:
                yield name, line_of(code, match.start()), words


def comments():
    for name, text in files("*.cpp", "*.hpp", "*.js"):
        for match in re.finditer(r"(?m)(?:^ *//[/!<]* .*\n)+|(?<=[;{},)]) +//[/!<]* .*\n(?: +//[/!<]* .*\n)*", text):
            said = re.sub(r"(?m)^ *//[/!<]*", "", match.group().strip())
            if len(said.split()) >= 3 and "Copyright" not in said:
                yield name, line_of(text, match.start()), said


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1] not in ("paragraphs", "messages", "comments"):
        sys.exit(__doc__)
    for where, number, what in {"paragraphs": paragraphs, "messages": messages, "comments": comments}[sys.argv[1]]():
        print(f"{where}:{number}: {' '.join(what.split())}")
