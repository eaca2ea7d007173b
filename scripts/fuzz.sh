#!/usr/bin/env bash
# Runs each fuzz target of build-fuzz (or the named targets) for a number of seconds.
#
#   scripts/fuzz.sh SECONDS [TARGET ...]
#
# With FUZZ_INPUTS=N, the run of a target ends after N inputs if the seconds are not over before. With FUZZ_LENGTH=N,
# inputs have at most N bytes (65536 by default). Short inputs are read faster.
#
# The initial inputs are files of the tests and inputs that earlier runs kept. Inputs that reach new code are kept in
# build-fuzz/corpus/TARGET. Inputs that fail are stored as build-fuzz/findings/TARGET-*, and the script then ends with
# an error. After the fault is fixed, such an input belongs in tests/fuzz/corpus/TARGET, so that `make test` runs it.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:?usage: scripts/fuzz.sh SECONDS [TARGET ...]}
shift
build=build-fuzz
targets=("$@")
if [ $# = 0 ]; then
    for program in "$build"/fuzz_*; do
        [ -x "$program" ] && [ -f "$program" ] && targets+=("${program##*/fuzz_}")
    done
fi

# Prints the file name extensions that a target reads. Test files with these extensions are initial inputs, besides
# the files of tests/fuzz/seeds/TARGET.
seeds_of() {
    case $1 in
        gltf) echo 'glb gltf' ;;
        obj | mtl | png | webp | ktx2 | tiff | xmp) echo "$1" ;;
        jpeg) echo "jpg jpeg" ;;
        radiance) echo hdr ;;
        openexr) echo exr ;;
        stb) echo 'bmp tga gif' ;;
        image_packet) echo 'png jpg webp ktx2' ;;
        cameras) echo json ;;
        job_rows) echo 'csv jsonl' ;;
        image_light) echo glb ;;
        light_words) echo txt ;;
        safetensors | lora) echo safetensors ;;
        *) ;;
    esac
}

# The inputs are small, so one thread is enough.
export OMP_NUM_THREADS=1 ITEM3D_ASSETS=$PWD/assets
failed=()
mkdir -p "$build/findings"
for target in "${targets[@]}"; do
    program=$build/fuzz_$target
    corpus=$build/corpus/$target seeds=$build/seeds/$target
    rm -rf "$seeds"
    mkdir -p "$corpus" "$seeds"
    number=0
    for ending in $(seeds_of "$target"); do
        while read -r file; do
            cp "$file" "$seeds/$((++number)).$ending"
        done < <(find tests/data assets/demo -name "*.$ending" -size -200k)
    done
    if [ -d "tests/fuzz/seeds/$target" ]; then cp "tests/fuzz/seeds/$target"/* "$seeds"; fi
    log=$build/findings/$target.log
    # -close_fd_mask=3 closes stdout and stderr of the target, because readers print warnings for most inputs.
    # -reload=0: inputs that other processes add to the corpus are not read.
    if "$program" -max_total_time="$seconds" -runs="${FUZZ_INPUTS:--1}" -rss_limit_mb=2048 -timeout=20 -max_len="${FUZZ_LENGTH:-65536}" \
        -reload=0 -close_fd_mask=3 -artifact_prefix="$build/findings/$target-" -print_final_stats=1 "$corpus" "$seeds" \
        $([ -d "tests/fuzz/corpus/$target" ] && echo "tests/fuzz/corpus/$target") >"$log" 2>&1; then
        printf '%-14s %s inputs, %s kept\n' "$target" \
            "$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")" "$(ls "$corpus" | wc -l)"
    else
        failed+=("$target")
        printf '%-14s FAILED: %s\n' "$target" "$(grep -m 1 -E 'ERROR|runtime error|terminate|Test unit written' "$log" || tail -n 1 "$log")"
    fi
    # A target that ends early leaves its folder, which is named after its process.
    for folder in /dev/shm/item3d_fuzz_*; do
        [ -d "/proc/${folder##*_}" ] || rm -rf "$folder"
    done
done
if [ ${#failed[@]} -gt 0 ]; then
    echo "findings are in $build/findings: ${failed[*]}" >&2
    exit 1
fi
