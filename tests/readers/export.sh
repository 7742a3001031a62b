#!/usr/bin/env bash
# Exports a fresh world in every format and opens the files with programs that are not ours.
#
# usage: export.sh BINARY PYTHON
set -euo pipefail
binary=$(realpath "$1")
python=$(realpath -s "$2")
check=$(dirname "$(realpath "$0")")/check_export.py
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"$binary" grow collision --size 256 --quiet --out world >/dev/null
mkdir files
export_to() { "$binary" export world "files/$1" "${@:2}" >/dev/null; }
for ending in png tif exr asc r16 r32; do export_to "h.$ending"; done
export_to h16.tif --bits 16
export_to south.raw --big-endian --flip y
export_to window.tif --window 125,250,500
export_to tile.tif --tiles 2
export_to unreal.png --engine unreal
export_to unity.raw --engine unity
export_to normals.png --layer normals
export_to map.png --engine azgaar
"$python" "$check" files
