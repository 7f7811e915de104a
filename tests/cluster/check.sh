#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The scripts of examples/cluster: check.sh parallel|slurm TRELLIS SOURCE.
#
# Each runs a sweep in shards and merges them; the runs are those of one process, but for their times, since merge
# refuses records that differ. `slurm` starts a Slurm of its own, with one node, in a temporary folder, and lets Slurm
# end a job and start it again. Exit status 77: what is needed is not installed.
set -euo pipefail
mode=$1 trellis=$2 source=$3
skip() { echo "skipped: $1"; exit 77; }

place=$(mktemp -d)
pids=()
finish() {
  local status=$?
  if [ "$status" -ne 0 ]; then tail -n 20 "$place"/*.log "$place"/slurm-*.out 2>/dev/null || true; fi
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  for pid in "${pids[@]}"; do wait "$pid" 2>/dev/null || true; done
  rm -rf "$place"
}
trap finish EXIT
PATH=$(dirname "$trellis"):$PATH
cd "$place"
cat > sweep.lua <<'LUA'
return experiment {
  problems = { scenes.cup(), scenes.trap() },
  strategies = { guided = skeleton() >> rrt { step = 0.5 }, plain = rrt { step = 0.5 } },
  seeds = 40,
  measure = false,
}
LUA
trellis sweep sweep.lua --quiet --out whole

# Whether a folder of shards holds the runs of `whole`.
same() { trellis merge "$1" whole --out both | grep -q '^160 runs of 2 folders'; }

parallel_sweep() {
  command -v parallel > /dev/null || skip "GNU parallel is not installed"
  bash "$source/examples/cluster/sweep-parallel" sweep.lua swept 3
  same swept/all
  # The same command continues: nothing is left to do.
  bash "$source/examples/cluster/sweep-parallel" sweep.lua swept 3
  same swept/all
}

port() { # a free one
  local port
  while port=$((20000 + RANDOM % 20000)) && (: < "/dev/tcp/127.0.0.1/$port") 2> /dev/null; do continue; done
  echo "$port"
}

slurm_sweep() {
  local program
  for program in slurmctld slurmd sbatch squeue scontrol; do
    command -v "$program" > /dev/null || [ -x "/usr/sbin/$program" ] || skip "$program is not installed (slurm-wlm)"
  done
  PATH=$PATH:/usr/sbin
  local node user
  node=$(hostname -s)
  user=$(id -un)
  mkdir state spool
  cat > slurm.conf <<CONF
ClusterName=trellis
SlurmctldHost=$node(127.0.0.1)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/none
CredType=cred/none
SlurmctldPort=$(port)
SlurmdPort=$(port)
StateSaveLocation=$place/state
SlurmdSpoolDir=$place/spool
SlurmctldPidFile=$place/slurmctld.pid
SlurmdPidFile=$place/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1
MinJobAge=300
KillWait=1
ReturnToService=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=2 Sockets=2 CoresPerSocket=1 ThreadsPerCore=1
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF=$place/slurm.conf
  slurmctld -D > slurmctld.log 2>&1 &
  pids+=($!)
  slurmd -D -N "$node" > slurmd.log 2>&1 &
  pids+=($!)
  for _ in $(seq 60); do
    scontrol show node "$node" 2> /dev/null | grep -q 'State=IDLE' && break
    sleep 0.5
  done
  scontrol show node "$node" 2> /dev/null | grep -q 'State=IDLE' || skip "no node of Slurm starts here"
  local job
  job=$(sbatch --parsable --array=1-3 "$source/examples/cluster/sweep.slurm" sweep.lua swept)
  # Slurm ends the second job of the array and starts it again.
  for _ in $(seq 600); do
    [ -s swept/shard-2/runs.jsonl ] && break
    sleep 0.02
  done
  if scontrol requeue "${job}_2" 2> /dev/null; then
    # Slurm would wait two minutes. In the second in which it was revoked, the node still refuses the job.
    sleep 2
    for _ in $(seq 60); do
      case $(squeue --noheader --jobs "${job}_2" --format %t 2> /dev/null) in
        PD) scontrol update "JobId=${job}_2" StartTime=now 2> /dev/null || true ;;
        R | "") break ;;
      esac
      sleep 0.5
    done
  else
    echo "the job had ended before"
  fi
  for _ in $(seq 240); do
    [ -z "$(squeue --noheader --jobs "$job" 2> /dev/null)" ] && break
    sleep 0.5
  done
  [ -z "$(squeue --noheader --jobs "$job" 2> /dev/null)" ]
  trellis merge swept/shard-* --out swept/all
  same swept/all
}

"${mode}_sweep"
