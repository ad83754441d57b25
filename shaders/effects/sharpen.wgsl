// Sharpen: edges stand out, without halos. What differs from its surroundings differs more.
//@ use lib/image_pass

struct Sharpen {
    /// Strength: 1 doubles the difference.
    @range(0, 3, 0.8) @hard(0, 8) amount: f32,
    /// Distance of the pixels that count as surroundings.
    @range(1, 8, 1) @hard(1, 64) @unit(px) radius_px: u32,
    /// How far edges may rise above and fall below their surroundings: 0 leaves no halo.
    @range(0, 1, 0.1) halo: f32,
}

fn sharpen(at: ImageAt, p: Sharpen) -> vec4f {
    let color = image_color(at.x, at.y);
    let step = i32(p.radius_px);
    let here = sharpen_tone(color);
    var mean = vec3f(0.0);
    var least = here;
    var most = here;
    for (var down = -1; down <= 1; down += 1) {
        for (var right = -1; right <= 1; right += 1) {
            let tone = sharpen_tone(image_color(at.x + right * step, at.y + down * step));
            // 1 2 1 across and down.
            mean += tone * f32((2 - abs(right)) * (2 - abs(down)));
            least = min(least, tone);
            most = max(most, tone);
        }
    }
    let sharp = here + p.amount * (here - mean / 16.0);
    let room = p.halo * (most - least);
    let held = clamp(sharp, max(least - room, vec3f(0.0)), most + room);
    return vec4f(held * held, color.a);
}

// Square roots are about what the eye sees.
fn sharpen_tone(color: vec4f) -> vec3f {
    return sqrt(max(color.rgb, vec3f(0.0)));
}
