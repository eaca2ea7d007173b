#!/usr/bin/env bash
# Runs clang-tidy (.clang-tidy) on the sources named, or on all of them. Needs a configured build
# folder and the packages clang-tidy and libomp-dev.
# usage: scripts/lint.sh [FILE...]; BUILD=FOLDER takes the compile commands of another build
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${BUILD:-build}
command -v clang-tidy >/dev/null || { echo "lint: error: install clang-tidy and libomp-dev" >&2; exit 1; }
[[ -f $build/compile_commands.json ]] || { echo "lint: error: $build is not configured" >&2; exit 1; }
files=("$@")
((${#files[@]})) || mapfile -t files < <(find apps bench src tests tools -name '*.cpp' | sort)

# The precompiled header is g++'s; sources include what they need, so clang goes without it.
commands=$(mktemp -d)
trap 'rm -rf "$commands"' EXIT
sed -E 's/-Winvalid-pch -include [^ ]+//' "$build/compile_commands.json" >"$commands/compile_commands.json"
printf '%s\0' "${files[@]}" |
    xargs -0 -n 1 -P "$(scripts/jobs.sh)" clang-tidy --quiet -p "$commands" \
        2> >(grep -vE 'warnings? (and [0-9]+ errors? )?generated' >&2)
