// Wood: rings of years around an axis, with fibers along it.
//@ use lib/noise
//@ use lib/surface

struct Wood {
    /// Color of the spring.
    @color(0.6, 0.36, 0.16) spring: vec4f,
    /// Color of the autumn.
    @color(0.22, 0.1, 0.04) autumn: vec4f,
    /// Rings per meter.
    @range(1.0, 40.0, 9.0) rings: f32,
    /// How crooked the tree is.
    @range(0.0, 1.0, 0.25) crooked: f32,
}

fn wood(surface: Surface, p: Wood) -> Surface {
    var s = surface;
    let bent = p.crooked * (noise_value(1.5 * s.position, 1u) - 0.5);
    let years = p.rings * (length(s.position.xz + vec2f(0.2, 0.1)) + bent);
    let season = abs(2.0 * (years - floor(years)) - 1.0);
    let fiber = noise_value(s.position * vec3f(40.0, 2.0, 40.0), 2u);
    let color = mix(p.autumn.rgb, p.spring.rgb, season * season * (3.0 - 2.0 * season));
    s.color = vec4f(color * (0.75 + 0.5 * fiber), s.color.a);
    return s;
}
