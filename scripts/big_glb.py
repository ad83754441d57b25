#!/usr/bin/env python3
"""Writes a GLB with as many triangles as asked for, to measure how large models load and are drawn: a bumpy torus, or cubes.

    python3 scripts/big_glb.py 16000000 /tmp/big.glb             # 288 MB: positions and 32-bit indices; the loader computes normals
    python3 scripts/big_glb.py 16000000 /tmp/big.glb --normals   # 384 MB
    python3 scripts/big_glb.py 100000000 /tmp/huge.glb           # 1.8 GB
    python3 scripts/big_glb.py 12000000 /tmp/cubes.glb --cubes   # 40 MB: a million instances of a cube (EXT_mesh_gpu_instancing)

Python's standard library alone. It writes row by row and takes little memory.
"""

import argparse
import json
import math
import struct
import sys
from array import array

MAJOR, MINOR, WAVES, HEIGHT = 1.0, 0.4, 9, 0.04


def grid(triangles):
    """Columns and rows of a closed grid with about so many triangles, two for each cell; columns are 2.5 times as many."""
    rows = max(3, round(math.sqrt(triangles / 5)))
    return max(3, round(triangles / 2 / rows)), rows


def ring(columns, row, rows):
    """Positions and normals of one row of vertices: the circle around the tube's axis at one angle of the tube."""
    angle = 2 * math.pi * row / rows
    radius = MINOR + HEIGHT * math.sin(WAVES * angle)
    out, up = MAJOR + radius * math.cos(angle), radius * math.sin(angle)
    normal_out, normal_up = math.cos(angle), math.sin(angle)
    positions, normals = array("f", bytes(12 * columns)), array("f", bytes(12 * columns))
    cosines, sines = circle(columns)
    positions[0::3] = array("f", (out * c for c in cosines))
    positions[1::3] = array("f", [up]) * columns
    positions[2::3] = array("f", (out * s for s in sines))
    normals[0::3] = array("f", (normal_out * c for c in cosines))
    normals[1::3] = array("f", [normal_up]) * columns
    normals[2::3] = array("f", (normal_out * s for s in sines))
    return positions, normals


def circle(columns, known={}):
    if columns not in known:
        angles = [2 * math.pi * i / columns for i in range(columns)]
        known[columns] = [math.cos(a) for a in angles], [math.sin(a) for a in angles]
    return known[columns]


def cells(columns, above):
    """Indices of the triangles between row 0 and the row whose first vertex is `above`."""
    indices = array("I")
    for i in range(columns):
        j = (i + 1) % columns
        indices.extend((i, above + i, j, j, above + i, above + j))
    return indices.tobytes()


CUBE_INDICES = (0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3)
INSTANCING = "EXT_mesh_gpu_instancing"


