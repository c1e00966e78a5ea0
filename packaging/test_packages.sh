#!/bin/sh
# Installs the packages with apt on a bare Debian 12 and uses them there. Usage: test_packages.sh FOLDER_OF_PACKAGES ROOT
# ROOT is made by mmdebstrap and removed at the end; when something fails it stays, to be looked into.
set -eu
packages=$(cd "$1" && pwd)
root=$2
inside=$(cd "$(dirname "$0")" && pwd)/in_clean_root.sh
export packages inside

lintian --fail-on error "$packages"/*.deb
du -h "$packages"/*.deb

[ ! -e "$root" ] || rm -rf --one-file-system "$root"
# Hooks run while the root still has the network and apt's settings of this machine.
# shellcheck disable=SC2016 # "$1" is the hook's: the root
mmdebstrap --variant=minbase --quiet \
  --customize-hook='mkdir "$1/packages" && cp "$packages"/*.deb "$inside" "$1/packages"' \
  --customize-hook='chroot "$1" sh /packages/in_clean_root.sh' \
  bookworm "$root"
rm -rf --one-file-system "$root"
