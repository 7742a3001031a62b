"""Opens vector maps with shapely and a plain XML parser: geometry valid, rings turned as RFC 7946 wants, rivers joined.

usage: check_vector.py FOLDER    (map.geojson, part.geojson, map.svg)
"""

import json
import sys
import xml.etree.ElementTree as tree
from collections import Counter
from pathlib import Path

from shapely.geometry import Point, shape
from shapely.ops import unary_union


def layers(path):
    text = json.loads(path.read_text())
    assert text["type"] == "FeatureCollection"
    found = {}
    for feature in text["features"]:
        geometry = shape(feature["geometry"])
        kind = feature["properties"]["layer"]
        assert geometry.is_valid, (path.name, kind, feature["properties"])
        assert not geometry.is_empty
        polygons = getattr(geometry, "geoms", [geometry])
        for polygon in polygons:
            if polygon.geom_type == "Polygon":
                assert polygon.exterior.is_ccw and not any(hole.is_ccw for hole in polygon.interiors), kind
        found.setdefault(kind, []).append((geometry, feature["properties"]))
    return text["upthrust"], found


def check_rivers(found, per_degree_m):
    """A river's reaches follow each other, and its end lies on what it says it ends in."""
    rivers = {}
    for line, about in found["river"]:
        rivers.setdefault(about["river"], []).append((about["reach"], line, about))
    lakes = {about["lake"]: geometry for geometry, about in found.get("lake", [])}
    land = unary_union([geometry for geometry, _ in found["land"]])
    lines = {}
    for number, reaches in rivers.items():
        reaches.sort(key=lambda reach: reach[0])
        for (_, a, p), (_, b, q) in zip(reaches, reaches[1:]):
            assert a.coords[-1] == b.coords[0], f"river {number} has a gap"
            assert p["discharge_m3_s"] <= q["discharge_m3_s"], f"river {number} loses water"
        lines[number] = {c for _, line, _ in reaches for c in line.coords}
    ends = Counter()
    for number, reaches in rivers.items():
        _, line, about = reaches[-1]
        end = line.coords[-1]
        ends[about["into"]] += 1
        if about["into"] == "river":
            assert end in lines[about["into_id"]], f"river {number} does not meet river {about['into_id']}"
        elif about["into"] == "lake":
            # The shore is drawn through half-flooded cells, so that a small lake's last cell may lie beyond it.
            assert lakes[about["into_id"]].distance(Point(end)) * per_degree_m < 10_000, f"river {number}"
        elif about["into"] == "sea":
            assert land.boundary.distance(Point(end)) * per_degree_m < 10_000, f"river {number} ends inland"
    return ends


def main(folder):
    about, found = layers(folder / "map.geojson")
    ends = check_rivers(found, about["metres_per_degree"])
    assert {"land", "contour", "river", "border", "motion", "peak", "plate"} <= found.keys(), found.keys()
    part_about, part = layers(folder / "part.geojson")
    half = [0.5 * 1000 * km / part_about["metres_per_degree"] for km in part_about["extent_km"]]
    for kind, features in part.items():
        for geometry, _ in features:
            west, south, east, north = geometry.bounds
            assert max(-west, east) <= half[0] * 1.0001 and max(-south, north) <= half[1] * 1.0001, kind
    svg = tree.parse(folder / "map.svg").getroot()
    groups = [g.get("id") for g in svg.iter("{http://www.w3.org/2000/svg}g") if g.get("id")]
    for wanted in ["tints", "contours", "rivers", "lakes", "coast", "plates", "borders", "motions", "peaks", "frame"]:
        assert wanted in groups, wanted
    counts = ", ".join(f"{len(features)} {kind}" for kind, features in sorted(found.items()))
    print(f"vector maps: {counts}; rivers end in {dict(ends)}")


main(Path(sys.argv[1]))
