"""Lets GDAL and Pillow write heightmaps, imports each with the binary, and compares what came out.

usage: check_import.py BINARY        (needs rasterio, pillow, zarr)
"""

import pathlib
import subprocess
import sys
import tempfile
import warnings

import numpy as np
import rasterio
import zarr
from PIL import Image
from rasterio.crs import CRS
from rasterio.transform import from_origin

warnings.simplefilter("ignore", rasterio.errors.NotGeoreferencedWarning)
binary = str(pathlib.Path(sys.argv[1]).resolve())
folder = pathlib.Path(tempfile.mkdtemp())
y, x = np.mgrid[0:90, 0:130]
land = (700 * np.sin(x / 17) * np.cos(y / 13) + 4 * x).astype("f4")
low, high = float(land.min()), float(land.max())


def grown(name, **params):
    """The heights and cell of a world whose only stage imports a file."""
    lines = ["[[stage]]", 'kind = "import"', f'path = "{name}"', *(f"{k} = {v}" for k, v in params.items())]
    (folder / "recipe.toml").write_text("\n".join(lines) + "\n")
    run = [binary, "grow", "recipe.toml", "--quiet", "--force", "--out", "world"]
    subprocess.run(run, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    world = zarr.open_group(folder / "world/world.zarr", mode="r")
    return np.asarray(world["height"]), world.attrs["cell_m"]


def gdal(name, driver, data, crs=None, cell=(30.0, 30.0), west=5e5, north=5e6, **options):
    transform = from_origin(west, north, *cell)
    profile = dict(driver=driver, width=data.shape[1], height=data.shape[0], count=1, dtype=data.dtype)
    with rasterio.open(folder / name, "w", **profile, crs=crs, transform=transform, **options) as file:
        file.write(data, 1)


utm = CRS.from_epsg(32632)
for number, options in enumerate(
    [
        dict(compress="deflate", predictor=3, tiled=True, blockxsize=64, blockysize=64),
        dict(compress="lzw", predictor=2),
        dict(BIGTIFF="YES"),
        dict(ENDIANNESS="BIG", compress="packbits"),
    ]
):
    gdal(f"f{number}.tif", "GTiff", land, utm, **options)
    heights, cell_m = grown(f"f{number}.tif")
    np.testing.assert_array_equal(heights, land, err_msg=str(options))
    assert cell_m == 30.0, cell_m

metres = np.round(land).astype("i2")
gdal("metres.tif", "GTiff", metres, utm, compress="deflate", predictor=2)
np.testing.assert_array_equal(grown("metres.tif")[0], metres)

holes = land.copy()
holes[20:30, 40:60] = -9999
gdal("holes.tif", "GTiff", holes, utm, nodata=-9999)
heights, _ = grown("holes.tif")
np.testing.assert_array_equal(heights[holes != -9999], land[holes != -9999])
inside = heights[holes == -9999]
around = land[19:31, 39:61]
assert around.min() <= inside.min() and inside.max() <= around.max(), (inside.min(), inside.max())

# Half a minute at 60 degrees north: as long as 927 m, and half as wide; the map's cells are squares.
gdal("degrees.tif", "GTiff", land, CRS.from_epsg(4326), (1 / 120, 1 / 120), 10.0, 60 + 45 / 120)
heights, cell_m = grown("degrees.tif")
east_m, north_m = 130 / 120 * 111195 * 0.5, 90 / 120 * 111195
assert abs(heights.shape[1] * cell_m / east_m - 1) < 1e-3, (heights.shape, cell_m)
assert abs(heights.shape[0] * cell_m / north_m - 1) < 0.02, (heights.shape, cell_m)

gdal("grid.asc", "AAIGrid", land, utm, DECIMAL_PRECISION=6)
heights, cell_m = grown("grid.asc")
np.testing.assert_allclose(heights, land, atol=1e-4)
assert cell_m == 30.0

tile = np.round(900 * np.sin(np.mgrid[0:1201, 0:1201][1] / 90)).astype("i2")
corner = (7 - 0.5 / 1200, 47 + 0.5 / 1200)
gdal("N46E007.hgt", "SRTMHGT", tile, CRS.from_epsg(4326), (1 / 1200, 1 / 1200), *corner)
heights, cell_m = grown("N46E007.hgt")
assert heights.shape[0] == 1201 and abs(cell_m / 92.66 - 1) < 1e-3, (heights.shape, cell_m)
assert abs(heights.mean() - tile.mean()) < 1

levels = np.round((land - low) / (high - low) * 65535).astype("u2")
Image.fromarray(levels).save(folder / "p16.png")
step = (high - low) / 65535
heights, _ = grown("p16.png", low_m=low, high_m=high)
assert abs(heights - land).max() <= 0.51 * step + 1e-4, abs(heights - land).max()

few = np.round((land - low) / (high - low) * 255).astype("u1")
Image.fromarray(few).save(folder / "p8.png")
Image.fromarray(few).convert("RGB").convert("P", palette=Image.Palette.ADAPTIVE, colors=256).save(folder / "palette.png")
Image.fromarray(few).save(folder / "p8.tif", compression="tiff_lzw")
for name in ("p8.png", "palette.png", "p8.tif"):
    heights, _ = grown(name, low_m=low, high_m=high)
    assert abs(heights - land).max() <= 0.51 * 257 * step + 1e-3, name
smooth, _ = grown("p8.png", low_m=low, high_m=high, smooth=1.0)
stairs, _ = grown("p8.png", low_m=low, high_m=high)
rough = [np.std(np.diff(h, axis=1) - np.diff(land, axis=1)) for h in (smooth, stairs)]
assert rough[0] < 0.3 * rough[1], rough

print("heightmaps of GDAL and Pillow came in as they were written")
