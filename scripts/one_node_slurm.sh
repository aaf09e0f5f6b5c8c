# A Slurm with one node for tests, in its own folder, with its own key, sockets and ports. Source this file. It needs Debian's
# package `slurm-wlm`, but no systemd, no control groups and no root. A Slurm that already runs on the machine is not touched.
#   one_node_slurm_start FOLDER   exports SLURM_CONF for sbatch and the other commands; fails if the node does not start
#   one_node_slurm_stop           ends the daemons and the jobs; call it from a trap on EXIT

one_node_slurm_pids=()

one_node_slurm_missing() {
  local name
  for name in munged slurmctld slurmd sbatch scontrol; do
    PATH=$PATH:/usr/sbin command -v "$name" >/dev/null || { echo "$name"; return; }
  done
}

# Prints N free ports.
one_node_slurm_ports() {
  python3 -c 'import socket, sys
sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(int(sys.argv[1]))]
print(*(s.getsockname()[1] for s in sockets))' "$1"
}

one_node_slurm_start() {
  local folder=$1 control_port node_port memory i
  local PATH=$PATH:/usr/sbin
  mkdir -p "$folder/state" "$folder/spool"
  read -r control_port node_port <<<"$(one_node_slurm_ports 2)"
  memory=$(awk '/^MemTotal/ { print int($2 / 1024) }' /proc/meminfo)
  (umask 077 && head -c 1024 /dev/urandom >"$folder/munge.key")
  cat >"$folder/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$control_port
SlurmdPort=$node_port
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
DefMemPerCPU=1000
SchedulerParameters=batch_sched_delay=0,sched_min_interval=100000
MpiDefault=none
ReturnToService=2
KillWait=2
NodeName=here NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$memory
PartitionName=all Nodes=here Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF=$folder/slurm.conf
  # --force: accept a temporary folder; only its owner can enter it.
  munged --foreground --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munged.pid" \
    --seed-file="$folder/munge.seed" --log-file="$folder/munged.log" >"$folder/munged.out" 2>&1 &
  one_node_slurm_pids+=($!)
  for ((i = 0; i < 50; i++)); do [ -S "$folder/munge.socket" ] && break; sleep 0.1; done
  slurmctld -D -L "$folder/slurmctld.log" >/dev/null 2>&1 &
  one_node_slurm_pids+=($!)
  slurmd -D -N here -L "$folder/slurmd.log" >/dev/null 2>&1 &
  one_node_slurm_pids+=($!)
  for ((i = 0; i < 300; i++)); do
    [ "$(sinfo --noheader --format=%T 2>/dev/null)" = idle ] && return 0
    sleep 0.1
  done
  echo "the node of the Slurm for the test does not come up:" >&2
  tail -n 5 "$folder"/*.log >&2
  return 1
}

one_node_slurm_stop() {
  local i
  [ "${#one_node_slurm_pids[@]}" = 0 ] && return 0
  if scancel --user="$(id -un)" >/dev/null 2>&1; then
    for ((i = 0; i < 100; i++)); do [ -z "$(squeue --noheader 2>/dev/null)" ] && break; sleep 0.1; done
  fi
  for ((i = ${#one_node_slurm_pids[@]} - 1; i >= 0; i--)); do # first slurmd, then slurmctld, last munged
    kill "${one_node_slurm_pids[i]}" 2>/dev/null || true
    wait "${one_node_slurm_pids[i]}" 2>/dev/null || true
  done
  one_node_slurm_pids=()
}
