// Samples and triangle setups, as sample effects see them. Mirrors `effects::hooks::{Sample, TriangleSetup}`, which explain
// each member.

struct Sample {
    at: vec2u,
    triangle: u32,
    areas: vec3u,
    setup: vec4u,
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

// Sum of a sample's areas, at least 1.
fn sample_total_area(sample: Sample) -> u32 {
    return max(sample.areas.x + sample.areas.y + sample.areas.z, 1u);
}
