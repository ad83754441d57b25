// Toon: light in a few flat steps with soft edges, and a rim.
//@ use lib/surface

struct Toon {
    /// Color of the rim, linear; its alpha is the strength.
    @color(1, 0.96, 0.88, 0) rim: vec4f,
    /// Number of flat tones.
    @range(1, 8, 3) @hard(1, 16) steps: u32,
    /// Width of the edge between two tones, as a fraction of a step.
    @range(0.05, 1, 0.12) softness: f32,
    /// Tone of the darkest step, as the eye sees it.
    @range(0, 1, 0.3) shadow: f32,
    /// Tone of the brightest step.
    @range(0, 1, 0.95) light: f32,
    /// How far the rim reaches in from the outline: 1 to where the surface faces the eye.
    @range(0.02, 1, 0.35) rim_width: f32,
}

fn toon(surface: Surface, p: Toon) -> Surface {
    var s = surface;
    let steps = f32(p.steps);
    let brightest = max(max(max(s.color.r, s.color.g), s.color.b), 0.0);
    // The soft edge of a step is its upper end.
    let position = min(sqrt(brightest), 1.0) * steps;
    let step = min(floor(position) + smoothstep(1.0 - p.softness, 1.0, position - floor(position)), steps - 1.0);
    let tone = p.light - (p.light - p.shadow) * (steps - 1.0 - step) / max(steps - 1.0, 1.0);
    var flat = vec3f(tone * tone);
    if brightest > 1e-6 { flat = s.color.rgb * (tone * tone / brightest); }
    let turned_away = 1.0 - clamp(dot(s.normal, s.view), 0.0, 1.0);
    let inner = 1.0 - p.rim_width;
    let rim = smoothstep(inner, inner + 0.5 * p.softness, turned_away) * p.rim.a;
    s.color = vec4f(flat + (p.rim.rgb - flat) * rim, s.color.a);
    return s;
}
