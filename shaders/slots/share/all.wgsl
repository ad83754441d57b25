// Share, all: an invocation for every triangle of the scene.
//@ use common/frame
//@ use common/draws

struct Share {
    id: u32,      // the triangle; beyond the last one where there is none left
    draw: u32,
    loaded: u32,  // a triangle in any case
}

fn share_of(invocation: u32) -> Share {
    let loaded = min(invocation, frame.triangle_count - 1u);
    return Share(invocation, draws_of_triangle(loaded), loaded);
}
