// What an image effect knows: the pixel that it finishes, and the integers of the whole picture. Mirror of
// `effects::hooks::{Pixel, Picture}`, where each is explained.
//@ use common/frame
//@ use slot/image

const IMAGE_NO_TRIANGLE = 0xffffffffu;

struct Pixel {
    color: vec4f,   // gamma-encoded
    x: u32,
    y: u32,
}

// Does the pixel lie in the picture?
fn image_has(x: i32, y: i32) -> bool {
    return all(vec2i(x, y) >= vec2i(0)) && all(vec2i(x, y) < vec2i(frame.size));
}

// What is where nothing is.
fn image_background() -> vec4f {
    return frame.background;
}
