#!/usr/bin/env python3
"""Checks the spelling of pages: hunspell's British dictionary with words.txt in this folder, and codespell.

Usage: check_spelling.py FILE|FOLDER... Prints each unknown word with the files that hold it; exit status 1 if there is any.
"""
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).parent
NOT_PROSE = re.compile(r"^(`{3,}).*?^\1`*$|<!--.*?-->|\$\$.*?\$\$|\{\w+\}`[^`]*`|`[^`]*`|\$[^$\n]+\$|\]\([^)]*\)|https?://\S+|<[^>\n]+>|^\(.*\)=$|\{cite\}\S+",
                       re.M | re.S)


def prose(text):
    """The text without code, formulas, link targets and names with digits, underscores or points."""
    text = re.sub(r"'s\b", "", NOT_PROSE.sub(" ", text))
    return re.sub(r"\S*[\d_/\\@=]\S*|\w+\.\w+\S*|\b[A-Z]{2,}s?\b", " ", text)


def unknown_words(text):
    out = subprocess.run(["hunspell", "-l", "-d", "en_GB", "-i", "UTF-8", "-p", str(HERE / "words.txt")], input=text, capture_output=True,
                         text=True, check=True).stdout
    return set(out.split())


def main(paths):
    files = [file for path in map(pathlib.Path, paths) for file in ([path] if path.is_file() else sorted(path.rglob("*.md")))]
    texts = {file: prose(file.read_text(encoding="utf-8")) for file in files}
    bad = 0
    for word in sorted(unknown_words("\n".join(texts.values()))):
        holders = [str(file) for file, text in texts.items() if re.search(rf"\b{re.escape(word)}\b", text)]
        print(f"{word}: {', '.join(holders[:3])}")
        bad += 1
    bad += subprocess.run(["codespell", "-q", "3", "-L", "nees,vell", *map(str, files)]).returncode != 0
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
