// Marble: veins that wander through a white stone.
//@ use lib/angle
//@ use lib/noise
//@ use lib/surface

struct Marble {
    /// Color of the stone.
    @color(0.85, 0.83, 0.8) stone: vec4f,
    /// Color of the veins.
    @color(0.08, 0.1, 0.14) vein: vec4f,
    /// Veins per meter.
    @range(0.2, 8.0, 1.5) veins: f32,
    /// How far they wander.
    @range(0.0, 3.0, 0.9) wander: f32,
}

fn marble(surface: Surface, p: Marble) -> Surface {
    var s = surface;
    let bent = p.wander * noise_layers(2.0 * s.position, 5u, 3u);
    let wave = abs(sine_turns(0.5 * p.veins * (s.position.x + 0.5 * s.position.y) + bent));
    let stone = mix(p.vein.rgb, p.stone.rgb, sqrt(clamp(wave, 0.001, 1.0)));
    s.color = vec4f(stone, s.color.a);
    return s;
}
