// dots_probe: the records of all dots, for the oracle to judge. No picture needs them.
//@ use lib/frame
//@ use lib/dots

@group(0) @binding(27) var<storage, read_write> dot_records: array<vec4u>;

@compute @workgroup_size(64)
fn dots_probe(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let id = frame_invocation(workgroup, workgroups, invocation_index, 64u);
    let number = dot_frame.first_probed + id;
    if id >= arrayLength(&dot_records) || number >= dot_frame.dots { return; }
    let entry = dots_find(number);
    dot_records[id] = dots_record(dots_clip(entry.x, entry.y));
}
