#!/usr/bin/env bash
# Runs blender/tests with each version of Blender that `scripts/setup.sh blender` has installed in .deps/blender.
#
# usage: scripts/test_blender.sh ITEM3D [TEST...]     TEST: for example test_core or test_core.Jobs
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
ITEM3D_PROGRAM=$(realpath "${1:?usage: scripts/test_blender.sh ITEM3D [TEST...]}")
export ITEM3D_PROGRAM PYTHONDONTWRITEBYTECODE=1
shift
failed=()
for folder in "$PWD"/.deps/blender/*/; do
    [[ -f $folder/python ]] || { echo "no Blender in .deps/blender; run: scripts/setup.sh blender" >&2; exit 1; }
    version=$(basename "$folder")
    echo "Blender $version, $(<"$folder/python")"
    PYTHONPATH=$folder "$(<"$folder/python")" -m blender.tests "$@" || failed+=("$version")
done
if ((${#failed[@]})); then
    echo "tests failed in Blender ${failed[*]}" >&2
    exit 1
fi
