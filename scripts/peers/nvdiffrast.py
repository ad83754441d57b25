#!/usr/bin/env python3
"""Draws closed meshes and soups of triangles with rasterlab and with nvdiffrast, a CUDA rasterizer of other people, compares the triangle
ids of every pixel, explains each difference, and measures the raster pass of nvdiffrast beside the whole frame of rasterlab.

usage: scripts/peers/nvdiffrast.py FOLDER --program target/release/rasterlab
       scripts/peers/nvdiffrast.py --self-test --program target/release/rasterlab

Needs numpy, and without --self-test a CUDA card, torch and nvdiffrast:

    TORCH_CUDA_ARCH_LIST=9.0 MAX_JOBS=8 python3 -m pip install --no-build-isolation --no-deps --target DIR SOURCE
    PYTHONPATH=DIR python3 scripts/peers/nvdiffrast.py FOLDER --program target/release/rasterlab

or, offline and without pip, inside its source: python3 setup.py build_ext --inplace, and DIR is the source.

Both snap to 1/16 px (`accuracy.coverage=fixed4`). The rows say how rasterlab projected and which way up nvdiffrast drew:
  exact, row 0 on top     strict vertex stage, y negated for nvdiffrast: both snap the same bits by the same operations, and its rule for
                          samples on edges is ours. What differs can only be equal depths, or cuts at the border of the picture.
  exact, row 0 below      the same with y as in OpenGL: of two triangles that share a level edge through samples, it draws the other.
  float, row 0 on top     rasterlab's default vertex stage, in floats: corners may snap to the neighbor.
  1/256 px                rasterlab with its default grid (fixed8): how much the grid matters; not explained pixel by pixel.
Exits with 1 if a difference remains unexplained, or the self-test fails."""

import argparse
import contextlib
import io
import statistics
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent

try:
    import numpy as np
    from cudaraster import explain, rules, scene, selftest
except ImportError as error:
    print(f"error: {error}: python3 -m pip install numpy", file=sys.stderr)
    sys.exit(2)

MESH_CAMERA = {"eye": (1.25, 0.75, 2.5), "fov_y_deg": 45.0, "near_m": 0.125}
SOUP_CAMERA = {"eye": (0.0, 0.0, 3.0), "fov_y_deg": 38.0, "near_m": 0.125}
EXACT = ["accuracy.coverage=fixed4", "accuracy.vertex_transform=strict"]
FLOAT = ["accuracy.coverage=fixed4"]


class Missing(Exception):
    """What has to be installed, in one sentence."""


class Peer:
    """nvdiffrast on the CUDA card."""

    def __init__(self):
        # This file has the name of the package, so its folder must not be searched for it.
        sys.path[:] = [entry for entry in sys.path if Path(entry or ".").resolve() != HERE]
        try:
            import torch
        except ImportError:
            raise Missing("torch is missing: python3 -m pip install torch") from None
        if not torch.cuda.is_available():
            raise Missing("torch finds no CUDA card: nvdiffrast needs one; --self-test works without")
        import importlib.metadata

        version = importlib.metadata.version
        # A source tree that was built in its place has no installed version, which the package asks for.
        importlib.metadata.version = lambda name: "in place" if name == "nvdiffrast" and not installed(version, name) else version(name)
        try:
            import nvdiffrast
            import nvdiffrast.torch as dr
        except ImportError as error:
            hint = "TORCH_CUDA_ARCH_LIST=9.0 python3 -m pip install --no-build-isolation --no-deps --target DIR SOURCE, then PYTHONPATH=DIR"
            raise Missing(f"nvdiffrast cannot be imported ({error}): {hint}") from None
        finally:
            importlib.metadata.version = version
        self.torch, self.dr, self.context = torch, dr, dr.RasterizeCudaContext()
        self.name = f"nvdiffrast {nvdiffrast.__version__}, torch {torch.__version__}, {torch.cuda.get_device_name()}"

    def tensors(self, clip, triangles):
        torch = self.torch
        return torch.from_numpy(clip).cuda()[None].contiguous(), torch.from_numpy(triangles.astype(np.int32)).cuda()

    def triangle_ids(self, clip, triangles, size):
        """int64 [height, width], row 0 where y = -1, -1 for none."""
        out, _ = self.dr.rasterize(self.context, *self.tensors(clip, triangles), resolution=(size[1], size[0]))
        return out[0, :, :, 3].cpu().numpy().astype(np.int64) - 1

    def milliseconds(self, clip, triangles, size, samples):
        """The median of `samples` calls of rasterize, each between two events of the stream, after as many for warming up."""
        torch, arguments = self.torch, self.tensors(clip, triangles)
        times = []
        for _ in range(2 * samples):
            before, after = (torch.cuda.Event(enable_timing=True) for _ in range(2))
            torch.cuda.synchronize()
            before.record()
            self.dr.rasterize(self.context, *arguments, resolution=(size[1], size[0]), grad_db=False)
            after.record()
            torch.cuda.synchronize()
            times.append(before.elapsed_time(after))
        return statistics.median(times[samples:])


