#!/usr/bin/env python3
"""Runs the examples on pages and compares their output with the pages; docs/developing/testing.md explains the marks of blocks.

Usage: examples.py [--update] [--data FOLDER] BUILD_FOLDER PAGE... Exit status 1 if a block differs or fails. Without the data
that a page needs it is 77, with CI=true it is 1. The data folder is FOLDER, else $MODEBANK_DATA, else
../shared/data. --update writes what is printed now into the pages, all of it where a line says ???.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = re.compile(r"(?P<marks>(?:^<!-- [\w ]+: [^\n]*? -->\n+)*)^```(?P<language>\w+)\n(?P<text>.*?)^```$", re.M | re.S)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
SKIPPED = 77
DEFAULT_TOLERANCE = 0.02
TIMEOUT_S = 900


class Differs(Exception):
    pass


def marks_of(block):
    return dict(re.findall(r"<!-- ([\w ]+): (.*?) -->", block["marks"]))


def skeleton(line):
    """A line without its numbers and its widths of columns."""
    return re.sub(r"[\s-]+", " ", NUMBER.sub("#", line)).strip()


def same_number(shown, printed, tolerance):
    a, b = float(shown), float(printed)
    last_digit = 10.0 ** -len(shown.partition(".")[2].partition("e")[0])
    return abs(a - b) <= max(tolerance * max(abs(a), abs(b)), 1.01 * last_digit if "e" not in shown else 0)


def same_line(shown, printed, tolerance):
    if skeleton(shown) != skeleton(printed):
        return False
    return all(same_number(a, b, tolerance) for a, b in zip(NUMBER.findall(shown), NUMBER.findall(printed)))


def parts_of(shown):
    """The lists of lines between lines "..."."""
    parts = [[]]
    for line in shown:
        if line.strip() == "...":
            parts.append([])
        else:
            parts[-1].append(line)
    return parts


def place_of(part, printed, begin, alike):
    for at in range(begin, len(printed) - len(part) + 1):
        if all(alike(a, b) for a, b in zip(part, printed[at:])):
            return at
    return None


def places_of(shown, printed, alike):
    """Positions in the output of each shown part; None for the first one that is missing."""
    parts, places, begin = parts_of(shown), [], 0
    for index, part in enumerate(parts):
        at = place_of(part, printed, begin, alike)
        if at is None or (index == 0 and at != 0 and part):
            return parts, None
        places.append(at)
        begin = at + len(part)
    if len(parts) == 1 and begin != len(printed):
        return parts, None
    return parts, places


def compare(shown, printed, tolerance):
    if places_of(shown, printed, lambda a, b: same_line(a, b, tolerance))[1] is None:
        raise Differs("shown:\n" + "\n".join(shown) + "\nprinted:\n" + "\n".join(printed))


def renewed(shown, printed):
    """All of what is printed in place of a line ???; else what is printed now in place of what is shown, with the same lines left out where the words are the same."""
    if shown == ["???"]:
        return printed
    parts, places = places_of(shown, printed, lambda a, b: skeleton(a) == skeleton(b))
    if places is None:
        return [*printed, "..."] if len(parts) > 1 else printed
    lines = []
    for index, (part, at) in enumerate(zip(parts, places)):
        lines += (["..."] if index else []) + printed[at:at + len(part)]
    return lines


class NoData(Exception):
    pass


class Page:
    def __init__(self, path, arguments):
        self.path, self.arguments = path, arguments
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="modebank-page-"))
        (self.folder / "build").symlink_to(arguments.build)  # README's commands are typed before an installation
        self.environment = dict(os.environ, PATH=f"{arguments.build}{os.pathsep}{os.environ['PATH']}", COLUMNS="100", NO_COLOR="1",
                                PYTHONPATH=str(arguments.build / "python"), MODEBANK_SOURCE=str(ROOT))

    def run(self, words, text=None):
        done = subprocess.run(words, cwd=self.folder, env=self.environment, input=text, capture_output=True, text=True, timeout=TIMEOUT_S)
        if done.returncode != 0:
            raise Differs(f"exit status {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout

    def console(self, text, tolerance):
        """The block's text with the present output."""
        pieces = re.split(r"^\$ ", text, flags=re.M)
        renewed_text = pieces[0]
        for piece in pieces[1:]:
            command, shown = re.match(r"((?:[^\n]*\\\n)*[^\n]*\n)(.*)", piece, re.S).groups()
            shown = shown.splitlines()
            printed = [line.rstrip() for line in self.run(["bash", "-c", command]).splitlines()]
            if self.arguments.update:
                shown = renewed(shown, printed)
            else:
                compare(shown, printed, tolerance)
            renewed_text += "$ " + command + "".join(f"{line}\n" for line in shown)
        return renewed_text

    def copy_data(self, names):
        for name in names.split():
            if not (self.arguments.data / name).exists():
                raise NoData(f"needs {name} of the data folder")
            shutil.copy(self.arguments.data / name, self.folder)

    def block(self, block):
        marks, language, text = marks_of(block), block["language"], block["text"]
        if "data" in marks:
            self.copy_data(marks["data"])
        if "file" in marks:
            (self.folder / marks["file"]).write_text(text, encoding="utf-8")
        elif "run by" in marks:
            if not re.search(rf"^{re.escape(marks['run by'])}:", (ROOT / "Makefile").read_text(), re.M):
                raise Differs(f"the Makefile has no target {marks['run by']}")
        elif language == "console":
            text = self.console(text, float(marks.get("tolerance", DEFAULT_TOLERANCE)))
        elif language == "python":
            self.run(["/usr/bin/python3", "-"], text)
        elif language == "cpp":
            if not any(text.strip() in source.read_text() for source in (ROOT / "tests/examples").glob("*.cpp")):
                raise Differs("no file of tests/examples holds this")
        elif language not in ("text",):
            raise Differs(f"a {language} block that nothing runs: console, python, cpp, or <!-- file: NAME --> or <!-- run by: TARGET -->")
        return f"{block['marks']}```{block['language']}\n{text}```"

    def blocks(self):
        page = self.path.read_text(encoding="utf-8")
        bad, out, end = 0, "", 0
        for block in BLOCK.finditer(page):
            try:
                text = self.block(block)
            except (Differs, subprocess.TimeoutExpired) as error:
                bad, text = bad + 1, block[0]
                print(f"{self.path}:{page.count(chr(10), 0, block.start('language')) + 1}: {error}\n", flush=True)
            except NoData as missing:
                print(f"SKIPPED: {missing}: set MODEBANK_DATA; the rest of {self.path.name} is not run", flush=True)
                required = os.environ.get("CI") == "true"
                sys.exit(1 if bad or required else SKIPPED)
            out += page[end:block.start()] + text
            end = block.end()
        if self.arguments.update:
            self.path.write_text(out + page[end:], encoding="utf-8")
        return bad


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--update", action="store_true")
    parser.add_argument("--data", type=pathlib.Path, default=os.environ.get("MODEBANK_DATA") or ROOT / "../shared/data")
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("pages", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    arguments.build = arguments.build.resolve()
    bad = 0
    for path in arguments.pages:
        page = Page(path, arguments)
        try:
            bad += page.blocks()
        finally:
            shutil.rmtree(page.folder)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