def cubes(count):
    """Document and bytes of a lattice of so many cubes, each turned and of a size of its own."""
    side = math.ceil(count ** (1 / 3))
    corners = [(corner >> axis & 1) - 0.5 for corner in range(8) for axis in (2, 1, 0)]
    places, turns, sizes = array("f"), array("f"), array("f")
    for i in range(count):
        places.extend((2 * (i % side), 2 * (i // side % side), 2 * (i // side // side)))
        angle = 0.6 * i % (2 * math.pi)
        turns.extend((0.6 * math.sin(angle), 0.8 * math.sin(angle), 0, math.cos(angle)))
        sizes.extend([0.5 + i % 7 / 10] * 3)
    parts = [array("f", corners).tobytes(), array("H", CUBE_INDICES).tobytes()] + [part.tobytes() for part in (places, turns, sizes)]
    views, start = [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": start, "byteLength": len(part)})
        start += len(part)
    kinds = (8, "VEC3", 5126), (36, "SCALAR", 5123), (count, "VEC3", 5126), (count, "VEC4", 5126), (count, "VEC3", 5126)
    accessors = [{"bufferView": view, "componentType": component, "count": number, "type": kind}
                 for view, (number, kind, component) in enumerate(kinds)]
    accessors[0].update(min=[-0.5] * 3, max=[0.5] * 3)
    instancing = {"attributes": {"TRANSLATION": 2, "ROTATION": 3, "SCALE": 4}}
    return {
        "asset": {"version": "2.0", "generator": "rasterlab scripts/big_glb.py"},
        "extensionsUsed": [INSTANCING], "extensionsRequired": [INSTANCING],
        "buffers": [{"byteLength": start}], "bufferViews": views, "accessors": accessors,
        "meshes": [{"name": "cube", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0, "extensions": {INSTANCING: instancing}}], "scenes": [{"nodes": [0]}], "scene": 0,
    }, parts


def write_begin(file, document, binary_bytes):
    """The header, the JSON, and the head of the part with the bytes that follow."""
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + binary_bytes))
    file.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", binary_bytes, b"BIN\0"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("triangles", type=int)
    parser.add_argument("output")
    parser.add_argument("--normals", action="store_true", help="write normals, which the loader computes otherwise")
    parser.add_argument("--cubes", action="store_true", help="write instances of a cube, 12 triangles each")
    args = parser.parse_args()
    if sys.byteorder != "little" or array("I").itemsize != 4:
        sys.exit("glTF is little-endian: run this on such a machine")
    if args.cubes:
        count = max(1, args.triangles // 12)
        document, parts = cubes(count)
        with open(args.output, "wb") as file:
            write_begin(file, document, sum(map(len, parts)))
            file.writelines(parts)
        print(f"{args.output}: {count} instances of a cube")
        return
    columns, rows = grid(args.triangles)
    vertices, triangles = columns * rows, 2 * columns * rows
    parts = [("POSITION", 12 * vertices)] + [("NORMAL", 12 * vertices)] * args.normals + [("indices", 12 * triangles)]
    views, start = [], 0
    for _, length in parts:
        views.append({"buffer": 0, "byteOffset": start, "byteLength": length})
        start += length
    if start + 4096 >= 1 << 32:
        sys.exit(f"{triangles} triangles take {start} bytes; a GLB holds less than 4 GiB")
    reach = MAJOR + MINOR + HEIGHT
    accessors = [{"bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3",
                  "min": [-reach, -MINOR - HEIGHT, -reach], "max": [reach, MINOR + HEIGHT, reach]}]
    attributes = {"POSITION": 0}
    if args.normals:
        accessors.append({"bufferView": 1, "componentType": 5126, "count": vertices, "type": "VEC3"})
        attributes["NORMAL"] = 1
    accessors.append({"bufferView": len(views) - 1, "componentType": 5125, "count": 3 * triangles, "type": "SCALAR"})
    document = {
        "asset": {"version": "2.0", "generator": "rasterlab scripts/big_glb.py"},
        "buffers": [{"byteLength": start}], "bufferViews": views, "accessors": accessors,
        "meshes": [{"name": "torus", "primitives": [{"attributes": attributes, "indices": len(accessors) - 1}]}],
        "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0,
    }
    with open(args.output, "wb") as file:
        write_begin(file, document, start)
        for part in range(1 + args.normals):
            for row in range(rows):
                file.write(ring(columns, row, rows)[part].tobytes())
        # Every row has the indices of row 0 plus its first vertex: an addition of long integers, 32 bits for each index. None overflows.
        first = int.from_bytes(cells(columns, columns), "little")
        ones = int.from_bytes(array("I", [1]).tobytes() * (6 * columns), "little")
        for row in range(rows - 1):
            file.write((first + row * columns * ones).to_bytes(24 * columns, "little"))
        # The last row closes the tube.
        last = array("I", (index + (rows - 1) * columns if index < columns else index - columns
                           for index in array("I", cells(columns, columns))))
        file.write(last.tobytes())
    print(f"{args.output}: {triangles} triangles, {vertices} vertices, {start} bytes")


if __name__ == "__main__":
    main()
