// Glass composition: what the layers of glass of a pixel do together to what lies behind them. What the opaque triangle hides is left out.
// Chosen by the accuracy axis `transparency`. Default: sorted.
//
// Of the list with this head, which is not empty.
//@ declare fn glass_composition(pixel: u32, head: u32) -> GlassSeen

//@ variant sorted
// In the order of depth key and triangle id: the list is sorted in integers. It ends before what is hidden afterwards.
//@ use lib/glass
//@ use lib/glass_list
//@ use variants/glass_front

// Most layers that are composed, from the nearest on; the others stay in the list.
override GLASS_COMPOSED_LAYERS: u32 = 0xffffffffu;

fn glass_composition(pixel: u32, head: u32) -> GlassSeen {
    let first = glass_sorted(head);
    var seen = GlassLayer(vec3f(1.0), vec3f(0.0));
    var last = 0u;
    var count = 0u;
    var link = first;
    while link != 0u && glass_front_is_behind(pixel, glass_key(link), glass_id(link)) {
        if GLASS_COMPOSED_LAYERS == 0xffffffffu || count < GLASS_COMPOSED_LAYERS { seen = glass_merged(seen, glass_layer(link)); }
        count += 1u;
        last = link;
        link = glass_next(link);
    }
    if last == 0u { return GlassSeen(0u, seen); }
    glass_set_next(last, 0u);
    return GlassSeen(first, seen);
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

fn glass_composition(pixel: u32, head: u32) -> GlassSeen {
    var first = 0u;
    var count = 0u;
    for (var link = head; link != 0u; link = glass_next(link)) {
        if !glass_front_is_behind(pixel, glass_key(link), glass_id(link)) { continue; }
        count += 1u;
        if first == 0u || glass_is_before(link, first) { first = link; }
    }
    if count == 0u { return GlassSeen(0u, GlassLayer(vec3f(1.0), vec3f(0.0))); }
    if count == 1u { return GlassSeen(first, glass_layer(first)); }
    let nearest = bitcast<f32>(depth_bits(glass_key(first)));
    var added: array<Wide, 3>;
    var covered: array<Wide, 3>;
    var faded = vec3u(0u);
    for (var link = head; link != 0u; link = glass_next(link)) {
        if !glass_front_is_behind(pixel, glass_key(link), glass_id(link)) { continue; }
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
    return GlassSeen(first, GlassLayer(passed, color * (1.0 - passed)));
}
