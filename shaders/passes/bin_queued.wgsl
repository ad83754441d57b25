// Bin queued: one workgroup per medium or large triangle finds the 16x16 tiles of the picture that it may touch.
//@ use slot/pieces
//@ use slot/queues
//@ use common/bins

// Which queue: that of the large ones, or of the medium ones.
override IS_LARGE: bool = false;

@compute @workgroup_size(64)
fn bin_queued(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slot = group.y * groups.x + group.x;
    let count = select(
        min(atomicLoad(&counters.medium), frame.medium_capacity), min(atomicLoad(&counters.large), frame.large_capacity), IS_LARGE);
    if slot >= count { return; }
    let entry = queues[select(frame.medium_first, frame.large_first, IS_LARGE) + slot];
    let t = pieces_load(entry);
    let a = vertex_at(t.a);
    var b = vertex_at(t.b);
    var c = vertex_at(t.c);
    if fixed_sign(fixed_edge(a, b, c)) < 0 {
        let swap = b;
        b = c;
        c = swap;
    }
    bins_gather(entry, a, b, c, triangle_pixels(min(min(a, b), c), max(max(a, b), c)), IS_LARGE, lane, 64u);
}
