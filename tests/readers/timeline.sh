#!/usr/bin/env bash
# Keeps the timeline of a run, opens it with xarray, and replays it into the film that the run itself made.
#
# usage: timeline.sh BINARY PYTHON
set -euo pipefail
binary=$1 python=$2
here=$(dirname "$0")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# Plates alone: a timeline keeps heights and the layers it is told to, not the weather and rivers that colour a carved run.
"$binary" grow collision --size 128 --quiet --keep-timeline=uplift --out "$folder/world" \
    --set climate.enabled=false --set rivers.enabled=false --set stream_power.enabled=false \
    --video "$folder/run.mp4" --video-size 320x180 >/dev/null
"$binary" film "$folder/world" "$folder/replay.mp4" --video-size 320x180 >/dev/null
cmp "$folder/run.mp4" "$folder/replay.mp4"
"$python" "$here/check_timeline.py" "$folder/world/world.zarr"
