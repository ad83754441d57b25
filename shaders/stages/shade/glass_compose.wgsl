// glass_compose: sorts the layers of glass of every pixel of a band by depth key and triangle id, in integers, leaves out what the
// opaque triangle hides, and composes the others in linear light. The nearest layer then stands for the pixel in the framebuffer.
//@ use lib/frame
//@ use lib/glass
//@ use lib/glass_band
//@ use variants/glass_buffer
//@ use variants/glass_front

// Most layers of a pixel that are sorted: a CPU adapter ends all loops of an invocation after 65,535 iterations.
override GLASS_DEEPEST: u32 = 0xffffffffu;

@compute @workgroup_size(64)
fn glass_compose(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let index = frame_invocation(workgroup, workgroups, invocation_index, 64u);
    let pixel = glass_band_first() + index;
    if index >= glass_band_length() || pixel >= frame.size.x * frame.size.y { return; }
    let head = glass_buffer_load(pixel);
    if head == 0u { return; }
    if glass_is_deep(head) {
        glass_buffer_add(glass_counts() + GLASS_COUNT_DEEP, 1u);
        glass_buffer_store(pixel, 0u);
        return;
    }
    let first = glass_sorted(head);
    var seen = GlassLayer(vec3f(1.0), vec3f(0.0));
    var last = 0u;
    var link = first;
    while link != 0u && glass_front_is_behind(pixel, glass_key(link), glass_id(link)) {
        seen = glass_merged(seen, glass_layer(link));
        last = link;
        link = glass_next(link);
    }
    if last == 0u {
        glass_buffer_store(pixel, 0u);
        return;
    }
    glass_set_next(last, 0u);
    glass_buffer_store(pixel, first);
    let composed = glass_composed(pixel);
    let words = glass_packed(seen);
    glass_buffer_store(composed, glass_front_id(pixel));
    glass_buffer_store(composed + 1u, words.x);
    glass_buffer_store(composed + 2u, words.y);
    glass_buffer_store(composed + 3u, words.z);
    glass_front_store(pixel, glass_key(first), glass_id(first));
}

fn glass_key(link: u32) -> u32 { return glass_buffer_load(glass_node(link)); }
fn glass_id(link: u32) -> u32 { return glass_buffer_load(glass_node(link) + GLASS_NODE_ID); }
fn glass_next(link: u32) -> u32 { return glass_buffer_load(glass_node(link) + GLASS_NODE_NEXT); }
fn glass_set_next(link: u32, next: u32) { glass_buffer_store(glass_node(link) + GLASS_NODE_NEXT, next); }

fn glass_layer(link: u32) -> GlassLayer {
    let word = glass_node(link) + GLASS_NODE_LAYER;
    return glass_unpacked(vec3u(glass_buffer_load(word), glass_buffer_load(word + 1u), glass_buffer_load(word + 2u)));
}

// Has a list more layers than are sorted?
fn glass_is_deep(head: u32) -> bool {
    if GLASS_DEEPEST == 0xffffffffu { return false; }
    var link = head;
    for (var count = 0u; count < GLASS_DEEPEST; count += 1u) {
        if link == 0u { return false; }
        link = glass_next(link);
    }
    return link != 0u;
}

// Is a layer nearer than another? The larger key is, and of equal keys the smaller id.
fn glass_is_before(a: u32, b: u32) -> bool {
    let key_a = glass_key(a);
    let key_b = glass_key(b);
    return key_a > key_b || (key_a == key_b && glass_id(a) < glass_id(b));
}

// Sorts a list, which is not empty, in place and returns its head: runs of 1, 2, 4, ... nodes are merged pair by pair.
fn glass_sorted(head: u32) -> u32 {
    var list = head;
    for (var run = 1u; run != 0u; run <<= 1u) {
        var left = list;
        var tail = 0u;
        var merges = 0u;
        list = 0u;
        while left != 0u {
            merges += 1u;
            var right = left;
            var left_count = 0u;
            while left_count < run && right != 0u {
                right = glass_next(right);
                left_count += 1u;
            }
            var right_count = run;
            while left_count > 0u || (right_count > 0u && right != 0u) {
                let is_right_done = right_count == 0u || right == 0u;
                let takes_left = left_count > 0u && (is_right_done || glass_is_before(left, right));
                let link = select(right, left, takes_left);
                if takes_left {
                    left = glass_next(left);
                    left_count -= 1u;
                } else {
                    right = glass_next(right);
                    right_count -= 1u;
                }
                if tail == 0u { list = link; } else { glass_set_next(tail, link); }
                tail = link;
            }
            left = right;
        }
        glass_set_next(tail, 0u);
        if merges <= 1u { break; }
    }
    return list;
}
