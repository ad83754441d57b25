// Sample tests: is a covered sample drawn? All steps must pass, in this order: glass is left out, the sample effects, the shape of particle discs
// and of points, the alpha mask of the material, and the draw order, which counts the samples that are left.
// Chosen by the stack and the scene; without any, every covered sample is drawn.
//@ steps fn sample_test(t: Triangle, at: vec2u, pixel: u32) -> bool

//@ step opaque
// Passes that find the nearest opaque triangle leave out glass, which raster passes of its own draw. Light passes through it.
//@ use lib/triangle
//@ use lib/glass

fn sample_test_opaque(t: Triangle, at: vec2u, pixel: u32) -> bool {
    return (draws[t.draw].flags & DRAW_GLASS) == 0u;
}

//@ step effects
// The sample effects of the stack. The glue loads the setup of each from lib/sample_setup.
//@ use lib/triangle
//@ use lib/areas
//@ use lib/sample
//@ use lib/sample_setup
//@ use glue/sample

fn sample_test_effects(t: Triangle, at: vec2u, pixel: u32) -> bool {
    return glue_sample(Sample(at, t.id, areas_at(t, at), vec4u()), t.draw, t.entry);
}

//@ step particle_disc
// A particle is a triangle of which only the ellipse that touches its sides in their midpoints is
// drawn, and nothing if it had to be clipped. With areas a, b, c: (a + b - c)^2 <= 4 a b.
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/areas

fn sample_test_particle_disc(t: Triangle, at: vec2u, pixel: u32) -> bool {
    if (draws[t.draw].flags & DRAW_PARTICLES) == 0u { return true; }
    let areas = areas_at(t, at);
    let d = u32(abs(i32(areas.x + areas.y) - i32(areas.z)));
    let is_inside = !fixed_is_less(fixed_umul(2u * areas.x, 2u * areas.y), fixed_umul(d, d));
    return t.entry < frame.triangle_count && is_inside;
}

//@ step point
// Of the triangle about a point its disc is drawn, or its pixel.
//@ use lib/triangle
//@ use variants/points

fn sample_test_point(t: Triangle, at: vec2u, pixel: u32) -> bool {
    return point_covers(t, vec2i(at));
}

//@ step alpha_mask
// A sample is drawn where the alpha of its material's image reaches the threshold. Only integers
// decide, from the setup of the triangle, so every pass, option and adapter decides alike: the largest level, filtered linearly
// in steps of 1/256 of a texel, or the nearest texel where the sampler asks for that.
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/sample_setup
//@ use lib/areas
//@ use lib/material_atlas

fn sample_test_alpha_mask(t: Triangle, at: vec2u, pixel: u32) -> bool {
    let last = sample_setup_load(t.entry, SAMPLE_SETUPS - 1u);
    if last.z == 0u { return true; }
    let first = sample_setup_load(t.entry, SAMPLE_SETUPS - 2u);
    let weights = alpha_mask_weights(areas_at(t, at), vec3u(t.a.w, t.b.w, t.c.w));
    let position = vec2i(
        alpha_mask_mixed(weights, bitcast<vec3i>(vec3u(first.x, first.z, last.x))),
        alpha_mask_mixed(weights, bitcast<vec3i>(vec3u(first.y, first.w, last.y))));
    let threshold = atlas_material(last.z - 1u).alpha_threshold;
    let lookup = atlas_lookup(last.z - 1u + ATLAS_MATERIAL);
    let first_texel = atlas_word(lookup.levels);
    if ((lookup.sampling >> 4u) & 1u) == 0u { return (alpha_mask_texel(lookup, first_texel, position >> vec2u(8u)) << 16u) >= threshold; }
    let corner = position - 128;
    let part = vec2u(corner & vec2i(255));
    let texel = corner >> vec2u(8u);
    let above = alpha_mask_texel(lookup, first_texel, texel) * (256u - part.x) + alpha_mask_texel(lookup, first_texel, texel + vec2i(1, 0)) * part.x;
    let below = alpha_mask_texel(lookup, first_texel, texel + vec2i(0, 1)) * (256u - part.x) + alpha_mask_texel(lookup, first_texel, texel + vec2i(1, 1)) * part.x;
    return above * (256u - part.y) + below * part.y >= threshold;
}

