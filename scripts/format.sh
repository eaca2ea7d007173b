#!/usr/bin/env bash
# Formats all C++ and CUDA sources, or with --check lists those that are not formatted and fails.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mapfile -t files < <(find apps bench python src tests tools -type f \
    \( -name '*.cpp' -o -name '*.h' -o -name '*.cu' -o -name '*.cuh' \) | sort)
if [[ ${1:-} != --check ]]; then
    clang-format -i "${files[@]}"
    exit
fi
unformatted=()
for file in "${files[@]}"; do
    clang-format --dry-run -Werror "$file" 2>/dev/null || unformatted+=("$file")
done
if ((${#unformatted[@]})); then
    printf 'not formatted: %s\n' "${unformatted[@]}" >&2
    echo "run: make format" >&2
    exit 1
fi
echo "format: ${#files[@]} files are formatted"
