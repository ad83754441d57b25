// Share, meshlets: an invocation for every triangle of the meshlets that culling left.
//@ use common/draws
//@ use common/survivors

struct Share {
    id: u32,      // the triangle; beyond the last one where there is none left
    draw: u32,
    loaded: u32,  // a triangle in any case
}

fn share_of(invocation: u32) -> Share {
    let slot = visible_meshlets_slot(invocation);
    let survivor = visible_meshlets_load(slot);
    let place = invocation % MESHLET_TRIANGLES;
    let is_there = slot < visible_meshlets_end() && place < survivor.triangles;
    let t = meshlet_lists[survivor.first_triangle + min(place, survivor.triangles - 1u)];
    let loaded = draws[survivor.draw].first_triangle + t;
    return Share(select(0xffffffffu, loaded, is_there), survivor.draw, loaded);
}
