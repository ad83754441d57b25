// Plasma: sums of waves as colors, as demos drew it before there were shaders.
//@ use lib/angle
//@ use lib/surface

struct Plasma {
    /// Waves across the picture.
    @range(0.5, 8.0, 2.0) scale: f32,
    /// Turns of color in a second.
    @range(0.0, 2.0, 0.25) @unit(/s) speed: f32,
    @given(seconds) time_s: f32,
}

fn plasma(surface: Surface, p: Plasma) -> Surface {
    var s = surface;
    let at = p.scale * (s.screen - 0.5);
    let t = p.speed * p.time_s;
    let away = at + 0.5 * vec2f(sine_turns(0.3 * t), cosine_turns(0.2 * t));
    let sum = sine_turns(at.x + t) + sine_turns(0.5 * (at.y - t)) + sine_turns(length(away) + 0.5 * t);
    let hue = 0.25 * sum + 0.1 * t;
    let color = 0.5 + 0.5 * vec3f(cosine_turns(hue), cosine_turns(hue + 0.33), cosine_turns(hue + 0.67));
    s.color = vec4f(color * (0.3 + 0.7 * clamp(dot(s.normal, s.view), 0.0, 1.0)), s.color.a);
    return s;
}
