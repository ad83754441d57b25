// Project: pulls every vertex, transforms it, tells what lies before the near plane, snaps it once, and keeps 16 bytes.
//@ use common/frame
//@ use common/transform

@group(0) @binding(4) var<storage, read_write> vertices: array<vec4u>;

@compute @workgroup_size(LIST_GROUP)
fn project(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    // No early return: what all lanes load alike is then loaded once, even where branches are lane masks.
    let invocation = frame_invocation(group, groups, lane, LIST_GROUP);
    let id = min(invocation, frame.vertex_count - 1u);
    let draw = draws_of_vertex(id);
    let bits = transform_bits(draw, id - draws[draw].first_vertex);
    let gate = vertex_gate(bits);
    let clip = transform_clip(draw, vertex_position(bits, gate));

    let is_near = clip.z <= clip.w && clip.w > 0.0;
    let inv_w = 1.0 / select(1.0, clip.w, is_near);
    let at = vertex_snap(clip, inv_w, frame.center);
    let flags = select(gate, select(VERTEX_NEAR, vertex_guard(at), is_near), gate == 0u);
    let is_known = gate == 0u && is_near;
    let record = vertex_pack(
        select(vec2i(0), at, is_known), select(0.0, clip.z * inv_w, is_known), select(0.0, inv_w, is_known), flags);
    if invocation < frame.vertex_count { vertices[id] = record; }
}
