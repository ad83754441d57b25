// Tile large: one workgroup per large triangle finds the 64x64 tiles of the picture that it may touch.
//@ use slot/pieces
//@ use slot/queues
//@ use common/rounds
//@ use common/fixed
//@ use common/reach
//@ use slot/marks

// Sign of the biased edge function at its innermost sample of a box of pixels: negative means all outside.
fn tile_is_outside(a: vec2i, b: vec2i, pixels: vec4i) -> bool {
    let d = b - a;
    let inner = select(pixels.xy, pixels.zw, vec2<bool>((d.y < 0), (d.x > 0)));
    return fixed_sign(fixed_edge(a, b, grid_sample(inner))) < fixed_bias(d);
}

@compute @workgroup_size(64)
fn tile_large(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slot = rounds_large_done() + group.y * groups.x + group.x;
    if slot >= min(atomicLoad(&counters.large), frame.large_capacity) { return; }
    let entry = queues[frame.large_first + slot];
    let t = pieces_load(entry);
    let a = vertex_at(t.a);
    var b = vertex_at(t.b);
    var c = vertex_at(t.c);
    if fixed_sign(fixed_edge(a, b, c)) < 0 {
        let swap = b;
        b = c;
        c = swap;
    }

    let pixels = triangle_pixels(min(min(a, b), c), max(max(a, b), c));
    let first = pixels.xy / 64;
    let tiles = pixels.zw / 64 - first + 1;
    for (var i = i32(lane); i < tiles.x * tiles.y; i += 64) {
        let tile = first + vec2i(i % tiles.x, i / tiles.x);
        let box = vec4i(max(tile * 64, pixels.xy), min(tile * 64 + 63, pixels.zw));
        if SHAPE == SHAPE_BOXES || !(tile_is_outside(a, b, box) || tile_is_outside(b, c, box) || tile_is_outside(c, a, box)) {
            queues_push_tile(entry, vec2u(tile));
            marks_box(box);
        }
    }
}
