# Functions that run a Slurm cluster of two nodes on this machine, for tests. To use them, source this file
# and call slurm_missing, slurm_start FOLDER and slurm_stop. They need the Debian packages slurm-wlm and
# munge. The cluster has no cgroups, no accounting and no system service. All its files are in FOLDER, and
# the configuration of the system is not changed.

# Prints the first program that is missing on this machine, or nothing if a cluster can be started.
slurm_missing() {
    local program
    for program in munged slurmctld slurmd sbatch scontrol squeue scancel; do
        PATH=$PATH:/usr/sbin:/sbin command -v "$program" >/dev/null || {
            echo "$program is not installed (Debian: slurm-wlm and munge)"
            return
        }
    done
}

slurm_port() {
    python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

# slurm_start FOLDER: starts the cluster and exports SLURM_CONF. The path of FOLDER must be short, because
# the path of a socket has at most 107 characters.
slurm_start() {
    slurm_folder=$(readlink -f "$1")
    local host user
    host=$(hostname -s)
    user=$(id -un)
    PATH=$PATH:/usr/sbin:/sbin
    mkdir -p "$slurm_folder"/{state,spool,log,run}
    export SLURM_CONF=$slurm_folder/slurm.conf
    cat >"$SLURM_CONF" <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(slurm_port)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$slurm_folder/run/munge.socket,cred_expire=4
CredType=cred/munge
StateSaveLocation=$slurm_folder/state
SlurmdSpoolDir=$slurm_folder/spool/%n
SlurmctldPidFile=$slurm_folder/run/slurmctld.pid
SlurmdPidFile=$slurm_folder/run/slurmd.%n.pid
SlurmctldLogFile=$slurm_folder/log/slurmctld.log
SlurmdLogFile=$slurm_folder/log/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
KillWait=20
SlurmctldTimeout=60
SlurmdTimeout=60
MaxArraySize=${SLURM_TEST_MAX_ARRAY_SIZE:-2}
NodeName=one NodeHostname=$host NodeAddr=127.0.0.1 Port=$(slurm_port) CPUs=1 RealMemory=2000
NodeName=two NodeHostname=$host NodeAddr=127.0.0.1 Port=$(slurm_port) CPUs=1 RealMemory=2000
PartitionName=all Nodes=one,two Default=YES MaxTime=INFINITE State=UP
END
    (umask 077 && head -c 256 /dev/urandom >"$slurm_folder/munge.key")
    munged --force --key-file="$slurm_folder/munge.key" --socket="$slurm_folder/run/munge.socket" \
        --pid-file="$slurm_folder/run/munged.pid" --log-file="$slurm_folder/log/munged.log" \
        --seed-file="$slurm_folder/run/munged.seed" || return
    slurmctld -c || return
    slurmd -N one && slurmd -N two || return
    local i
    for i in $(seq 100); do
        [ "$(sinfo --noheader --states=idle --format=%D 2>/dev/null)" = 2 ] && return
        sleep 0.3
    done
    echo "the nodes did not come up; see $slurm_folder/log" >&2
    return 1
}

slurm_stop() {
    local file pid
    for file in "$slurm_folder"/run/{slurmd.one,slurmd.two,slurmctld,munged}.pid; do
        pid=$(cat "$file" 2>/dev/null) || continue
        kill "$pid" 2>/dev/null
        while kill -0 "$pid" 2>/dev/null; do sleep 0.1; done
    done
}
