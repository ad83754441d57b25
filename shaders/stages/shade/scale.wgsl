// scale: converts the picture as drawn to the picture as shown, where they differ in size. Mirrors `gpu::records::ScalingUniform`.
//@ use lib/frame
//@ use lib/color
//@ use lib/picture

// The picture as shown.
struct Scaling {
    size: vec2u,
    stride: u32, // pixels from one row to the next
    spare: u32,
}

@group(0) @binding(18) var<uniform> scaling: Scaling;
@group(0) @binding(19) var<storage, read_write> shown: array<u32>;

// Drawn pixels per shown pixel, along a side, where more are drawn than shown; else 1.
override SCALE_SIDE: u32 = 1u;

// A sum of weighted colors of drawn pixels in linear light.
struct ColorSum {
    opaque: vec4f, // color times opacity, and opacity
    plain: vec3f,  // color alone, for where nothing is opaque
}

fn color_sum_add(sum: ColorSum, at: vec2u, weight: f32) -> ColorSum {
    let bytes = (vec4u(color[at.y * frame.stride + at.x]) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u);
    let encoded = vec4f(bytes) / 255.0;
    let linear = color_decode(encoded.rgb) * weight;
    return ColorSum(sum.opaque + vec4f(linear * encoded.a, encoded.a * weight), sum.plain + linear);
}

// The mean, given weights that sum to 1.
fn color_sum_mean(sum: ColorSum) -> vec4f {
    let alpha = sum.opaque.a;
    return vec4f(select(sum.plain, sum.opaque.rgb / select(1.0, alpha, alpha > 0.0), alpha > 0.0), alpha);
}

// The square of drawn pixels under a shown pixel, each with the same weight.
fn downscaled(pixel: vec2u) -> ColorSum {
    var sum = ColorSum(vec4f(0.0), vec3f(0.0));
    let weight = 1.0 / f32(SCALE_SIDE * SCALE_SIDE);
    for (var i = 0u; i < SCALE_SIDE * SCALE_SIDE; i += 1u) {
        sum = color_sum_add(sum, pixel * SCALE_SIDE + vec2u(i % SCALE_SIDE, i / SCALE_SIDE), weight);
    }
    return sum;
}

// The four drawn pixels about a shown pixel, weighted bilinearly. Integers place it among them: where it lies on one, the others
// weigh exactly nothing, since any weight, however small, would give a transparent pixel their color.
fn upscaled(pixel: vec2u, size: vec2u) -> ColorSum {
    let whole = 2u * size;
    let at = (2u * pixel + 1u) * frame.size + size;
    let behind = at / whole; // the drawn pixel behind the shown one's middle
    let rest = at - behind * whole;
    let low = max(behind, vec2u(1u)) - 1u;
    let high = min(behind, frame.size - 1u);
    let near = vec2f(whole - rest) / vec2f(whole);
    let far = vec2f(rest) / vec2f(whole);
    var sum = ColorSum(vec4f(0.0), vec3f(0.0));
    sum = color_sum_add(sum, low, near.x * near.y);
    sum = color_sum_add(sum, vec2u(high.x, low.y), far.x * near.y);
    sum = color_sum_add(sum, vec2u(low.x, high.y), near.x * far.y);
    return color_sum_add(sum, high, far.x * far.y);
}

@compute @workgroup_size(8, 8)
fn scale(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = workgroup.xy * 8u + local.xy;
    if any(pixel >= scaling.size) { return; }
    var sum: ColorSum;
    if SCALE_SIDE > 1u { sum = downscaled(pixel); } else { sum = upscaled(pixel, scaling.size); }
    let mean = color_sum_mean(sum);
    shown[pixel.y * scaling.stride + pixel.x] = color_pack(vec4f(color_encode(mean.rgb), mean.a));
}
