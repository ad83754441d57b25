// Survivors: the meshlets that culling left, one after another behind the lists of what each meshlet holds.
//@ use common/counters
//@ use common/culling

@group(0) @binding(26) var<storage, read> meshlet_lists: array<u32>;

struct Survivor {
    draw: u32,
    first_triangle: u32,  // words of `meshlet_lists`
    first_vertex: u32,
    triangles: u32,
    vertices: u32,
}

fn visible_meshlets_end() -> u32 {
    return atomicLoad(&counters.visible_meshlets);
}

// Which one an invocation works on: every one has as many as it may have triangles. A second round begins behind the first.
fn visible_meshlets_slot(invocation: u32) -> u32 {
    return atomicLoad(&counters.visible_meshlets_done) + invocation / MESHLET_TRIANGLES;
}

// The last one for whoever comes too late.
fn visible_meshlets_load(slot: u32) -> Survivor {
    let at = culling.first_visible + VISIBLE_MESHLET_WORDS * min(slot, visible_meshlets_end() - 1u);
    let counts = meshlet_lists[at + 3u];
    return Survivor(meshlet_lists[at], meshlet_lists[at + 1u], meshlet_lists[at + 2u], counts & 0xffffu, counts >> 16u);
}
