#!/usr/bin/env bash
# Reconstructs a model from photographs, edits it, and relights the edited model at sunset.
#
#   scripts/photographs.sh DATASET OUT ["a cow" ["a golden cow"]]
#   scripts/photographs.sh --from-images PICTURES OUT ["a cow" ["a golden cow"]]
#
# The second form is for photographs without camera poses, with masks in PICTURES/masks. It needs colmap.
# The sentences describe the model before and after the edit. The results are in OUT/model, OUT/edit and
# OUT/sunset, each with a model.glb and a report or images. If the script is interrupted, the same command
# continues; finished parts are kept.
set -euo pipefail
photographs=()
if [[ ${1:-} == --from-images ]]; then
    photographs=(--from-images)
    shift
fi
if (($# < 2)); then
    sed -n '2,10s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
    exit 2
fi
item3d=$(dirname "${BASH_SOURCE[0]}")/../build/item3d
dataset=$1 out=$2 from=${3:-a cow} to=${4:-a golden cow}

[[ -e $out/model/reconstruct.json ]] || "$item3d" reconstruct "${photographs[@]}" "$dataset" -o "$out/model" --resume
[[ -e $out/edit/edit.json ]] || "$item3d" edit "$out/model/model.glb" --from "$from" --to "$to" -o "$out/edit" --resume
"$item3d" relight "$out/edit/model.glb" -o "$out/sunset" --from-light "$out/model/light.hdr" --light sunset
echo "Open $out/model/report.html, $out/edit/report.html and $out/sunset/sheet.png"
