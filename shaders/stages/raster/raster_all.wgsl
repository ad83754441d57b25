// raster_all: draws triangles of all sizes in one dispatch, where passes before it have filled the queues. The first workgroups take what
// is queued, because that takes longest; the others have an invocation for every triangle.
//@ use lib/frame
//@ use lib/small_triangle
//@ use variants/medium_boxes
//@ use variants/large_tiles

override DRAWS_MEDIUM: bool = true;
override DRAWS_LARGE: bool = true;

@compute @workgroup_size(64)
fn raster_all(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let group = workgroup.y * workgroups.x + workgroup.x;
    let of_queues = workgroups.x * workgroups.y - (frame.triangle_count + 63u) / 64u;
    if group < of_queues {
        if DRAWS_LARGE { large_tiles(group, of_queues, invocation_index); }
        if DRAWS_MEDIUM { medium_boxes(group, of_queues, invocation_index); }
    } else {
        small_triangle((group - of_queues) * 64u + invocation_index);
    }
}
