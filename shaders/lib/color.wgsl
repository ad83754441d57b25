// Color: linear light to gamma-encoded values and back (IEC 61966-2-1), luminance, and packed bytes.
// 1 / 2.4 is written as a number: naga computes constants in f32.

fn color_encode(linear: vec3f) -> vec3f {
    let c = clamp(linear, vec3f(0.0), vec3f(1.0));
    let curve = 1.055 * pow(c, vec3f(0.4166666666666667)) - 0.055;
    return select(curve, 12.92 * c, c <= vec3f(0.0031308));
}

fn color_decode(encoded: vec3f) -> vec3f {
    let curve = pow((encoded + 0.055) / 1.055, vec3f(2.4));
    return select(curve, encoded / 12.92, encoded <= vec3f(0.04045));
}

// Four bytes, red lowest, as Rgba8Unorm is stored.
fn color_pack(encoded: vec4f) -> u32 {
    let bytes = vec4u(clamp(encoded, vec4f(0.0), vec4f(1.0)) * 255.0 + 0.5);
    return bytes.r | (bytes.g << 8u) | (bytes.b << 16u) | (bytes.a << 24u);
}

// Relative luminance of linear RGB (Rec. 709).
fn color_luminance(linear: vec3f) -> f32 {
    return dot(linear, vec3f(0.2126, 0.7152, 0.0722));
}
