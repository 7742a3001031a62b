"""Opens exported files with programs that are not ours and compares them with each other and with their sidecars.

usage: check_export.py FOLDER       (made by export.sh; needs rasterio, Pillow, opencv-python-headless, OpenEXR)
"""

import json
import pathlib
import sys
import warnings

import cv2
import numpy as np
import OpenEXR
import rasterio
from PIL import Image

folder = pathlib.Path(sys.argv[1])
# Plain numbers for a picture or a part of one have no place on a map, which rasterio remarks on.
warnings.filterwarnings("ignore", category=rasterio.errors.NotGeoreferencedWarning)


def sidecar(name):
    return json.loads((folder / f"{name}.json").read_text())


def metres(values, said):
    return said["black_m"] + values.astype(np.float64) * (said["white_m"] - said["black_m"]) / 65535.0


def within_half_a_step(values, said, heights):
    step = (said["white_m"] - said["black_m"]) / 65535.0
    assert np.abs(metres(values, said) - heights).max() <= step * 0.5001


# Floating point: every reader gives the same bits.
said = sidecar("h.tif")
width, height = said["size"]
with rasterio.open(folder / "h.tif") as tif:
    heights = tif.read(1)
    assert tif.dtypes == ("float32",) and (tif.width, tif.height) == (width, height)
    assert tif.res == (said["metres_per_sample"],) * 2, tif.res
    assert tif.bounds.left == 0 and tif.bounds.bottom == 0, tif.bounds
    assert 'UNIT["metre",1' in tif.crs.to_wkt(), tif.crs
    assert tif.tags()["AREA_OR_POINT"] == "Area"
with rasterio.open(folder / "h.asc") as asc:
    assert asc.res == tuple([said["metres_per_sample"]] * 2) and asc.bounds.left == 0 and asc.bounds.bottom == 0
    np.testing.assert_array_equal(asc.read(1), heights)
exr = OpenEXR.File(str(folder / "h.exr")).channels()
assert list(exr) == ["Y"], list(exr)
np.testing.assert_array_equal(exr["Y"].pixels, heights)
np.testing.assert_array_equal(np.fromfile(folder / "h.r32", "<f4").reshape(height, width), heights)

# 16 bits: within half a step of them.
opened = cv2.imread(str(folder / "h.png"), cv2.IMREAD_UNCHANGED)
assert opened.dtype == np.uint16 and opened.shape == (height, width), (opened.dtype, opened.shape)
np.testing.assert_array_equal(np.asarray(Image.open(folder / "h.png")), opened)
within_half_a_step(opened, sidecar("h.png"), heights)
with rasterio.open(folder / "h16.tif") as tif:
    assert tif.dtypes == ("uint16",)
    np.testing.assert_array_equal(tif.read(1), opened)
    # GDAL's scale and offset make metres of the numbers.
    scaled = tif.read(1) * tif.scales[0] + tif.offsets[0]
    assert np.abs(scaled - heights).max() <= 0.5001 * tif.scales[0] + 1e-3, (tif.scales, tif.offsets)
np.testing.assert_array_equal(np.fromfile(folder / "h.r16", "<u2").reshape(height, width), opened)
np.testing.assert_array_equal(np.fromfile(folder / "south.raw", ">u2").reshape(height, width)[::-1], opened)

# A window knows where it lies; samples that are vertices are points.
said = sidecar("window.tif")
x_m, y_m = said["corner_m"]
cell_m = said["metres_per_sample"]
with rasterio.open(folder / "window.tif") as tif:
    west, north = round(x_m / cell_m), round(y_m / cell_m)
    np.testing.assert_array_equal(tif.read(1), heights[north : north + tif.height, west : west + tif.width])
    assert abs(tif.bounds.left - x_m) < 1e-6 and abs(tif.bounds.top - (height * cell_m - y_m)) < 1e-6
with rasterio.open(folder / "tile_x0_y0.tif") as tile, rasterio.open(folder / "tile_x1_y0.tif") as east:
    assert tile.tags()["AREA_OR_POINT"] == "Point"
    np.testing.assert_array_equal(tile.read(1)[:, -1], east.read(1)[:, 0])
    side_m = (tile.width - 1) * tile.res[0]
    assert abs(east.bounds.left - tile.bounds.left - side_m) < 1e-6

# What Unreal does with the numbers to type gives metres above the sea.
said = sidecar("unreal.png")
values = np.asarray(Image.open(folder / "unreal.png")).astype(np.float64)
typed = said["import"]
assert values.shape == (typed["overall_resolution"],) * 2
height_m = ((values - 32768) / 128 * typed["scale_z"] + typed["location_z_cm"]) / 100
assert np.abs(height_m - (metres(values, said) - said["sea_level_m"])).max() < 1e-3
range_cm = (said["white_m"] - said["black_m"]) * 100
assert abs(typed["scale_z"] / (range_cm / 512) - 1) < 2e-5
materials = [np.asarray(Image.open(folder / f"unreal_{name}.png")) for name in ("sand", "grass", "rock", "snow")]
assert all(m.dtype == np.uint8 and m.shape == values.shape for m in materials)
assert (np.sum(materials, axis=0, dtype=int) == 255).all()

# Normals are unit vectors that face up.
normals = np.asarray(Image.open(folder / "normals.png").convert("RGB")).astype(np.float64) / 127.5 - 1
assert np.abs(np.linalg.norm(normals, axis=2) - 1).max() < 0.02 and (normals[:, :, 2] > 0).all()

# A map program's grays: the sea below lightness 13, land from 20 on.
said = sidecar("map.png")
gray = np.asarray(Image.open(folder / "map.png"))
assert gray.dtype == np.uint8
land = heights > said["sea_level_m"]
assert (gray[land] >= 48).all() and (gray[~land] <= 34).all()

print(f"{folder}: {width} x {height} heights agree in 7 formats, {len(list(folder.iterdir()))} files read")
