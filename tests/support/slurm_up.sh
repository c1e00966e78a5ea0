#!/bin/sh
# Starts a private Slurm of two nodes, n1 and n2, on this machine: munged, slurmctld and two slurmd, all in one folder,
# without services or files elsewhere. Usage: slurm_up.sh FOLDER FIRST_PORT. Then set SLURM_CONF=FOLDER/slurm.conf; end
# it with slurm_down.sh FOLDER.
set -eu
PATH=$PATH:/usr/sbin
mkdir -p "$1"
folder=$(readlink -f "$1") port=$2
host=$(hostname -s) user=$(id -un)
cd "$folder"
chmod 755 .
mkdir -p state log spool run
install -d -m 700 munge
dd if=/dev/urandom of=munge/key bs=1 count=1024 status=none
chmod 400 munge/key
munged --force --key-file="$folder/munge/key" --socket="$folder/run/munge.sock" --pid-file="$folder/run/munged.pid" \
  --log-file="$folder/log/munged" --seed-file="$folder/munge/seed"
# cred_expire: time before a job of a lost node is started again, two minutes by default.
# config_overrides: nodes may claim more processors than the machine has.
cat > slurm.conf <<CONF
ClusterName=modebank
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$folder/run/munge.sock,cred_expire=5
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool/%n
TmpFS=$folder/tmp/%n
SlurmctldPidFile=$folder/run/slurmctld.pid
SlurmdPidFile=$folder/run/slurmd.%n.pid
SlurmctldLogFile=$folder/log/slurmctld
SlurmdLogFile=$folder/log/slurmd.%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SlurmdParameters=config_overrides
SchedulerParameters=sched_min_interval=0,batch_sched_delay=0,sched_interval=2,bf_interval=2
MinJobAge=3600
KillWait=2
InactiveLimit=0
SlurmctldTimeout=30
SlurmdTimeout=5
JobRequeue=1
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
NodeName=n[1-2] NodeHostname=$host NodeAddr=127.0.0.1 Port=[$((port + 1))-$((port + 2))] CPUs=1 State=UNKNOWN
PartitionName=main Nodes=n[1-2] Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
CONF
export SLURM_CONF="$folder/slurm.conf"
slurmctld -f "$SLURM_CONF"
for node in n1 n2; do
  mkdir -p "tmp/$node"
  slurmd -f "$SLURM_CONF" -N "$node"
done
tries=0
until [ "$(sinfo -h -t idle -o %D 2>/dev/null)" = 2 ]; do
  tries=$((tries + 1))
  [ $tries -le 3000 ] || { echo "the nodes did not come up:" >&2; tail -n 20 log/* >&2; exit 1; }
  sleep 0.1
done
