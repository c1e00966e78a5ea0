#!/bin/sh
# README's two commands as root in an empty Debian, in a folder with source.bundle, the committed source. Prints the versions of the tools.
# `make debian` runs this script.
set -eu
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
# The data folder is missing here, so its tests are skipped, as on a user's machine.
unset CI MODEBANK_NIGHTLY MODEBANK_DATA
apt-get update -q
apt-get install -q -y --no-install-recommends make git
git init -q source
cd source
git fetch -q ../source.bundle HEAD
git checkout -q FETCH_HEAD
make
make test
echo "$(sed -n 's/^PRETTY_NAME=//p' /etc/os-release): $(gcc --version | sed -n 1p)"
dpkg-query -W -f '${Package} ${Version}\n' libceres-dev libeigen3-dev libhdf5-dev libhwy-dev libboost-dev libmatio-dev
build/modebank version
