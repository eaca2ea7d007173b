#!/usr/bin/env bash
# Runs the tests of kernels, tensors, text, networks and guidance as they would run on other processors: with older
# instruction sets for the kernels of LibTorch, oneDNN and item3d, and with 1 to 4 threads. This finds tests that pass
# only on the developer's processor. The libraries ignore instruction sets that this processor lacks.
# usage: scripts/test_matrix.sh [BUILD]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${1:-build}
export ITEM3D_ASSETS=$PWD/assets
cells=(
    # With an older ATen level, oneDNN must not use AMX: otherwise LibTorch's attention packs bfloat16 for AMX and
    # asserts that ATen uses AVX-512. Each processor with AMX has AVX-512, so this combination does not occur.
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
    # Old processors, for all libraries at once.
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