def installed(version, name):
    with contextlib.suppress(Exception):
        return bool(version(name))
    return False


def top_first(ids, row_0_is_top):
    return ids if row_0_is_top else ids[::-1]


def compare(title, model, camera, size, own_ids, peer_ids_of, row_0_is_top, is_float):
    """Draws with the peer, explains and prints a row; returns the explanation."""
    own_clip = scene.clip_positions(model, camera, *size)
    peer_clip = scene.opengl_positions(own_clip, row_0_is_top)
    peer_ids = top_first(peer_ids_of(peer_clip, model.triangles, size), row_0_is_top)
    terms = scene.term_sums(model, camera, *size) if is_float else None
    drawing = explain.Drawing.of(model, own_clip, peer_clip, size, row_0_is_top, terms)
    found = explain.explain(drawing, own_ids, peer_ids)
    print_row(title, found)
    return found


HEADER = (
    "| scene | drawn | covered px | different | one is empty | tie | snap | clip | depth | unexplained | farthest from an edge, 1/16 px |\n"
    "|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|"
)


def print_row(title, found):
    counts = " | ".join(f"{count:,}" for count in found.classes.values())
    far = max(found.farthest.values())
    print(f"| {title} | {found.own_covered:,} | {found.different:,} | {found.coverage:,} | {counts} | {far:.3f} |", flush=True)
    for x, y, own, peer in found.unexplained:
        print(f"  unexplained: pixel ({x}, {y}) shows {own} in rasterlab and {peer} in the peer")


def camera_of(glb):
    return scene.Camera(**(MESH_CAMERA if glb.stem.startswith("mesh") else SOUP_CAMERA))


def compare_all(glbs, program, peer, size):
    """Compares every scene and returns the number of unexplained pixels."""
    print(HEADER)
    unexplained = 0
    for glb in glbs:
        model, camera = scene.read_glb(glb), camera_of(glb)
        exact = program.triangle_ids(glb, camera, size, EXACT)
        rows = [("exact, row 0 on top", exact, True, False), ("exact, row 0 below", exact, False, False)]
        rows.append(("float, row 0 on top", program.triangle_ids(glb, camera, size, FLOAT), True, True))
        for name, own_ids, row_0_is_top, is_float in rows:
            found = compare(f"{glb.stem} | {name}", model, camera, size, own_ids, peer.triangle_ids, row_0_is_top, is_float)
            unexplained += found.classes["unexplained"]
        own_clip = scene.clip_positions(model, camera, *size)
        fine = program.triangle_ids(glb, camera, size, [])
        peer_ids = peer.triangle_ids(scene.opengl_positions(own_clip, True), model.triangles, size)
        one_empty = int(((fine >= 0) != (peer_ids >= 0)).sum())
        print(f"| {glb.stem} | 1/256 px | {int((fine >= 0).sum()):,} | {int((fine != peer_ids).sum()):,} | {one_empty:,} | | | | | | |", flush=True)
    return unexplained


