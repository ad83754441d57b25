// Glass composition: what the layers of glass of a pixel do together to what lies behind them. What the opaque triangle hides is left out.
// Chosen by the accuracy axis `transparency`. Default: sorted.
//
// Of the list with this head, which is not empty, before the opaque triangle of a pixel (variants/glass_front).
//@ declare fn glass_composition(front: vec2u, head: u32) -> GlassSeen

//@ variant sorted
// In the order of depth key and triangle id: the list is sorted in integers. It ends before what is hidden afterwards.
//@ use lib/glass
//@ use lib/glass_list
//@ use variants/glass_front

// Most layers that are composed, from the nearest on; the others stay in the list.
override GLASS_COMPOSED_LAYERS: u32 = 0xffffffffu;

fn glass_composition(front: vec2u, head: u32) -> GlassSeen {
    let first = glass_sorted(head);
    var seen = GlassLayer(vec3f(1.0), vec3f(0.0));
    if first == 0u { return GlassSeen(0u, seen, true); }
    var last = 0u;
    var count = 0u;
    var link = first;
    while link != 0u && glass_front_is_behind(front, glass_key(link), glass_id(link)) {
        if GLASS_COMPOSED_LAYERS == 0xffffffffu || count < GLASS_COMPOSED_LAYERS { seen = glass_merged(seen, glass_layer(link)); }
        count += 1u;
        last = link;
        link = glass_next(link);
    }
    if last == 0u { return GlassSeen(0u, seen, false); }
    glass_set_next(last, 0u);
    return GlassSeen(first, seen, false);
}

