// The frame: its uniform, its counters, the index of an invocation, and the search for the record that an id belongs to.
// Mirrors `gpu::records::{FrameUniform, CounterRecord}`.

struct Frame {
    background: vec4f,       // gamma-encoded; of a gradient the top row's
    eye: vec4f,              // world space; w is 1 for a perspective projection, 0 for an orthographic one
    forward: vec4f,          // viewing direction, unit length, world space
    ndc_x: vec4f,            // world-space vector of one unit of NDC x, per meter of depth for a perspective projection
    ndc_y: vec4f,            // the same for NDC y
    clip_from_world: mat4x4f, // for the offsets of vertex effects
    picture_from_world: mat4x4f, // clip_from_world of the picture, while a shadow map is drawn for it
    center: vec2f,           // half the picture in subpixel units
    depth_range_m: vec2f,    // depth of the nearest and farthest corner of the scene's bounding box
    linear_depth_m: vec2f,   // meters at depth 1 and at depth 0; used only where eye.w is 0
    size: vec2u,             // pixels
    stride: u32,             // pixels from one row of the color buffer to the next
    vertex_count: u32,       // snapped vertices
    triangle_count: u32,
    draw_count: u32,
    clip_capacity: u32,      // entries that fit each queue
    clipped_triangle_capacity: u32,
    medium_capacity: u32,
    large_capacity: u32,
    tile_capacity: u32,
    medium_first: u32,       // first word of each queue in `queues`; the clip queue begins at 0
    large_first: u32,
    tile_first: u32,
    point_radius: u32,       // units of 1/256 px; used only where vertices are drawn as discs
    first_rank: u32,         // first record of triangle ranks, behind the vertices and sample setups
    deform_count: u32,       // draws that are deformed
    background_first: u32,   // first row of a gradient, a word of the color buffer; 0 without one
    point_count: u32,        // triangles that are points
    first_box: u32,          // word of the attributes at which the boxes of blocks of points begin, six words each
    spare_0: u32,
    spare_1: u32,
}

@group(0) @binding(0) var<uniform> frame: Frame;

struct Counters {
    clip: atomic<u32>,           // demand of each queue
    medium: atomic<u32>,
    large: atomic<u32>,
    tiles: atomic<u32>,
    clipped_triangles: atomic<u32>,
    rejected_nonfinite: atomic<u32>,
    rejected_range: atomic<u32>,
    degenerate: atomic<u32>,
    flipped_clips: atomic<u32>,  // clipped triangles dropped because the snap reversed them
    depth_without_id: atomic<u32>, // pixels that have a depth but no triangle
    marked_tiles: atomic<u32>,
    next_sample_index: atomic<u32>,
    next_sample_index_again: atomic<u32>,
    full_pixels: atomic<u32>,    // pixels with more layers than their sums can hold
    dropped: atomic<u32>,        // triangles dropped instead of clipped
    visible_meshlets: atomic<u32>,
    outside: atomic<u32>,        // meshlets outside the view volume
    backfacing: atomic<u32>,     // meshlets that face away
    hidden: atomic<u32>,         // meshlets that are occluded
    visible_meshlets_done: atomic<u32>, // entries drawn in the early phase; 0 with a single phase
    clip_done: atomic<u32>,
    medium_done: atomic<u32>,
    large_done: atomic<u32>,
    tiles_done: atomic<u32>,
    listed_dots: atomic<u32>,    // dots that may be visible, where the adapter lists them
    background_tiles: atomic<u32>, // tiles that no triangle touches, where dots or image effects finish them
    spare_0: atomic<u32>,
    spare_1: atomic<u32>,
    farthest: array<atomic<u32>>, // a key for every block of 8x8 pixels: see lib/hidden_blocks
}

@group(0) @binding(7) var<storage, read_write> counters: Counters;

// Invocations per workgroup of the passes over vertices and triangles; larger groups launch faster on a GPU.
override GROUP_SIZE: u32 = 64u;
// Invocations per meshlet: the most triangles that a meshlet has.
override MESHLET_TRIANGLES: u32 = 64u;

// Index of an invocation in a dispatch that was folded to two dimensions.
fn frame_invocation(workgroup: vec3u, workgroups: vec3u, invocation_index: u32, group_size: u32) -> u32 {
    return (workgroup.y * workgroups.x + workgroup.x) * group_size + invocation_index;
}

// Word of the picture behind its last row.
fn color_end() -> u32 {
    return frame.stride * frame.size.y;
}

// A binary search, over records sorted by their first id, for the last record whose first id is not above a given id.
struct Search {
    low: u32,
    high: u32,  // the record lies in low..high
}

const SEARCH_STEPS = 32u; // enough for every u32

fn search_begin(count: u32) -> Search {
    return Search(0u, count);
}

fn search_is_open(search: Search) -> bool {
    return search.high - search.low > 1u;
}

// The record to compare next.
fn search_middle(search: Search) -> u32 {
    return (search.low + search.high) / 2u;
}

// `is_reached`: the first id of the middle record is not above the given id.
fn search_narrow(search: Search, is_reached: bool) -> Search {
    let middle = search_middle(search);
    return Search(select(search.low, middle, is_reached), select(middle, search.high, is_reached));
}
