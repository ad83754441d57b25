// Scaling, between: a shown pixel lies between four drawn ones, and each counts by how near it is.
//@ use common/frame
//@ use common/light

fn scaling_light(pixel: vec2u, size: vec2u) -> Light {
    let at = (vec2f(pixel) + 0.5) * vec2f(frame.size) / vec2f(size) - 0.5;
    let first = floor(at);
    let share = at - first;
    let last = vec2i(frame.size) - 1;
    let low = vec2u(clamp(vec2i(first), vec2i(0), last));
    let high = vec2u(clamp(vec2i(first) + 1, vec2i(0), last));
    var sum = Light(vec4f(0.0), vec3f(0.0));
    sum = light_add(sum, low, (1.0 - share.x) * (1.0 - share.y));
    sum = light_add(sum, vec2u(high.x, low.y), share.x * (1.0 - share.y));
    sum = light_add(sum, vec2u(low.x, high.y), (1.0 - share.x) * share.y);
    return light_add(sum, high, share.x * share.y);
}
