#!/usr/bin/env bash
# Runs every benchmark program of a build folder and stores the results in BUILD/bench/ as JSON.
# usage: scripts/bench.sh BUILD
set -euo pipefail
build=${1:?usage: scripts/bench.sh BUILD}
mkdir -p "$build/bench"
found=0
for program in "$build"/bench_*; do
    [[ -f $program && -x $program ]] || continue
    found=1
    name=$(basename "$program")
    echo "== $name"
    "$program" --benchmark_out="$build/bench/$name.json" --benchmark_out_format=json
done
((found)) || { echo "bench: no benchmark was built in $build" >&2; exit 1; }
echo "The numbers are in $build/bench"
