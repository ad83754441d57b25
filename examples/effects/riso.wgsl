// Riso: a print in two spot colors and a dark one, whose plates do not quite fit.
//
// A pixel effect changes the color of one pixel, but sees triangle id, depth and object of all of them. The plates of the spot
// colors are made of those: each object is printed in the first color, the second or both, from the pixel that lies `slip` away.
//@ use lib/image
//@ use lib/color
//@ use lib/angle
//@ use lib/hash

struct Riso {
    /// First spot color.
    @color(1.0, 0.12, 0.22) first: vec4f,
    /// Second spot color.
    @color(1.0, 0.66, 0.04) second: vec4f,
    /// Color of the plate that carries the shading.
    @color(0.03, 0.06, 0.28) key: vec4f,
    /// Color of the paper.
    @color(0.86, 0.83, 0.74) paper: vec4f,
    /// How far the plates are out of register.
    @range(0, 16, 3) @hard(0, 64) @unit(px) slip_px: u32,
    /// Distance from dot to dot.
    @range(2, 16, 5) @hard(1, 64) @unit(px) dot_px: f32,
    /// Where the roller leaves paper bare.
    @range(0.0, 1.0, 0.35) wear: f32,
}

fn riso(pixel: Pixel, p: Riso) -> Pixel {
    var q = pixel;
    let slip = i32(p.slip_px);
    let at = vec2i(vec2u(q.x, q.y));
    let darkness = 1.0 - clamp(color_luminance(q.color.rgb), 0.0, 1.0);
    let inks = vec3f(
        plate(at + vec2i(slip, slip / 2), 1u),
        plate(at - vec2i(slip / 3, slip), 2u),
        screen(vec2f(at), 45.0, darkness, p));
    // The roller misses the same specks of paper on every plate, more of them where little ink lies.
    let speck = hash_unit((hash(q.y) + q.x) ^ 0x51ed27u);
    let worn = inks * select(1.0, 0.0, speck < 0.06 * p.wear);
    // Inks are transparent: each takes its part of the light that the paper returns.
    let light = p.paper.rgb * mix(vec3f(1.0), p.first.rgb, worn.x) * mix(vec3f(1.0), p.second.rgb, worn.y) * mix(vec3f(1.0), p.key.rgb, worn.z);
    q.color = vec4f(color_encode(light), q.color.a);
    return q;
}

// 1 where the object at a pixel is printed from this plate: 1 is the first, 2 the second.
fn plate(at: vec2i, bit: u32) -> f32 {
    let there = image_at(at.x, at.y);
    if there.x == IMAGE_NO_TRIANGLE { return 0.0; }
    return select(0.0, 1.0, ((1u + there.z % 3u) & bit) != 0u);
}

// Coverage by the dots of a screen at an angle.
fn screen(at: vec2f, angle_deg: f32, darkness: f32, p: Riso) -> f32 {
    let along = direction_degrees(angle_deg);
    let cell = vec2f(dot(at, along), at.y * along.x - at.x * along.y) / p.dot_px;
    let hill = 0.5 + 0.25 * (cosine_turns(cell.x) + cosine_turns(cell.y));
    return clamp((1.3 * darkness - 1.25 + hill) * (0.6 * p.dot_px) + 0.5, 0.0, 1.0);
}
