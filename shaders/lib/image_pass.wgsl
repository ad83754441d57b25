// Image pass: what a pass over the finished picture may read, in linear light. Mirrors `effects::hooks::ImageAt`, which explains each
// member. Places are in pixels from the top left corner: the middle of the first pixel is (0.5, 0.5).
//@ use lib/frame
//@ use lib/geometry
//@ use lib/image

@group(0) @binding(33) var<storage, read> image_source: array<vec4f>;
@group(0) @binding(34) var<storage, read> image_before: array<vec4f>;

// Pixels of the picture for one that the pass writes, along a side, and for one that the pass before it wrote.
override IMAGE_SCALE: u32 = 1u;
override IMAGE_LAST_SCALE: u32 = 1u;

struct ImageAt {
    x: i32,
    y: i32,
    size: vec2u,
    scale: u32,
}

const IMAGE_EMPTY_M = 1e9; // depth of a pixel that shows nothing
const IMAGE_FARTHEST_PX = 65536.0; // farthest place that a bilinear read tells from others

// Width and height of the picture at a fraction of its size, at least 1.
fn image_size_at(scale: u32) -> vec2u {
    return (frame.size + scale - 1u) / scale;
}

// The middle of the pixel, in pixels of the picture.
fn image_middle(at: ImageAt) -> vec2f {
    return (vec2f(f32(at.x), f32(at.y)) + 0.5) * f32(at.scale);
}

// Color of a pixel of the picture that the effect began with; outside, that of the nearest pixel.
fn image_color(x: i32, y: i32) -> vec4f {
    let at = vec2u(clamp(vec2i(x, y), vec2i(0), vec2i(frame.size) - 1));
    return image_source[at.y * frame.size.x + at.x];
}

// Color of a pixel of what the last pass wrote; in the first pass, of the picture.
fn image_last(x: i32, y: i32) -> vec4f {
    let size = image_size_at(IMAGE_LAST_SCALE);
    let at = vec2u(clamp(vec2i(x, y), vec2i(0), vec2i(size) - 1));
    return image_before[at.y * size.x + at.x];
}

// The place in 1/256 of a pixel from the middle of the first one.
fn image_grid(place: vec2f) -> vec2i {
    let held = clamp(place, vec2f(-IMAGE_FARTHEST_PX), vec2f(IMAGE_FARTHEST_PX));
    return vec2i(floor(held * 256.0 + 0.5)) - 128;
}

// The same as image_color and image_last at a place between pixels. Weights are whole multiples of 1/256.
fn image_color_at(x: f32, y: f32) -> vec4f {
    let grid = image_grid(vec2f(x, y));
    let near = grid >> vec2u(8u);
    let part = vec2f(grid & vec2i(255)) / 256.0;
    let upper = mix(image_color(near.x, near.y), image_color(near.x + 1, near.y), part.x);
    let lower = mix(image_color(near.x, near.y + 1), image_color(near.x + 1, near.y + 1), part.x);
    return mix(upper, lower, part.y);
}

fn image_last_at(x: f32, y: f32) -> vec4f {
    let grid = image_grid(vec2f(x, y));
    let near = grid >> vec2u(8u);
    let part = vec2f(grid & vec2i(255)) / 256.0;
    let upper = mix(image_last(near.x, near.y), image_last(near.x + 1, near.y), part.x);
    let lower = mix(image_last(near.x, near.y + 1), image_last(near.x + 1, near.y + 1), part.x);
    return mix(upper, lower, part.y);
}

// Depth of a pixel along the viewing direction, meters; IMAGE_EMPTY_M where nothing is drawn.
fn image_depth_m(x: i32, y: i32) -> f32 {
    return image_meters(bitcast<f32>(image_at(x, y).y));
}

// Meters along the viewing direction, given a reversed depth; IMAGE_EMPTY_M of 0 and less.
fn image_meters(depth: f32) -> f32 {
    if depth <= 0.0 { return IMAGE_EMPTY_M; }
    if !IS_PERSPECTIVE { return frame.linear_depth_m.y + depth * (frame.linear_depth_m.x - frame.linear_depth_m.y); }
    // The z of clip space is the distance of the near plane everywhere.
    return min(frame.clip_from_world[3].z / max(depth, 1e-30), IMAGE_EMPTY_M);
}

// How many meters farther a pixel of reversed depth `depth + by` is than one of `depth`. No difference of distances is taken, so far from
// the eye the result is as exact as `by`.
fn image_meters_apart(depth: f32, by: f32) -> f32 {
    let there_m = image_meters(depth + by);
    if depth <= 0.0 || depth + by <= 0.0 { return there_m - image_meters(depth); }
    // Along the viewing direction an orthographic depth changes by 1 from the far plane to the near one.
    let per_meter = vec3f(frame.clip_from_world[0].z, frame.clip_from_world[1].z, frame.clip_from_world[2].z);
    if !IS_PERSPECTIVE { return -by / length(per_meter); }
    return -by * (there_m / depth);
}

// Side of a pixel at a depth, meters.
fn image_pixel_size_m(depth_m: f32) -> f32 {
    return length(frame.ndc_y.xyz) * 2.0 / f32(frame.size.y) * select(1.0, depth_m, IS_PERSPECTIVE);
}
