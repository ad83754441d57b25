// What the kept pass of an effect wrote in the previous frame; zeros in the first one. Mirrors `effects::hooks::ImageAt::{kept, kept_at}`.
//@ use lib/image_pass

@group(0) @binding(37) var<storage, read> image_kept_before: array<vec4f>;

// Pixels of the picture for one that the kept pass writes, along a side.
override IMAGE_KEPT_SCALE: u32 = 1u;

// By the kept pass's own pixels; outside, that of the nearest pixel.
fn image_kept(x: i32, y: i32) -> vec4f {
    let size = image_size_at(IMAGE_KEPT_SCALE);
    let at = vec2u(clamp(vec2i(x, y), vec2i(0), vec2i(size) - 1));
    return image_kept_before[at.y * size.x + at.x];
}

// The same at a place between its pixels. Weights are whole multiples of 1/256.
fn image_kept_at(x: f32, y: f32) -> vec4f {
    let grid = image_grid(vec2f(x, y));
    let near = grid >> vec2u(8u);
    let part = vec2f(grid & vec2i(255)) / 256.0;
    let upper = mix(image_kept(near.x, near.y), image_kept(near.x + 1, near.y), part.x);
    let lower = mix(image_kept(near.x, near.y + 1), image_kept(near.x + 1, near.y + 1), part.x);
    return mix(upper, lower, part.y);
}
