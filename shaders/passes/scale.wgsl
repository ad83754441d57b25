// Scale: from the pixels that were drawn to those that are shown. The one pass of a picture that is drawn larger or smaller
// than it is wanted.
//@ use common/color
//@ use common/light
//@ use slot/scaling

// What is shown. Mirror of `gpu::uniforms::ScalingUniform`.
struct Scaling {
    size: vec2u,
    stride: u32, // pixels from one row to the next
    spare: u32,
}

@group(0) @binding(18) var<uniform> scaling: Scaling;
@group(0) @binding(19) var<storage, read_write> shown: array<u32>;

@compute @workgroup_size(8, 8)
fn scale(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = group.xy * 8u + local.xy;
    if any(pixel >= scaling.size) { return; }
    let mean = light_mean(scaling_light(pixel, scaling.size));
    shown[pixel.y * scaling.stride + pixel.x] = color_pack(vec4f(color_encode(mean.rgb), mean.a));
}
