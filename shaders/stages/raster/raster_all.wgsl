// raster_all: draws triangles of all sizes in one dispatch, where passes before it have filled the queues. The first workgroups have an
// invocation for every triangle; the others take what is queued.
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
    let of_triangles = (frame.triangle_count + 63u) / 64u;
    if group < of_triangles {
        small_triangle(group * 64u + invocation_index);
        return;
    }
    let of_queues = workgroups.x * workgroups.y - of_triangles;
    if DRAWS_LARGE { large_tiles(group - of_triangles, of_queues, invocation_index); }
    if DRAWS_MEDIUM { medium_boxes(group - of_triangles, of_queues, invocation_index); }
}
