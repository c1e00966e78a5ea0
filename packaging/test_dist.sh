#!/bin/sh
# Uses the tarball in an empty Debian 12 and an empty Debian 13. Compares the oldest glibc in docs/howto/install.md with the one that the tarball
# needs.
# Usage: test_dist.sh TARBALL ROOT
set -eu
tarball=$1 root=$2
here=$(dirname "$0")
du -h "$tarball"
unpacked=$(mktemp -d)
trap 'rm -rf "$unpacked"' EXIT
tar -xzf "$tarball" -C "$unpacked"
oldest=$(objdump -T "$unpacked"/*/bin/* "$unpacked"/*/lib/* | grep -o 'GLIBC_2\.[0-9]*' | sort -uV | tail -n 1)
grep -q "glibc ${oldest#GLIBC_} " "$here/../docs/howto/install.md" || {
  echo "modebank: the tarball needs glibc ${oldest#GLIBC_}; docs/howto/install.md must state that" >&2
  exit 1
}
for suite in bookworm trixie; do
  "$here/with_root.sh" "$suite" "$root" "$here/inside_dist.sh" "$tarball"
done
