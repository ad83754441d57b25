// dispatch_args: converts the demand of every queue into workgroup counts, folded to two dimensions above 65,535 workgroups.
// Mirrors `gpu::records::DispatchArgs`.
//@ use lib/frame
//@ use lib/queues

struct Dispatch { x: u32, y: u32, z: u32 }

struct Args {
    clip: Dispatch,
    medium: Dispatch,
    large: Dispatch,
    tiles: Dispatch,
    resolve: Dispatch,
    clipped_triangles: Dispatch,
    meshlets: Dispatch,
    background: Dispatch,
}

@group(0) @binding(10) var<storage, read_write> args: Args;

fn folded(groups: u32) -> Dispatch {
    return Dispatch(min(groups, 65535u), (groups + 65534u) / 65535u, 1u);
}

@compute @workgroup_size(1)
fn dispatch_args() {
    args.clip = folded((queues_clip_count() - atomicLoad(&counters.clip_done) + 63u) / 64u);
    args.medium = folded(queues_medium_count() - atomicLoad(&counters.medium_done));
    args.large = folded(queues_large_count() - atomicLoad(&counters.large_done));
    args.tiles = folded(queues_tiles_count() - atomicLoad(&counters.tiles_done));
    let clipped_triangles = min(atomicLoad(&counters.clipped_triangles), frame.clipped_triangle_capacity);
    args.clipped_triangles = folded((clipped_triangles + GROUP_SIZE - 1u) / GROUP_SIZE);
    args.resolve = folded(atomicLoad(&counters.marked_tiles));
    args.background = folded(atomicLoad(&counters.background_tiles));
    let meshlets = atomicLoad(&counters.visible_meshlets) - atomicLoad(&counters.visible_meshlets_done);
    args.meshlets = folded((meshlets * MESHLET_TRIANGLES + GROUP_SIZE - 1u) / GROUP_SIZE);
}
