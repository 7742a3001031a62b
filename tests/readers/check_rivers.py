"""Lets landlab and fastscapelib drain and erode the same land as the binary, and compares cell by cell.

usage: check_rivers.py BINARY        (needs numpy, zarr; compares with landlab and fastscapelib where they are installed)

Receivers are no layer of a world. They show in the number of cells above each cell, which changes where one of them does.
"""

import importlib.util
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import zarr

binary, scratch = pathlib.Path(sys.argv[1]).resolve(), tempfile.TemporaryDirectory()
folder = pathlib.Path(scratch.name)
# More than 128 rows, which the binary works on in more than one strip.
size, cell_m, steps, years, short, k, m = 150, 500.0, 10, 20_000.0, 200.0, 1e-5, 0.5
y, x = np.mgrid[0:size, 0:size]
rim = (x == 0) | (y == 0) | (x == size - 1) | (y == size - 1)
rng, held = np.random.default_rng(4), []
# A cone falls by 7.4 m at least to one of eight neighbours and its roughness is below 6 m, so there are no pits. The rim
# is not quite level, or a cell in the corner would have two ways down of one slope.
rough = rng.uniform(0, 6, (size, size))
cone = np.where(rim, 0.01 * rough, 900 - 8 * np.hypot(x - 73.3, y - 76.1) + rough).astype("f4").astype("f8")
# Fractal hills, a sixth of them under lakes.
waves = np.maximum(np.hypot(np.fft.fftfreq(size)[:, None], np.fft.fftfreq(size)), 1 / size)
hills = np.fft.ifft2(np.fft.fft2(rng.normal(size=(size, size))) / waves**2).real
hills = (1000 + 150 * (hills - hills.mean()) / hills.std()).astype("f4").astype("f8")


def stage(kind, **params):
    return "\n".join(["[[stage]]", f'kind = "{kind}"', *(f"{key} = {value}" for key, value in params.items())]) + "\n"


def erode(n, steps, years):
    law = dict(erodibility=k, m=m, n=n, rim='"fixed"', talus_angle_deg=89.0, diffusivity_m2_per_yr=0.0)
    return stage("stream_power", **law, duration_myr=years * steps / 1e6, step_kyr=years / 1e3)


world = f"[world]\nsize = {size}\nextent_km = {size * cell_m / 1e3}\nsea_level_m = -1000.0\n"
# Keeps every hollow as a lake and cuts no bed, so that it only counts.
count = stage("rivers", rain_mm_per_yr=1000.0, carve=0.0, smallest_lake_km2=0.0, shallowest_lake_m=0.0)


