#!/usr/bin/env bash
# Runs the tests of kernels, networks and guidance as other processors would: with lower levels of LibTorch's and
# of our own kernels, and with 1 to 4 threads, so that a test that passes by the luck of one processor
# fails on the machine that writes it. Levels that this processor lacks are left out by the libraries.
# usage: scripts/test_matrix.sh [BUILD]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${1:-build}
export ITEM3D_ASSETS=$PWD/assets
cells=(
    # Without AMX as well: LibTorch's attention packs bfloat16 for AMX whenever oneDNN has it, and asserts
    # its own AVX-512 level there. No processor has the first without the second.
    "ATEN_CPU_CAPABILITY=default ONEDNN_MAX_CPU_ISA=AVX512_CORE_BF16"
    "ATEN_CPU_CAPABILITY=avx2 ONEDNN_MAX_CPU_ISA=AVX512_CORE_BF16"
    ONEDNN_MAX_CPU_ISA=AVX2
    ONEDNN_MAX_CPU_ISA=AVX512_CORE
    ITEM3D_CPU=none
    ITEM3D_CPU=avx2
    ITEM3D_CPU=avx512
    ITEM3D_CPU=bf16
    ITEM3D_TEST_THREADS=1
    ITEM3D_TEST_THREADS=2
    ITEM3D_TEST_THREADS=3
    ITEM3D_TEST_THREADS=4
    # An old processor, whole.
    "ATEN_CPU_CAPABILITY=default ONEDNN_MAX_CPU_ISA=SSE41 ITEM3D_CPU=none ITEM3D_TEST_THREADS=3"
    "ATEN_CPU_CAPABILITY=avx2 ONEDNN_MAX_CPU_ISA=AVX2 ITEM3D_CPU=avx2 ITEM3D_TEST_THREADS=4"
)
log=$(mktemp)
trap 'rm -f "$log"' EXIT
failed=0
for cell in "${cells[@]}"; do
    for test in kernels tensors text networks guidance; do
        # shellcheck disable=SC2086
        if ! env $cell "$build/test_$test" --gtest_brief=1 >"$log" 2>&1; then
            failed=1
            echo "matrix: $cell: test_$test failed" >&2
            cat "$log" >&2
        fi
    done
    echo "matrix: $cell"
done
exit $failed
