#!/usr/bin/env bash
# Records the particles of a small eruption, and opens the recording and what is exported of it with programs that are not ours.
#
# usage: bake.sh BINARY PYTHON
set -euo pipefail
binary=$(realpath "$1")
python=$(realpath -s "$2")
check=$(dirname "$(realpath "$0")")/check_bake.py
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cat >fire.toml <<'RECIPE'
name = "Fire"
[world]
seed = 3
size = 40
extent_km = 0.05
[[stage]]
kind = "rmp_peak"
height_m = 12.0
half_width_km = 0.015
[[stage]]
kind = "lava"
duration_min = 0.05
spacing_m = 0.8
schedule = [{ start_time = 0, duration = 2, particles_per_second = 150 }]
RECIPE
"$binary" grow fire.toml --quiet --bake --bake-rate 20 --out world >/dev/null
for file in frame.ply frame.csv; do "$binary" export world/lava.upbake "$file" --at 2.5 >/dev/null; done
"$python" "$check" world/lava.upbake 50 frame.ply frame.csv
