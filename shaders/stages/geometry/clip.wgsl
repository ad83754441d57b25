// clip: cuts queued triangles at the near plane and the guard band (Sutherland and Hodgman 1974), in clip space, and queues the
// clipped triangles by size. An edge is always cut from its inside to its outside end, so both triangles at the edge get the
// same bits, and a coordinate that a plane fixes is assigned, not computed.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/queues
//@ use lib/queued_triangle
//@ use lib/shape
//@ use lib/snap
//@ use variants/projection

@group(0) @binding(9) var<storage, read_write> clipped_triangles: array<ClippedTriangle>;

// A corner of the polygon.
struct Corner {
    clip: ClipPosition,
    planes: u32,   // VERTEX_NEAR, VERTEX_LEFT and so on: the planes that fix a coordinate
    source: u32,   // 0, 1, 2: a corner of the triangle; 3: a cut
    is_edge: bool, // the polygon's edge that begins here lies on an edge of the triangle, not on a plane
}

struct Polygon {
    corners: array<Corner, 9>,
    count: u32,
}

fn is_outside(plane: u32, corner: Corner, flags: vec4u) -> bool {
    if corner.source < 3u { return (flags[corner.source] & plane) != 0u; }
    return (corner.planes & plane) == 0u && projection_is_outside(plane, corner.clip);
}

fn cut(plane: u32, inside: Corner, outside: Corner) -> Corner {
    return Corner(projection_cut(plane, inside.clip, outside.clip), plane | (inside.planes & outside.planes), 3u, false);
}

fn clip_against(plane: u32, polygon: Polygon, flags: vec4u) -> Polygon {
    var result: Polygon;
    var next_outside = is_outside(plane, polygon.corners[0], flags);
    for (var i = 0u; i < polygon.count; i += 1u) {
        let here = polygon.corners[i];
        let next = polygon.corners[select(i + 1u, 0u, i + 1u == polygon.count)];
        let here_outside = next_outside;
        next_outside = is_outside(plane, next, flags);
        if !here_outside && result.count < 9u {
            result.corners[result.count] = here;
            result.count += 1u;
        }
        if here_outside != next_outside && result.count < 9u {
            // One call: integer arithmetic is long, and compilers inline it into every caller.
            var inside = here;
            var outside = next;
            if here_outside { inside = next; outside = here; }
            result.corners[result.count] = cut(plane, inside, outside);
            // Where the outline returns inside, it continues along the same edge.
            result.corners[result.count].is_edge = here_outside && here.is_edge;
            result.count += 1u;
        }
    }
    return result;
}

// The snapped vertex of a corner: an original vertex keeps its bits.
fn record(corner: Corner, t: Triangle) -> vec4u {
    if corner.source == 0u { return t.a; }
    if corner.source == 1u { return t.b; }
    if corner.source == 2u { return t.c; }
    return projection_cut_record(corner.clip, corner.planes);
}

// Queues a fan of the polygon. A triangle of the fan that the snap reversed, relative to the polygon, is dropped and counted.
fn emit(polygon: Polygon, t: Triangle) {
    var records: array<vec4u, 9>;
    for (var i = 0u; i < polygon.count; i += 1u) { records[i] = record(polygon.corners[i], t); }
    var whole = Wide(0u, 0u);
    for (var i = 1u; i + 1u < polygon.count; i += 1u) {
        whole = fixed_add(whole, fixed_edge(vertex_at(records[0]), vertex_at(records[i]), vertex_at(records[i + 1u])));
    }
    if SHAPE == SHAPE_BOXES {
        emit_box(polygon, t, whole);
        return;
    }
    for (var i = 1u; i + 1u < polygon.count; i += 1u) {
        let a = vertex_at(records[0]);
        let b = vertex_at(records[i]);
        let c = vertex_at(records[i + 1u]);
        let sign = fixed_sign(fixed_edge(a, b, c));
        if sign == 0 || sign != fixed_sign(whole) {
            atomicAdd(&counters.flipped_clips, 1u);
            continue;
        }
        let is_first = i == 1u && polygon.corners[0].is_edge;
        let is_last = i + 2u == polygon.count && polygon.corners[i + 1u].is_edge;
        let outline = select(0u, 1u, polygon.corners[i].is_edge) | select(0u, 2u, is_last) | select(0u, 4u, is_first);
        emit_triangle(t, records[0], records[i], records[i + 1u], i, outline, sign > 0);
    }
}

