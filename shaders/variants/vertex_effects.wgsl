// Vertex effects: what the vertex effects of the stack do to the corners of triangles.
// Chosen by the stack: applied where an effect moves vertices.
//
// Clip-space position of a corner after the effects. `p` is the vertex in object space, `id` its triangle.
//@ declare fn vertex_effects_clip(draw: u32, vertex: u32, id: u32, p: vec3f) -> vec4f
// The same of a vertex that was not rejected.
//@ declare fn vertex_effects_clip_of(draw: u32, vertex: u32, id: u32) -> vec4f
// The same of the corners of a triangle, `at`: its vertices within its draw.
//@ declare fn vertex_effects_triangle(draw: u32, at: vec3u, id: u32) -> mat3x4f
// Before samples of a triangle are shaded: computes what they share.
//@ declare fn vertex_effects_begin(id: u32, draw: u32, at: vec3u)
// Interpolated and flat normal after the effects, before they are turned towards the viewer, given those of the file.
//@ declare fn vertex_effects_normals(smooth_normal: vec3f, flat_normal: vec3f, weights: vec3f) -> mat2x3f

//@ variant default
// Nothing moves.
//@ use lib/attributes
//@ use lib/geometry

fn vertex_effects_clip(draw: u32, vertex: u32, id: u32, p: vec3f) -> vec4f {
    return transform_clip(draw, p);
}

fn vertex_effects_triangle(draw: u32, at: vec3u, id: u32) -> mat3x4f {
    return mat3x4f(vertex_effects_clip_of(draw, at.x, id), vertex_effects_clip_of(draw, at.y, id), vertex_effects_clip_of(draw, at.z, id));
}

fn vertex_effects_clip_of(draw: u32, vertex: u32, id: u32) -> vec4f {
    return vertex_effects_clip(draw, vertex, id, floats_of_class(position_bits(draw, vertex), 0u));
}

fn vertex_effects_begin(id: u32, draw: u32, at: vec3u) {}

fn vertex_effects_normals(smooth_normal: vec3f, flat_normal: vec3f, weights: vec3f) -> mat2x3f {
    return mat2x3f(smooth_normal, flat_normal);
}

//@ variant applied
// Effects tell how far a corner moves, not where it ends, so that a vertex which stays keeps its bits,
// and one far from the origin loses none.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/vertex
//@ use lib/attributes
//@ use lib/geometry
//@ use variants/draw_records
// What a corner knows before the effects, beyond its own vertex: triangle where an effect moves corners triangle by triangle.
//@ steps fn corner_step(v: Vertex, draw: u32, id: u32, p: vec3f) -> Vertex
//@ use glue/vertex

// The stored normal in world space, of any length; zero where there is none.
fn vertex_effects_stored_normal(draw: u32, vertex: u32) -> vec3f {
    let stored = normal_from_bits(normal_bits(draw, vertex));
    return draw_normal(draw, stored.xyz);
}

// A corner after the effects.
fn vertex_effects_corner(draw: u32, vertex: u32, id: u32, p: vec3f) -> Vertex {
    let position = clamp_world(draw_point(draw, p));
    let normal = normal_direction(vertex_effects_stored_normal(draw, vertex));
    let v = Vertex(position, vec3f(0.0), normal, vec3f(0.0), position, vec3f(0.0), vec2f(0.0), 0u, 0u);
    return glue_vertex(corner_step(v, draw, id, p), draw);
}

fn vertex_effects_clip(draw: u32, vertex: u32, id: u32, p: vec3f) -> vec4f {
    let corner = vertex_effects_corner(draw, vertex, id, p);
    let offset = clamp_world(corner.offset);
    let m = frame.clip_from_world;
    let clip = transform_clip(draw, p) + (m[0] * offset.x + m[1] * offset.y + m[2] * offset.z);
    // An orthographic depth beyond the far plane is clamped to it: there are no depths below 0.
    return vertex_effects_on_grid(vec4f(clip.xy, max(clip.z, 0.0), clip.w), corner.cell_px);
}

// A corner at the nearest corner of a grid of the picture that begins at its center. The place is snapped and rounded to a cell in
// integers, so that adapters decide alike; what lies before the near plane has no place.
fn vertex_effects_on_grid(clip: vec4f, cell_px: u32) -> vec4f {
    if cell_px == 0u || IS_SHADOW_MAP || clip.z > clip.w || clip.w <= 0.0 { return clip; }
    let cell = i32(cell_px * (u32(2.0 * frame.center.y) / max(frame.size.y, 1u)));
    let limit = vec2f(16777216.0);
    let snapped = vec2i(clamp(round(clip.xy * (1.0 / clip.w) * frame.center), -limit, limit)) + cell / 2;
    let whole = snapped / cell - select(vec2i(0), vec2i(1), snapped % vec2i(cell) < vec2i(0));
    return vec4f(vec2f(whole * cell) / frame.center * clip.w, clip.zw);
}

// A loop, because compilers inline the vertex effects wherever they are called. It fills no array: NVIDIA's driver 580.159 loses
// members of array elements that a loop writes.
fn vertex_effects_triangle(draw: u32, at: vec3u, id: u32) -> mat3x4f {
    var a: vec4f;
    var b: vec4f;
    var c: vec4f;
    for (var i = 0u; i < 3u; i += 1u) {
        let vertex = select(select(at.z, at.y, i == 1u), at.x, i == 0u);
        let corner = vertex_effects_clip_of(draw, vertex, id);
        if i == 0u { a = corner; } else if i == 1u { b = corner; } else { c = corner; }
    }
    return mat3x4f(a, b, c);
}

