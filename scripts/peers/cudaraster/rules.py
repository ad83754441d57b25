"""The rules of the CUDA rasterizer inside nvdiffrast (Laine and Karras 2011), written anew from its source: the snap to 1/16 px, the
clipper, which samples a triangle covers, its depth plane, and a slow picture of them all. The names of its functions are in the comments.

Positions here are in 1/16 px from the center of the picture, x right and y as its clip space has it: up, or down where y was negated."""

import numpy as np

F = np.float32
SUBPIXEL = 16
DEPTH_ERROR = 2200  # CR_LERP_ERROR(0), in units of the depth, of which there are 2^32
DEPTH_MIN = DEPTH_ERROR << 3
DEPTH_MAX = 2**32 - 1 - (DEPTH_ERROR << 3)


def snap(clip, width, height):
    """snapTriangle: x * (1 / w) * half the picture, each rounded to f32, then to the nearest integer, ties to even. int64 [n, 2]."""
    inv_w = F(1.0) / clip[:, 3]
    scale = (F(width * SUBPIXEL // 2), F(height * SUBPIXEL // 2))
    return np.stack([np.rint((clip[:, axis] * inv_w) * scale[axis]) for axis in (0, 1)], axis=1).astype(np.int64)


def inside_frustum(clip):
    """Which vertices lie in the view frustum: a triangle with another is clipped (the strict test of triangleSetupImpl)."""
    return clip[:, 3] >= np.abs(clip[:, :3]).max(axis=1)


def clip_polygon(corners, plane):
    """clipPolygonWithPlane: corners are pairs of weights, `plane` the distances at v0 and along both edges."""
    out = []
    if len(corners) < 3:
        return out
    distance = lambda corner: plane[0] + plane[1] * corner[0] + plane[2] * corner[1]
    before = corners[-1]
    for corner in corners:
        a, b = distance(before), distance(corner)
        if a * b < 0:
            share = a / (a - b)
            rest = F(1.0) - share
            out.append((before[0] * rest + corner[0] * share, before[1] * rest + corner[1] * share))
        if b >= 0:
            out.append(corner)
        before = corner
    return out


def clipped(corners):
    """clipTriangleWithFrustum and the fan that triangleSetupImpl makes of its result: a list of f32 [3, 4]."""
    v0 = corners[0]
    d1, d2 = corners[1] - v0, corners[2] - v0
    weights = [(F(0), F(0)), (F(1), F(0)), (F(0), F(1))]
    for axis in range(3):
        if (corners[:, 3] < np.abs(corners[:, axis])).any():
            for sign in (F(1), F(-1)):
                weights = clip_polygon(weights, [vector[3] + sign * vector[axis] for vector in (v0, d1, d2)])
    made = [v0 + d1 * a + d2 * b for a, b in weights]
    return [np.array([made[0], made[i - 1], made[i]]) for i in range(2, len(made))]


def wrapped(value, bits):
    value &= (1 << bits) - 1
    return value - (1 << bits) if value >> (bits - 1) else value


def depth_plane(z, inv_w, points, width, height):
    """setupTriangle and setupPleq: the depth at pixel (x, y) is a x + b y + c modulo 2^32, for a triangle of positive area."""
    coefficient, bias = F(DEPTH_MAX - DEPTH_MIN) * F(0.5), F(DEPTH_MAX + DEPTH_MIN) * F(0.5)
    # The compiler fuses the multiplication with 1 / w and the addition.
    values = [F(float(v * coefficient) * float(iw) + float(bias)) for v, iw in zip(z, inv_w)]
    (x0, y0), (x1, y1), (x2, y2) = (tuple(int(v) for v in point) for point in points)
    v0 = (x0 + width * 8 - 8, y0 + height * 8 - 8)
    d1, d2 = (x1 - x0, y1 - y0), (x2 - x0, y2 - y0)
    area = d1[0] * d2[1] - d1[1] * d2[0]
    exponent = int(max(values).view(np.int32)) >> 23
    shift = min(max(exponent - (127 + 22), 0), 8)
    t = [int(value) >> shift for value in values]
    t1, t2 = t[1] - t[0], t[2] - t[0]
    bits = int((F(1.0) / F(area)).view(np.int32))
    mantissa, rcp_shift = (bits & 0x7FFFFF) | 0x800000, (23 + 127) - (bits >> 23)
    xc = wrapped((t1 * d2[1] - t2 * d1[1]) * mantissa, 64)
    yc = wrapped((t2 * d1[0] - t1 * d2[0]) * mantissa, 64)
    a = (xc >> (rcp_shift - (shift + 4))) & 0xFFFFFFFF
    b = (yc >> (rcp_shift - (shift + 4))) & 0xFFFFFFFF
    center = [(v0[k] * 2 + min(d1[k], d2[k], 0) + max(d1[k], d2[k], 0)) >> 5 for k in (0, 1)]
    offset = [v0[k] - (center[k] << 4) for k in (0, 1)]
    c = (t[0] << shift) - (((xc >> 13) * offset[0] + (yc >> 13) * offset[1]) >> (rcp_shift - (shift + 13)))
    c -= a * center[0] + b * center[1]
    return a, b, c & 0xFFFFFFFF


def covered(points, xs, ys):
    """The edge rule (cover8x8_exact_noLUT): which of the samples, each on its own, a triangle of positive area covers. An edge
    excludes the samples on it if it goes up (dy > 0), or level to the left."""
    inside = np.ones(np.broadcast(xs, ys).shape, bool)
    for k in range(3):
        (ax, ay), (bx, by) = points[k], points[(k + 1) % 3]
        dx, dy = bx - ax, by - ay
        value = (ax - xs) * dy - (ay - ys) * dx
        inside &= value > 0 if dy > 0 or (dy == 0 and dx <= 0) else value >= 0
    return inside


def picture(clip, triangles, width, height):
    """The picture of all rules: ids, int64 [height, width], -1 for none, row 0 first where y = -1; and the depths, uint64."""
    ids = np.full((height, width), -1, np.int64)
    depths = np.full((height, width), DEPTH_MAX, np.uint64)
    inside = inside_frustum(clip)
    for number, triangle in enumerate(triangles):
        corners = clip[triangle]
        if not inside[triangle].all():
            bounds = [(corners[:, 3] < sign * corners[:, axis]).all() for axis in range(3) for sign in (F(1), F(-1))]
            parts = [] if any(bounds) else clipped(corners)
        else:
            parts = [corners]
        for part in parts:
            draw(ids, depths, number, part, width, height)
    return ids, depths


def draw(ids, depths, number, corners, width, height):
    """One triangle inside the frustum: set up, covered samples, depth test. Of equal depths the later one stays."""
    points, z, inv_w = snap(corners, width, height), corners[:, 2], F(1.0) / corners[:, 3]
    (x0, y0), (x1, y1), (x2, y2) = points
    area = (x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0)
    if area == 0:
        return
    if area < 0:
        order = [0, 2, 1]
        points, z, inv_w = points[order], z[order], inv_w[order]
    center = np.array([width * 8, height * 8])
    low = np.maximum((points.min(axis=0) + center) // 16 - 1, 0)
    high = np.minimum((points.max(axis=0) + center) // 16 + 2, (width, height))
    if (low >= high).any():
        return
    columns, rows = np.arange(low[0], high[0]), np.arange(low[1], high[1])
    xs, ys = (columns * 16 + 8 - center[0])[None, :], (rows * 16 + 8 - center[1])[:, None]
    a, b, c = depth_plane(z, inv_w, points, width, height)
    # Products of two numbers below 2^32 and 2^11.
    depth = (np.uint64(a) * columns.astype(np.uint64)[None, :] + np.uint64(b) * rows.astype(np.uint64)[:, None] + np.uint64(c)) & np.uint64(0xFFFFFFFF)
    window = (slice(low[1], high[1]), slice(low[0], high[0]))
    wins = covered(points, xs, ys) & (depth <= depths[window])
    ids[window][wins] = number
    depths[window][wins] = depth[wins]
