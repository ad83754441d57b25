// Average, four32: see the totals of that name.
//@ use common/frame
//@ use slot/owner

// Bits per channel in the sums.
override SUM_BITS: u32 = 12u;

struct Average {
    color: vec3f,
    weight: u32,
    is_full: bool, // the sums have overflowed
}

fn average_of(pixel: u32) -> Average {
    let weight = triangle_beyond(4u * pixel + 3u);
    let whole = (1u << SUM_BITS) - 1u;
    let color = vec3f(vec3u(
        xray_average(triangle_beyond(4u * pixel), weight),
        xray_average(triangle_beyond(4u * pixel + 1u), weight),
        xray_average(triangle_beyond(4u * pixel + 2u), weight))) / f32(whole);
    return Average(color, weight, weight > 0xffffffffu / whole);
}
