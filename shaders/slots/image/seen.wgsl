// Image, seen: triangle ids and keys of all pixels, which are final by the time of the resolve.
//@ use common/draws
//@ use common/picture
//@ use slot/owner
//@ use slot/depth

// Triangle id, depth key and draw of a pixel; those of the nearest pixel of the picture when it lies outside.
fn image_at(x: i32, y: i32) -> vec3u {
    let at = vec2u(clamp(vec2i(x, y), vec2i(0), vec2i(frame.size) - 1));
    let found = owner_load(at.y * frame.size.x + at.x);
    if found.x == 0u { return vec3u(IMAGE_NO_TRIANGLE, image_depth(found.y), frame.draw_count); }
    return vec3u(~found.x, image_depth(found.y), draws_of_triangle(~found.x) + 1u);
}

// Depths of empty pixels stay 0.
fn image_depth(key: u32) -> u32 {
    return select(depth_bits(key), 0u, key == 0u);
}

// Bytes of this pixel in the picture before this one: they still stand where its own will be written.
fn image_previous(pixel: Pixel) -> vec4u {
    return (vec4u(color[pixel.y * frame.stride + pixel.x]) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u);
}
