#!/bin/sh
# Runs tests of the pages' scripts: scripts_test.sh TEST.js... Skips loudly without node, or fails where everything must be
# there.
set -eu
if ! command -v node >/dev/null; then
  echo "SKIPPED: node is missing (Debian package nodejs)"
  [ "${CI:-}" = true ] && exit 1
  exit 77
fi
exec node --test "$@"
