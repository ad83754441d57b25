// Rings: the order in which the rasterizer fills the picture, as the rings of a tree.
//
// `rank` says which fraction of all samples the triangle's first one comes after. It needs the effect draw_order before this one.
// Every sample is counted, exactly and in the order of the file, so the picture stops after as many as you ask for, on any adapter.
//@ use lib/surface
//@ use lib/angle
//@ use lib/hash

struct Rings {
    /// Color of the wood that grows in spring.
    @color(0.72, 0.45, 0.22) early: vec4f,
    /// Color of the wood that grows in late summer.
    @color(0.2, 0.08, 0.03) late: vec4f,
    /// Color of what is drawn last.
    @color(1.0, 0.36, 0.05) ember: vec4f,
    /// Number of rings in the whole picture.
    @range(1, 200, 90) @hard(1, 2000) years: u32,
    /// Where the picture stops: the same as draw_order.fraction.
    @range(0.0, 1.0, 0.7) end: f32,
    /// Width of the glow behind the end.
    @range(0.001, 0.5, 0.1) @log glow_width: f32,
}

fn rings(surface: Surface, p: Rings) -> Surface {
    var s = surface;
    // Good years and bad ones: a wave along the ranks, slow enough that years keep their order.
    let even = f32(p.years) * s.rank;
    let years = even + 0.8 * sine_turns(0.11 * even) + 0.2 * sine_turns(0.31 * even);
    let year = fract(years);
    let wood = mix(p.early.rgb, p.late.rgb, year * year * year) * (0.8 + 0.2 * hash_unit(u32(years)));
    let near = clamp(1.0 - (p.end - s.rank) / p.glow_width, 0.0, 1.0);
    s.color = vec4f(wood, s.color.a);
    s.glow = p.ember.rgb * (1.6 * near * near);
    s.color += vec4f(s.glow, 0.0);
    return s;
}
