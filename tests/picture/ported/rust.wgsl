// Rust: eats from patches into the paint, with a light rim around them.
//@ use lib/noise
//@ use lib/surface

struct Rust {
    /// Color of the rust.
    @color(0.25, 0.08, 0.03) rust: vec4f,
    /// How much is eaten.
    @range(0.0, 1.0, 0.45) spread: f32,
    /// Patches per meter.
    @range(0.3, 12.0, 2.5) scale: f32,
}

fn rust(surface: Surface, p: Rust) -> Surface {
    var s = surface;
    let place = p.scale * s.position;
    let depth = noise_layers(place, 4u, 11u) + 0.4 * noise_gradient(6.0 * place, 12u) + 1.2 * (p.spread - 0.5);
    let eaten = clamp(8.0 * depth, 0.0, 1.0);
    let rim = clamp(1.0 - abs(12.0 * depth), 0.0, 1.0);
    let grain = 0.6 + 0.8 * noise_value(24.0 * place, 13u);
    let color = mix(s.color.rgb, p.rust.rgb * grain, eaten) + 0.15 * rim;
    s.color = vec4f(color, s.color.a);
    return s;
}
