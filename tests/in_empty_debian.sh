#!/bin/bash
# README's two commands as they stand there, in bare roots of Debian with `make` and `git` alone: the committed source.
# Prints the times of each and the versions of the tools. After a failure build/SUITE is kept; `chroot build/SUITE` enters it.
# Usage: in_empty_debian.sh [SUITE...]: bookworm (Debian 12), trixie (Debian 13); by default both.
set -eu
cd "$(dirname "$0")"

if [ ! -e source.bundle ]; then
  cd ..
  mkdir -p build
  git bundle create -q build/source.bundle HEAD
  [ $# -gt 0 ] || set -- bookworm trixie
  for suite in "$@"; do packaging/with_root.sh "$suite" "build/$suite" tests/in_empty_debian.sh build/source.bundle; done
  exit
fi

# In the root.
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
# The data folder is missing here, so its tests are skipped, as on a user's machine.
unset CI MODEBANK_DATA
apt-get update -q
apt-get install -q -y --no-install-recommends make git
git init -q source
cd source
git fetch -q ../source.bundle HEAD
git checkout -q FETCH_HEAD
TIMEFORMAT='%0R s, %0U s and %0S s of processor time'
awk '/^```/ { if (block) exit; block = /^```sh$/; next } block { sub(/ *#.*/, ""); print }' README.md > ../commands
[ "$(wc -l < ../commands)" -eq 2 ] || { echo "README's first block has other than two commands" >&2; exit 1; }
while read -r command; do
  echo "\$ $command"
  time bash -c "$command" </dev/null
done < ../commands
echo "$(sed -n 's/^PRETTY_NAME=//p' /etc/os-release): $(gcc --version | sed -n 1p)"
dpkg-query -W -f '${Package} ${Version}\n' libceres-dev libeigen3-dev libhdf5-dev libhwy-dev libboost-dev libmatio-dev
