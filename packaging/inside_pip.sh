#!/bin/sh
# test_pip.sh runs this script in the empty root. As an ordinary user, pip builds and installs the module; then the example of
# docs/howto/python.md runs.
set -eu
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
as_user() { su --login robot -c "$1"; }

as_user 'mkdir source && tar -xf /files/source.tar -C source'
sh /home/robot/source/.ci/install-packages build pip >/tmp/apt.log 2>&1 || { cat /tmp/apt.log >&2; exit 1; }
begin=$(date +%s)
# The network is off, so pip cannot use a registry.
unshare --net su --login robot -c "python3 -m venv --system-site-packages env &&
  CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)} env/bin/pip install --no-build-isolation ./source" >/tmp/pip.log 2>&1 ||
  { tail -n 40 /tmp/pip.log >&2; exit 1; }
tail -n 1 /tmp/pip.log
echo "pip install took $(($(date +%s) - begin)) s"
as_user "env/bin/pip show --files modebank | grep modebank/ && du -h env/lib/python3*/site-packages/modebank/*.so"
awk "/^## / { here = /Try it/ } /^\`\`\`/ { block = here && /python/; next } block" /home/robot/source/docs/howto/python.md >/tmp/readme.py
as_user 'env/bin/python3 /tmp/readme.py >readme.txt && grep "^finding .*Switching between .* linear models predicts" readme.txt'