// Queues the bounding box of the polygon, at the depth of its nearest corner, as a triangle that has this box. The boxes of a fan
// would overlap, and a sample under several would be drawn as often.
fn emit_box(polygon: Polygon, t: Triangle, whole: Wide) {
    let sign = fixed_sign(whole);
    if sign == 0 {
        atomicAdd(&counters.flipped_clips, 1u);
        return;
    }
    var low = vec2i(0x7fffffff);
    var high = vec2i(-0x7fffffff);
    var nearest = vec2u(0u);
    for (var i = 0u; i < polygon.count; i += 1u) {
        let corner = record(polygon.corners[i], t);
        low = min(low, vertex_at(corner));
        high = max(high, vertex_at(corner));
        nearest = max(nearest, corner.zw);
    }
    let first = snap_pack(low, nearest.x, nearest.y, 0u);
    let right = snap_pack(vec2i(high.x, low.y), nearest.x, nearest.y, 0u);
    let below = snap_pack(vec2i(low.x, high.y), nearest.x, nearest.y, 0u);
    emit_triangle(t, first, select(below, right, sign > 0), select(right, below, sign > 0), 1u, 0u, sign > 0);
}

fn emit_triangle(t: Triangle, a: vec4u, b: vec4u, c: vec4u, index: u32, outline: u32, is_clockwise: bool) {
    if !triangle_is_shown(draws[t.draw].flags, is_clockwise) { return; }
    let slot = atomicAdd(&counters.clipped_triangles, 1u);
    if slot >= frame.clipped_triangle_capacity { return; }
    clipped_triangles[slot] = ClippedTriangle(a, b, c, vec4u(t.id, t.draw, index, outline));
    let low = min(min(vertex_at(a), vertex_at(b)), vertex_at(c));
    let high = max(max(vertex_at(a), vertex_at(b)), vertex_at(c));
    let pixels = triangle_pixels(low, high);
    if any(pixels.zw < pixels.xy) { return; }
    if max(high.x - low.x, high.y - low.y) > SMALL_EXTENT { queues_push_large(CLIPPED_ENTRY | slot); }
    else { queues_push_medium(CLIPPED_ENTRY | slot); }
}

@compute @workgroup_size(64)
fn clip(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let count = queues_clip_count();
    let invocations = workgroups.x * workgroups.y * 64u;
    let first = queues_clip_done() + frame_invocation(workgroup, workgroups, invocation_index, 64u);
    for (var slot = first; slot < count; slot += invocations) { clip_queued(slot); }
}

fn clip_queued(slot: u32) {
    let t = triangle_load(queues[slot]);
    let at = triangle_vertices(t.draw, t.id - draws[t.draw].first_triangle);
    let flags = vec4u(t.a.x, t.b.x, t.c.x, 0u);
    var polygon: Polygon;
    for (var k = 0u; k < 3u; k += 1u) {
        polygon.corners[k] = Corner(projection_corner(t.draw, at[k], t.id), 0u, k, true);
    }
    polygon.count = 3u;
    // Near, left, right, top, bottom. A loop, because five copies of the polygon take a CPU adapter's compiler seconds.
    for (var plane = VERTEX_NEAR; plane <= VERTEX_BOTTOM; plane <<= 1u) {
        polygon = clip_against(plane, polygon, flags);
    }
    if polygon.count >= 3u { emit(polygon, t); }
}
