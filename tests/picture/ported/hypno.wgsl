// Hypno: spiral arms turn over the picture.
//@ use lib/angle
//@ use lib/image_pass

struct Hypno {
    /// Rings to the height of the picture.
    @range(1.0, 20.0, 5.0) rings: f32,
    /// Turns in a second.
    @range(-2.0, 2.0, 0.5) @unit(/s) speed: f32,
    /// How dark the gaps are.
    @range(0.0, 1.0, 0.7) depth: f32,
    @given(seconds) time_s: f32,
    @given(width) width: u32,
    @given(height) height: u32,
}

fn hypno(at: ImageAt, p: Hypno) -> vec4f {
    let size = vec2f(f32(p.width), f32(p.height));
    let from_middle = (image_middle(at) - 0.5 * size) / size.y;
    // Three arms: the third power of the direction as a complex number, without its angle.
    let d = from_middle / max(length(from_middle), 1e-3);
    let arms = d.x * (4.0 * d.x * d.x - 3.0);
    let wave = cosine_turns(p.rings * length(from_middle) + 0.15 * arms - p.speed * p.time_s);
    let color = image_color(at.x, at.y);
    return vec4f(color.rgb * (1.0 - p.depth * (0.5 - 0.5 * wave)), color.a);
}
