// Raster small: every triangle is fetched, culled and classified by one invocation; the small are drawn on the spot, or put
// on the lists of the tiles that they touch; the others wait in a queue for a kernel of their size. Classifying and drawing the small share one fetch.
//@ use common/triangle
//@ use common/fixed
//@ use common/reject
//@ use slot/queues
//@ use slot/share
//@ use slot/walk

// Most candidate samples, and most pixels per side, that one invocation walks; chosen by the adapter's caps.
override MAX_SMALL_SAMPLES: i32 = 128;
override MAX_SMALL_SIDE: i32 = 64;
// The first of several passes over the triangles fills the queues and counts.
override IS_FIRST_VISIT: bool = true;

const SMALL_EXTENT = 32768; // units: 128 px as a rule
// Corner flags that leave a triangle out instead of sending it to the clipper.
override DROPPED_FLAGS: u32 = 0u;

@compute @workgroup_size(GROUP_SIZE)
fn raster_small(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    // Loads come before the first branch: what all lanes load alike is then loaded once, even where branches are masks.
    let share = share_of(frame_invocation(group, groups, lane, GROUP_SIZE));
    let id = share.id;
    let t = triangle_of(share.draw, share.loaded);
    let draw_flags = draws[t.draw].flags;
    if id >= frame.triangle_count { return; }
    let any_flag = (t.a.x | t.b.x | t.c.x) & 255u;
    if any_flag != 0u {
        if IS_FIRST_VISIT { unready(t, any_flag); }
        return;
    }

    let a = vertex_at(t.a);
    let b = vertex_at(t.b);
    let c = vertex_at(t.c);
    let low = min(min(a, b), c);
    let high = max(max(a, b), c);
    let is_large = max(high.x - low.x, high.y - low.y) > SMALL_EXTENT;
    var area = fixed_small_area(a, b, c);
    if is_large { area = fixed_sign(fixed_edge(a, b, c)); }
    if area == 0 {
        if IS_FIRST_VISIT { atomicAdd(&counters.degenerate, 1u); }
        return;
    }
    if !triangle_is_shown(draw_flags, area > 0) { return; }
    let pixels = triangle_pixels(low, high);
    if any(pixels.zw < pixels.xy) { return; }
    if is_large {
        if IS_FIRST_VISIT { queues_push_large(id); }
        return;
    }

    let sides = pixels.zw - pixels.xy + 1;
    if sides.x * sides.y > MAX_SMALL_SAMPLES || max(sides.x, sides.y) > MAX_SMALL_SIDE {
        if IS_FIRST_VISIT { queues_push_medium(id); }
        return;
    }
    walk(t, area, pixels);
}

// A corner was rejected, or lies in front of the near plane or beyond the guard band.
fn unready(t: Triangle, any_flag: u32) {
    if reject_count(any_flag) { return; }
    if (any_flag & DROPPED_FLAGS) != 0u {
        atomicAdd(&counters.dropped, 1u);
        return;
    }
    if (t.a.x & t.b.x & t.c.x & VERTEX_CLIPPED) == 0u { queues_push_clip(t.id); }
}
