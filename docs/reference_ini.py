#!/usr/bin/env python3
"""Prints configs/reference.ini: every key at its default, with its help. `make reference-ini` writes it; a test compares."""
import pathlib
import sys
import textwrap

sys.path.insert(0, str(pathlib.Path(__file__).parent / "_ext"))
import program  # noqa: E402  its folder is added above

HEAD = """# Every key at its default, written by `make reference-ini`: to look up, and to copy lines from. A configuration needs [data] alone;
# minimal.ini has its five lines. After each help text stand what is allowed and the unit.
"""


def comment(text):
    return "\n".join(textwrap.wrap(text, 120, initial_indent="# ", subsequent_indent="# ", break_on_hyphens=False))


def main():
    print(HEAD, end="")
    section = None
    for key in program.described()["keys"]:
        if key["key"].split(".")[0] != section:
            section = key["key"].split(".")[0]
            print(f"\n[{section}]")
        print(comment(f"{key['help']} ({key['allowed']}{'; ' + key['unit'] if key['unit'] else ''})"))
        print(f"{key['key'].split('.')[1]} = {key['default']}".rstrip())


if __name__ == "__main__":
    main()
