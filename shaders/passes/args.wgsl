// Args: turns the demand of every queue into dispatch sizes, folded to two dimensions past 65,535 workgroups.
//@ use common/frame
//@ use common/counters

struct Dispatch { x: u32, y: u32, z: u32 }

struct Args {
    clip: Dispatch,
    medium: Dispatch,
    large: Dispatch,
    tiles: Dispatch,
    resolve: Dispatch,
    pieces: Dispatch,
    meshlets: Dispatch,
}

@group(0) @binding(10) var<storage, read_write> args: Args;

// Invocations for the triangles of a meshlet.
override MESHLET_TRIANGLES: u32 = 64u;

fn fold(groups: u32) -> Dispatch {
    return Dispatch(min(groups, 65535u), (groups + 65534u) / 65535u, 1u);
}

@compute @workgroup_size(1)
fn args_write() {
    args.clip = fold((min(atomicLoad(&counters.clip), frame.clip_capacity) - atomicLoad(&counters.clip_done) + 63u) / 64u);
    args.medium = fold(min(atomicLoad(&counters.medium), frame.medium_capacity) - atomicLoad(&counters.medium_done));
    args.large = fold(min(atomicLoad(&counters.large), frame.large_capacity) - atomicLoad(&counters.large_done));
    args.tiles = fold(min(atomicLoad(&counters.tiles), frame.tile_capacity) - atomicLoad(&counters.tiles_done));
    args.pieces = fold((min(atomicLoad(&counters.pieces), frame.clipped_triangle_capacity) + GROUP_SIZE - 1u) / GROUP_SIZE);
    args.resolve = fold(atomicLoad(&counters.marked_tiles));
    let meshlets = atomicLoad(&counters.visible_meshlets) - atomicLoad(&counters.visible_meshlets_done);
    args.meshlets = fold((meshlets * MESHLET_TRIANGLES + GROUP_SIZE - 1u) / GROUP_SIZE);
}
