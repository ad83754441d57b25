#!/usr/bin/env python3
"""Prints what materials, glass and image passes cost on one adapter at 1920x1080, as Markdown: milliseconds of the planned options, the median of
five rounds in which all rows take turns.

usage: scripts/picture_costs.py [ARGUMENT OF `rasterlab explain`]...     e.g. --adapter llvmpipe --size 1280x720

RASTERLAB names the program, target/release/rasterlab without it.
"""

import json
import os
import statistics
import subprocess
import sys

LAB = os.environ.get("RASTERLAB", "target/release/rasterlab")
ROUNDS = 5

# Three balls of 32,000 triangles with textures of color, normals, metal and roughness.
GOLF = """
[scene]
builtin = "golf?tess=45"
[camera]
eye = [1.3, 1.9, 4.6]
target = [0.1, 0.46, 0.0]
fov_y_deg = 30.0
"""

# Eight sheets, each of which covers the picture, and nothing else.
SHEETS = """
[scene]
builtin = "stack?layers=8&gap=0.1"
[camera]
eye = [0.0, 0.0, 4.0]
target = [0.0, 0.0, 0.0]
fov_y_deg = 5.0
[effects.lambert]
"""

# Lengths are what they say at a height of 1080 pixels.
TOWN = """
[scene]
builtin = "town?houses=40&lights=1"
[camera]
eye = [3.0, 4.6, 25.0]
target = [0.0, 2.6, 0.0]
fov_y_deg = 25.0
[output]
reference_height_px = 1080
[effects.lambert]
"""

# Name, preset, beginning of the names of the passes that count, or nothing for the whole frame.
ROWS = [
    ("golf balls, lambert", GOLF + "[effects.lambert]", ""),
    ("golf balls, studio", GOLF + "[effects.studio]", ""),
    ("8 sheets, opaque", SHEETS, ""),
    ("8 sheets of glass, exact", SHEETS + "[effects.glass]", ""),
    ("its passes that sort and compose", SHEETS + "[effects.glass]", "glass_compose"),
    ("8 sheets of glass, nearest4", SHEETS + '[effects.glass]\n[accuracy]\ntransparency = "nearest4"', ""),
    ("8 sheets of glass, weighted", SHEETS + '[effects.glass]\n[accuracy]\ntransparency = "weighted"', ""),
    ("town, lambert", TOWN, ""),
    ("passes of blur, radius 32 px", TOWN + '[effects.blur]\narea = "everywhere"\nradius_px = 32.0', "image"),
    ("passes of bloom, radius 96 px", TOWN + "[effects.bloom]\nradius_px = 96.0", "image"),
    ("passes of paint", TOWN + "[effects.paint]", "image"),
]


def milliseconds(name, preset, passes, arguments):
    command = [LAB, "explain", "-", "--measure", "--json", "--quiet", *arguments]
    result = subprocess.run(command, input="schema = 2\n" + preset, stdout=subprocess.PIPE, check=True, text=True)
    times = json.loads(result.stdout)["results"][0]["times"]
    if not passes:
        return times["whole_ms"]
    of_passes = [ms for of_pass, ms in times["passes"] if of_pass.startswith(passes)]
    if not of_passes:
        sys.exit(f"picture_costs: {name} has no pass whose name begins with {passes}")
    return sum(of_passes)


def main():
    arguments = sys.argv[1:] if "--size" in sys.argv else ["--size", "1920x1080", *sys.argv[1:]]
    times = {row[0]: [] for row in ROWS}
    for _ in range(ROUNDS):
        for row in ROWS:
            times[row[0]].append(milliseconds(*row, arguments))
    print("| picture | ms | least | most |\n|---|--:|--:|--:|")
    for name, rounds in times.items():
        print(f"| {name} | {statistics.median(rounds):.3f} | {min(rounds):.3f} | {max(rounds):.3f} |")


if __name__ == "__main__":
    main()
