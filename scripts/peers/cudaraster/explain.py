"""Why two pictures of triangle ids differ: every pixel on which they do is put into one class, from integers where the rules are integers.

Positions here are in 1/16 px from the top left corner of the picture, x right and y down, as rasterlab has them with coverage=fixed4.
Exact positions mean that both rasterizers snapped the same bits to the same integers; otherwise rasterlab's positions are known only
to within the rounding of its float vertex stage, and a vertex whose bound reaches another integer is called doubtful."""

from dataclasses import dataclass

import numpy as np

from . import rules

F = np.float32
# rasterlab's float depth at a sample, relative (docs/exactness.md, section 3), and the roundings of 1/w itself.
OWN_DEPTH_ERROR = 14 * 2.0**-23
# The peer's: its stated error of the plane, f32 roundings of z * (1 / w) at 2^32, of z and of 1 / w, in units of 2^-31 of z / w.
PEER_DEPTH_ERROR = (rules.DEPTH_ERROR + 3 * 256) * 2.0**-31

CLASSES = ("tie", "snap", "clip", "depth", "unexplained")


@dataclass
class Drawing:
    """What both rasterizers were given, and where its vertices are."""

    triangles: np.ndarray  # int [t, 3]
    positions: np.ndarray  # int64 [n, 2], snapped, y down
    doubtful: np.ndarray  # bool [n]: rasterlab may have snapped elsewhere
    inv_w: np.ndarray  # f64 [n]
    peer_z: np.ndarray  # f64 [n], z / w
    is_clipped: np.ndarray  # bool [t], by the peer at the borders of the picture
    size: tuple  # width, height
    row_0_is_top: bool

    @classmethod
    def of(cls, model, own_clip, peer_clip, size, row_0_is_top, terms=None):
        """From rasterlab's strict clip positions, f32 [n, 3], and those that the peer was given, f32 [n, 4]. With `terms`, those of
        `scene.term_sums`, rasterlab drew with its float vertex stage; without, with the strict one, whose snaps are known."""
        width, height = size
        snapped = rules.snap(peer_clip, width, height)
        positions = np.stack([snapped[:, 0], snapped[:, 1] if row_0_is_top else -snapped[:, 1]], axis=1) + np.array([width * 8, height * 8])
        own = own_positions(own_clip, width, height)
        if not np.array_equal(own, positions):
            raise AssertionError("the same bits snapped to different integers")
        doubtful = np.zeros(len(own), bool) if terms is None else may_snap_elsewhere(own_clip, terms, positions, width, height)
        w = own_clip[:, 2].astype(float)
        inside = rules.inside_frustum(peer_clip)[model.triangles].all(axis=1)
        return cls(model.triangles, positions, doubtful, 1.0 / w, peer_clip[:, 2].astype(float) / w, ~inside, size, row_0_is_top)


def own_positions(clip, width, height):
    """rasterlab's strict snap: the center of the picture plus round(x * (1 / w) * center), y down. int64 [n, 2]."""
    inv_w = F(1.0) / clip[:, 2]
    x, y = (np.rint((clip[:, axis] * inv_w) * F(side * 8)) for axis, side in ((0, width), (1, height)))
    return np.stack([width * 8 + x, height * 8 - y], axis=1).astype(np.int64)


def may_snap_elsewhere(clip, terms, positions, width, height):
    """Vertices that a float vertex stage may snap to another integer than `positions`: by the bound B of docs/exactness.md, section 9.
    `terms` are the sums of the magnitudes of the terms of x, y and w."""
    w = np.abs(clip[:, 2].astype(float))
    doubtful = np.zeros(len(clip), bool)
    for axis, side, sign in ((0, width, 1.0), (1, height, -1.0)):
        ndc = clip[:, axis].astype(float) / w
        bound = 2.0**-23 * side * 8 * (4.0 * terms[:, axis] / w + (4.0 * terms[:, 2] / w + 4.5) * np.abs(ndc))
        exact = side * 8 + sign * ndc * side * 8
        doubtful |= np.abs(exact - positions[:, axis]) + bound >= 0.5
    return doubtful


@dataclass
class Hit:
    """A triangle per pixel, seen from the sample."""

    is_there: np.ndarray
    own: np.ndarray  # covered by rasterlab's rule
    peer: np.ndarray  # covered by the peer's
    on_edge: np.ndarray  # exactly on an edge
    distance: np.ndarray  # from the nearest edge, 1/16 px
    inv_w: np.ndarray
    z: np.ndarray
    z_slope: np.ndarray  # change of z / w within 1/16 px, at most
    is_clipped: np.ndarray
    is_doubtful: np.ndarray