def ours(ground, stages):
    """The layers of a world grown from a ground, and the number of cells above each where there is a discharge."""
    ground.astype("<f4").tofile(folder / "ground.r32")
    (folder / "recipe.toml").write_text(world + stage("import", path='"ground.r32"') + stages)
    run = [binary, "grow", "recipe.toml", "--quiet", "--force", "--out", "world"]
    subprocess.run(run, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    group = zarr.open_group(folder / "world/world.zarr", mode="r")
    layers = {name: np.asarray(group[name], dtype="f8") for name in ("height", "wear", "discharge") if name in group}
    return layers | {"above": np.rint(layers.get("discharge", 0) * 365.25 * 86_400 / cell_m**2)}


class Fastscapelib:
    def __init__(self, *resolvers):
        self.grid = fs.RasterGrid([size, size], [cell_m, cell_m], fs.NodeStatus.FIXED_VALUE)  # the graph does not hold it
        self.graph = fs.FlowGraph(self.grid, [fs.SingleFlowRouter(), *resolvers])

    def above(self, z):
        self.filled = self.graph.update_routes(z).copy()
        return np.rint(self.graph.accumulate(1.0) / cell_m**2)

    def eroded(self, z, n):
        for _ in range(steps):
            z = z - self.wear(z, n, self.above(z), years)
        return z

    def wear(self, z, n, above, years):
        return fs.SPLEroder(self.graph, k, m, n, 1e-9).erode(z, above * cell_m**2, years).copy()


class Landlab:
    def above(self, z):
        self.grid = landlab.RasterModelGrid((size, size), xy_spacing=cell_m)
        self.z = self.grid.add_field("topographic__elevation", z.copy(), at="node")
        self.flow = landlab.components.FlowAccumulator(self.grid, flow_director="D8")
        self.flow.run_one_step()
        # To landlab a node of the rim has no cell of its own.
        return np.rint(self.grid.at_node["drainage_area"].reshape(size, size) / cell_m**2) + rim

    def eroded(self, z, n):
        self.above(z)
        eroder = landlab.components.FastscapeEroder(self.grid, K_sp=k, m_sp=m, n_sp=n)
        for _ in range(steps):
            self.flow.run_one_step()
            eroder.run_one_step(years)
        return self.z.reshape(size, size)


def compare(holds, line):
    held.append(bool(holds))
    print(line if holds else f"FAILED: {line}")


def without_pits(name, peer, *exponents):
    first = ours(cone, erode(1.0, 1, years) + count)
    same = (first["above"] == peer.above(first["height"])).mean()
    compare(same == 1, f"{name}, cells above each cell after a step: the same in {same:.2%} of cells")
    for n in exponents:
        theirs = peer.eroded(cone, n)
        apart = np.abs(ours(cone, erode(n, steps, years))["height"] - theirs).max()
        figures = f"worn by up to {(cone - theirs).max():.0f} m, apart by up to {apart:.1e} m"
        # A world stores f32, which rounds by half of this; the rest is for landlab's powers, which are of single precision.
        compare(apart < np.spacing(np.float32(cone.max())), f"{name}, n = {n}, {steps} steps: {figures}")


def with_lakes(name, peer):
    above, plain = peer.above(hills), Fastscapelib()
    same, dry = ours(hills, count)["above"] == above, peer.filled < hills + 1e-9
    # A saddle has as many passes of one height as it has lower cells on the far side, and each program takes the first it
    # comes upon. Below such a lake water then goes another way for some cells.
    share = same[dry].mean()
    compare(share > 0.99, f"{name}, {np.mean(~dry):.0%} lakes, cells above each cell: the same in {share:.2%} of the others")
    # Where the steepest way down meets no pit, lakes change nothing but the water that comes: heights are the same.
    plain.above(hills)
    ways, clear = plain.graph.impl(), np.zeros(hills.size, bool)
    for i, below in zip(ways.dfs_indices, ways.receivers[ways.dfs_indices, 0]):
        clear[i] = same.flat[i] and (rim.flat[i] if below == i else clear[below])
    for n in (1.0, 2.0):
        apart = np.abs(ours(hills, erode(n, 1, years))["height"] - hills + peer.wear(hills, n, above, years)).flat[clear]
        figures = f"{apart.size} cells, apart by up to {apart.max():.1e} m"
        compare(apart.max() < np.spacing(np.float32(hills.max())), f"{name}, n = {n}, below all lakes: {figures}")
        # Of lakes only the wear in all, in one short step: ours lays sediment in them, theirs does not. Theirs lowers a
        # filled lake like a river of next to no slope, and cuts its floor where the outlet is cut below that; ours keeps
        # such a floor until the next step. In 20 ky and with n of 1 that is up to a tenth of all wear, in 20 y nothing.
        theirs = np.maximum(hills - peer.filled + peer.wear(peer.filled, n, above, short), 0)
        more = ours(hills, erode(n, 1, short))["wear"].sum() / theirs.sum() - 1
        compare(abs(more) < 0.005, f"{name}, n = {n}, lakes and all, a step of {short:.0f} y: wear {more:+.2%} in all")


for name in ("fastscapelib", "landlab"):
    if not importlib.util.find_spec(name):
        print(f"not compared: {name} is not installed")
    elif name == "landlab":
        import landlab.components
        # Much below 1 the drops of some cells vanish in these steps, and rounding decides their ways.
        without_pits(name, Landlab(), 0.9, 1.0, 1.5, 2.0)
    else:
        import fastscapelib as fs
        # Version 0.3.0 takes every n below 1 for 1.
        without_pits(name, Fastscapelib(), 1.0, 1.5, 2.0)
        with_lakes(name, Fastscapelib(fs.MSTSinkResolver()))
print(f"rivers: {sum(held)} of {len(held)} comparisons hold")
sys.exit(not all(held))
