// Triangle sources: which triangle an invocation of raster_small works on.
// Chosen by the accuracy axis `culling`: meshlets where meshlets are culled; and by the scene: beside_points where a pass of their own draws
// points.
//
// x: the triangle's id, or one past the last triangle where there is none. y: its draw. z: an id that exists in any case.
//@ declare fn triangle_source(invocation: u32) -> vec3u

//@ variant default
// An invocation for every triangle of the scene.
//@ use lib/frame
//@ use glue/draws

fn triangle_source(invocation: u32) -> vec3u {
    let existing = min(invocation, frame.triangle_count - 1u);
    return vec3u(invocation, draw_of_triangle(existing), existing);
}

//@ variant beside_points
// An invocation for every triangle that is no point.
//@ use lib/frame
//@ use lib/triangle
//@ use glue/draws

fn triangle_source(invocation: u32) -> vec3u {
    let count = frame.triangle_count - frame.point_count;
    let existing = min(invocation, count - 1u);
    let draw = draw_beside_points(existing);
    let id = existing + draws[draw].first_point;
    return vec3u(select(0xffffffffu, id, invocation < count), draw, id);
}

//@ variant meshlets
// An invocation for every triangle of the visible meshlets.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/meshlets

fn triangle_source(invocation: u32) -> vec3u {
    let slot = visible_meshlets_slot(invocation);
    let meshlet = visible_meshlets_load(slot);
    let index = invocation % MESHLET_TRIANGLES;
    let exists = slot < visible_meshlets_end() && index < meshlet.triangles;
    let t = meshlet_lists[meshlet.first_triangle + min(index, meshlet.triangles - 1u)];
    let existing = draws[meshlet.draw].first_triangle + t;
    return vec3u(select(0xffffffffu, existing, exists), meshlet.draw, existing);
}
