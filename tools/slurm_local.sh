#!/usr/bin/env bash
# A private one-node Slurm on the loopback interface, to prove cluster job scripts on one machine.
#
#   slurm_local.sh install          Debian packages (root)
#   slurm_local.sh start            munged, slurmctld, slurmd; all state under $SLURM_LOCAL_DIR
#   eval "$(slurm_local.sh env)"    point sbatch, squeue, scontrol at it
#   slurm_local.sh stop             ends exactly the three processes that start began, by their pid files
#
# Nothing of the system's own Slurm or munge set-up (/etc/slurm, /etc/munge, services) is read or changed.
set -euo pipefail

DIR=${SLURM_LOCAL_DIR:-${TMPDIR:-/tmp}/slurm-local-$(id -u)}
CPUS=${SLURM_LOCAL_CPUS:-2}
PORT=${SLURM_LOCAL_PORT:-26817}          # slurmctld; slurmd takes the next one
NODE=localnode
export SLURM_CONF=$DIR/slurm.conf
export PATH=$PATH:/usr/sbin:/sbin        # munged, slurmctld, slurmd live in sbin

say() { printf '%s\n' "$*" >&2; }
alive() { [ -s "$1" ] && kill -0 "$(cat "$1")" 2>/dev/null; }

wait_for() {                             # wait_for SECONDS WHAT COMMAND...
    local n=$(( $1 * 5 )) what=$2; shift 2
    while ! "$@" >/dev/null 2>&1; do
        n=$((n - 1)); [ "$n" -gt 0 ] || { say "timed out: $what"; tail -n 5 "$DIR"/log/*.log >&2 || true; return 1; }
        sleep 0.2
    done
}

install() {
    export DEBIAN_FRONTEND=noninteractive
    apt-get update -q
    # plain 'slurm-wlm' with recommends pulls in a few hundred MB of plug-ins and -dev packages
    apt-get install -y -q --no-install-recommends munge slurmctld slurmd slurm-client slurm-wlm-basic-plugins
}

configure() {
    local user mem
    user=$(id -un)
    mem=$(awk '/MemTotal/ {print int($2/1024*0.9)}' /proc/meminfo)
    mkdir -p "$DIR"/{log,state,spool,munge}
    chmod 0755 "$DIR" "$DIR"/munge       # munged refuses a socket folder that group or others may write
    chmod 0700 "$DIR"/state
    if [ ! -s "$DIR/munge.key" ]; then   # 0600 and owned by the user that runs munged, else it refuses
        (umask 077; head -c 128 /dev/urandom > "$DIR/munge.key")
    fi
    cat > "$SLURM_CONF" <<CONF
ClusterName=local
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$PORT
SlurmdPort=$((PORT + 1))
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$DIR/munge/munge.socket
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
StateSaveLocation=$DIR/state
SlurmdSpoolDir=$DIR/spool
SlurmctldPidFile=$DIR/slurmctld.pid
SlurmdPidFile=$DIR/slurmd.pid
SlurmctldLogFile=$DIR/log/slurmctld.log
SlurmdLogFile=$DIR/log/slurmd.log
# containers: no cgroups, no systemd scope
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SwitchType=switch/none
SchedulerType=sched/backfill
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,bf_interval=1
ReturnToService=2
SlurmdParameters=config_overrides
MinJobAge=3600
InactiveLimit=0
KillWait=5
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc=$DIR/log/jobcomp.txt
NodeName=$NODE NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$CPUS RealMemory=$mem State=UNKNOWN
PartitionName=local Nodes=$NODE Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
CONF
    # slurmd initialises its cgroup plug-in even when nothing uses it, and dies where /sys/fs/cgroup is not
    # mounted; an empty private folder satisfies it (tried with 22.05)
    mkdir -p "$DIR/cgroup"
    printf 'CgroupPlugin=cgroup/v1\nCgroupMountpoint=%s\n' "$DIR/cgroup" > "$DIR/cgroup.conf"
}

start() {
    alive "$DIR/slurmctld.pid" && { say "already running in $DIR"; return 0; }
    configure
    rm -f "$DIR"/munge/munge.socket*
    munged --key-file="$DIR/munge.key" --socket="$DIR/munge/munge.socket" --pid-file="$DIR/munged.pid" \
           --log-file="$DIR/log/munged.log" --seed-file="$DIR/munge.seed" --num-threads=2
    wait_for 10 munged sh -c "munge -S '$DIR/munge/munge.socket' -n | unmunge -S '$DIR/munge/munge.socket'"
    slurmctld -c                          # -c: forget the state of an earlier run
    wait_for 20 slurmctld sh -c "scontrol ping | grep -q UP"
    slurmd -N "$NODE" || { tail -n 5 "$DIR/log/slurmd.log" >&2; return 1; }
    wait_for 20 "node up" sh -c "sinfo -h -n $NODE -o %T | grep -Eq '^(idle|mixed|allocated)'"
    sinfo >&2
}

stop_one() {                              # by pid file only, never by name
    local f=$1 pid
    alive "$f" || return 0
    pid=$(cat "$f")
    kill "$pid"
    for _ in $(seq 50); do kill -0 "$pid" 2>/dev/null || return 0; sleep 0.2; done
    kill -9 "$pid" 2>/dev/null || true
}

stop() {
    scancel --me 2>/dev/null || true
    stop_one "$DIR/slurmd.pid"; stop_one "$DIR/slurmctld.pid"; stop_one "$DIR/munged.pid"
    [ "${1:-}" = --purge ] && rm -rf "$DIR"
    say stopped
}

status() {
    for d in munged slurmctld slurmd; do
        if alive "$DIR/$d.pid"; then say "$d: pid $(cat "$DIR/$d.pid")"; else say "$d: not running"; fi
    done
    sinfo 2>/dev/null; squeue 2>/dev/null
}

case ${1:-} in
    install|start|status) "$1" ;;
    stop) stop "${2:-}" ;;
    env) printf 'export SLURM_CONF=%q\n' "$SLURM_CONF" ;;
    *) sed -n '2,10p' "$0"; exit 2 ;;
esac
