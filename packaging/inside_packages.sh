#!/bin/sh
# test_packages.sh runs this script in the empty root. It installs each package with the fewest other packages that apt allows,
# and uses it.
set -eu
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8

as_user() { su --login robot -c "$1"; }
install_packages() {
  apt-get install -q -y --no-install-recommends "$@" >/tmp/apt.log 2>&1 || { tail -n 20 /tmp/apt.log >&2; exit 1; }
  echo "installed $*, and what they need:"
  grep -E "newly installed|Need to get|After this operation" /tmp/apt.log
}
seconds() { date +%s; }

install_packages ./modebank_*.deb
begin=$(seconds)
as_user 'modebank demo >demo.txt 2>demo.log' || { as_user 'cat demo.log demo.txt' >&2; exit 1; }
as_user 'grep -q "of the held-out samples are assigned to their true ground" demo.txt && cat demo.txt'
echo "modebank demo took $(($(seconds) - begin)) s"
as_user 'modebank report modebank_demo/demo.h5 -o demo.html && test -s demo.html && modebank verify modebank_demo/demo.h5'

for module in ./python3-modebank_*.deb; do
  [ -e "$module" ] || continue
  install_packages "$module"
  as_user 'python3 -c "import modebank; a = modebank.Archive(\"modebank_demo/demo.h5\"); print(a, modebank.Filter(a))"'
done

install_packages ./libmodebank-dev_*.deb
install_packages cmake g++ make
begin=$(seconds)
as_user 'cmake -S /usr/share/doc/libmodebank-dev/examples -B examples -DCMAKE_BUILD_TYPE=Release >cmake.log 2>&1 &&
         cmake --build examples >>cmake.log 2>&1' || { as_user 'tail -n 30 cmake.log' >&2; exit 1; }
as_user 'examples/embedded_bank && examples/identify && examples/robot_loop modebank_demo/demo.h5 1'
echo "the examples of libmodebank-dev took $(($(seconds) - begin)) s"
