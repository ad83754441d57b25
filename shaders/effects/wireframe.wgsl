// Wireframe: draws the edges of triangles at a constant width. The width is in pixels.
//@ use lib/surface
//@ use lib/sample
//@ use lib/fixed

struct Wireframe {
    /// Color of the lines; alpha is its weight against the surface's color.
    @color(0.9, 0.95, 1) ink: vec4f,
    /// Color of the faces; alpha is its weight against the surface's color.
    @color(0.01, 0.012, 0.02) @when(hidden, removed) paper: vec4f,
    /// Width of the lines.
    @range(0.5, 8, 1.5) @hard(0, 256) @unit(px) width_px: f32,
    /// What becomes of lines behind faces.
    @choice(shown, removed) @default(removed) hidden: u32,
}

// For the edge opposite each corner: the area from which a sample is too far away; 0 draws nothing. Each triangle draws half of
// an edge's width.
fn wireframe_sample_setup(t: TriangleSetup, p: Wireframe) -> vec4u {
    let half_width = u32(round(p.width_px * 128.0));
    let shift = fixed_shift(fixed_abs(fixed_edge(t.a, t.b, t.c)));
    return vec4u(
        select(0u, wireframe_reach(t.c - t.b, half_width, shift), (t.outline & 1u) != 0u),
        select(0u, wireframe_reach(t.a - t.c, half_width, shift), (t.outline & 2u) != 0u),
        select(0u, wireframe_reach(t.b - t.a, half_width, shift), (t.outline & 4u) != 0u), 0u);
}

fn wireframe_reach(edge: vec2i, half_width: u32, shift: u32) -> u32 {
    let squared = fixed_add(fixed_mul(edge.x, edge.x), fixed_mul(edge.y, edge.y));
    let reach = fixed_umul(fixed_root(squared), half_width);
    // A reach above 31 bits is above every area.
    return select(fixed_down(reach, shift), 0x7fffffffu, fixed_shift(reach) > shift) + 1u;
}

fn wireframe_sample(s: Sample, p: Wireframe) -> bool {
    return p.hidden == WIREFRAME_HIDDEN_REMOVED || any(s.areas < s.setup.xyz);
}

@smooth
fn wireframe_surface(surface: Surface, p: Wireframe) -> Surface {
    var s = surface;
    let distance = min(min(s.edge_distance_px.x, s.edge_distance_px.y), s.edge_distance_px.z);
    // Where the faces are drawn too, the line fades over one pixel.
    var line = 1.0;
    if p.hidden == WIREFRAME_HIDDEN_REMOVED { line = clamp(0.5 * p.width_px + 0.5 - distance, 0.0, 1.0); }
    let face = mix(s.color.rgb, p.paper.rgb, p.paper.a);
    s.color = vec4f(mix(face, mix(s.color.rgb, p.ink.rgb, p.ink.a), line), s.color.a);
    return s;
}
