#!/usr/bin/env python3
"""Checks that the built pages can be searched without a server or a network, opened from disk.

Usage: check_search.py HTML_FOLDER. Asks search.html in a headless chromium; exit status 1, with what was found, where a page is missing.
"""
import pathlib
import re
import subprocess
import sys
import tempfile
import urllib.parse

# What a reader types, and a page that must be found.
WANTED = {"rank deficient": "howto/poor_excitation.html", "window.length": "reference/keys.html#confval-window.length"}


def found(folder, words):
    with tempfile.TemporaryDirectory() as profile:
        page = subprocess.run(
            ["chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}", "--host-resolver-rules=MAP * ~NOTFOUND",
             "--virtual-time-budget=8000", "--dump-dom", f"{(folder / 'search.html').resolve().as_uri()}?q={urllib.parse.quote(words)}"],
            check=True, capture_output=True, text=True, timeout=300).stdout
    results = re.search(r'<ul class="search">(.*?)</ul>', page, re.S)
    return re.findall(r'<a href="([^"?]*)', results[1]) if results else []


def main():
    folder = pathlib.Path(sys.argv[1])
    status = 0
    for words, page in WANTED.items():
        pages = found(folder, words)
        if page not in pages:
            print(f"docs/check_search.py: searching for \"{words}\" finds {', '.join(pages) or 'nothing'}, but not {page}")
            status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
