#!/usr/bin/env bash
# Tries farm/slurm.sh on two pretended nodes of this machine, as root, in a temporary folder: slurmctld and two slurmd run
# on ports of their own and are stopped at the end. One task is queued again in mid-render, one node is killed. The
# picture must have the bits of one render.
#
#   farm/try_slurm.sh [WAVEPATH]     the program, else ./build/host/wavepath
#
# Needs slurmctld, slurmd, slurm-client and munge. Leaves with 77 where they are missing.
set -euo pipefail
root="$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")"
program="$(readlink -f "${1:-$root/build/host/wavepath}")"
for tool in slurmctld slurmd sbatch munged mungekey; do
  PATH="$PATH:/usr/sbin:/sbin" command -v "$tool" >/dev/null || { echo "skipped: $tool is missing" && exit 77; }
done
((EUID == 0)) || { echo "skipped: slurmd starts tasks as root alone" && exit 77; }
PATH="$(dirname "$program"):$PATH:/usr/sbin:/sbin"
export PATH

folder="$(mktemp -d)" host="$(hostname -s)"
chmod 0755 "$folder"
stop() {
  for file in "$folder"/*.pid "$folder"/munge/pid; do [[ ! -s $file ]] || kill "$(<"$file")" 2>/dev/null || true; done
  pkill -KILL -f "slurmstepd.*$folder" 2>/dev/null || true
  sleep 1
  [[ ${KEEP:-} ]] && echo "kept: $folder" || rm -rf "$folder"
}
trap stop EXIT

# A key and a daemon of munge of our own.
install -d -o munge -g munge -m 0711 "$folder/munge"
as_munge() { runuser -u munge -- "$@"; }
as_munge mungekey --create --keyfile="$folder/munge/key"
as_munge munged --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" --pid-file="$folder/munge/pid" \
  --log-file="$folder/munge/log" --seed-file="$folder/munge/seed"

mkdir "$folder/state"
export SLURM_CONF="$folder/slurm.conf"
cat >"$SLURM_CONF" <<CONF
ClusterName=wavepath
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$folder/munge/socket,cred_expire=5
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool.%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/%n.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SlurmdParameters=config_overrides
PropagateResourceLimits=NONE
ReturnToService=2
SlurmdTimeout=10
KillWait=5
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=17001 CPUs=1 RealMemory=500 State=UNKNOWN
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=17002 CPUs=1 RealMemory=500 State=UNKNOWN
PartitionName=main Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
version="$(slurmctld -V | sed 's/[^0-9]*\([0-9]*\).*/\1/')"
if ((version >= 23)); then
  echo "CgroupPlugin=disabled" >"$folder/cgroup.conf"
else
  echo "CgroupPlugin=cgroup/v1" >"$folder/cgroup.conf" # does nothing until it is asked
fi
slurmctld -c -f "$SLURM_CONF"
start_node() { slurmd -N "$1" -f "$SLURM_CONF"; }
start_node n1
start_node n2
# At once with all that runs there, as a power cut does: the daemon, who started the tasks, then the tasks.
kill_node() {
  local task
  kill -KILL "$(<"$1.pid")"
  for task in $(pgrep -f "$folder/spool.$1/job"); do kill -KILL "$(ps -o ppid= -p "$task" | tr -d ' ')" || true; done
  for task in $(pgrep -f "slurm_script|$folder|picture-part"); do
    ! tr '\0' '\n' <"/proc/$task/environ" 2>/dev/null | grep -qx "SLURMD_NODENAME=$1" || kill -KILL "$task" || true
  done
}
wait_for() { # seconds, what, command
  local end=$((SECONDS + $1)) what="$2"
  shift 2
  until "$@"; do
    ((SECONDS < end)) || { echo "no $what after the time given; see $folder" && KEEP=1 && exit 1; }
    sleep 0.3
  done
}
nodes_are_idle() { [[ "$(sinfo -h -N -o %t | grep -c idle)" == 2 ]]; }
wait_for 60 "idle nodes" nodes_are_idle

cd "$folder"
flags=(--spp 4096 --size 128x96)
wavepath parts "$root/scenes/cornell_box.gltf" --count 4 "${flags[@]}" -o picture.exr --checkpoint-interval 1 -q >job.txt
merge="$("$root/farm/slurm.sh" job.txt --output="$folder/job-%a.log")"
array=$((merge - 1))

wait_for 120 "state of part 0" test -s picture-part-00000.state
echo "queued again in mid-render: task 1"
scontrol requeue "${array}_1"
wait_for 120 "state of a part on n2" bash -c "squeue -h -t R -w n2 -o %i | grep -q ."
sleep 2
echo "killed: node n2 with its tasks ($(squeue -h -t R -w n2 -o %i | paste -sd,))"
kill_node n2
sleep 12
start_node n2
is_done() { [[ -s picture.exr ]] && [[ -z "$(squeue -h)" ]]; }
wait_for 600 "picture" is_done
sed -n '/requeue\|NODE/Ip' slurmctld.log | tail -5
wavepath render "$root/scenes/cornell_box.gltf" "${flags[@]}" --mergeable -q -o one.exr
wavepath compare picture.exr one.exr --max max=0
echo "the same bits as one render"
