#!/usr/bin/env bash
# Keeps the timeline of a run, opens it with xarray, and replays it into the film that the run itself made.
#
# usage: timeline.sh BINARY PYTHON
set -euo pipefail
binary=$1 python=$2
here=$(dirname "$0")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# Plates alone: the very same film.
"$binary" grow collision --size 128 --quiet --keep-timeline=uplift --out "$folder/world" \
    --set climate.enabled=false --set rivers.enabled=false --set stream_power.enabled=false \
    --video "$folder/run.mp4" --video-size 320x180 >/dev/null
"$binary" film "$folder/world" "$folder/replay.mp4" --video-size 320x180 >/dev/null
cmp "$folder/run.mp4" "$folder/replay.mp4"
"$python" "$here/check_timeline.py" "$folder/world/world.zarr"
# With weather and rivers: the same but for rounding, since a timeline keeps heights, not the layers they are made of.
"$binary" grow collision --size 128 --quiet --keep-timeline --out "$folder/whole" --video "$folder/whole.mp4" >/dev/null
"$binary" film "$folder/whole" "$folder/again.mp4" >/dev/null
ffmpeg -v error -i "$folder/whole.mp4" -i "$folder/again.mp4" -lavfi "psnr=stats_file=$folder/psnr" -f null -
awk '{ for (i = 1; i <= NF; i++) if (sub("psnr_avg:", "", $i) && $i != "inf" && $i < 45) exit 1 }' "$folder/psnr"
