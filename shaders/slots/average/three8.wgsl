// Average, three8: see the totals of that name.
//@ use common/frame
//@ use slot/owner

struct Average {
    color: vec3f,
    weight: u32,
    is_full: bool, // the sums have overflowed, unless so often that the number of layers begins anew
}

fn average_of(pixel: u32) -> Average {
    let first = triangle_beyond(3u * pixel);
    let weight = first >> 20u;
    let color = vec3f(vec3u(
        xray_average(first & 0xfffffu, weight),
        xray_average(triangle_beyond(3u * pixel + 1u), weight),
        xray_average(triangle_beyond(3u * pixel + 2u), weight))) / 255.0;
    return Average(color, weight, weight == 0u && (first | triangle_beyond(3u * pixel + 1u)) != 0u);
}
