#!/bin/sh
# Builds and installs the committed tree's Python module by pip in an empty Debian 12. Usage: test_pip.sh ROOT
set -eu
root=$(realpath -m "$1")
cd "$(dirname "$0")/.."
files=$(mktemp -d)
trap 'rm -rf "$files"' EXIT
git archive --output="$files/source.tar" HEAD
packaging/with_root.sh bookworm "$root" packaging/inside_pip.sh "$files/source.tar"
