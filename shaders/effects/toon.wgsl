// Toon: light in a few flat steps with soft edges, and a rim.
//@ use lib/surface

struct Toon {
    rim: vec4f,
    steps: u32,
    softness: f32,
    shadow: f32,
    light: f32,
    rim_width: f32,
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
