// Average, packed16: see the totals of that name.
//@ use common/frame
//@ use slot/owner

struct Average {
    color: vec3f,
    weight: u32,
    is_full: bool, // the sums have overflowed
}

fn average_of(pixel: u32) -> Average {
    let first = triangle_beyond(2u * pixel);
    let second = triangle_beyond(2u * pixel + 1u);
    let weight = second >> 16u;
    let color = vec3f(vec3u(
        xray_average(first & 0xffffu, weight),
        xray_average(first >> 16u, weight),
        xray_average(second & 0xffffu, weight))) / 255.0;
    return Average(color, weight, weight > 257u);
}
