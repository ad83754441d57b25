// Triangles: the draws that they belong to, the vertices that they join, and their three snapped vertices.
// Mirrors `gpu::records::{DrawRecord, InstancedDrawRecord, DrawShapeRecord}` and `frame::SnappedVertex`.
//@ use lib/frame
//@ use lib/fixed
//@ use glue/draws
//@ use glue/index_bytes
//@ use variants/draw_records
//@ use variants/points
//@ use variants/corner_records

// ---- Draws. `draws` is a uniform where the scene has one draw, else a storage buffer: the glue declares it. Its records are
// `InstancedDraw` where many instances show few primitives; `variants/draw_records` reads what the two kinds keep in different places.

struct Draw {
    clip_from_object: mat4x4f,
    world_from_object: mat4x4f,
    normal_from_object: mat4x4f, // cofactors, which keep the direction of plane normals
    base_color: vec4f,
    origin: vec4f,               // object-space origin of packed and of eye-relative positions
    step: vec4f,                 // one step of a packed position
    first_vertex: u32,           // where no pass projects points, those are not counted
    vertex_count: u32,
    first_triangle: u32,
    flags: u32,                  // DRAW_* bits; from bit 8 on the index of its primitive
    topology: u32,
    index_offset: u32,
    index_format: u32,           // bytes per index; 0 without indices
    position_offset: u32,
    position_stride: u32,
    position_format: u32,
    normal_offset: u32,
    normal_stride: u32,
    normal_format: u32,
    color_offset: u32,
    color_stride: u32,
    color_format: u32,           // component count in bits 8 and up; 0 without colors
    scopes: u32,                 // bit k is set if the draw lies in scope k of the stack
    point_radius_px: f32,        // radius of the discs of its points at a distance of 1
    first_point: u32,            // points, and blocks of points, of all draws before
    first_block: u32,
}

// A draw whose primitive is described in `shapes`. Its matrices to the world lie behind the attributes.
struct InstancedDraw {
    clip_from_object: mat4x4f,
    first_vertex: u32,
    first_triangle: u32,
    flags: u32,                  // as in `Draw`; the index of its primitive is that of its shape
    scopes: u32,
}

// What all instances of a primitive share; members are those of `Draw`.
struct DrawShape {
    base_color: vec4f,
    origin: vec4f,
    step: vec4f,
    vertex_count: u32,
    topology: u32,
    index_offset: u32,
    index_format: u32,
    position_offset: u32,
    position_stride: u32,
    position_format: u32,
    normal_offset: u32,
    normal_stride: u32,
    normal_format: u32,
    color_offset: u32,
    color_stride: u32,
    color_format: u32,
    first_placement: u32,        // word of the attributes at which the matrices of all instances begin
    spare_0: u32,
    spare_1: u32,
}

// Where the values of an attribute lie, in bytes, and how.
struct AttributePlace {
    offset: u32,
    stride: u32,
    format: u32,
}

const DRAW_DOUBLE_SIDED = 1u;
const DRAW_MIRRORED = 2u;
const DRAW_PARTICLES = 4u;
const DRAW_UNEVEN = 8u;  // its transform shears, or scales unevenly
const DRAW_FACETED = 16u; // normals are those of the planes
const DRAW_PRIMITIVE_SHIFT = 8u;

// ---- Topology. Indices are u8, u16 or u32, as the file stores them; the glue declares `index_bytes`.

override HAS_INDICES: bool = true;
// Every draw has u32 indices.
override U32_INDICES: bool = false;
// No draw is a strip, a fan, points or lines.
override ONLY_TRIANGLE_LISTS: bool = false;

const TOPOLOGY_STRIP = 1u;
const TOPOLOGY_FAN = 2u;
const TOPOLOGY_POINTS = 3u;
const TOPOLOGY_LINES = 4u;

// Vertex within its draw at a position of the draw's index list; an index out of range means the last vertex.
fn index_at(draw: u32, position: u32) -> u32 {
    if !HAS_INDICES { return position; }
    let first = draw_index_offset(draw);
    if U32_INDICES { return min(index_bytes[first / 4u + position], draw_vertex_count(draw) - 1u); }
    let bytes = draw_index_format(draw);
    if bytes == 0u { return position; }
    let byte = first + position * bytes;
    let index = extractBits(index_bytes[byte / 4u], (byte % 4u) * 8u, bytes * 8u);
    return min(index, draw_vertex_count(draw) - 1u);
}

