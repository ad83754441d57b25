// The picture as image effects see it: the pixel to finish, and the triangle ids and depths of all pixels, which are final
// when the picture is resolved. Mirrors `effects::hooks::{Pixel, Picture}`, which explain each member.
//@ use lib/frame
//@ use glue/draws
//@ use lib/picture
//@ use variants/depth
//@ use variants/framebuffer_read

struct Pixel {
    color: vec4f,   // gamma-encoded
    x: u32,
    y: u32,
}

const IMAGE_NO_TRIANGLE = 0xffffffffu;

// Is the pixel inside the picture?
fn image_has(x: i32, y: i32) -> bool {
    return all(vec2i(x, y) >= vec2i(0)) && all(vec2i(x, y) < vec2i(frame.size));
}

// Width and height of the picture, pixels.
fn image_size() -> vec2u {
    return frame.size;
}

// Of the row of the pixel that is finished.
fn image_background() -> vec4f {
    return background;
}

// Triangle id, depth bits and draw of a pixel; those of the nearest pixel of the picture for one outside.
fn image_at(x: i32, y: i32) -> vec3u {
    let at = vec2u(clamp(vec2i(x, y), vec2i(0), vec2i(frame.size) - 1));
    let found = framebuffer_load(at.y * frame.size.x + at.x);
    if found.x == 0u { return vec3u(IMAGE_NO_TRIANGLE, image_depth(found.y), frame.draw_count); }
    return vec3u(~found.x, image_depth(found.y), image_draw_of(~found.x) + 1u);
}

// The draw that was found last, its first triangle and the one behind its last. Neighbors mostly show the same.
var<private> image_draw: u32;
var<private> image_draw_triangles: vec2u;

fn image_draw_of(triangle: u32) -> u32 {
    if triangle < image_draw_triangles.x || triangle >= image_draw_triangles.y {
        image_draw = draw_of_triangle(triangle);
        let next = image_draw + 1u;
        let end = select(frame.triangle_count, draws[min(next, frame.draw_count - 1u)].first_triangle, next < frame.draw_count);
        image_draw_triangles = vec2u(draws[image_draw].first_triangle, end);
    }
    return image_draw;
}

// Bits of the reversed depth that a key means; 0 for an empty pixel.
fn image_depth(key: u32) -> u32 {
    return select(depth_bits(key), 0u, key == 0u);
}

// Bytes of this pixel in the previous picture: they are still where its own will be written.
fn image_previous(pixel: Pixel) -> vec4u {
    return (vec4u(color[pixel.y * frame.stride + pixel.x]) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u);
}
