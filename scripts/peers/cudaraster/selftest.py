"""Checks of this folder without a card: the rules in numpy stand in for nvdiffrast, and rasterlab draws on any adapter."""

import contextlib
import io
import subprocess
import sys
import tempfile
from array import array
from pathlib import Path

import numpy as np

from . import explain, rules, scene

F = np.float32
SIZE = (256, 256)
EXACT = ["accuracy.coverage=fixed4", "accuracy.vertex_transform=strict"]
CAMERA = scene.Camera(eye=(1.25, 0.75, 2.5))
FRONT = scene.Camera(eye=(0.0, 0.0, 3.0), fov_y_deg=38.0)


def check(is_true, sentence):
    if not is_true:
        raise AssertionError(sentence)


def run(program):
    """Runs every check, prints a line for each, and returns the exit code."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        subprocess.run([sys.executable, Path(__file__).parents[2] / "raster_scenes.py", folder], check=True, stdout=subprocess.DEVNULL)
        checks = [snaps, samples_of_neighbors, rules_of_hits, depth_planes, silhouette, level_edges, closed_mesh, soup, float_stage, moved_snaps, planted_faults]
        for one in checks:
            try:
                said = one(program, folder)
            except AssertionError as error:
                print(f"FAILED {one.__name__}: {error}")
                return 1
            print(f"ok {one.__name__}: {said}", flush=True)
    return 0


def snaps(_program, _folder):
    # 64 x 32 px: half the picture is 512 x 256 units.
    cases = [((0.5, -0.25, 2.0), (128, -32)), ((0.5 / 512, 1.5 / 256, 1.0), (0, 2)), ((-1.5 / 512, -0.5 / 256, 1.0), (-2, 0)), ((1, 1, 1), (512, 256))]
    clip = np.array([[x, y, 0.0, w] for (x, y, w), _ in cases], F)
    check(np.array_equal(rules.snap(clip, 64, 32), [at for _, at in cases]), f"snapped to {rules.snap(clip, 64, 32).tolist()}")
    inside = rules.inside_frustum(np.array([[1, 1, 1, 1], [1.01, 0, 0, 1], [0, -1.01, 0, 1], [0, 0, 1.01, 1]], F))
    check(inside.tolist() == [True, False, False, False], "the frustum is wrong")
    return f"{len(cases)} vertices by hand, ties to even"


def lattice(numbers, cells):
    """Corners of a jittered lattice and its triangles, of positive area; some corners lie on samples."""
    side = cells + 1
    points = np.stack(np.meshgrid(np.arange(side) * 40, np.arange(side) * 40, indexing="xy"), axis=-1).reshape(-1, 2) + 8
    points += numbers.integers(-1, 2, points.shape) * 8
    cell = (np.arange(cells)[:, None] * side + np.arange(cells)).reshape(-1)
    a, b, c, d = cell, cell + 1, cell + side + 1, cell + side
    return points, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def samples_of_neighbors(_program, _folder):
    points, triangles = lattice(np.random.default_rng(1), 20)
    xs, ys = (np.arange(6, 44) * 16 + 8)[None, :], (np.arange(6, 44) * 16 + 8)[:, None]
    count = sum(rules.covered(points[triangle], xs, ys).astype(int) for triangle in triangles)
    check((count == 1).all(), f"{int((count != 1).sum())} samples are not covered exactly once")
    return f"each of {count.size} samples belongs to one of {len(triangles)} triangles"


def rules_of_hits(_program, _folder):
    """The rules that explain.py states in pixels, against rules.py in the peer's own coordinates."""
    numbers = np.random.default_rng(2)
    width, height = 6, 8
    points = numbers.integers(0, 14, (4000, 3, 2)) * 8
    corners = np.arange(12000).reshape(-1, 3)
    columns, rows = numbers.integers(0, width, 4000), numbers.integers(0, height, 4000)
    ties = 0
    for row_0_is_top in (True, False):
        zero = np.zeros(12000)
        drawing = explain.Drawing(corners, points.reshape(-1, 2), zero > 1, zero + 1, zero, np.zeros(4000, bool), (width, height), row_0_is_top)
        found = explain.hits(drawing, np.arange(4000), columns, rows)
        for i in range(4000):
            own = points[i] - [width * 8, height * 8]
            x, y = int(columns[i]) * 16 + 8 - width * 8, int(rows[i]) * 16 + 8 - height * 8
            expected = [by_rules(own, x, y, True), by_rules(own, x, y, row_0_is_top)]
            check([found.own[i], found.peer[i]] == expected, f"triangle {own.tolist()}, sample ({x}, {y}): {found.own[i]}, {found.peer[i]}, {expected}")
            ties += int(expected[0] != expected[1])
    check(ties > 5, f"only {ties} samples lie on an edge where the rules differ")
    return f"8000 samples, {ties} on an edge that the rules give to different triangles"


