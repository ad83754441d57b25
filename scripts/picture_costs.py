#!/usr/bin/env python3
"""Prints what materials, glass and image passes cost on one adapter at 1920x1080, as Markdown: milliseconds of the fastest exact option of
visibility, the median of three rounds in which all rows take turns.

usage: scripts/picture_costs.py [ARGUMENT OF `rasterlab bench`]...     e.g. --adapter llvmpipe --size 1280x720

RASTERLAB names the program, target/release/rasterlab without it.
"""

import json
import os
import statistics
import subprocess
import sys

LAB = os.environ.get("RASTERLAB", "target/release/rasterlab")
ROUNDS = 3
# Options of visibility that are exact.
VISIBILITY = ("packed32", "split32", "packed64")

# Three balls of 32,000 triangles with textures of color, normals, metal and roughness.
GOLF = ["golf", "--set", "scene.builtin=golf?tess=45", "--unset", "studio", "--unset", "tonemap"]
# Eight triangles, each of which covers the picture, and nothing else.
GLASS = ["--scene", "stack?layers=8&gap=0.1", "--set", "camera.fov_y_deg=5"]
# Lengths are what they say at the height of 1080 pixels.
TOWN = ["bloom", "--unset", "bloom", "--set", "output.reference_height_px=1080"]

# Name, arguments, beginning of the names of the passes that count, or nothing for all.
ROWS = [
    ("golf balls, lambert", [*GOLF, "--set", "lambert"], ""),
    ("golf balls, studio", [*GOLF, "--set", "studio"], ""),
    ("8 layers, opaque", GLASS, ""),
    ("8 layers of glass, exact", [*GLASS, "--set", "glass"], ""),
    ("8 layers of glass, nearest4", [*GLASS, "--set", "glass", "--set", "accuracy.transparency=nearest4"], ""),
    ("8 layers of glass, weighted", [*GLASS, "--set", "glass", "--set", "accuracy.transparency=weighted"], ""),
    ("blur, radius 32 px", [*TOWN, "--set", "blur.area=everywhere", "--set", "blur.radius_px=32"], "image"),
    ("bloom, radius 96 px", [*TOWN, "--set", "bloom.radius_px=96"], "image"),
    ("paint", [*TOWN, "--set", "paint"], "image"),
]


def milliseconds(row, arguments):
    name, preset, passes = row
    command = [LAB, "bench", *preset, "--json", "--quiet", *arguments]
    result = subprocess.run(command, stdout=subprocess.PIPE, check=True)
    options = [r for r in json.loads(result.stdout)["results"] if r["option"] in VISIBILITY and r["ms_p50"] is not None]
    if not options:
        sys.exit(f"picture_costs: no option drew {name}")
    best = min(options, key=lambda r: r["ms_p50"])
    if best["error"]["wrong_triangles"]:
        sys.exit(f"picture_costs: {name} has {best['error']['wrong_triangles']} wrong pixels")
    if not passes:
        return best["ms_p50"]
    return sum(p["ms_p50"] for p in best["passes"] if p["name"].startswith(passes))


def main():
    arguments = sys.argv[1:] if "--size" in sys.argv else ["--size", "1920x1080", *sys.argv[1:]]
    times = {row[0]: [] for row in ROWS}
    for _ in range(ROUNDS):
        for row in ROWS:
            times[row[0]].append(milliseconds(row, arguments))
    print("| picture | ms | least | most |\n|---|--:|--:|--:|")
    for name, rounds in times.items():
        print(f"| {name} | {statistics.median(rounds):.3f} | {min(rounds):.3f} | {max(rounds):.3f} |")


if __name__ == "__main__":
    main()
