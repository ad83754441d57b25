// Project: pulls every vertex, transforms it, tells what lies before the near plane, snaps it once, and keeps 16 bytes.
// Where effects part the triangles, that is every corner of every triangle.
//@ use common/frame
//@ use common/transform
//@ use slot/sources

@group(0) @binding(4) var<storage, read_write> vertices: array<vec4u>;

@compute @workgroup_size(LIST_GROUP)
fn project(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    // No early return: what all lanes load alike is then loaded once, even where branches are lane masks.
    let invocation = frame_invocation(group, groups, lane, LIST_GROUP);
    let id = min(invocation, frame.vertex_count - 1u);
    let source = sources_of(id);
    let bits = transform_bits(source.draw, source.vertex);
    let gate = vertex_gate(bits);
    let clip = movement_clip(source.draw, source.vertex, source.triangle, vertex_position(bits, gate));

    let is_near = clip.z <= clip.w && clip.w > 0.0;
    let inv_w = 1.0 / select(1.0, clip.w, is_near);
    let at = vertex_snap(clip, inv_w, frame.center);
    let flags = select(gate, select(VERTEX_NEAR, vertex_guard(at), is_near), gate == 0u);
    let is_known = gate == 0u && is_near;
    let record = vertex_pack(
        select(vec2i(0), at, is_known), select(0.0, clip.z * inv_w, is_known), select(0.0, inv_w, is_known), flags);
    if invocation < frame.vertex_count { vertices[id] = record; }
}
