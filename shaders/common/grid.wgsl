// Grid: where samples and snapped positions lie. A pixel is 2^SUBPIXEL_BITS units wide, its sample in the middle.

override SUBPIXEL_BITS: u32 = 8u;

// The sample of a pixel, in units.
fn grid_sample(pixel: vec2i) -> vec2i {
    return (pixel << vec2u(SUBPIXEL_BITS)) + vec2i(i32(1u << (SUBPIXEL_BITS - 1u)));
}

// Units in a pixel.
fn grid_unit() -> i32 {
    return i32(1u << SUBPIXEL_BITS);
}

// First pixel whose sample is not before `low`, last whose sample is before `high`; in units.
fn grid_first(low: vec2i) -> vec2i {
    return (low + vec2i(grid_unit() / 2 - 1)) >> vec2u(SUBPIXEL_BITS);
}

fn grid_last(high: vec2i) -> vec2i {
    return (high - vec2i(grid_unit() / 2 + 1)) >> vec2u(SUBPIXEL_BITS);
}