fn vertex_effects_clip_of(draw: u32, vertex: u32, id: u32) -> vec4f {
    return vertex_effects_clip(draw, vertex, id, floats_of_class(position_bits(draw, vertex), 0u));
}

// What the samples of a triangle share.
struct MovedNormals {
    is_deformed: bool,     // the plane is no longer the file's
    flat_normal: vec3f,
    is_turned: bool,       // the corners' normals are no longer the file's
    a: vec4f,              // as returned by `normal_from_bits`
    b: vec4f,
    c: vec4f,
}

var<private> moved: MovedNormals;

fn vertex_effects_begin(id: u32, draw: u32, at: vec3u) {
    let pa = floats_of_class(position_bits(draw, at.x), 0u);
    let pb = floats_of_class(position_bits(draw, at.y), 0u);
    let pc = floats_of_class(position_bits(draw, at.z), 0u);
    // A loop, because compilers inline the vertex effects wherever they are called. It fills no array: NVIDIA's driver 580.159 loses
    // members of array elements that a loop without bounds checks writes.
    var a: Vertex;
    var b: Vertex;
    var c: Vertex;
    for (var i = 0u; i < 3u; i += 1u) {
        let p = select(select(pc, pb, i == 1u), pa, i == 0u);
        let vertex = select(select(at.z, at.y, i == 1u), at.x, i == 0u);
        let v = vertex_effects_corner(draw, vertex, id, p);
        if i == 0u { a = v; } else if i == 1u { b = v; } else { c = v; }
    }
    moved.is_deformed = any(a.offset != b.offset) || any(a.offset != c.offset);
    let ab = draw_vector(draw, pb - pa) + (b.offset - a.offset);
    let ac = draw_vector(draw, pc - pa) + (c.offset - a.offset);
    let plane = normal_direction(normal_of_plane(vec3f(0.0), ab, ac));
    moved.flat_normal = select(plane, -plane, (draws[draw].flags & DRAW_MIRRORED) != 0u);

    let na = vertex_effects_stored_normal(draw, at.x);
    let nb = vertex_effects_stored_normal(draw, at.y);
    let nc = vertex_effects_stored_normal(draw, at.z);
    // Where planes alone have normals, nothing turns them.
    let is_smooth = (draws[draw].flags & DRAW_FACETED) == 0u;
    moved.is_turned = is_smooth && (any(a.normal != normal_direction(na)) || any(b.normal != normal_direction(nb)) || any(c.normal != normal_direction(nc)));
    moved.a = vertex_effects_weighted(draw, a.normal, na, normal_from_bits(normal_bits(draw, at.x)));
    moved.b = vertex_effects_weighted(draw, b.normal, nb, normal_from_bits(normal_bits(draw, at.y)));
    moved.c = vertex_effects_weighted(draw, c.normal, nc, normal_from_bits(normal_bits(draw, at.z)));
}

// Turned normals keep the lengths by which the file weights them. `in_world` is the stored one in world space, which an uneven
// transform gives another length.
fn vertex_effects_weighted(draw: u32, turned: vec3f, in_world: vec3f, stored: vec4f) -> vec4f {
    let is_uneven = (draws[draw].flags & DRAW_UNEVEN) != 0u;
    return vec4f(turned * select(length(in_world), length(stored.xyz), is_uneven), stored.w);
}

// What no effect changes keeps its bits: the plane of a triangle that is only carried along, and the interpolated normal where
// no corner's normal is turned.
fn vertex_effects_normals(smooth_normal: vec3f, flat_normal: vec3f, weights: vec3f) -> mat2x3f {
    var normals = mat2x3f(smooth_normal, flat_normal);
    if moved.is_deformed { normals[1] = moved.flat_normal; }
    if moved.is_turned { normals[0] = normal_direction(normal_interpolated(moved.a, moved.b, moved.c, weights)); }
    return normals;
}

//@ step triangle
// Normal and center of the corner's triangle, before any effect. `p` is the corner in object space.
//@ use lib/triangle
//@ use lib/vertex
//@ use lib/attributes
//@ use lib/geometry
//@ use variants/draw_records

fn corner_step_triangle(v: Vertex, draw: u32, id: u32, p: vec3f) -> Vertex {
    var corner = v;
    let at = triangle_vertices(draw, id - draws[draw].first_triangle);
    let a = corner_position(draw, at.x);
    let b = corner_position(draw, at.y);
    let c = corner_position(draw, at.z);
    corner.flat_normal = normal_direction(draw_normal(draw, normal_of_plane(a, b, c)));
    corner.center = clamp_world(center_of(draw, a, b, c));
    corner.arm = draw_vector(draw, ((p - a) + (p - b) + (p - c)) / 3.0);
    let middle = transform_clip(draw, (a + b + c) / 3.0);
    corner.center_screen = center_in_picture(corner.center, center_clipped(middle, middle, middle, vec2f(0.5)));
    corner.triangle = id;
    return corner;
}

// A vertex in object space; the origin where it is rejected.
fn corner_position(draw: u32, vertex: u32) -> vec3f {
    let bits = position_bits(draw, vertex);
    return floats_of_class(bits, bit_class(bits));
}
