#!/usr/bin/env python3
"""Writes the scenes of the table of raster costs in docs/benchmarks.md to a folder: closed double-sided spheres of 840, 9,800 and 159,200
triangles, and soups of 3,000, 30,000 and 300,000 random triangles, each with the same numbers every time.

usage: scripts/raster_scenes.py FOLDER

The soups fill the picture from `--set 'camera.eye=[0,0,3]' --set 'camera.target=[0,0,0]' --set camera.fov_y_deg=38`.
"""

import json
import math
import random
import struct
import sys
from array import array
from pathlib import Path


def write_glb(path, attributes, indices):
    """Writes one double-sided primitive: attributes are name -> array of floats, three a vertex."""
    views, accessors, body = [], [], b""
    for values in [*attributes.values(), *([indices] if indices else [])]:
        is_index = values is indices
        view = {"buffer": 0, "byteOffset": len(body), "byteLength": len(values) * 4}
        accessor = {"bufferView": len(views), "componentType": 5125 if is_index else 5126}
        accessor |= {"count": len(values) if is_index else len(values) // 3, "type": "SCALAR" if is_index else "VEC3"}
        views.append(view)
        accessors.append(accessor)
        body += values.tobytes()
    position = attributes["POSITION"]
    accessors[0] |= {"min": [min(position[k::3]) for k in range(3)], "max": [max(position[k::3]) for k in range(3)]}
    primitive = {"attributes": {name: i for i, name in enumerate(attributes)}, "material": 0}
    if indices:
        primitive["indices"] = len(attributes)
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "materials": [{"doubleSided": True}],
        "meshes": [{"primitives": [primitive]}],
        "buffers": [{"byteLength": len(body)}],
        "bufferViews": views,
        "accessors": accessors,
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body += b"\0" * (-len(body) % 4)
    head = struct.pack("<III", 0x46546C67, 2, 28 + len(text) + len(body)) + struct.pack("<II", len(text), 0x4E4F534A)
    path.write_bytes(head + text + struct.pack("<II", len(body), 0x004E4942) + body)
    print(path)


def sphere(folder, segments):
    """A closed sphere of `segments` by half as many rings."""
    rings = segments // 2
    vertices = array("f")
    for i in range(1, rings):
        polar = math.pi * i / rings
        for k in range(segments):
            turn = 2 * math.pi * k / segments
            vertices.extend((math.sin(polar) * math.cos(turn), math.cos(polar), math.sin(polar) * math.sin(turn)))
    vertices.extend((0.0, 1.0, 0.0, 0.0, -1.0, 0.0))
    north, south = len(vertices) // 3 - 2, len(vertices) // 3 - 1
    last = (rings - 2) * segments
    indices = array("I")
    for i in range(segments):
        next_one = (i + 1) % segments
        indices.extend((north, next_one, i, south, last + i, last + next_one))
        for ring in range(rings - 2):
            a, b = ring * segments + i, ring * segments + next_one
            indices.extend((a, b, a + segments, b, b + segments, a + segments))
    write_glb(folder / f"mesh-{len(indices) // 3}.glb", {"POSITION": vertices, "NORMAL": vertices[:]}, indices)


def soup(folder, count, size):
    """Random triangles whose corners scatter by `size` about a random center."""
    numbers = random.Random(1)
    vertices = array("f")
    for _ in range(count):
        x, y, z = numbers.uniform(-1.9, 1.9), numbers.uniform(-1.05, 1.05), numbers.uniform(-0.5, 0.5)
        for _ in range(3):
            vertices.extend((x + numbers.gauss(0, size), y + numbers.gauss(0, size), z + numbers.gauss(0, 0.1)))
    write_glb(folder / f"soup-{count}.glb", {"POSITION": vertices}, None)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for segments in (30, 100, 400):
        sphere(folder, segments)
    for count, size in ((3_000, 0.42), (30_000, 0.2), (300_000, 0.047)):
        soup(folder, count, size)


if __name__ == "__main__":
    main()
