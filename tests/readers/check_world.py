"""Opens a world with xarray as a stranger would and checks what it finds.

usage: check_world.py WORLD.zarr        (needs xarray and zarr)
"""

import sys
import warnings

import numpy as np
import xarray as xr

with warnings.catch_warnings():
    warnings.simplefilter("error")
    world = xr.open_zarr(sys.argv[1])
    tree = xr.open_datatree(sys.argv[1], engine="zarr")

height = world["height"]
assert height.dims == ("y", "x"), height.dims
assert height.dtype == np.float32 and height.attrs["units"] == "m"
width_cells, height_cells = world.attrs["size"]
assert height.shape == (height_cells, width_cells)

cell_m = world.attrs["cell_m"]
for axis, cells in (("x", width_cells), ("y", height_cells)):
    centres = world[axis]
    assert centres.dims == (axis,) and centres.dtype == np.float64
    assert centres.attrs["units"] == "m" and centres.attrs["axis"] == axis.upper()
    np.testing.assert_allclose(centres, (np.arange(cells) + 0.5) * cell_m, rtol=1e-15)

for name, layer in world.data_vars.items():
    assert layer.dims == ("y", "x") and "units" in layer.attrs and "long_name" in layer.attrs, name
    assert np.isfinite(layer.values).all(), name
column = sum(world[name].astype("f4") for name in ("bedrock", "lava", "sediment") if name in world)
np.testing.assert_array_equal(column, height)

for name in ("name", "recipe", "seed", "version", "sea_level_m", "time_yr", "edges", "ledger"):
    assert name in world.attrs, name
for name in world.attrs["tables"]:
    table = tree[f"tables/{name}"].to_dataset(inherit=False)
    assert set(table.variables) == set(table.attrs["columns"]), name
    for column in table.attrs["columns"]:
        assert table[column].dims == ("row",), column
        table[column].load()

print(f"{sys.argv[1]}: {height_cells} x {width_cells} cells, {len(world.data_vars)} layers, tables {world.attrs['tables']}")