// Sorts a list, which is not empty, in place and returns its head: runs of 8 nodes are sorted one by one, then runs of 8, 16, 32, ...
// merged pair by pair. Returns 0 for a list of more than are composed.
fn glass_sorted(head: u32) -> u32 {
    var list = 0u;
    var tail = 0u;
    var runs = 0u;
    var rest = head;
    while rest != 0u {
        if runs == GLASS_DEEPEST / GLASS_RUN { return 0u; }
        let run = glass_sorted_run(rest);
        if tail == 0u { list = run.first; } else { glass_set_next(tail, run.first); }
        tail = run.last;
        rest = run.rest;
        runs += 1u;
    }
    for (var run = GLASS_RUN; runs > 1u; run <<= 1u) {
        var left = list;
        tail = 0u;
        runs = 0u;
        list = 0u;
        while left != 0u {
            runs += 1u;
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
    }
    return list;
}

// Nodes of a run.
const GLASS_RUN = 8u;

struct GlassRun {
    first: u32,
    last: u32,
    rest: u32, // the node that followed the run; 0 for none
}

// Sorts the first 8 nodes of a list, or all of them, in registers: each takes its place among those before it. Nothing follows the last.
fn glass_sorted_run(head: u32) -> GlassRun {
    // The nearest four and the farther four; an empty place has key 0, the largest id and link 0.
    var near_keys = vec4u(0u);
    var far_keys = vec4u(0u);
    var near_ids = vec4u(0xffffffffu);
    var far_ids = vec4u(0xffffffffu);
    var near = vec4u(0u);
    var far = vec4u(0u);
    var rest = head;
    for (var count = 0u; count < GLASS_RUN && rest != 0u; count += 1u) {
        let key = glass_key(rest);
        let id = glass_id(rest);
        let are_near = glass_are_before(near_keys, near_ids, key, id);
        let are_far = glass_are_before(far_keys, far_ids, key, id);
        far_keys = glass_inserted(far_keys, key, are_far, near_keys.w, are_near.w);
        far_ids = glass_inserted(far_ids, id, are_far, near_ids.w, are_near.w);
        far = glass_inserted(far, rest, are_far, near.w, are_near.w);
        near_keys = glass_inserted(near_keys, key, are_near, 0u, true);
        near_ids = glass_inserted(near_ids, id, are_near, 0u, true);
        near = glass_inserted(near, rest, are_near, 0u, true);
        rest = glass_next(rest);
    }
    glass_chain(near, far.x);
    glass_chain(far, 0u);
    return GlassRun(near.x, select(glass_last(near), glass_last(far), far.x != 0u), rest);
}

// Four places in order, into which a value comes behind those that are before it; `previous` is what stands before the first of them.
fn glass_inserted(places: vec4u, value: u32, are_before: vec4<bool>, previous: u32, is_previous_before: bool) -> vec4u {
    let moved = select(vec4u(previous, places.xyz), vec4u(value), vec4<bool>(is_previous_before, are_before.xyz));
    return select(moved, places, are_before);
}

// Links four nodes, of which the last may be missing, in their order, and the fourth to what follows.
fn glass_chain(links: vec4u, follows: u32) {
    if links.x != 0u { glass_set_next(links.x, links.y); }
    if links.y != 0u { glass_set_next(links.y, links.z); }
    if links.z != 0u { glass_set_next(links.z, links.w); }
    if links.w != 0u { glass_set_next(links.w, follows); }
}

// The last of these that is not missing.
fn glass_last(links: vec4u) -> u32 {
    let last = select(links.x, links.y, links.y != 0u);
    return select(select(last, links.z, links.z != 0u), links.w, links.w != 0u);
}

//@ variant weighted
// In no order, by sums that commute because they are integers (McGuire and Bavoil 2013): the light that layers add over what they
// cover, in the mean, as far as all of them cover what lies behind. A layer weighs its coverage times the cube of the depth of the
// nearest layer over its own, at least 1/256. One layer alone is taken as it is. Lists are not sorted, and keep what is hidden.
//@ use lib/fixed
//@ use lib/glass
//@ use lib/glass_list
//@ use variants/depth
//@ use variants/glass_front

// Steps of a number of a layer, of a weight, and of the logarithm to base 2 of what passes.
const GLASS_STEPS = 65535.0;
const GLASS_WEIGHT_STEPS = 256.0;
const GLASS_FADE_STEPS = 65536.0;
// Where sums of these logarithms stay: nothing passes any more.
const GLASS_FADE_MOST = 0x4000000u;

fn glass_composition(front: vec2u, head: u32) -> GlassSeen {
    let nothing = GlassLayer(vec3f(1.0), vec3f(0.0));
    var first = 0u;
    var count = 0u;
    var length = 0u;
    for (var link = head; link != 0u; link = glass_next(link)) {
        if length == GLASS_DEEPEST { return GlassSeen(0u, nothing, true); }
        length += 1u;
        if !glass_front_is_behind(front, glass_key(link), glass_id(link)) { continue; }
        count += 1u;
        if first == 0u || glass_is_before(link, first) { first = link; }
    }
    if count == 0u { return GlassSeen(0u, nothing, false); }
    if count == 1u { return GlassSeen(first, glass_layer(first), false); }
    let nearest = bitcast<f32>(depth_bits(glass_key(first)));
    var added: array<Wide, 3>;
    var covered: array<Wide, 3>;
    var faded = vec3u(0u);
    for (var link = head; link != 0u; link = glass_next(link)) {
        if !glass_front_is_behind(front, glass_key(link), glass_id(link)) { continue; }
        let layer = glass_layer(link);
        let nearness = bitcast<f32>(depth_bits(glass_key(link))) / nearest;
        let weight = u32(max(nearness * nearness * nearness * GLASS_WEIGHT_STEPS, 1.0) + 0.5);
        let light = vec3u(layer.added * GLASS_STEPS + 0.5) * weight;
        let coverage = vec3u((1.0 - layer.passed) * GLASS_STEPS + 0.5) * weight;
        for (var channel = 0u; channel < 3u; channel += 1u) {
            added[channel] = fixed_add(added[channel], Wide(0u, light[channel]));
            covered[channel] = fixed_add(covered[channel], Wide(0u, coverage[channel]));
        }
        let fades = vec3u(max(-log2(max(layer.passed, vec3f(1e-9))), vec3f(0.0)) * GLASS_FADE_STEPS + 0.5);
        faded = min(faded + fades, vec3u(GLASS_FADE_MOST));
    }
    let passed = exp2(vec3f(faded) * (-1.0 / GLASS_FADE_STEPS));
    var color = vec3f(0.0);
    for (var channel = 0u; channel < 3u; channel += 1u) {
        let whole = max(fixed_to_f32(covered[channel]), 1.0);
        color[channel] = min(fixed_to_f32(added[channel]) / whole, 1.0);
    }
    return GlassSeen(first, GlassLayer(passed, color * (1.0 - passed)), false);
}