// Vertices within the draw of the corners of its triangle `t`, in glTF's order.
fn triangle_vertices(draw: u32, t: u32) -> vec3u {
    var positions = vec3u(3u * t, 3u * t + 1u, 3u * t + 2u);
    if !ONLY_TRIANGLE_LISTS {
        let topology = draw_topology(draw);
        if topology == TOPOLOGY_STRIP { positions = vec3u(t, t + 1u + (t & 1u), t + 2u - (t & 1u)); }
        if topology == TOPOLOGY_FAN { positions = vec3u(t + 1u, t + 2u, 0u); }
        if topology == TOPOLOGY_POINTS { positions = vec3u(t); }
        if topology == TOPOLOGY_LINES { positions = vec3u(t & ~1u, t, t | 1u); }
    }
    return vec3u(index_at(draw, positions.x), index_at(draw, positions.y), index_at(draw, positions.z));
}

// ---- Snapped vertices, 16 bytes each: x << 8 | flags, y << 8, bits of depth, bits of 1/w.

const VERTEX_NONFINITE = 1u;
const VERTEX_OUT_OF_RANGE = 2u;
const VERTEX_NEAR = 4u;     // between the eye and the near plane
const VERTEX_LEFT = 8u;     // outside the guard band
const VERTEX_RIGHT = 16u;
const VERTEX_TOP = 32u;
const VERTEX_BOTTOM = 64u;
const VERTEX_REJECTED = 3u;
const VERTEX_CLIPPED = 124u;

// Position of a snapped vertex, in units.
fn vertex_at(record: vec4u) -> vec2i {
    return bitcast<vec2i>(record.xy) >> vec2u(8u);
}

// ---- Triangles.

// Some triangle may need clipping.
override HAS_CLIPPING: bool = false;

// The snapped vertices of its corners.
struct CornerRecords {
    a: vec4u,
    b: vec4u,
    c: vec4u,
}

struct Triangle {
    a: vec4u,
    b: vec4u,
    c: vec4u,
    id: u32,
    draw: u32,
    entry: u32,    // index among all triangles and, behind them, all clipped triangles
    outline: u32,  // bit k is set if the edge opposite corner k belongs to the original triangle (not made by clipping)
}

fn triangle_load(id: u32) -> Triangle {
    return triangle_of(draw_of_triangle(id), id);
}

// The same where the draw is known.
fn triangle_of(draw: u32, id: u32) -> Triangle {
    let corners = corner_records(draw, id);
    return triangle_spread(Triangle(corners.a, corners.b, corners.c, id, draw, id, 7u));
}

// Is a triangle of this orientation drawn, given the flags of its draw? Clockwise on screen (area > 0) is the back of a glTF
// triangle.
fn triangle_is_shown(flags: u32, is_clockwise: bool) -> bool {
    let is_back = is_clockwise != ((flags & DRAW_MIRRORED) != 0u);
    return (flags & DRAW_DOUBLE_SIDED) != 0u || !is_back;
}

// First and last candidate pixel of a box in units, clamped to the picture; empty where the last precedes the first.
fn triangle_pixels(low: vec2i, high: vec2i) -> vec4i {
    let first = max(grid_first(low), vec2i(0));
    let last = min(grid_last(high), vec2i(frame.size) - 1);
    return vec4i(first, last);
}

// Counts a triangle with a corner that is not finite or out of range. Returns whether the triangle is rejected; `any_flag`
// combines the flags of all corners.
fn triangle_rejected(any_flag: u32) -> bool {
    if (any_flag & VERTEX_NONFINITE) != 0u {
        atomicAdd(&counters.rejected_nonfinite, 1u);
    } else if (any_flag & VERTEX_OUT_OF_RANGE) != 0u {
        atomicAdd(&counters.rejected_range, 1u);
    }
    return (any_flag & VERTEX_REJECTED) != 0u;
}

// The vertex that a snapped vertex is the projection of.
struct VertexSource {
    draw: u32,
    vertex: u32,   // within the draw
    triangle: u32, // where triangles share no vertices, else 0
}
