#!/usr/bin/env bash
# Runs clang-tidy (.clang-tidy) on the named sources, or on all sources. Needs a configured build folder and the
# packages clang-tidy and libomp-dev.
# usage: scripts/lint.sh [FILE...]; the environment variable BUILD names another build folder than build
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${BUILD:-build}
command -v clang-tidy >/dev/null || { echo "lint: error: install clang-tidy and libomp-dev" >&2; exit 1; }
[[ -f $build/compile_commands.json ]] || { echo "lint: error: $build is not configured" >&2; exit 1; }
files=("$@")
((${#files[@]})) || mapfile -t files < <(find apps bench src tests tools -name '*.cpp' | sort)

# Clang cannot read g++'s precompiled header. It is left out, because sources include all headers that they need.
commands=$(mktemp -d)
trap 'rm -rf "$commands"' EXIT
sed -E 's/-Winvalid-pch -include [^ ]+//' "$build/compile_commands.json" >"$commands/compile_commands.json"
printf '%s\0' "${files[@]}" |
    xargs -0 -n 1 -P "$(scripts/jobs.sh)" clang-tidy --quiet -p "$commands" \
        2> >(grep -vE 'warnings? (and [0-9]+ errors? )?generated' >&2)
