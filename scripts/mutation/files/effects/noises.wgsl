// Noises: every noise as a channel of the surface's color, in the middle of its range.
//@ use lib/noise
//@ use lib/surface

struct Noises {
    /// Which noises are shown.
    @choice(smooth, rough) kind: u32,
    /// Cells to a meter.
    @range(0.1, 20.0, 3.7) cells: f32,
    /// Another seed gives other noise.
    @range(0, 999, 7) seed: u32,
}

fn noises(surface: Surface, p: Noises) -> Surface {
    var s = surface;
    let at = s.position * p.cells - vec3f(2.3, 0.4, 1.7);
    var color = vec3f(noise_value(at, p.seed), 0.5 + 0.5 * noise_gradient(at, p.seed), 0.5 + 0.5 * noise_simplex(at, p.seed));
    if p.kind == NOISES_KIND_ROUGH {
        let found = noise_cellular(at, p.seed);
        color = vec3f(0.4 * found.x + 0.5 * found.y, found.z, 0.5 + 0.5 * noise_layers(at, 3u, p.seed));
    }
    s.color = vec4f(color, s.color.a);
    return s;
}
