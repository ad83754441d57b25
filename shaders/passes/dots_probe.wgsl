// Dots probe: the records of all dots, for a judge to read; no picture needs them.
//@ use common/frame
//@ use common/dots

@group(0) @binding(27) var<storage, read_write> dot_records: array<vec4u>;

@compute @workgroup_size(64)
fn dots_probe(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let id = frame_invocation(group, groups, lane, 64u);
    let number = dot_frame.first_probed + id;
    if id >= arrayLength(&dot_records) || number >= dot_frame.dots { return; }
    let entry = dots_find(number);
    dot_records[id] = dots_record(dots_clip(entry.x, entry.y));
}
