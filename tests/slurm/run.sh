#!/usr/bin/env bash
# A study as a Slurm array on this one machine, with one shard killed and requeued: the merged result must equal that of a
# single run bit for bit. Called by hand, as root (Slurm's daemons want it), from the repository root:
#   apt-get install --no-install-recommends slurmctld slurmd slurm-client munge
#   cargo build --release && tests/slurm/run.sh
# Starts its own munged, slurmctld and slurmd in a folder of their own, and ends these three alone.
set -euo pipefail
cd "$(dirname "$0")/../.."
for program in slurmctld slurmd munged sbatch squeue; do
    command -v "$program" >/dev/null || { echo "skipped: $program is not installed"; exit 0; }
done
[ "$(id -u)" = 0 ] || { echo "skipped: Slurm's daemons are started as root"; exit 0; }
tauscope=$PWD/target/release/tauscope
[ -x "$tauscope" ] || { echo "no $tauscope; cargo build --release makes it"; exit 2; }

work=$(mktemp -d)
chmod 755 "$work"
daemons=()
finish() {
    for pid in "${daemons[@]}"; do kill "$pid" 2>/dev/null || true; done
    for pid in "${daemons[@]}"; do wait "$pid" 2>/dev/null || true; done
    rm -rf "$work"
}
trap finish EXIT

host=$(hostname -s)
address=$(getent hosts "$host" | awk '{print $1; exit}')
mkdir -p "$work"/{munge,state,spool,log}
chmod 711 "$work/munge"
dd if=/dev/urandom of="$work/munge/key" bs=128 count=1 status=none
chmod 400 "$work/munge/key"
munged --foreground --force --key-file="$work/munge/key" --socket="$work/munge/socket" --pid-file="$work/munge/pid" \
    --log-file="$work/munge/log" --seed-file="$work/munge/seed" 2>"$work/log/munged" &
daemons+=($!)
for _ in $(seq 50); do [ -S "$work/munge/socket" ] && break; sleep 0.1; done

cat >"$work/slurm.conf" <<CONF
ClusterName=one
SlurmctldHost=$host($address)
NodeName=$host NodeAddr=$address CPUs=4 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
SlurmdParameters=config_overrides
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket,cred_expire=5
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
SlurmctldPort=26817
SlurmdPort=26818
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/log/slurmctld
SlurmdLogFile=$work/log/slurmd
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
JobCompType=jobcomp/filetxt
JobCompLoc=$work/log/jobs
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=2
ReturnToService=2
RequeueExit=75
MinJobAge=300
SlurmdTimeout=6
KillWait=2
CONF
# Newer versions want to be told that there are no cgroups; older ones do not know the word.
[ "$(slurmd -V | tr -dc '0-9.' | cut -d. -f1)" -lt 23 ] || echo CgroupPlugin=disabled >"$work/cgroup.conf"
export SLURM_CONF=$work/slurm.conf
slurmctld -D -c 2>"$work/log/slurmctld.err" &
daemons+=($!)
slurmd -D 2>"$work/log/slurmd.err" &
daemons+=($!)
for _ in $(seq 100); do sinfo -h -o %T 2>/dev/null | grep -q idle && break; sleep 0.2; done
sinfo -h -o %T 2>/dev/null | grep -q idle || { echo "Slurm does not come up:"; tail "$work"/log/*; exit 1; }

scenario=$PWD/tests/scenarios/montecarlo.toml
study=(--trials 200 --estimators ols,wls --seed 7 --quiet)
echo "== one machine"
"$tauscope" montecarlo "$scenario" "${study[@]}" --out "$work/single"

echo "== an array of 4"
job=$(cd "$work" && TAUSCOPE=$tauscope sbatch --parsable --array=0-3 --cpus-per-task=1 \
    "$OLDPWD/deploy/slurm/montecarlo.sbatch" "$scenario" "${study[@]}" --out "$work/shards")
# Kill the worker of shard 2 as soon as it has finished a chunk, and not its batch shell: that would orphan it.
victim=$work/shards/shard_0002_of_0004
for _ in $(seq 600); do compgen -G "$victim/unfinished/trials_*.parquet" >/dev/null && break; sleep 0.1; done
killed=
for status in /proc/[0-9]*/environ; do
    pid=${status#/proc/}; pid=${pid%/environ}
    if [ "$(readlink "/proc/$pid/exe" 2>/dev/null)" = "$tauscope" ] \
        && tr '\0' '\n' <"$status" 2>/dev/null | grep -qx 'SLURM_ARRAY_TASK_ID=2' \
        && tr '\0' '\n' <"$status" 2>/dev/null | grep -qx "SLURM_CONF=$SLURM_CONF"; then
        kill -KILL "$pid" && killed=$pid
    fi
done
[ -n "$killed" ] || { echo "the worker of shard 2 was gone before it could be killed"; exit 1; }
kept=$(find "$victim/unfinished" -name 'trials_*.parquet' | wc -l)
echo "killed worker $killed of shard 2 with $kept chunks finished"
# A requeued task waits two minutes; there is nothing to wait for here.
for _ in $(seq 100); do
    [ "$(squeue -h -j "${job}_2" -o %T 2>/dev/null)" = RUNNING ] || break
    sleep 0.1
done
for _ in $(seq 50); do scontrol update JobId="${job}_2" StartTime=now 2>/dev/null && break; sleep 0.2; done
for _ in $(seq 1200); do [ -z "$(squeue -h -j "$job" -o %i 2>/dev/null)" ] && break; sleep 0.2; done
if ! scontrol -o show job "${job}_2" | grep -q 'Restarts=1.*'; then
    echo "shard 2 was not requeued:"; scontrol -o show job "${job}_2"; cat "$work"/tauscope-*.log; exit 1
fi

echo "== merge"
"$tauscope" montecarlo merge "$work/shards" --out "$work/merged" --quiet
for file in trials.parquet summary.json study.json; do
    cmp "$work/single/$file" "$work/merged/$file"
done
echo "ok: 4 shards, one killed and requeued, equal one machine bit for bit"