def by_rules(points, x, y, is_down):
    if not is_down:
        points, y = points * [1, -1], -y
    (ax, ay), (bx, by), (cx, cy) = points
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    order = [0, 1, 2] if area > 0 else [0, 2, 1]
    return bool(area != 0 and rules.covered(points[order], np.array([x]), np.array([y]))[0])


def depth_planes(_program, _folder):
    numbers = np.random.default_rng(3)
    worst = 0.0
    for _ in range(400):
        points = numbers.integers(-128 * 16, 128 * 16, (3, 2))
        d1, d2 = points[1] - points[0], points[2] - points[0]
        area = int(d1[0] * d2[1] - d1[1] * d2[0])
        if area <= 0:
            continue
        w = numbers.uniform(1, 3, 3).astype(F)
        z = (w * numbers.uniform(-1, 1, 3)).astype(F)
        a, b, c = rules.depth_plane(z, F(1) / w, points, 256, 256)
        half = (rules.DEPTH_MAX - rules.DEPTH_MIN) / 2
        ndc = z.astype(float) / w.astype(float)
        for share in numbers.dirichlet((1, 1, 1), 4):
            x, y = np.floor((share @ points + 128 * 16) / 16)
            at = np.array([x * 16 + 8, y * 16 + 8]) - 128 * 16 - points[0]
            s = (at[0] * d2[1] - at[1] * d2[0]) / area
            t = (d1[0] * at[1] - d1[1] * at[0]) / area
            if min(s, t, 1 - s - t) < 0:
                continue
            exact = ((1 - s - t) * ndc[0] + s * ndc[1] + t * ndc[2] + 1) * half + rules.DEPTH_MIN
            worst = max(worst, abs(((a * int(x) + b * int(y) + c) & 0xFFFFFFFF) - exact))
    bound = explain.PEER_DEPTH_ERROR * 2**31
    check(0 < worst <= bound, f"a plane is {worst:.0f} units off, and {bound:.0f} are stated")
    return f"at most {worst:.0f} units of 2^-32 off, {bound:.0f} are stated"


def write(folder, name, vertices, indices):
    """A GLB by the writer of the scenes."""
    sys.path.insert(0, str(Path(__file__).parents[2]))
    with contextlib.redirect_stdout(io.StringIO()):
        from raster_scenes import write_glb

        write_glb(folder / name, {"POSITION": array("f", np.asarray(vertices, F).reshape(-1).tolist())}, array("I", indices))
    sys.path.pop(0)
    return folder / name


def drawn(program, glb, camera, row_0_is_top, settings=EXACT, terms=False, own_ids=None, peer_ids=None):
    """rasterlab's picture, the rules' picture and the explanation of their differences."""
    model = scene.read_glb(glb)
    own_clip = scene.clip_positions(model, camera, *SIZE)
    peer_clip = scene.opengl_positions(own_clip, row_0_is_top)
    if peer_ids is None:
        peer_ids, _ = rules.picture(peer_clip, model.triangles, *SIZE)
        peer_ids = peer_ids if row_0_is_top else peer_ids[::-1]
    if own_ids is None:
        own_ids = program.triangle_ids(glb, camera, SIZE, settings)
    sums = scene.term_sums(model, camera, *SIZE) if terms else None
    drawing = explain.Drawing.of(model, own_clip, peer_clip, SIZE, row_0_is_top, sums)
    return own_ids, peer_ids, explain.explain(drawing, own_ids, peer_ids)


def explained(found, allowed, what):
    odd = {name: count for name, count in found.classes.items() if count and name not in allowed}
    check(not odd, f"{what}: {odd} of {found.different} different pixels, such as {found.unexplained}")
    return f"{found.different} of {found.own_covered} covered pixels differ" + "".join(
        f", {count} by {name}" for name, count in found.classes.items() if count
    )


def silhouette(program, folder):
    """The matrix: one triangle whose edges cross the whole picture."""
    glb = write(folder, "one.glb", [(-0.9, -0.8, 0.3), (0.95, -0.5, -0.2), (0.1, 0.9, 0.1)], [0, 1, 2])
    for camera in (CAMERA, FRONT):
        own, _, found = drawn(program, glb, camera, True)
        check(found.own_covered > 4000, "the triangle is not there")
        check(found.different == 0, f"{found.different} pixels of one triangle differ from the rules")
    return f"{found.own_covered} pixels of one triangle, from two eyes, none differs"


