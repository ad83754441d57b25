// Light of several drawn pixels: their colours in linear light, each as far as it is opaque.
//@ use common/color
//@ use common/picture

struct Light {
    opaque: vec4f, // colour times opacity, and opacity
    plain: vec3f,  // colour alone, where nothing is opaque
}

fn light_add(sum: Light, at: vec2u, weight: f32) -> Light {
    let bytes = (vec4u(color[at.y * frame.stride + at.x]) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u);
    let encoded = vec4f(bytes) / 255.0;
    let linear = color_decode(encoded.rgb) * weight;
    return Light(sum.opaque + vec4f(linear * encoded.a, encoded.a * weight), sum.plain + linear);
}

// The mean, given weights that sum to 1.
fn light_mean(sum: Light) -> vec4f {
    let alpha = sum.opaque.a;
    return vec4f(select(sum.plain, sum.opaque.rgb / select(1.0, alpha, alpha > 0.0), alpha > 0.0), alpha);
}
