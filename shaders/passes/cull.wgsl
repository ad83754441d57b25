// Cull: one invocation per meshlet of every instance. What lies outside the picture, faces away or is hidden is left out; the
// others are listed for the projection and the raster.
//@ use common/frame
//@ use common/counters
//@ use common/facing
//@ use common/culling
//@ use slot/occlusion

@group(0) @binding(26) var<storage, read_write> meshlet_lists: array<u32>;

// The last round counts what is left out.
override COUNTS_CULLED: bool = true;

const CULL_LEFT = 0u;    // to be drawn
const CULL_OUTSIDE = 1u;
const CULL_BACKFACING = 2u;
const CULL_HIDDEN = 3u;
const CULL_WAITS = 4u;   // another round draws it

// How many of the group come to each verdict.
var<workgroup> tallies: array<atomic<u32>, 5>;
var<workgroup> first_slot: u32;

fn cull_verdict(id: u32, instance: u32, record: u32) -> u32 {
    let whole = Box(instances[instance].center.xyz, instances[instance].half.xyz);
    let around = extent_of(instance, whole);
    if extent_is_outside(around) { return CULL_OUTSIDE; }
    if (instances[instance].flags & INSTANCE_DEFORMS) != 0u { return occlusion_verdict(id, instance, whole, around); }
    let box = Box(meshlets[record].center.xyz, meshlets[record].half.xyz);
    let e = extent_of(instance, box);
    if extent_is_outside(e) { return CULL_OUTSIDE; }
    if facing_is_turned(instance, record, e) { return CULL_BACKFACING; }
    return occlusion_verdict(id, instance, box, e);
}

@compute @workgroup_size(GROUP_SIZE)
fn cull(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    if lane == 0u {
        for (var i = 0u; i < 5u; i += 1u) { atomicStore(&tallies[i], 0u); }
    }
    workgroupBarrier();
    let id = frame_invocation(group, groups, lane, GROUP_SIZE);
    var verdict = CULL_WAITS;
    var instance = 0u;
    var record = 0u;
    var place = 0u;
    if id < culling.meshlet_count {
        instance = instances_of(id);
        record = instances[instance].first_meshlet + id - instances[instance].first;
        verdict = cull_verdict(id, instance, record);
        place = atomicAdd(&tallies[verdict], 1u);
    }
    workgroupBarrier();
    if lane == 0u {
        first_slot = atomicAdd(&counters.visible_meshlets, atomicLoad(&tallies[CULL_LEFT]));
        if COUNTS_CULLED {
            atomicAdd(&counters.outside, atomicLoad(&tallies[CULL_OUTSIDE]));
            atomicAdd(&counters.backfacing, atomicLoad(&tallies[CULL_BACKFACING]));
            atomicAdd(&counters.hidden, atomicLoad(&tallies[CULL_HIDDEN]));
        }
    }
    let slot = workgroupUniformLoad(&first_slot) + place;
    if verdict == CULL_LEFT {
        let at = culling.first_visible + VISIBLE_MESHLET_WORDS * slot;
        meshlet_lists[at] = instance;
        meshlet_lists[at + 1u] = meshlets[record].first_triangle;
        meshlet_lists[at + 2u] = meshlets[record].first_vertex;
        meshlet_lists[at + 3u] = meshlets[record].triangles | (meshlets[record].vertices << 16u);
    }
}
