// The normal of what a pixel of the finished picture shows, from its depth and those of its neighbors: the same whatever effects did to
// the normals of the surface. Mirrors `effects::hooks::ImageAt::normal`.
//@ use lib/frame
//@ use lib/geometry
//@ use lib/image

// In world space, unit length, towards the viewer's side; zero where nothing is drawn. Outside of the picture, that of the nearest pixel.
fn image_normal(x: i32, y: i32) -> vec3f {
    let at = clamp(vec2i(x, y), vec2i(0), vec2i(frame.size) - 1);
    let depth = bitcast<f32>(image_at(at.x, at.y).y);
    if depth <= 0.0 { return vec3f(0.0); }
    // On a plane, depths change evenly across the picture: so much from its middle to its right and to its upper edge.
    let middle = vec2f(frame.size) * 0.5;
    let slope = vec2f(image_slope(at, depth, vec2i(1, 0)), -image_slope(at, depth, vec2i(0, 1))) * middle;
    let along = slope.x * frame.ndc_x.xyz / dot(frame.ndc_x.xyz, frame.ndc_x.xyz) + slope.y * frame.ndc_y.xyz / dot(frame.ndc_y.xyz, frame.ndc_y.xyz);
    if !IS_PERSPECTIVE {
        return normalize((frame.linear_depth_m.x - frame.linear_depth_m.y) * along - frame.forward.xyz);
    }
    let place = (vec2f(at) + 0.5 - middle) / middle * vec2f(1.0, -1.0);
    return -normalize(along + (depth - dot(place, slope)) * frame.forward.xyz);
}

// The smaller of the changes of depth to both sides of a pixel.
fn image_slope(at: vec2i, depth: f32, step: vec2i) -> f32 {
    let ahead = bitcast<f32>(image_at(at.x + step.x, at.y + step.y).y) - depth;
    let behind = depth - bitcast<f32>(image_at(at.x - step.x, at.y - step.y).y);
    return select(behind, ahead, abs(ahead) < abs(behind));
}
