#!/usr/bin/env python3
"""Names every test that ctest skipped, with the reason, and the instruction sets that vector kernels ran.

Usage: skipped.py JUNIT_FILE (ctest --output-junit). Prints the lines that `make test` ends with. Exit status 1 if a
skipped test is not in allowed_skips.txt, which lists those that a bare root skips; with CI=true none is allowed.
"""
import collections
import fnmatch
import os
import pathlib
import re
import sys
import xml.etree.ElementTree

REASON = re.compile(r"^SKIPPED: (.*)|.*\.\.\. skipped ['\"](.*)['\"]$|^(this machine has no instruction set .*)")
KERNELS = re.compile(r"^vector kernels: (\S+)$", re.M)
END = re.compile(r"^\[ +SKIPPED +\]|^\[-+\]|^$")


def reasons(output):
    """Reasons in the output of one test program: of GoogleTest, of unittest, or lines SKIPPED: REASON."""
    found, lines = [], iter(output.splitlines())
    for line in lines:
        line = line.strip()
        if line.endswith(": Skipped"):
            text = []
            for below in lines:
                if END.match(below.strip()):
                    break
                text.append(below.strip())
            found.append(" ".join(text))
        elif match := REASON.match(line):
            found.append(next(group for group in match.groups() if group))
    return list(dict.fromkeys(found))


def main():
    skipped, kernels, whole = collections.defaultdict(list), collections.Counter(), 0
    for case in xml.etree.ElementTree.parse(sys.argv[1]).iter("testcase"):
        name, output = case.get("name").split("  # ")[0], case.findtext("system-out") or ""
        kernels.update(set(KERNELS.findall(output)))
        is_skipped = case.find("skipped") is not None or case.get("status") in ("notrun", "disabled")
        whole += is_skipped
        given = reasons(output)
        for reason in given or (["no reason is given"] if is_skipped else []):
            skipped[reason].append(name if is_skipped else f"{name} (in part)")
    if kernels:
        print("vector kernels, and the number of tests that ran them: " + ", ".join(f"{name} {count}" for name, count in sorted(kernels.items())))
    for reason, names in sorted(skipped.items()):
        for name in names:
            print(f"skipped: {name}: {reason}")
    in_part = len({name for names in skipped.values() for name in names if name.endswith("(in part)")})
    print(f"{whole} tests were skipped" + (f", {in_part} in part" if in_part else "") + ".")
    return not_allowed({name for names in skipped.values() for name in names})


def not_allowed(names):
    """Prints the skipped tests that may not be skipped here; 1 if there are any."""
    lines = (pathlib.Path(__file__).parent / "allowed_skips.txt").read_text(encoding="utf-8").splitlines()
    patterns = [line.split()[0] for line in lines if line and not line.startswith("#")]
    if os.environ.get("CI") == "true":
        patterns = []
    bad = [name for name in names if not any(fnmatch.fnmatchcase(name.removesuffix(" (in part)"), p) for p in patterns)]
    for name in sorted(bad):
        print(f"modebank: {name} may not be skipped here (tests/allowed_skips.txt)")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