def compare_with_rules(glbs, peer):
    """The rules written anew against nvdiffrast itself, on small pictures."""
    print("\nThe rules in scripts/peers/cudaraster/rules.py against nvdiffrast itself, 256x256:")
    for glb in glbs:
        model, camera = scene.read_glb(glb), camera_of(glb)
        if len(model.triangles) > 10_000:
            continue
        clip = scene.opengl_positions(scene.clip_positions(model, camera, 256, 256), True)
        by_rules, _ = rules.picture(clip, model.triangles, 256, 256)
        drawn = peer.triangle_ids(clip, model.triangles, (256, 256))
        print(f"  {glb.stem}: {int((by_rules != drawn).sum())} of {drawn.size:,} pixels differ", flush=True)


def measure_all(glbs, program, peer, size, samples):
    print("\nA call of rasterize ends with a wait of the CPU for the card, as nvdiffrast is written; that wait is in its time.")
    print("\n| scene | rasterlab packed64, whole frame, ms | nvdiffrast, raster pass, ms | ratio |\n|---|--:|--:|--:|")
    for glb in glbs:
        model, camera = scene.read_glb(glb), camera_of(glb)
        clip = scene.opengl_positions(scene.clip_positions(model, camera, *size), True)
        theirs = peer.milliseconds(clip, model.triangles, size, samples)
        rows = {row["option"]: row for row in program.bench(glb, camera, size, samples)["results"]}
        ours = rows["packed64"]["ms_p50"]
        print(f"| {glb.stem} | {ours:.3f} | {theirs:.3f} | {theirs / ours:.1f} |", flush=True)


def scenes(folder, only):
    """The GLBs, meshes first, by rising number of triangles."""
    found = sorted(folder.glob("mesh-*.glb"), key=triangles_of) + sorted(folder.glob("soup-*.glb"), key=triangles_of)
    return [glb for glb in found if not only or glb.stem in only.split(",")]


def triangles_of(glb):
    return int(glb.stem.split("-")[1])


def write_scenes(folder):
    subprocess.run([sys.executable, HERE.parent / "raster_scenes.py", folder], check=True, stdout=subprocess.DEVNULL)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, metavar="FOLDER", help="where scenes and arrays are written")
    parser.add_argument("--program", type=Path, default=HERE.parent.parent / "target/release/rasterlab", help="default: %(default)s")
    parser.add_argument("--adapter", help="the adapter of rasterlab, if there are several")
    parser.add_argument("--size", default="1920x1080", help="default: %(default)s; at most 2048 a side")
    parser.add_argument("--samples", type=int, default=60, help="timed frames; default: %(default)s")
    parser.add_argument("--only", default="", metavar="NAMES", help="only these scenes, such as mesh-840,soup-3000")
    parser.add_argument("--no-times", action="store_true", help="compare only")
    parser.add_argument("--self-test", action="store_true", help="checks this script and its rules without a card")
    args = parser.parse_args()
    if not args.program.is_file():
        raise Missing(f"{args.program} is not there: cargo build --release, or --program FILE")
    program = scene.Program(args.program, args.adapter)
    if args.self_test:
        return selftest.run(program)
    if args.folder is None:
        parser.error("FOLDER is missing")
    peer = Peer()
    size = tuple(int(side) for side in args.size.split("x"))
    if len(size) != 2 or max(size) > 2048:
        parser.error("--size is WxH, at most 2048x2048: above, nvdiffrast draws in parts with other roundings")
    args.folder.mkdir(parents=True, exist_ok=True)
    write_scenes(args.folder)
    print(f"{peer.name}; {size[0]}x{size[1]}\n")
    glbs = scenes(args.folder, args.only)
    if not glbs:
        parser.error(f"--only {args.only}: there is no such scene; mesh-840, mesh-9800, mesh-159200, soup-3000, soup-30000, soup-300000")
    unexplained = compare_all(glbs, program, peer, size)
    compare_with_rules(glbs, peer)
    if not args.no_times:
        measure_all(glbs, program, peer, size, args.samples)
    return 1 if unexplained else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Missing as missing:
        print(f"error: {missing}", file=sys.stderr)
        sys.exit(2)
