// What an image effect knows: the pixel that it finishes, and the integers of the whole picture. Twin of
// `effects::hooks::{Pixel, Picture}`, where each is explained.
//@ use common/frame
//@ use common/draws
//@ use common/picture
//@ use slot/owner

const IMAGE_NO_OWNER = 0xffffffffu;

struct Pixel {
    color: vec4f,   // gamma-encoded
    x: u32,
    y: u32,
}

// Does the pixel lie in the picture?
fn image_has(x: i32, y: i32) -> bool {
    return all(vec2i(x, y) >= vec2i(0)) && all(vec2i(x, y) < vec2i(frame.size));
}

// Owner, depth key and draw of a pixel; those of the nearest pixel of the picture when it lies outside.
fn image_at(x: i32, y: i32) -> vec3u {
    let at = vec2u(clamp(vec2i(x, y), vec2i(0), vec2i(frame.size) - 1));
    let found = owner_load(at.y * frame.size.x + at.x);
    if found.x == 0u { return vec3u(IMAGE_NO_OWNER, found.y, frame.draw_count); }
    return vec3u(~found.x, found.y, draws_of_triangle(~found.x) + 1u);
}

// What is where nothing is.
fn image_background() -> vec4f {
    return frame.background;
}

// Bytes of this pixel in the picture before this one: they still stand where its own will be written.
fn image_previous(pixel: Pixel) -> vec4u {
    return (vec4u(color[pixel.y * frame.stride + pixel.x]) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u);
}
