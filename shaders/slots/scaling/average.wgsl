// Scaling, average: a shown pixel is the mean of the square of drawn ones that lies under it.
//@ use common/light

// Drawn pixels to a side of that square.
override SCALE_SIDE: u32 = 2u;

fn scaling_light(pixel: vec2u, size: vec2u) -> Light {
    var sum = Light(vec4f(0.0), vec3f(0.0));
    let weight = 1.0 / f32(SCALE_SIDE * SCALE_SIDE);
    for (var i = 0u; i < SCALE_SIDE * SCALE_SIDE; i += 1u) {
        sum = light_add(sum, pixel * SCALE_SIDE + vec2u(i % SCALE_SIDE, i / SCALE_SIDE), weight);
    }
    return sum;
}