fn alpha_mask_texel(lookup: Lookup, first: u32, at: vec2i) -> u32 {
    let size = vec2i(vec2u(lookup.size & 0xffffu, lookup.size >> 16u));
    let x = atlas_wrapped(at.x, size.x, lookup.sampling & 3u);
    let y = atlas_wrapped(at.y, size.y, (lookup.sampling >> 2u) & 3u);
    return atlas_word(first + u32(y * size.x + x)) >> 24u;
}

// Perspective weights of the corners, with 31 bits in all: areas times 1/w, whose significands are shifted to one exponent.
fn alpha_mask_weights(areas: vec3u, inv_w: vec3u) -> vec3u {
    let spread = areas << vec3u(max(countLeadingZeros(areas.x + areas.y + areas.z), 1u) - 1u);
    let exponents = inv_w >> vec3u(23u);
    let apart = vec3u(max(max(exponents.x, exponents.y), exponents.z)) - exponents;
    let significands = ((inv_w & vec3u(0x7fffffu)) | vec3u(0x800000u)) << vec3u(8u);
    let near = select(significands >> min(apart, vec3u(31u)), vec3u(0u), apart > vec3u(31u));
    return vec3u(fixed_umul(spread.x, near.x).hi, fixed_umul(spread.y, near.y).hi, fixed_umul(spread.z, near.z).hi);
}

// The weighted mean of three numbers, rounded down.
fn alpha_mask_mixed(weights: vec3u, values: vec3i) -> i32 {
    let least = min(min(values.x, values.y), values.z);
    let above = vec3u(values - least);
    var rest = fixed_add(fixed_add(fixed_umul(weights.x, above.x), fixed_umul(weights.y, above.y)), fixed_umul(weights.z, above.z));
    let sum = max(weights.x + weights.y + weights.z, 1u);
    // A float underestimates, twice, within 2^-19 of the remainder; then little is missing.
    let inverse = 0.999998 / f32(sum);
    var quotient = 0u;
    for (var i = 0u; i < 2u; i += 1u) {
        let estimate = u32((f32(rest.hi) * 4294967296.0 + f32(rest.lo)) * inverse);
        quotient += estimate;
        rest = fixed_sub(rest, fixed_umul(estimate, sum));
    }
    for (var i = 0u; i < 8u && !fixed_is_less(rest, Wide(0u, sum)); i += 1u) {
        quotient += 1u;
        rest = fixed_sub(rest, Wide(0u, sum));
    }
    return least + bitcast<i32>(quotient);
}

//@ step draw_order
// Only the samples that come first are drawn. ORDER_TEST tells in which order:
// 0, submission: the first samples of the triangles in order, each triangle's row by row; the same set on every adapter.
// 1, scheduler: every covered sample takes the next index of a counter, so the number of samples is exact, but which samples
// are drawn differs from frame to frame.
// 2, racy: load, compare, add, as a simple kernel counts. Other invocations add in between, so too many samples are drawn.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/order

@group(0) @binding(14) var<uniform> order: Order;

override ORDER_TEST: u32 = 0u;
// A second pass visits the samples of the frame, and counts for itself.
override USES_SECOND_COUNTER: bool = false;

const ORDER_TEST_SUBMISSION = 0u;
const ORDER_TEST_SCHEDULER = 1u;

fn sample_test_draw_order(t: Triangle, at: vec2u, pixel: u32) -> bool {
    if ORDER_TEST == ORDER_TEST_SUBMISSION {
        return t.id < order.boundary_triangle || (t.id == order.boundary_triangle && pixel < order.cut);
    }
    if ORDER_TEST == ORDER_TEST_SCHEDULER {
        var index = 0u;
        if USES_SECOND_COUNTER { index = atomicAdd(&counters.next_sample_index_again, 1u); }
        else { index = atomicAdd(&counters.next_sample_index, 1u); }
        return order.limit_hi > 0u || index < order.limit_lo;
    }
    // The racy test.
    if USES_SECOND_COUNTER {
        if order.limit_hi == 0u && atomicLoad(&counters.next_sample_index_again) >= order.limit_lo { return false; }
        atomicAdd(&counters.next_sample_index_again, 1u);
        return true;
    }
    if order.limit_hi == 0u && atomicLoad(&counters.next_sample_index) >= order.limit_lo { return false; }
    atomicAdd(&counters.next_sample_index, 1u);
    return true;
}
