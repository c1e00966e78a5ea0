#!/usr/bin/env python3
"""A page of every kind in Debian's Firefox: firefox_test.py PROGRAM SOURCE_FOLDER WORK_FOLDER

Run, comparison, study and the overview of `modebank view`, opened by puppeteer-core (firefox.cjs).
"""
import os
import pathlib
import shutil
import subprocess
import sys

import archives

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "app/view"))
from server import Server  # noqa: E402


def main():
    program, source, work = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    modebank = archives.Modebank(program, source, work)
    data = archives.demo_data(modebank)
    demo, one = (archives.demo(modebank, data, name, "--mixture.components", components) for name, components in (("demo", "1..4"), ("one_mode", "1")))
    pages = [modebank.page("run", demo), modebank.page("compare", demo, one), modebank.page("of_study", archives.study(modebank, data))]
    folder = work / "view"
    folder.mkdir()
    shutil.copy(demo, folder)
    server = Server(program, folder)
    try:
        urls = [page.as_uri() for page in pages] + [f"http://{server.host}/?token={server.token}"]
        run = subprocess.run(["node", pathlib.Path(__file__).with_name("firefox.cjs"), *urls],
                             env=os.environ | {"NODE_PATH": str(source / "build/npm/node_modules")})
    finally:
        server.stop()
    return run.returncode


if __name__ == "__main__":
    sys.exit(main())
