// image_begin: takes every pixel of the picture from gamma-encoded bytes to linear light, for the image passes that follow.
//@ use lib/frame
//@ use lib/color
//@ use lib/picture

@group(0) @binding(35) var<storage, read_write> image_target: array<vec4f>;

@compute @workgroup_size(8, 8)
fn image_begin(@builtin(global_invocation_id) at: vec3u) {
    if any(at.xy >= frame.size) { return; }
    let bytes = (vec4u(color[at.y * frame.stride + at.x]) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u);
    let encoded = vec4f(bytes) / 255.0;
    image_target[at.y * frame.size.x + at.x] = vec4f(color_decode(encoded.rgb), encoded.a);
}
