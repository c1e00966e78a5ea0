#!/bin/sh
# node.sh NAME MOUNT_PROGRAM BACKING MOUNT CACHE_S SKEW_S COMMAND...: runs a command as on a machine of that name that
# has BACKING at MOUNT over a network. It has its own host name, processes and mounts (root only).
set -eu
if [ "${MODEBANK_NODE:-}" != inside ]; then
  exec env MODEBANK_NODE=inside unshare --uts --pid --mount --fork --kill-child --mount-proc "$0" "$@"
fi
unset MODEBANK_NODE
hostname "$1"
program=$2 backing=$3 mount=$4 cache_s=$5 skew_s=$6
shift 6
"$program" "$backing" "$mount" "$cache_s" "$skew_s" &
tries=0
until mountpoint -q "$mount"; do
  tries=$((tries + 1))
  [ "$tries" -lt 6000 ] || { echo "node.sh: $mount was not mounted" >&2; exit 125; }
  sleep 0.05
done
status=0
"$@" || status=$?
umount "$mount" 2>/dev/null || umount -l "$mount"
exit "$status"
