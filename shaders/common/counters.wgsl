// Counters: demand of every queue, and what a frame did not draw. Mirror of `gpu::uniforms::CounterRecord`.

struct Counters {
    clip: atomic<u32>,
    medium: atomic<u32>,
    large: atomic<u32>,
    tiles: atomic<u32>,
    pieces: atomic<u32>,
    rejected_nonfinite: atomic<u32>,
    rejected_range: atomic<u32>,
    degenerate: atomic<u32>,
    flipped_clips: atomic<u32>,
    depth_without_id: atomic<u32>,
    marked_tiles: atomic<u32>,
    next_sample_index: atomic<u32>,
    next_sample_index_again: atomic<u32>,
    bins: atomic<u32>,           // entries of the lists of all tiles
    full_pixels: atomic<u32>,    // pixels with more layers than the sums hold
    dropped: atomic<u32>,        // triangles left out that would have to be clipped
    visible_meshlets: atomic<u32>,      // meshlets that culling left
    outside: atomic<u32>,        // meshlets outside the picture
    backfacing: atomic<u32>,         // meshlets that face away
    hidden: atomic<u32>,         // meshlets behind what was drawn
    visible_meshlets_done: atomic<u32>, // entries that an earlier round has drawn; 0 without rounds
    clip_done: atomic<u32>,
    medium_done: atomic<u32>,
    large_done: atomic<u32>,
    tiles_done: atomic<u32>,
    longest_list: atomic<u32>,   // entries of the longest list of a tile
    spare_0: atomic<u32>,
    spare_1: atomic<u32>,
}

@group(0) @binding(7) var<storage, read_write> counters: Counters;
