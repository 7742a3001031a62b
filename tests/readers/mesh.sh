#!/usr/bin/env bash
# Grows a small world, exports it as meshes, and opens them with trimesh.
#
# usage: mesh.sh BINARY PYTHON
set -euo pipefail
binary=$1 python=$2
here=$(dirname "$0")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$binary" grow erode-my-map --size 200x150 --quiet --out "$folder/world"
for ending in glb obj stl; do
    "$binary" export "$folder/world" "$folder/land.$ending"
done
"$python" "$here/check_mesh.py" "$folder/world/world.zarr" "$folder/land.glb" "$folder/land.obj" "$folder/land.stl"
