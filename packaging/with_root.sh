#!/bin/sh
# Makes an empty Debian in the folder ROOT, with an ordinary user `robot`, and runs SCRIPT in it as root. SCRIPT runs in a folder
# that also contains FILES (files or folders). After a failure ROOT remains for inspection: `chroot ROOT` enters it.
# Usage: with_root.sh SUITE ROOT SCRIPT [FILES...]
# SUITE is bookworm (Debian 12) or trixie (Debian 13).
set -eu
suite=$1 root=$2 script=$(basename "$3")
shift 2
mirror=$(sh "$(dirname "$0")/../.ci/mirror")

# The files are copied through a folder, because mmdebstrap runs a hook as one string without a list of arguments.
files=$(mktemp -d)
trap 'rm -rf "$files"' EXIT
cp -R "$@" "$files"
export files script

[ ! -e "$root" ] || rm -rf --one-file-system "$root"
mkdir -p "$(dirname "$root")"
# A hook runs while the root still has the network and this machine's apt settings.
# shellcheck disable=SC2016 # the hook's "$1" is the root
mmdebstrap --variant=minbase --quiet \
  --customize-hook='cp -R "$files" "$1/files" && chmod -R a+rX "$1/files"' \
  --customize-hook='chroot "$1" useradd --create-home --shell /bin/sh robot' \
  --customize-hook='chroot "$1" sh -c "cd /files && exec ./$script"' \
  "$suite" "$root" "$mirror"
rm -rf --one-file-system "$root"
