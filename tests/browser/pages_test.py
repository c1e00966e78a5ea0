#!/usr/bin/env python3
"""The report's pages in headless Chromium: pages_test.py PROGRAM SOURCE_FOLDER WORK_FOLDER [TEST...]

Makes pages of every kind and checks that each section draws without a console error or a request, that zoom, hover,
click-through and sorting work, and that the numbers shown are the archive's. Pages and screenshots stay in
WORK_FOLDER/pages.
"""
import os
import pathlib
import sys
import unittest


def leave(reason):
    """Skips the test; in the nightly run, where every tool is installed, it fails."""
    print(f"SKIPPED: {reason}")
    sys.exit(1 if os.environ.get("CI") == "true" else 77)


try:
    import h5py  # noqa: F401
    import selenium  # noqa: F401
except ImportError as error:
    leave(f"{error.name} is absent: apt-get install python3-h5py python3-selenium")
for program, package in (("chromium", "chromium"), ("chromedriver", "chromium-driver")):
    if not os.path.exists(f"/usr/bin/{program}"):
        leave(f"{program} is absent: apt-get install {package}")

import session  # noqa: E402
from compare_page import ComparePage  # noqa: E402, F401
from looking_around import LookingAround  # noqa: E402, F401
from run_pages import RunPages  # noqa: E402, F401
from study_page import StudyPage  # noqa: E402, F401

TESTS = ["ComparePage", "LookingAround", "RunPages", "StudyPage"]

if __name__ == "__main__":
    program, source, folder = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    try:
        session.start(program, source, folder / "pages")
        result = unittest.main(argv=[sys.argv[0], *(sys.argv[4:] or TESTS)], verbosity=2, exit=False).result
    finally:
        session.stop()
    sys.exit(not result.wasSuccessful())
