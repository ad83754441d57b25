// Corners, own: every triangle has three projected records to itself, since effects part it from its neighbours.

// Records of the three corners of a triangle.
fn corners_of(draw: u32, id: u32) -> vec3u {
    return 3u * id + vec3u(0u, 1u, 2u);
}
