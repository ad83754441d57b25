// Meshlets: clusters of a mesh's triangles with bounds in object space, the instances that show them, and the list of visible
// meshlets. Mirrors `gpu::records::{CullingUniform, MeshletRecord, InstanceRecord}`.
//@ use lib/frame
//@ binding @group(0) @binding(26) var<storage, read> meshlet_lists: array<u32>;

struct Culling {
    meshlet_count: u32,   // a meshlet counts once for every instance
    first_visible: u32,   // word of `meshlet_lists` at which the visible meshlets begin
    hiz_width: u32,       // tiles of 8x8 pixels in a row of the depth pyramid, a multiple of 8
    hiz_first_block: u32, // word of `hiz` at which the blocks of 64x64 pixels begin
}

@group(0) @binding(25) var<uniform> culling: Culling;

struct Meshlet {
    center: vec4f,        // center of its bounding box; w: cosine of the half angle of its normal cone
    half: vec4f,          // half the box's sides; w: sine of that angle
    axis: vec4f,          // axis of the normal cone; w: least altitude of a triangle, 0 where the cone tells nothing
    first_triangle: u32,  // word of `meshlet_lists`
    first_vertex: u32,    // word of `meshlet_lists`
    triangles: u32,
    vertices: u32,
}

@group(0) @binding(24) var<storage, read> meshlets: array<Meshlet>;

struct Instance {
    eye: vec4f,          // object space, relative to the draw's origin where positions are. w: 1 or -1, the side from which triangles are seen; 0: xyz is the viewing direction
    center: vec4f,       // center of its bounding box, object space. w: screen area of a unit of area at w = 1 that faces the eye
    half: vec4f,         // half the box's sides. w: largest length on screen, in units, of a meter within the box at w = 1
    first: u32,          // its first meshlet, counted over all instances
    first_meshlet: u32,  // record of that meshlet
    flags: u32,
    spare: u32,
}

const INSTANCE_FACES = 1u;   // shows one side of its triangles
const INSTANCE_DEFORMS = 2u; // is deformed: the bounds of its meshlets do not hold, the bounding box of the instance does

@group(0) @binding(27) var<storage, read> instances: array<Instance>;

// The instance of a meshlet that is counted over all instances.
fn instances_of(id: u32) -> u32 {
    var search = search_begin(frame.draw_count);
    for (var i = 0u; i < SEARCH_STEPS && search_is_open(search); i += 1u) {
        search = search_narrow(search, instances[search_middle(search)].first <= id);
    }
    return search.low;
}

// Words of an entry in the list of visible meshlets: draw, first triangle, first vertex, and both counts.
const VISIBLE_MESHLET_WORDS = 4u;

struct VisibleMeshlet {
    draw: u32,
    first_triangle: u32,  // word of `meshlet_lists`
    first_vertex: u32,    // word of `meshlet_lists`
    triangles: u32,
    vertices: u32,
}

fn visible_meshlets_end() -> u32 {
    return atomicLoad(&counters.visible_meshlets);
}

// The entry that an invocation works on. The late phase begins behind the entries of the early one.
fn visible_meshlets_slot(invocation: u32) -> u32 {
    return atomicLoad(&counters.visible_meshlets_done) + invocation / MESHLET_TRIANGLES;
}

// The entry in a slot; the last entry for a slot past the end.
fn visible_meshlets_load(slot: u32) -> VisibleMeshlet {
    let at = culling.first_visible + VISIBLE_MESHLET_WORDS * min(slot, visible_meshlets_end() - 1u);
    let counts = meshlet_lists[at + 3u];
    return VisibleMeshlet(meshlet_lists[at], meshlet_lists[at + 1u], meshlet_lists[at + 2u], counts & 0xffffu, counts >> 16u);
}

// What culling decides about a meshlet.
const CULL_VISIBLE = 0u;
const CULL_OUTSIDE = 1u;
const CULL_BACKFACING = 2u;
const CULL_HIDDEN = 3u;
const CULL_OTHER_PHASE = 4u; // another phase draws it
