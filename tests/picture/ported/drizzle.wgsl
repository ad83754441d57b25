// Drizzle: rings of drops on water, through which the picture is seen.
//@ use lib/angle
//@ use lib/hash
//@ use lib/image_pass

struct Drizzle {
    /// Distance of drops.
    @range(8.0, 128.0, 24.0) @unit(px) cell_px: f32,
    /// How far a ring bends what is seen.
    @range(0.0, 16.0, 3.0) @unit(px) bend_px: f32,
    /// Drops of a place in a second.
    @range(0.1, 4.0, 0.7) @unit(/s) rate: f32,
    @given(seconds) time_s: f32,
}

fn drizzle(at: ImageAt, p: Drizzle) -> vec4f {
    let place = image_middle(at);
    let home = vec2i(floor(place / p.cell_px));
    var moved = vec2f(0.0);
    for (var y = -1; y <= 1; y += 1) {
        for (var x = -1; x <= 1; x += 1) {
            let cell = home + vec2i(x, y);
            let seed = hash(u32(cell.x + 4096) * 8192u + u32(cell.y + 4096));
            let life = fract(p.rate * p.time_s + hash_unit(seed));
            let middle = (vec2f(cell) + 0.2 + 0.6 * vec2f(hash_unit(seed + 1u), hash_unit(seed + 2u))) * p.cell_px;
            let away = place - middle;
            let behind = (life * p.cell_px - length(away)) / (0.25 * p.cell_px);
            let ring = max(1.0 - behind * behind, 0.0) * (1.0 - life) * sine_turns(behind);
            moved += away / max(length(away), 1.0) * ring;
        }
    }
    let seen = place + p.bend_px * moved;
    return image_color_at(seen.x, seen.y);
}
