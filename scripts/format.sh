#!/usr/bin/env bash
# Formats all C++ and CUDA sources. With --check, lists unformatted sources instead, and fails if there are any.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mapfile -t files < <(find apps bench python src tests tools -type f \
    \( -name '*.cpp' -o -name '*.h' -o -name '*.cu' -o -name '*.cuh' \) | sort)
if [[ ${1:-} != --check ]]; then
    clang-format -i "${files[@]}"
    exit
fi
command -v clang-format >/dev/null || { echo "format: clang-format is missing; run scripts/setup.sh" >&2; exit 1; }
status=0
found=$(printf '%s\0' "${files[@]}" | xargs -0 -n 100 -P "$(nproc)" clang-format --dry-run -Werror 2>&1) || status=$?
mapfile -t unformatted < <(sed -n 's/^\([^:]*\):[0-9]*:[0-9]*: error: .*/\1/p' <<<"$found" | sort -u)
if ((status != 0 && ${#unformatted[@]} == 0)); then
    echo "format: clang-format failed: $found" >&2
    exit 1
fi
if ((${#unformatted[@]})); then
    printf 'not formatted: %s\n' "${unformatted[@]}" >&2
    echo "run: make format" >&2
    exit 1
fi
echo "format: ${#files[@]} files are formatted"
