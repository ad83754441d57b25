// Mask, asked: a covered sample is drawn where the alpha of its material's image reaches the cutoff. Integers alone say so, from
// what was settled about the triangle, so that every pass, option and adapter says the same: the largest level, mixed in 1/256
// of a texel, or the nearest texel where the sampler asks for that.
//@ use common/decisions
//@ use common/parts
//@ use common/texels

fn mask_is_drawn(t: Triangle, at: vec2u) -> bool {
    let last = decisions_load(t.entry, SAMPLE_SETUPS - 1u);
    if last.z == 0u { return true; }
    let first = decisions_load(t.entry, SAMPLE_SETUPS - 2u);
    let weights = mask_weights(parts_of(t, at), vec3u(t.a.w, t.b.w, t.c.w));
    let place = vec2i(
        mask_mixed(weights, bitcast<vec3i>(vec3u(first.x, first.z, last.x))), mask_mixed(weights, bitcast<vec3i>(vec3u(first.y, first.w, last.y))));
    let least = texels_paint(last.z - 1u).alpha_threshold;
    let look = texels_lookup(last.z - 1u + TEXELS_PAINT);
    let first_texel = texels_word(look.levels);
    if ((look.sampling >> 4u) & 1u) == 0u { return (mask_alpha(look, first_texel, place >> vec2u(8u)) << 16u) >= least; }
    let corner = place - 128;
    let part = vec2u(corner & vec2i(255));
    let texel = corner >> vec2u(8u);
    let above = mask_alpha(look, first_texel, texel) * (256u - part.x) + mask_alpha(look, first_texel, texel + vec2i(1, 0)) * part.x;
    let below = mask_alpha(look, first_texel, texel + vec2i(0, 1)) * (256u - part.x) + mask_alpha(look, first_texel, texel + vec2i(1, 1)) * part.x;
    return above * (256u - part.y) + below * part.y >= least;
}

fn mask_alpha(look: Lookup, first: u32, at: vec2i) -> u32 {
    let size = vec2i(vec2u(look.size & 0xffffu, look.size >> 16u));
    let x = texels_wrapped(at.x, size.x, look.sampling & 3u);
    let y = texels_wrapped(at.y, size.y, (look.sampling >> 2u) & 3u);
    return texels_word(first + u32(y * size.x + x)) >> 24u;
}

// Shares of the corners in perspective, of 31 bits in all: parts times 1/w, whose significands are shifted to one exponent.
fn mask_weights(parts: vec3u, inv_w: vec3u) -> vec3u {
    let spread = parts << vec3u(max(countLeadingZeros(parts.x + parts.y + parts.z), 1u) - 1u);
    let exponents = inv_w >> vec3u(23u);
    let apart = vec3u(max(max(exponents.x, exponents.y), exponents.z)) - exponents;
    let significands = ((inv_w & vec3u(0x7fffffu)) | vec3u(0x800000u)) << vec3u(8u);
    let near = select(significands >> min(apart, vec3u(31u)), vec3u(0u), apart > vec3u(31u));
    return vec3u(fixed_umul(spread.x, near.x).hi, fixed_umul(spread.y, near.y).hi, fixed_umul(spread.z, near.z).hi);
}

// The weighted mean of three numbers, rounded down.
fn mask_mixed(weights: vec3u, values: vec3i) -> i32 {
    let least = min(min(values.x, values.y), values.z);
    let above = vec3u(values - least);
    var rest = fixed_add(fixed_add(fixed_umul(weights.x, above.x), fixed_umul(weights.y, above.y)), fixed_umul(weights.z, above.z));
    let sum = max(weights.x + weights.y + weights.z, 1u);
    // A float guesses too little, twice, within 2^-19 of what is left; then few are missing.
    let share = 0.999998 / f32(sum);
    var quotient = 0u;
    for (var i = 0u; i < 2u; i += 1u) {
        let guess = u32((f32(rest.hi) * 4294967296.0 + f32(rest.lo)) * share);
        quotient += guess;
        rest = fixed_sub(rest, fixed_umul(guess, sum));
    }
    for (var i = 0u; i < 8u && !fixed_is_less(rest, Wide(0u, sum)); i += 1u) {
        quotient += 1u;
        rest = fixed_sub(rest, Wide(0u, sum));
    }
    return least + bitcast<i32>(quotient);
}
