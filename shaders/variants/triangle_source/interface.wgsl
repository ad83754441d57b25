// Triangle sources: which triangle an invocation of raster_small works on.
// Chosen by the accuracy axis `culling`: meshlets where meshlets are culled. Default: the function below, an invocation for
// every triangle of the scene.
//@ use lib/frame
//@ use glue/draws

// x: the triangle's id, or one past the last triangle where there is none. y: its draw. z: an id that exists in any case.
//@ declare fn triangle_source(invocation: u32) -> vec3u
fn triangle_source(invocation: u32) -> vec3u {
    let existing = min(invocation, frame.triangle_count - 1u);
    return vec3u(invocation, draw_of_triangle(existing), existing);
}
