#!/usr/bin/env python3
"""Counts the lines, files and tokens of each room, for the table tests/house.csv, which holds the size of the house.

Usage: house.py, in the root: puts the present counts into the table (`make house`). tests/structure_test.py checks
them: the table equals the tree, no number exceeds both that of the parent's table and the room's aim, and no Python
statement ends in a semicolon. The parent is HEAD where the tree differs from it, else HEAD's first parent. Counted is
every tracked text file but pages, golden data and seeds of fuzzing; tokens without comments.
"""
import csv
import io
import os
import pathlib
import re
import subprocess
import tokenize

TABLE = "tests/house.csv"
NUMBERS = ["lines", "files", "tokens", "long_python_lines"]
BUILD = [".ci/", "cmake/", "packaging/", "Makefile", "CMakeLists.txt", "CMakePresets.json", "setup.py",
         "pyproject.toml", "modebank-config.cmake"]
# Room, what belongs to it (the first room that fits), and its aim: lines, files, tokens per line.
ROOMS = {
    "ident": (["ident/"], 6650, 90, 9.3),
    "mixture": (["mixture/"], 2300, 24, 9.3),
    "filter": (["filter/"], 10850, 120, 9.3),
    "io": (["io/"], 9500, 130, 9.3),
    "python": (["python/"], 1500, 20, 11.5),
    "page": (["app/report/web/"], 1900, 18, 13.0),
    "app": (["app/"], 13300, 125, 9.3),
    "tests": (["tests/"], 25250, 280, 11.0),
    "build": (BUILD, 800, 30, 12.0),
    "docs": (["docs/"], 300, 8, 14.5),
    "configs": (["configs/"], 800, 20, 4.0),
}
FREE = re.compile(r"\.md$|^tests/golden/data/|^tests/fuzz/(corpus|seeds)/|^docs/pictures/|"
                  r"^(\.gitignore|\.clang-format|\.clang-tidy|CITATION\.cff|Doxyfile|LICENSE)$")
BINARY = re.compile(r"\.(h5|hdf5|mat|bag|mcap|db3|bin|gz|png|svg|ico|npz|bz2|lz4|zst)$")
TOKEN = re.compile(r"""[A-Za-z_]\w*|\d[\w.']*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'"""
                   r"""|->|<<|>>|::|&&|\|\||[<>=!+\-*/&|^%]=|[^\s\w]""")
BLOCK_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.S)
HASH_COMMENT = re.compile(r"#[^\n]*")
HASHES = re.compile(r"\.(py|pyi|sh|R|m|cmake|txt|ini)$|Makefile$")
MOST_COLUMNS = 120


def git(root, *arguments):
    done = subprocess.run(["git", "-C", root, *arguments], capture_output=True, check=True)
    return done.stdout.decode("utf-8", "replace")


def room_of(path):
    for room, (places, *_) in ROOMS.items():
        if any(path.startswith(place) if place.endswith("/") else path == place for place in places):
            return room
    return None


def is_python(path, text):
    return path.endswith((".py", ".pyi")) or text.startswith("#!") and "python3" in text.split("\n", 1)[0]


def joined_statements(path, text):
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    semicolons = [token for token in tokens if token.type == tokenize.OP and token.string == ";"]
    return [f"{path}:{token.start[0]}: a semicolon" for token in semicolons]


def measure(root):
    """Counts by room, and offences of single files."""
    counts, offences = {room: dict.fromkeys(NUMBERS, 0) for room in ROOMS}, []
    for path in git(root, "ls-files", "-z").split("\0"):
        file = root / path
        if not path or FREE.search(path) or BINARY.search(path) or not file.is_file():
            continue
        room = room_of(path)
        if room is None:
            offences.append(f"{path}: in no room of tests/house.py")
            continue
        text = file.read_bytes().decode("utf-8", "replace")
        here = counts[room]
        here["lines"] += text.count("\n")
        here["files"] += 1
        comment = HASH_COMMENT if HASHES.search(path) else BLOCK_COMMENT
        here["tokens"] += len(TOKEN.findall(comment.sub("", text)))
        if is_python(path, text):
            here["long_python_lines"] += sum(len(line) > MOST_COLUMNS for line in text.split("\n"))
            offences += joined_statements(path, text)
    return counts, offences


def text_of(counts):
    rows = [["room", *NUMBERS]] + [[room, *here.values()] for room, here in counts.items()]
    return "".join(",".join(map(str, row)) + "\n" for row in rows)


def write(root):
    for _ in range(2):  # the table is in a room, too
        (root / TABLE).write_text(text_of(measure(root)[0]))


def read(text):
    return {row["room"]: {name: int(row[name] or 0) for name in NUMBERS} for row in csv.DictReader(io.StringIO(text))}


def parent_of(root):
    """The parent's table; a sentence that says what is missing where there is none."""
    revision = "HEAD" if git(root, "status", "--porcelain", "--untracked-files=no") else "HEAD^1"
    try:
        git(root, "rev-parse", "--verify", revision)
    except subprocess.CalledProcessError:
        return f"this clone has no {revision}"
    try:
        return read(git(root, "show", f"{revision}:{TABLE}"))
    except subprocess.CalledProcessError:
        return f"{revision} has no {TABLE} yet"


def growth(counts, parent):
    for room, here in counts.items():
        _, lines, files, density = ROOMS[room]
        aims = {"lines": lines, "files": files, "tokens": int(lines * density), "long_python_lines": 0}
        for name, number in here.items():
            most = max(parent.get(room, {}).get(name, 0), aims[name])
            if number > most:
                yield f"{room} has {number} {name.replace('_', ' ')}; the parent and the aim allow {most}"


def offences(root):
    """A line for each offence. What cannot be compared is skipped by name; in CI a missing parent is an offence."""
    try:
        git(root, "rev-parse", "--git-dir")
    except (OSError, subprocess.CalledProcessError):
        print("SKIPPED: sizes of rooms: this is no git repository")
        return []
    counts, found = measure(root)
    table = root / TABLE
    if not table.exists() or read(table.read_text()) != counts:
        found.append(f"{TABLE} does not equal the tree: make house")
    parent = parent_of(root)
    if not isinstance(parent, str):
        return found + list(growth(counts, parent))
    if os.environ.get("CI") == "true" and "clone" in parent:
        return [*found, f"sizes of rooms: {parent}"]
    print(f"SKIPPED: sizes of rooms: {parent}")
    return found


if __name__ == "__main__":
    write(pathlib.Path("."))
