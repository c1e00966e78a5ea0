#!/bin/sh
# Runs tests of the pages' scripts, bundled like the pages: scripts_test.sh TEST.js... Without node it skips them; with
# CI=true it fails instead.
set -eu
if ! command -v node >/dev/null; then
  echo "SKIPPED: node is absent: apt-get install nodejs"
  [ "${CI:-}" = true ] && exit 1
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
web=$(dirname "$1")/..
ln -s "$(realpath "$web")"/*.json "$folder"
NODE_PATH=/usr/share/nodejs esbuild --bundle --platform=node --format=esm --charset=utf8 --log-level=warning \
  --out-extension:.js=.mjs --outdir="$folder/test" "$@"
node --test "$folder/test"
