#!/bin/bash
# Tests a batch on a Slurm cluster of two nodes (`make test-slurm`), which the script starts on this
# machine and stops at the end. During the batch, a node is drained, a worker is killed and another worker
# is pre-empted. Each job must be done exactly once, with the same bytes as in an undisturbed run.
#
# usage: scripts/slurm_test.sh BUILD [JOBS]
#
# With more than 12 jobs, a worker is killed or requeued every few seconds until all jobs are done.
set -u
cd "$(dirname "$0")/.."
source scripts/slurm_cluster.sh
item3d=$PWD/${1:-build}/item3d
jobs=${2:-12}
export SOURCE_DATE_EPOCH=0  # results contain the date of their edit, so it must be fixed

missing=$(slurm_missing)
if [ -n "$missing" ]; then
    echo "test-slurm: skipped: $missing"
    exit 0
fi
folder=$(mktemp -d /tmp/i3slurm.XXXXXX)
finish() {
    [ -n "${requeued:-}" ] && kill "$requeued" 2>/dev/null
    slurm_stop
    [ -z "${keep:-}" ] && rm -rf "$folder"
}
trap finish EXIT
fail() {
    echo "test-slurm: FAILED: $*; see $folder" >&2
    keep=yes
    exit 1
}
# wait_for NAME COMMAND...: waits until the command succeeds, at most two minutes.
wait_for() {
    local what=$1 i
    shift
    for i in $(seq 600); do
        "$@" && return
        sleep 0.2
    done
    fail "$what did not come"
}

if ! slurm_start "$folder/slurm"; then
    echo "test-slurm: skipped: Slurm's daemons do not run here (containers may forbid what they need)"
    exit 0
fi
# Slurm delays the start of requeued jobs by two minutes. This loop starts them at once.
(
    while sleep 0.5; do
        for job in $(squeue --noheader --array --states=PENDING --format='%i %r' |
            awk '$2 == "BeginTime" { print $1 }'); do
            scontrol update "JobId=$job" StartTime=now
        done
    done
) >/dev/null 2>&1 &
requeued=$!

# The jobs take a few seconds. Every fourth job continues from the result of the job before it.
printf 'v %s\n' '0 0 0' '1 0 0' '1 1 0' '0 1 0' >"$folder/square.obj"
echo 'f 1 2 3 4' >>"$folder/square.obj"
settings=(--with iterations=10 --with texture-size=64 --with image-size=32 --with light-augment=off
    --with detail=off)
{
    echo "name,model,from,to,seed,after"
    for i in $(seq "$jobs"); do
        if [ $((i % 4)) = 0 ]; then
            echo "job$i,,a red square,a blue square,$i,job$((i - 1))"
        else
            echo "job$i,$folder/square.obj,a white square,a red square,$i,"
        fi
    done
} >"$folder/jobs.csv"

"$item3d" batch "$folder/jobs.csv" -o "$folder/alone" "${settings[@]}" --workers 2 --threads 1 --quiet ||
    fail "the undisturbed batch"
"$item3d" batch "$folder/jobs.csv" -o "$folder/out" "${settings[@]}" --slurm --workers 3 --threads 1 \
    --sbatch-option --time=0:30:00 || fail "the submission"
cat "$folder/out/slurm/workers.sh"

done_jobs() { find "$folder/out/runs" -maxdepth 3 -name result 2>/dev/null | wc -l; }
done_at_least() { [ "$(done_jobs)" -ge "$1" ]; }
worker_on() { squeue --noheader --array --states=RUNNING --nodelist="$1" --format=%i | head -1; }

wait_for "the first result" done_at_least 1
# A worker is killed, as the kernel does if memory is exhausted.
kill -KILL "$(pgrep -f "batch work $folder/out" | head -1)" || fail "no worker to kill"
wait_for "the third result" done_at_least 3
# A node is drained, and its worker gets SIGTERM, as in a pre-emption.
scontrol update NodeName=two State=DRAIN Reason=test
task=$(worker_on two)
[ -n "$task" ] && scancel --signal=TERM --batch "$task"
wait_for "the sixth result" done_at_least 6
scontrol update NodeName=two State=RESUME
task=$(worker_on one)
[ -n "$task" ] && scontrol requeue "$task"

disturbances=0
while [ "$jobs" -gt 12 ] && ! done_at_least "$jobs"; do
    sleep $((2 + RANDOM % 4))
    case $((RANDOM % 2)) in
        0) worker=$(pgrep -f "batch work $folder/out" | shuf -n 1) && kill -KILL "$worker" ;;
        1) task=$(squeue --noheader --array --states=RUNNING --format=%i | shuf -n 1) &&
            [ -n "$task" ] && scontrol requeue "$task" ;;
    esac && disturbances=$((disturbances + 1))
    [ -n "$(squeue --noheader)" ] || fail "no worker is left with $(done_jobs) of $jobs jobs done"
done

no_jobs_left() { [ -z "$(squeue --noheader)" ]; }
for i in $(seq 600); do
    no_jobs_left && break
    sleep 0.5
done
no_jobs_left || fail "jobs are still queued: $(squeue --noheader)"

[ "$(done_jobs)" = "$jobs" ] || fail "$(done_jobs) of $jobs jobs are done"
[ -s "$folder/out/slurm/summary.log" ] || fail "no summary"
cd "$folder/alone/runs" || fail "no reference"
compared=0
for model in */*/result/model.glb; do
    cmp "$model" "$folder/out/runs/$model" || fail "another result: $model"
    compared=$((compared + 1))
done
[ "$compared" = "$jobs" ] || fail "$compared results compared"
starts=$(cat "$folder"/out/slurm/*.log | grep -c '^task ')
echo "test-slurm: $jobs jobs done once, $starts starts of 3 workers, $disturbances more kills and requeues," \
    "all bytes as undisturbed"
