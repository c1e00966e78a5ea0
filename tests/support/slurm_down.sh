#!/bin/sh
# Ends the jobs and daemons that slurm_up.sh started, by the ids in the folder. Usage: slurm_down.sh FOLDER
folder=$(readlink -f "$1")
export SLURM_CONF="$folder/slurm.conf"
timeout 10 scancel --full --state=RUNNING,PENDING --user="$(id -un)" 2>/dev/null
sleep 0.3
for file in "$folder"/run/slurmd.*.pid "$folder/run/slurmctld.pid" "$folder/run/munged.pid"; do
  [ -f "$file" ] && kill "$(cat "$file")" 2>/dev/null
done
sleep 0.5
exit 0
