#!/usr/bin/env python3
"""Checks which folder includes which: never upward, never another folder's detail/; and that no room grows (house.py).

Usage: structure_test.py SOURCE_FOLDER. Prints one line per offence; exit status 1 if there is any.
"""
import pathlib
import re
import sys

import house

# A folder with the folders that it may include, lowest first. Subfolders without an entry belong to their parent.
IDENT = ["ident/base", "ident/data", "ident/model"]
FIT = IDENT + ["ident/model/models", "ident/fit"]
STEP = IDENT + ["filter/step"]
LIBRARIES = FIT + ["ident/lag", "ident/terms", "ident/check", "ident/simulate", "mixture", "filter/step", "filter/judge", "filter/learn", "filter/learn/chain"]
IO = ["io/files", "io/hdf5", "io/table", "io/csv", "io/arrays", "io/archive/groups", "io/archive/bank", "io/archive", "io/recording", "io/import", "io/simulation"]
BELOW_APP = LIBRARIES + IO
MAY_INCLUDE = {
    "ident/base": [],
    "ident/data": IDENT[:1],
    "ident/model": IDENT[:2],
    "ident/model/models": IDENT,
    "ident/fit": FIT,
    "ident/lag": FIT,
    "ident/terms": FIT + ["ident/lag"],
    "ident/check": FIT + ["ident/lag"],
    "ident/simulate": IDENT,
    "mixture": IDENT,
    "filter/step": IDENT,
    "filter/judge": STEP,
    "filter/learn": FIT + ["ident/lag", "mixture", "filter/step", "filter/judge"],
    "filter/learn/chain": FIT + ["ident/lag", "ident/terms", "mixture", "filter/step", "filter/judge", "filter/learn"],
    "io/files": IDENT[:1],
    "io/hdf5": IDENT[:1],
    "io/table": IDENT[:1] + ["io/files"],
    "io/csv": IDENT[:1] + ["io/files", "io/table"],
    "io/arrays": IDENT[:1] + ["io/files", "io/hdf5", "io/table"],
    "io/archive/groups": IDENT[:1] + ["io/hdf5"],
    "io/archive/bank": STEP + ["io/files", "io/hdf5", "io/archive/groups"],
    "io/archive": LIBRARIES + ["io/files", "io/hdf5", "io/archive/groups", "io/archive/bank"],
    "io/recording": IDENT[:1] + ["io/files", "io/table"],
    "io/import": FIT + ["ident/lag", "ident/check", "io/files", "io/table", "io/csv", "io/arrays", "io/recording"],
    "io/include": LIBRARIES + ["io/archive/bank"],  # modebank/modebank.hpp, which includes all installed headers
    "io/simulation": IDENT + ["ident/simulate", "io/files"],
    "app/config": BELOW_APP,
    "app/text": BELOW_APP,
    "app/chain": BELOW_APP + ["app/config", "app/text"],
    "app/study": BELOW_APP + ["app/config", "app/text", "app/chain"],
    "app/export": BELOW_APP + ["app/config", "app/text"],
    "app/report": BELOW_APP + ["app/config", "app/text", "app/chain", "app/study"],
    "app/init": BELOW_APP,
    "app/cli": BELOW_APP + [f"app/{room}" for room in ("config", "text", "chain", "study", "export", "report", "init")],
    "python/bindings": BELOW_APP + [f"app/{room}" for room in ("config", "text", "chain")],
}
# Folders of the installed headers <modebank/NAME/...>.
PUBLIC = {"base": "ident/base", "ident": "ident/model", "mixture": "mixture", "filter": "filter/step", "judge": "filter/judge",
          "learn": "filter/learn", "archive": "io/archive/bank"}
INCLUDE = r'^\s*#\s*include "([^"]+)"'
# The only detail shared by all kernels: use of the lanes of vector registers.
SHARED_DETAIL = "ident/base/detail"


def folder_of(path):
    """The named folder that a file belongs to: the longest one."""
    if installed := re.match(r"(?:\w+/include/)?modebank/(\w+)/", path):
        return PUBLIC[installed[1]]
    return max((f for f in MAY_INCLUDE if path.startswith(f + "/")), key=len, default=None)


def offence(source, header):
    home, target = folder_of(source), folder_of(header)
    if target is None:
        return None if header.startswith("tests/") else "is in no folder of the project"
    if target != home and target not in MAY_INCLUDE[home]:
        return f"{home} may not include {target}"
    owner = header.split("/detail/")[0]
    if "/detail/" in header and not header.startswith(SHARED_DETAIL) and not source.startswith(owner + "/"):
        return f"{owner}/detail belongs to {owner}"
    return None


def left_out_of_the_whole(root):
    """Installed headers that modebank/modebank.hpp does not include."""
    headers = {path.as_posix().split("/include/")[1] for path in root.glob("*/include/**/*.hpp")} - {"modebank/modebank.hpp"}
    included = set(re.findall(r'#include "([^"]+)"', (root / "io/include/modebank/modebank.hpp").read_text()))
    return [f"modebank/modebank.hpp does not include {header}" for header in sorted(headers - included)]


def upward():
    """Folders that may include a later one in the table. Without such folders there are no cycles."""
    order = list(MAY_INCLUDE)
    return [f"{home} may include {target}, which stands above it" for home in order for target in MAY_INCLUDE[home] if order.index(target) > order.index(home)]


def rooms_without_cmake_file(root):
    """Rooms of app without a library of their own."""
    return [f"{room} has no CMakeLists.txt" for room in MAY_INCLUDE if room.startswith("app/") and not (root / room / "CMakeLists.txt").exists()]


def inside_knowledge(root):
    """Private headers that a test of goldens, NIST, laws or coverage includes, if only by files of tests/."""
    bad = []
    for test in sorted((root / "tests").rglob("*_test.cpp")):
        if not re.search(r"(golden|nist|laws|coverage)_test\.cpp$", test.name):
            continue
        seen, left = set(), [test]
        while left:
            found = set(re.findall(INCLUDE, left.pop().read_text(), re.MULTILINE)) - seen
            seen |= found
            files = [root / header for header in found if header.startswith("tests/")]
            left += files + [file.with_suffix(".cpp") for file in files if file.with_suffix(".cpp").exists()]
        private = sorted(header for header in seen if not header.startswith(("modebank/", "tests/")))
        bad += [f"{test.relative_to(root)} -> {header}: is not a public header" for header in private]
    return bad


def main(root):
    bad = (left_out_of_the_whole(root) + upward() + rooms_without_cmake_file(root) + inside_knowledge(root) +
           house.offences(root))
    for folder in sorted({f.split("/")[0] for f in MAY_INCLUDE}):
        for source in sorted((root / folder).rglob("*.[hc]pp")):
            name = source.relative_to(root).as_posix()
            for header in re.findall(INCLUDE, source.read_text(), re.MULTILINE):
                if reason := offence(name, header):
                    bad.append(f"{name} -> {header}: {reason}")
    print("\n".join(bad))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
