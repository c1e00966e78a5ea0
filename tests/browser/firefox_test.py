#!/usr/bin/env python3
"""A page of every kind in Debian's Firefox: firefox_test.py PROGRAM SOURCE_FOLDER WORK_FOLDER

Run, comparison, study and the index of a folder, opened by puppeteer-core (firefox.cjs).
"""
import os
import pathlib
import shutil
import subprocess
import sys

import archives


def main():
    program, source, work = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    modebank = archives.Modebank(program, source, work)
    data = archives.demo_data(modebank)
    demo, one = (archives.demo(modebank, data, name, "--mixture.components", components) for name, components in (("demo", "1..4"), ("one_mode", "1")))
    pages = [modebank.page("run", demo), modebank.page("compare", demo, one), modebank.page("of_study", archives.study(modebank, data))]
    folder = work / "results"
    folder.mkdir()
    shutil.copy(demo, folder)
    modebank("report", folder, "-o", work / "site")
    urls = [page.as_uri() for page in [*pages, work / "site/index.html"]]
    run = subprocess.run(["node", pathlib.Path(__file__).with_name("firefox.cjs"), *urls],
                         env=os.environ | {"NODE_PATH": str(source / "build/npm/node_modules")})
    return run.returncode


if __name__ == "__main__":
    sys.exit(main())
