// Tones that several effects compute alike. Mirror of `effects::hooks::tone`.

// Share of light that the eye sees of linear RGB (Rec. 709).
fn tone_luminance(linear: vec3f) -> f32 {
    return dot(linear, vec3f(0.2126, 0.7152, 0.0722));
}

// Cosine and sine of an angle in degrees. The functions built into WGSL may err by 2^-11, which is a sixth of a pixel
// across a small picture; Taylor's series on an eighth of a turn err by 2^-24.
fn tone_turned(degrees: f32) -> vec2f {
    let quarters = round(degrees / 90.0);
    let x = (degrees - 90.0 * quarters) * 0.017453292519943295;
    let q = x * x;
    let sin = x * (1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0 * (1.0 - q / 72.0))));
    let cos = 1.0 - q / 2.0 * (1.0 - q / 12.0 * (1.0 - q / 30.0 * (1.0 - q / 56.0 * (1.0 - q / 90.0))));
    let quadrant = i32(quarters) & 3;
    let along = select(vec2f(cos, sin), vec2f(-sin, cos), (quadrant & 1) != 0);
    return select(along, -along, quadrant >= 2);
}
