// Fog: blends towards a color with distance. The law is that of Beer and Lambert.
//@ use lib/surface

struct Fog {
    /// Color of the fog, linear.
    @color(0.36, 0.44, 0.55) color: vec4f,
    /// Extinction coefficient: light falls as exp(-density · path).
    @range(0, 2, 0.35) @hard(0, 10000) @unit(per m) @depth density: f32,
    /// Depth at which the fog begins.
    @range(0, 20, 3) @hard(0, 1e6) @unit(m) @depth start_m: f32,
    /// How fast the fog thins out above the level; 0 is as thick everywhere.
    @range(0, 4, 0) @hard(0, 1000) @unit(per m) falloff: f32,
    /// Height up to which the fog is whole, world space.
    @range(-3, 3, 0) @hard(-1e6, 1e6) @unit(m) @height level_m: f32,
}

@smooth
fn fog(surface: Surface, p: Fog) -> Surface {
    var s = surface;
    let above = max(s.position.y - p.level_m, 0.0);
    let thickness = p.density * exp(-above * p.falloff);
    let fraction = 1.0 - exp(-thickness * max(s.depth_m - p.start_m, 0.0));
    s.glow *= 1.0 - fraction;
    s.color = vec4f(s.color.rgb + (p.color.rgb - s.color.rgb) * fraction, s.color.a);
    return s;
}
