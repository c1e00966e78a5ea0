#!/bin/sh
# Installs the packages with apt in an empty Debian 12 and uses them there. Usage: test_packages.sh FOLDER_OF_PACKAGES ROOT
set -eu
packages=$1 root=$2
here=$(dirname "$0")
lintian --fail-on error "$packages"/*.deb
du -h "$packages"/*.deb
"$here/with_root.sh" bookworm "$root" "$here/inside_packages.sh" "$packages"/*.deb
