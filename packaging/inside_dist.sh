#!/bin/sh
# test_dist.sh runs this script in an empty root without further packages. It unpacks the tarball, and uses the program as an
# ordinary user.
set -eu
as_user() { su --login robot -c "$1"; }

as_user 'tar -xzf /files/modebank-*.tar.gz && mv modebank-* modebank'
# The loader must take everything but glibc's own libraries from the tarball, and every library in the tarball must have a use.
as_user 'LD_LIBRARY_PATH=/usr/lib/x86_64-linux-gnu ldd modebank/bin/modebank' >/tmp/loaded
if grep -vE '/modebank/bin/\.\./lib/|linux-vdso|ld-linux|=> [^ ]*/lib(c|dl|m|pthread|resolv|rt)\.so' /tmp/loaded >&2; then
  echo "modebank: the tarball lacks the libraries above" >&2
  exit 1
fi
for library in /home/robot/modebank/lib/*; do
  grep -q "/$(basename "$library") " /tmp/loaded || { echo "modebank: the program does not load $library" >&2; exit 1; }
done

begin=$(date +%s)
as_user 'modebank/bin/modebank demo >demo.txt 2>demo.log' || { as_user 'cat demo.log demo.txt' >&2; exit 1; }
grep 'of the held-out samples are assigned to their true ground' /home/robot/demo.txt
as_user 'modebank/bin/modebank report modebank_demo/demo.h5 -o demo.html && test -s demo.html &&
         modebank/bin/modebank verify modebank_demo/demo.h5'
for page in /home/robot/modebank/share/man/man1/*.gz; do gzip -t "$page"; done
echo "Debian $(cat /etc/debian_version): demo, report and verify took $(($(date +%s) - begin)) s"
