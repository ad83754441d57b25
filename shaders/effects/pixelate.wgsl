// Pixelate: large square pixels. Each has one color.
//@ use lib/image_pass

struct Pixelate {
    /// Side of a square.
    @range(2, 32, 5) @hard(1, 512) @unit(px) size_px: u32,
    /// How dark the lines between the squares are.
    @range(0, 1, 0.15) gap: f32,
}

fn pixelate(at: ImageAt, p: Pixelate) -> vec4f {
    let size = i32(p.size_px);
    let first = vec2i(at.x / size, at.y / size) * size;
    // Of a large square, pixels on a grid of 8 by 8 are enough.
    let steps = min(size, 8);
    var sum = vec4f(0.0);
    for (var down = 0; down < steps; down += 1) {
        for (var right = 0; right < steps; right += 1) {
            let within = (2 * vec2i(right, down) + 1) * size / (2 * steps);
            sum += image_color(first.x + within.x, first.y + within.y);
        }
    }
    let mean = sum / f32(steps * steps);
    let is_gap = at.x == first.x || at.y == first.y;
    return vec4f(mean.rgb * select(1.0, 1.0 - p.gap, is_gap), mean.a);
}
