// The frame uniform: one picture's size, viewpoint and capacities. Mirror of `gpu::uniforms::FrameUniform`.

struct Frame {
    background: vec4f,       // already gamma-encoded
    eye: vec4f,              // world space; w is 1 for a perspective, 0 where all rays are parallel
    forward: vec4f,          // unit, world space
    ndc_x: vec4f,            // what one unit of normalized device x is in the world, per metre of depth for a perspective
    ndc_y: vec4f,
    clip_from_world: mat4x4f, // for what vertex effects add
    picture_from_world: mat4x4f, // the same of the picture that a light's view is drawn for
    center: vec2f,           // half the picture in units (common/grid)
    depth_range_m: vec2f,          // depth of the nearest and farthest corner of the scene's box
    linear_depth_m: vec2f,   // metres at depth 1 and 0; only where eye.w is 0
    size: vec2u,             // pixels
    stride: u32,             // pixels from one row of the colour buffer to the next
    vertex_count: u32,       // projected records
    triangle_count: u32,
    draw_count: u32,
    clip_capacity: u32,      // entries that fit each queue
    clipped_triangle_capacity: u32,
    medium_capacity: u32,
    large_capacity: u32,
    tile_capacity: u32,
    bin_capacity: u32,       // entries of the lists of all tiles
    medium_first: u32,       // first word of each queue in `queues`; clip begins at 0
    large_first: u32,
    tile_first: u32,
    point_radius: u32,       // units of 1/256 px; only where corners are drawn as discs
    first_rank: u32,         // record at which ranks of triangles begin, behind vertices and decisions
    deform_count: u32,         // draws that bend
}

@group(0) @binding(0) var<uniform> frame: Frame;

// Invocations in a workgroup of the passes that run over lists; larger groups are launched faster on a GPU.
override GROUP_SIZE: u32 = 64u;
// Side of the square of pixels that a workgroup of the resolve visits.
override TILE_SIDE: u32 = 8u;

// Index of this invocation in a dispatch that was folded to two dimensions.
fn frame_invocation(group: vec3u, groups: vec3u, lane: u32, lanes: u32) -> u32 {
    return (group.y * groups.x + group.x) * lanes + lane;
}
