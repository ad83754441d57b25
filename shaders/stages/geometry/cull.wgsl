// cull: one invocation per meshlet of every instance. Meshlets that are outside the view volume, face away or are hidden are left
// out; the others are listed for projection and raster.
//@ use lib/frame
//@ use lib/meshlets
//@ use lib/extent
//@ use variants/occlusion

@group(0) @binding(26) var<storage, read_write> meshlet_lists: array<u32>;

// The last phase counts the meshlets that are not drawn.
override COUNTS_CULLED: bool = true;

// Invocations of the workgroup per verdict.
var<workgroup> tallies: array<atomic<u32>, 5>;
var<workgroup> first_slot: u32;

// Bound on the error of a sum of a few products, relative to its length.
const BACKFACING_ERROR = 9.5367431640625e-7; // 2^-20

// Do all triangles of a meshlet face away? Which side shows is decided after the snap, so a back face must be so large on
// screen that no rounding of its corners can reverse it.
fn is_backfacing(instance: u32, record: u32, e: Extent) -> bool {
    let altitude = meshlets[record].axis.w;
    let has_cone = (instances[instance].flags & INSTANCE_FACES) != 0u && altitude > 0.0;
    if !has_cone || !extent_is_unclipped(e) { return false; }
    let eye = instances[instance].eye;
    let center = extent_position(instance, meshlets[record].center.xyz);
    let axis = meshlets[record].axis.xyz;
    let is_point = eye.w != 0.0;
    let direction = select(eye.xyz, (center - eye.xyz) * eye.w, vec3<bool>(is_point));
    let square = dot(direction, direction);
    let along = dot(axis, direction);
    let across = sqrt(max(square - along * along, 0.0) + BACKFACING_ERROR * square);
    let error = BACKFACING_ERROR * select(4.0, dot(abs(center) + abs(eye.xyz), vec3f(1.0)), is_point);
    let radius = select(0.0, length(meshlets[record].half.xyz) * 1.000002, is_point);
    // Distance of the eye behind the plane of the triangle that faces away least: the cosine of a sum of angles.
    let behind = along * meshlets[record].center.w - across * meshlets[record].half.w - radius - error;
    if behind <= 0.0 { return false; }
    // A back face with a longest side s covers at least s * depth units squared, doubled. Corners that move by `shift` along
    // either axis change that by at most 4 sqrt(2) shift per unit of its longest side on screen, and 8 shift^2.
    let depth = instances[instance].center.w * altitude / e.high.w * (behind / e.high.w) / e.high.w;
    let shift = extent_shift(e);
    return depth > 5.7 * shift * instances[instance].half.w / e.low.w + 8.0 * shift * shift / altitude;
}

// CULL_* of a meshlet that is counted over all instances.
fn cull_verdict(id: u32, instance: u32, record: u32) -> u32 {
    let whole = Box(instances[instance].center.xyz, instances[instance].half.xyz);
    let around = extent_of(instance, whole);
    if extent_is_outside(around) { return CULL_OUTSIDE; }
    if (instances[instance].flags & INSTANCE_DEFORMS) != 0u { return occlusion_verdict(id, instance, whole, around); }
    let box = Box(meshlets[record].center.xyz, meshlets[record].half.xyz);
    let e = extent_of(instance, box);
    if extent_is_outside(e) { return CULL_OUTSIDE; }
    if is_backfacing(instance, record, e) { return CULL_BACKFACING; }
    return occlusion_verdict(id, instance, box, e);
}

@compute @workgroup_size(GROUP_SIZE)
fn cull(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    if invocation_index == 0u {
        for (var i = 0u; i < 5u; i += 1u) { atomicStore(&tallies[i], 0u); }
    }
    workgroupBarrier();
    let id = frame_invocation(workgroup, workgroups, invocation_index, GROUP_SIZE);
    var verdict = CULL_OTHER_PHASE;
    var instance = 0u;
    var record = 0u;
    var index = 0u;
    if id < culling.meshlet_count {
        instance = instances_of(id);
        record = instances[instance].first_meshlet + id - instances[instance].first;
        verdict = cull_verdict(id, instance, record);
        index = atomicAdd(&tallies[verdict], 1u);
    }
    workgroupBarrier();
    if invocation_index == 0u {
        first_slot = atomicAdd(&counters.visible_meshlets, atomicLoad(&tallies[CULL_VISIBLE]));
        if COUNTS_CULLED {
            atomicAdd(&counters.outside, atomicLoad(&tallies[CULL_OUTSIDE]));
            atomicAdd(&counters.backfacing, atomicLoad(&tallies[CULL_BACKFACING]));
            atomicAdd(&counters.hidden, atomicLoad(&tallies[CULL_HIDDEN]));
        }
    }
    let slot = workgroupUniformLoad(&first_slot) + index;
    if verdict == CULL_VISIBLE {
        let at = culling.first_visible + VISIBLE_MESHLET_WORDS * slot;
        meshlet_lists[at] = instance;
        meshlet_lists[at + 1u] = meshlets[record].first_triangle;
        meshlet_lists[at + 2u] = meshlets[record].first_vertex;
        meshlet_lists[at + 3u] = meshlets[record].triangles | (meshlets[record].vertices << 16u);
    }
}
