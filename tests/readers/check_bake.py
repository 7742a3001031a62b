"""Reads a recording of particles by its documented bytes alone, and compares a frame with its exports.

usage: check_bake.py FILE.upbake FRAME FILE.ply FILE.csv       (needs numpy, trimesh, and numcodecs, which comes with zarr)
"""

import hashlib
import json
import struct
import sys

import numpy as np
import trimesh
from numcodecs.zstd import Zstd


def read(path):
    """The header, and all frames as (numbers, a column each of values)."""
    data = open(path, "rb").read()
    assert data[:6] == b"UPBAKE"
    version, length = struct.unpack("<HI", data[6:12])
    assert version == 1
    text = data[44 : 44 + length]
    assert hashlib.sha256(text).digest() == data[12:44]
    header, at = json.loads(text), 44 + length
    hashes = hashlib.sha256(data[:at]).digest()
    frames, chunks, units = [], 0, []
    while data[at : at + 4] == b"CHNK":
        first, count, _step, packed, unpacked = struct.unpack("<5I", data[at + 4 : at + 24])
        body = data[at + 56 : at + 56 + packed]
        digest = data[at + 24 : at + 56]
        assert hashlib.sha256(data[at + 4 : at + 24] + body).digest() == digest
        assert first == len(frames)
        raw = bytes(Zstd().decode(body))
        assert len(raw) == unpacked
        new, unit = unpack(raw, count, len(header["columns"]))
        frames += new
        units.append(unit)
        hashes += digest
        chunks, at = chunks + 1, at + 56 + packed
    assert data[at : at + 4] == b"DONE"
    end = struct.unpack("<I3Q", data[at + 4 : at + 32])
    assert hashlib.sha256(data[at + 4 : at + 32] + hashes).digest() == data[at + 32 :]
    sizes = [len(ids) for ids, _ in frames]
    assert end == (chunks, len(frames), sum(sizes), max(sizes)), (end, len(frames))
    assert len(frames) == header["frames"]
    return header, frames, np.max(units, axis=0)


def unpack(raw, count, columns):
    """The frames of a chunk."""
    scales = np.frombuffer(raw, "<f8", 2 * columns).reshape(columns, 2)
    at, frames, before = 16 * columns, [], ({}, None)
    for _ in range(count):
        (n,) = struct.unpack("<I", raw[at : at + 4])
        ids = np.cumsum(np.frombuffer(raw, "<u4", n, at + 4))
        at += 4 + 4 * n
        wholes = np.zeros((columns, n), np.uint16)
        old = [before[0].get(int(i), -1) for i in ids]
        for column in range(columns):
            low, high = np.frombuffer(raw, np.uint8, 2 * n, at).reshape(2, n).astype(np.uint16)
            at += 2 * n
            folded = low | (high << 8)
            difference = (folded >> 1) ^ (-(folded & 1).astype(np.int16)).view(np.uint16)
            base = [before[1][column, k] if k >= 0 else 0 for k in old]
            wholes[column] = difference + np.array(base, np.uint16)
        frames.append((ids, scales[:, :1] + scales[:, 1:] * wholes))
        before = ({int(i): k for k, i in enumerate(ids)}, wholes)
    assert at == len(raw)
    return frames, scales[:, 1]


path, number, ply, csv = sys.argv[1:]
header, frames, units = read(path)
assert [c["name"] for c in header["columns"]] == ["x", "y", "z", "temperature", "age"], header["columns"]
assert (header["seed"], header["stage"], header["frames_per_s"]) == (3, "lava", 20.0), header
assert header["parameters"]["spacing_m"] == 0.8
ids, values = frames[int(number)]
assert len(ids) > 200

rows = np.genfromtxt(csv, delimiter=",", names=True)
np.testing.assert_array_equal(rows["id"], ids)
names = ["x_m", "y_m", "z_m", "temperature_degc", "age_s"]
for name, column, digit in zip(names, values, [1e-4, 1e-4, 1e-4, 1e-3, 1e-4]):
    np.testing.assert_allclose(rows[name], column, atol=0.51 * digit, rtol=0)

points = trimesh.load(ply)
assert points.vertices.shape == (len(ids), 3)
width, height = header["extent_m"]
want = np.column_stack([values[0] - width / 2, height / 2 - values[1], values[2]])
np.testing.assert_allclose(points.vertices, want, atol=1e-4)
kept = points.metadata["_ply_raw"]["vertex"]["data"]
np.testing.assert_allclose(np.ravel(kept["temperature"]), values[3], rtol=1e-6)
np.testing.assert_allclose(np.ravel(kept["age"]), values[4], rtol=1e-6, atol=1e-6)
np.testing.assert_array_equal(np.ravel(kept["id"]), ids)
assert abs(4 / 3 * np.pi * header["radius_m"] ** 3 - 0.8**3) < 1e-9, header["radius_m"]

# Hot, on its way down, and nobody older than the frame.
assert 900 < values[3].min() and values[3].max() < 1151, (values[3].min(), values[3].max())
assert 0 <= values[4].min() and values[4].max() <= 2.5 + units[4]
print(f"{path}: {len(frames)} frames, {len(ids)} particles in frame {number}, places within {units[:3].max() / 2:.1e} m")