def level_edges(program, folder):
    """A wall whose seen cells have level edges, some of them through samples."""
    side = 33
    at = np.arange(side) / (side - 1) * 2 - 1
    vertices = np.stack([*np.meshgrid(at * 1.01, at * 0.97, indexing="xy"), np.zeros((side, side))], axis=-1)
    cell = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).reshape(-1)
    corners = np.stack([cell, cell + 1, cell + side + 1, cell, cell + side + 1, cell + side], axis=1)
    glb = write(folder, "wall.glb", vertices, corners.reshape(-1).tolist())
    _, _, top = drawn(program, glb, FRONT, True)
    check(top.own_covered > 40_000 and top.different == 0, f"row 0 on top: {top.classes}")
    own, peer, below = drawn(program, glb, FRONT, False)
    check(below.classes["tie"] == below.different > 100, f"row 0 below: {below.classes}")
    check(below.farthest["tie"] == 0.0, "a tie is not on an edge")
    return f"row 0 on top: none differs; row 0 below: {below.different} of {below.own_covered}, all on level edges"


def closed_mesh(program, folder):
    said = []
    for name in ("mesh-840", "mesh-9800"):
        for row_0_is_top, allowed in ((True, ["depth"]), (False, ["depth", "tie"])):
            _, _, found = drawn(program, folder / f"{name}.glb", CAMERA, row_0_is_top)
            check(found.own_covered > 10_000, f"{name} is not there")
            said.append(f"{name}, row 0 {'on top' if row_0_is_top else 'below'}: " + explained(found, allowed, name))
    return "; ".join(said)


def soup(program, folder):
    _, _, found = drawn(program, folder / "soup-3000.glb", FRONT, True)
    said = explained(found, ["depth", "clip"], "soup-3000")
    check(found.classes["clip"] > 0, "no cut triangle differs, so the class was not tried")
    return said + f", cuts at most {found.farthest['clip']:.2f}/16 px from an edge"


def float_stage(program, folder):
    _, _, found = drawn(program, folder / "mesh-9800.glb", CAMERA, True, EXACT[:1], terms=True)
    return explained(found, ["depth", "snap"], "mesh-9800 with the float vertex stage")


def moved_snaps(_program, folder):
    """The class snap: a picture whose corners lie a little aside, within the float stage's bound if that is 64 times as wide."""
    model = scene.read_glb(folder / "mesh-9800.glb")
    own_clip = scene.clip_positions(model, CAMERA, *SIZE)
    peer_clip = scene.opengl_positions(own_clip, True)
    peer, _ = rules.picture(peer_clip, model.triangles, *SIZE)
    aside = peer_clip * np.array([1 + 2.0**-15, 1, 1, 1], F)
    own, _ = rules.picture(aside, model.triangles, *SIZE)
    sums = scene.term_sums(model, CAMERA, *SIZE)
    wide, narrow = (explain.explain(explain.Drawing.of(model, own_clip, peer_clip, SIZE, True, sums * by), own, peer) for by in (64, 1))
    said = explained(wide, ["depth", "snap"], "corners aside")
    check(wide.classes["snap"] > 10 and narrow.classes["unexplained"] > 0, f"{wide.classes}, with the bound itself {narrow.classes}")
    try:
        explain.Drawing.of(model, own_clip, aside, SIZE, True)
    except AssertionError:
        return said
    raise AssertionError("other positions are taken for the same")


def planted_faults(program, folder):
    """Faults that must stay unexplained."""
    glb = folder / "mesh-840.glb"
    own, peer, sound = drawn(program, glb, CAMERA, True)
    row, column = (int(at) for at in np.argwhere(own >= 0)[len(np.argwhere(own >= 0)) // 2])
    faults = {
        "moved by a pixel": np.roll(peer, 1, axis=1),
        "a row lower": np.roll(peer, 1, axis=0),
        "upside down": peer[::-1],
        "ids off by one": np.where(peer >= 0, peer - 1, -1),
        "a hole": peer.copy(),
    }
    faults["a hole"][row, column] = -1
    faults["one triangle missing"] = np.where(peer == own[row, column], -1, peer)
    for name, ids in faults.items():
        _, _, found = drawn(program, glb, CAMERA, True, own_ids=own, peer_ids=ids)
        check(found.classes["unexplained"] > 0, f"{name} was explained: {found.classes}")
        check(found.classes["unexplained"] >= found.different * 0.9 - sound.different, f"{name} was mostly explained: {found.classes}")
        _, _, exchanged = drawn(program, glb, CAMERA, True, own_ids=ids, peer_ids=own)
        check(exchanged.classes["unexplained"] > 0, f"{name} in rasterlab was explained: {exchanged.classes}")
    finer = program.triangle_ids(glb, CAMERA, SIZE, [])
    _, _, found = drawn(program, glb, CAMERA, True, own_ids=finer, peer_ids=peer)
    check(found.classes["unexplained"] > 0, f"another grid was explained: {found.classes}")
    return f"{len(faults)} faults and another grid stay unexplained"
