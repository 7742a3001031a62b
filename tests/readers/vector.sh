#!/usr/bin/env bash
# Exports the rivers, coasts and plates of a fresh world as lines, and opens the files with programs that are not ours.
#
# usage: vector.sh BINARY PYTHON
set -euo pipefail
binary=$(realpath "$1")
python=$(realpath -s "$2")
check=$(dirname "$(realpath "$0")")/check_vector.py
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cat >world.toml <<'RECIPE'
[world]
seed = 11
size = 256
[[stage]]
kind = "plates"
count = 12
duration_myr = 5.0
[[stage]]
kind = "rivers"
RECIPE
"$binary" grow world.toml --quiet --out world >/dev/null
for file in map.geojson map.svg; do "$binary" export world "$file" >/dev/null; done
"$binary" export world part.geojson --window 200,300,400 --contours 250 >/dev/null
"$python" "$check" .
