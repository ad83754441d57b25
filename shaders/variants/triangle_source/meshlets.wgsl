// Triangle sources, meshlets: an invocation for every triangle of the visible meshlets.
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
