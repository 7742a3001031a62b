"""Opens meshes with trimesh as a stranger would and checks what it finds.

usage: check_mesh.py WORLD.zarr FILE.glb FILE.obj FILE.stl        (needs trimesh and zarr)
"""

import sys

import numpy as np
import trimesh
import zarr

store, glb, obj, stl = sys.argv[1:]
world = zarr.open_group(store, mode="r")
width_cells, height_cells = world.attrs["size"]
cell_m = world.attrs["cell_m"]
extent_m = np.array([width_cells, height_cells]) * cell_m
low_m, high_m = float(np.min(world["height"])), float(np.max(world["height"]))

scene = trimesh.load(glb, process=False)
finest = [mesh for name, mesh in scene.geometry.items() if name.startswith("terrain_LOD0")]
assert len(finest) == 1, list(scene.geometry)
land = finest[0]
longer = min(512, max(width_cells, height_cells) + 1)
shorter = round((longer - 1) * min(extent_m) / max(extent_m)) + 1
assert len(land.vertices) == longer * shorter, (len(land.vertices), longer, shorter)
assert len(land.faces) == 2 * (longer - 1) * (shorter - 1)
np.testing.assert_allclose(land.extents[[0, 2]], extent_m, rtol=1e-6)
# The mesh's points lie between the cells, so the last few metres of peaks and pits may be cut or overshot.
slack = 0.05 * (high_m - low_m)
assert low_m - slack < land.bounds[0][1] and land.bounds[1][1] < high_m + slack
assert (land.face_normals[:, 1] > 0).all(), "a triangle faces down"
colours = land.visual.vertex_attributes["color"]
assert len(np.unique(colours, axis=0)) > 50, "the land has hardly any colour"

text = trimesh.load(obj, process=False)
assert len(text.faces) == len(land.faces)
np.testing.assert_allclose(text.bounds, land.bounds, rtol=1e-5, atol=1e-2)

solid = trimesh.load(stl)
assert solid.is_watertight and solid.is_winding_consistent, "the print is not closed"
assert solid.volume > 0
assert abs(solid.extents[0] - 150) < 1e-3, solid.extents
assert abs(solid.bounds[0][2]) < 1e-6, "the base does not lie at 0"
assert solid.body_count == 1

print(f"{glb}: {len(land.vertices)} points; {stl}: closed, {solid.volume / 1000:.1f} cm³")
