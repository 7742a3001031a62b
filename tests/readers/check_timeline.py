"""Opens a kept timeline with xarray.

usage: check_timeline.py WORLD.ZARR
"""

import sys

import numpy as np
import xarray as xr

store = sys.argv[1]
kept = xr.open_zarr(store, group="timeline")
world = xr.open_zarr(store)
assert kept.height.dims == ("t", "y", "x"), kept.height.dims
assert kept.height.attrs["units"] == "m" and kept.uplift.attrs["units"] == "mm/yr", kept.height.attrs
assert kept.sizes["t"] > 20, kept.sizes
assert (np.diff(kept.t.values) > 0).all(), "the clock runs forward"
assert np.array_equal(kept.x.values, world.x.values) and np.array_equal(kept.y.values, world.y.values)
assert np.array_equal(kept.height[-1].values, world.height.values), "the last frame is the finished world"
assert kept.done.values[-1] == 1.0 and (kept.stage.values == 0).all()
print(f"{kept.sizes['t']} moments from {kept.t.values[0]:.3g} to {kept.t.values[-1]:.3g} years")
