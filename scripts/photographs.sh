#!/usr/bin/env bash
# Photographs to a model, the model edited, and that seen at sunset.
#
#   scripts/photographs.sh DATASET OUT ["a cow" ["a golden cow"]]
#   scripts/photographs.sh --from-images PICTURES OUT ["a cow" ["a golden cow"]]
#
# The second is for photographs without poses, with masks in PICTURES/masks (it needs colmap). Leaves OUT/model, OUT/edit and OUT/sunset, each with a model.glb and what to look at. A part that is finished
# is not made again, and one that was interrupted goes on.
set -euo pipefail
photographs=()
if [[ ${1:-} == --from-images ]]; then
    photographs=(--from-images)
    shift
fi
if (($# < 2)); then
    sed -n '2,8s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
    exit 2
fi
item3d=$(dirname "${BASH_SOURCE[0]}")/../build/item3d
dataset=$1 out=$2 from=${3:-a cow} to=${4:-a golden cow}

[[ -e $out/model/reconstruct.json ]] || "$item3d" reconstruct "${photographs[@]}" "$dataset" -o "$out/model" --resume
[[ -e $out/edit/edit.json ]] || "$item3d" edit "$out/model/model.glb" --from "$from" --to "$to" -o "$out/edit" --resume
"$item3d" relight "$out/edit/model.glb" -o "$out/sunset" --from-light "$out/model/light.hdr" --light sunset
echo "Open $out/model/report.html, $out/edit/report.html and $out/sunset/sheet.png"