def hits(drawing, ids, columns, rows):
    """The triangles `ids` (-1: none) against the samples of these pixels."""
    is_there = ids >= 0
    corners = drawing.triangles[np.maximum(ids, 0)]
    points = drawing.positions[corners]
    area = cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    turned = area < 0
    corners[turned] = corners[turned][:, [0, 2, 1]]
    points[turned] = points[turned][:, [0, 2, 1]]
    area = np.abs(area)
    sample = np.stack([columns * 16 + 8, rows * 16 + 8], axis=1)
    own, peer, on_edge = (np.ones(len(ids), bool) for _ in range(3))
    on_edge[:] = False
    distance = np.full(len(ids), np.inf)
    weights = []
    for k in range(3):
        a, b = points[:, k], points[:, (k + 1) % 3]
        d, to = b - a, sample - a
        value = cross(d, to)
        dx, dy = d[:, 0], d[:, 1]
        own &= np.where((dy < 0) | ((dy == 0) & (dx > 0)), value >= 0, value > 0)
        # The peer owns left edges and level ones on the side of its row 0.
        level = dx > 0 if drawing.row_0_is_top else dx < 0
        peer &= np.where((dy < 0) | ((dy == 0) & level), value >= 0, value > 0)
        length2 = np.maximum((d * d).sum(axis=1), 1)
        along = np.clip((to * d).sum(axis=1) / length2, 0.0, 1.0)
        off = to - d * along[:, None]
        beside = np.where((along > 0) & (along < 1), np.abs(value) / np.sqrt(length2), np.hypot(off[:, 0], off[:, 1]))
        distance = np.minimum(distance, beside)
        on_edge |= beside == 0
        weights.append(value)
    flat = np.maximum(area, 1)
    # The edge from corner k to the next is opposite the one after that.
    shares = np.stack([weights[1], weights[2], weights[0]], axis=1) / flat[:, None]
    z = drawing.peer_z[corners]
    e1, e2 = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    z1, z2 = z[:, 1] - z[:, 0], z[:, 2] - z[:, 0]
    slope = (np.abs(z1 * e2[:, 1] - z2 * e1[:, 1]) + np.abs(z2 * e1[:, 0] - z1 * e2[:, 0])) / flat
    there = is_there & (area > 0)
    return Hit(
        is_there, own & there, peer & there, on_edge & there, np.where(there, distance, np.inf),
        (shares * drawing.inv_w[corners]).sum(axis=1), (shares * z).sum(axis=1), slope,
        drawing.is_clipped[np.maximum(ids, 0)] & is_there, drawing.doubtful[corners].any(axis=1) & is_there,
    )  # fmt: skip


def cross(a, b):
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


@dataclass
class Explanation:
    pixels: int
    own_covered: int  # by rasterlab
    different: int
    coverage: int  # of the different: one picture has a triangle, the other none
    classes: dict  # of the different: name -> pixels
    farthest: dict  # name -> largest distance from the nearest edge of either triangle where coverage differs, 1/16 px
    unexplained: list  # (x, y, own id, peer id), a few


def explain(drawing, own_ids, peer_ids):
    """Compares two pictures of ids, int64 [height, width], top row first, and explains every difference.

    tie: the sample lies exactly on an edge of a triangle that only one rule gives to it.
    snap: a corner may have snapped elsewhere in rasterlab's float vertex stage, and the sample is at most 1.5/16 px away from an edge, or the
    depths differ by less than both planes change in 1/16 px.
    clip: the peer cut the triangle at a border of the picture and snapped the cuts; the sample is at most 1/16 px away from an edge, or the
    depths differ by less than its plane changes in 1/16 px.
    depth: both rules give the sample to both triangles, whose depths are closer than one of both formats resolves."""
    rows, columns = np.nonzero(own_ids != peer_ids)
    a = hits(drawing, own_ids[rows, columns], columns, rows)
    b = hits(drawing, peer_ids[rows, columns], columns, rows)
    distance = np.minimum(a.distance, b.distance)
    clipped = a.is_clipped | b.is_clipped
    # Each picture shows a triangle that its own rule gives the sample to; snaps in doubt are the only excuse.
    lawful = (a.own | ~a.is_there) & (b.peer | ~b.is_there)
    differs = (a.is_there & ~a.peer) | (b.is_there & ~b.own)
    both = a.is_there & b.is_there & a.own & a.peer & b.own & b.peer
    z_apart = np.abs(a.z - b.z)
    same_depth = (np.abs(a.inv_w - b.inv_w) <= 2 * OWN_DEPTH_ERROR * np.maximum(a.inv_w, b.inv_w)) | (z_apart <= 2 * PEER_DEPTH_ERROR)
    cut_depth = z_apart <= 2 * PEER_DEPTH_ERROR + a.z_slope * a.is_clipped + b.z_slope * b.is_clipped
    tie = lawful & differs & ((a.on_edge & (a.own != a.peer)) | (b.on_edge & (b.own != b.peer)))
    snap = (a.is_doubtful | b.is_doubtful) & ((distance <= 1.5) | (both & (z_apart <= 2 * PEER_DEPTH_ERROR + a.z_slope + b.z_slope)))
    clip = clipped & (a.own | ~a.is_there) & ((distance <= 1.0) | (both & cut_depth))
    depth = both & same_depth
    names = np.select([tie, depth, snap, clip], ["tie", "depth", "snap", "clip"], "unexplained")
    found = {name: names == name for name in CLASSES}
    farthest = {name: float(distance[where & ~both].max(initial=0.0)) for name, where in found.items()}
    odd = np.nonzero(found["unexplained"])[0][:8]
    return Explanation(
        own_ids.size, int((own_ids >= 0).sum()), len(rows), int((a.is_there != b.is_there).sum()),
        {name: int(where.sum()) for name, where in found.items()}, farthest,
        [(int(columns[i]), int(rows[i]), int(own_ids[rows[i], columns[i]]), int(peer_ids[rows[i], columns[i]])) for i in odd],
    )  # fmt: skip
