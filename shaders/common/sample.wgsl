// What sample effects see. Twins of `effects::hooks::{Sample, TriangleSetup}`, where each member is explained.

struct Sample {
    at: vec2u,
    triangle: u32,
    parts: vec3u,
    decided: vec4u,
}

struct TriangleSetup {
    triangle: u32,
    a: vec2i,
    b: vec2i,
    c: vec2i,
    outline: u32,
    size: vec2u,
    center: vec3f,
    center_screen: vec2f,
}

fn sample_whole(sample: Sample) -> u32 {
    return max(sample.parts.x + sample.parts.y + sample.parts.z, 1u);
}
