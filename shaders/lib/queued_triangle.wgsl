// The triangle that a queue entry names: a triangle of the scene, or, with CLIPPED_ENTRY set, a triangle that clipping made.
// With HIDDEN_ENTRY set, the pass that found the nearest depths saw that blocks hide all of it, so the next pass leaves it out.
// Mirrors `gpu::records::ClippedTriangleRecord`.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use glue/clipped_triangles

struct ClippedTriangle {
    a: vec4u,
    b: vec4u,
    c: vec4u,
    parent: vec4u, // id of the triangle that was clipped, its draw, index in the fan, outline as in `Triangle`
}

// Bit of a queue entry that names a clipped triangle.
const CLIPPED_ENTRY = 0x80000000u;
// Bit of an entry of the medium queue and of the tiles.
const HIDDEN_ENTRY = 0x40000000u;

// This pass sets HIDDEN_ENTRY, or reads it.
override MARKS_ENTRIES: bool = false;
override SKIPS_HIDDEN_ENTRIES: bool = false;

fn queued_triangle(entry: u32) -> Triangle {
    let index = entry & ~(CLIPPED_ENTRY | HIDDEN_ENTRY);
    if HAS_CLIPPING && (entry & CLIPPED_ENTRY) != 0u {
        let clipped = clipped_triangles[index];
        return Triangle(
            clipped.a, clipped.b, clipped.c, clipped.parent.x, clipped.parent.y, frame.triangle_count + index, clipped.parent.w);
    }
    return triangle_load(index);
}

// A triangle with its corners clockwise on screen, and what its edge functions need: b and c are exchanged where they are not.
struct ClockwiseTriangle {
    a: vec2i,
    b: vec2i,
    c: vec2i,
    z: vec3u,     // depths, bits of floats
    area: Wide,   // twice the area, at least 0
    dx: vec3i,    // edges opposite a, b and c
    dy: vec3i,
    bias: vec3i,  // top-left rule of each edge
}

fn clockwise_triangle(t: Triangle) -> ClockwiseTriangle {
    let a = vertex_at(t.a);
    var b = vertex_at(t.b);
    var c = vertex_at(t.c);
    var z = vec3u(t.a.z, t.b.z, t.c.z);
    var area = fixed_edge(a, b, c);
    if fixed_sign(area) < 0 {
        let swap = b;
        b = c;
        c = swap;
        z = z.xzy;
        area = fixed_edge(a, b, c);
    }
    let dx = vec3i(c.x - b.x, a.x - c.x, b.x - a.x);
    let dy = vec3i(c.y - b.y, a.y - c.y, b.y - a.y);
    let bias = vec3i(fixed_bias(vec2i(dx.x, dy.x)), fixed_bias(vec2i(dx.y, dy.y)), fixed_bias(vec2i(dx.z, dy.z)));
    return ClockwiseTriangle(a, b, c, z, area, dx, dy, bias);
}

// First and last candidate pixel of a clockwise triangle, as `triangle_pixels`.
fn clockwise_pixels(t: ClockwiseTriangle) -> vec4i {
    return triangle_pixels(min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c));
}

// Do all samples of a box of pixels lie on the outer side of the edge a -> b? The sign at the innermost of them tells.
fn edge_excludes(a: vec2i, b: vec2i, pixels: vec4i) -> bool {
    let d = b - a;
    let innermost = grid_sample(select(pixels.xy, pixels.zw, vec2<bool>((d.y < 0), (d.x > 0))));
    return fixed_sign(fixed_edge(a, b, innermost)) < fixed_bias(d);
}
