// Fixed-point positions and exact edge functions. A pixel is 2^SUBPIXEL_BITS units wide, its sample in the middle; y points
// down. Small triangles have an extent of at most 32,768 units (128 px at 8 bits), so an edge function is exact in i32;
// intermediate products may wrap. For large ones, 64-bit products are built from 16-bit limbs.

override SUBPIXEL_BITS: u32 = 8u;

// Largest extent of a small triangle, in units.
override SMALL_EXTENT: i32 = 32768;

// For edge functions in floats: samples on an edge belong to the triangle only where the edge is a top or left one; else all of
// them do.
override IS_TOP_LEFT: bool = true;

// Units per pixel.
fn grid_unit() -> i32 {
    return i32(1u << SUBPIXEL_BITS);
}

// The sample of a pixel, in units.
fn grid_sample(pixel: vec2i) -> vec2i {
    return (pixel << vec2u(SUBPIXEL_BITS)) + vec2i(i32(1u << (SUBPIXEL_BITS - 1u)));
}

// First pixel whose sample is not before `low`, in units.
fn grid_first(low: vec2i) -> vec2i {
    return (low + vec2i(grid_unit() / 2 - 1)) >> vec2u(SUBPIXEL_BITS);
}

// Last pixel whose sample is before `high`, in units.
fn grid_last(high: vec2i) -> vec2i {
    return (high - vec2i(grid_unit() / 2 + 1)) >> vec2u(SUBPIXEL_BITS);
}

// A 64-bit integer in two's complement.
struct Wide { hi: u32, lo: u32 }

// a * b of unsigned words, from 16-bit limbs.
fn fixed_umul(x: u32, y: u32) -> Wide {
    let xl = x & 0xffffu;
    let xh = x >> 16u;
    let yl = y & 0xffffu;
    let yh = y >> 16u;
    let ll = xl * yl;
    let lh = xl * yh;
    let hl = xh * yl;
    let middle = (ll >> 16u) + (lh & 0xffffu) + (hl & 0xffffu);
    return Wide(xh * yh + (lh >> 16u) + (hl >> 16u) + (middle >> 16u), (ll & 0xffffu) | (middle << 16u));
}

fn fixed_negate(v: Wide) -> Wide {
    let lo = ~v.lo + 1u;
    return Wide(~v.hi + select(0u, 1u, lo == 0u), lo);
}

// a * b for |a|, |b| <= 2^24.
fn fixed_mul(a: i32, b: i32) -> Wide {
    let product = fixed_umul(u32(abs(a)), u32(abs(b)));
    if (a < 0) != (b < 0) { return fixed_negate(product); }
    return product;
}

fn fixed_add(a: Wide, b: Wide) -> Wide {
    let lo = a.lo + b.lo;
    return Wide(a.hi + b.hi + select(0u, 1u, lo < a.lo), lo);
}

fn fixed_sub(a: Wide, b: Wide) -> Wide {
    return Wide(a.hi - b.hi - select(0u, 1u, a.lo < b.lo), a.lo - b.lo);
}

// Twice the signed area of (a, b, p): the edge function of a -> b at p.
fn fixed_edge(a: vec2i, b: vec2i, p: vec2i) -> Wide {
    let d = b - a;
    return fixed_sub(fixed_mul(d.x, p.y - a.y), fixed_mul(d.y, p.x - a.x));
}

fn fixed_sign(v: Wide) -> i32 {
    if bitcast<i32>(v.hi) < 0 { return -1; }
    return select(0, 1, (v.hi | v.lo) != 0u);
}

fn fixed_abs(v: Wide) -> Wide {
    if bitcast<i32>(v.hi) < 0 { return fixed_negate(v); }
    return v;
}

// Compares unsigned words: a < b.
fn fixed_is_less(a: Wide, b: Wide) -> bool {
    return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo);
}

// Bits by which an unsigned value must be shifted down to fit 31 bits.
fn fixed_shift(v: Wide) -> u32 {
    return select(33u - countLeadingZeros(v.hi), v.lo >> 31u, v.hi == 0u);
}

// v >> shift for shift < 32, where the result fits a word.
fn fixed_down(v: Wide, shift: u32) -> u32 {
    return (v.lo >> shift) | select(v.hi << (32u - max(shift, 1u)), 0u, shift == 0u);
}

// Largest integer whose square is at most v < 2^52: estimated in f32, corrected in integers.
fn fixed_root(v: Wide) -> u32 {
    var root = u32(sqrt(fixed_to_f32(v)));
    for (var i = 0u; i < 32u && fixed_is_less(v, fixed_umul(root, root)); i += 1u) { root -= 1u; }
    for (var i = 0u; i < 32u && !fixed_is_less(v, fixed_umul(root + 1u, root + 1u)); i += 1u) { root += 1u; }
    return root;
}

// The value as a float, within two roundings.
fn fixed_to_f32(v: Wide) -> f32 {
    let size = fixed_abs(v);
    let magnitude = f32(size.hi) * 4294967296.0 + f32(size.lo);
    return select(magnitude, -magnitude, bitcast<i32>(v.hi) < 0);
}

// Edge function of a -> b at p as a float, within two roundings, for |differences| <= 2^24: products of 12-bit halves are
// exact in i32, and carrying leaves a low part of 24 bits, so nothing cancels.
fn fixed_weight(a: vec2i, b: vec2i, p: vec2i) -> f32 {
    let d = b - a;
    let e = p - a;
    let dh = d >> vec2u(12u);
    let eh = e >> vec2u(12u);
    let dl = d & vec2i(4095);
    let el = e & vec2i(4095);
    let lo = dl.x * el.y - dl.y * el.x;
    let mid = dh.x * el.y + dl.x * eh.y - dh.y * el.x - dl.y * eh.x + (lo >> 12u);
    let hi = dh.x * eh.y - dh.y * eh.x + (mid >> 12u);
    return f32(hi) * 16777216.0 + f32(((mid & 4095) << 12u) | (lo & 4095));
}

// Top-left rule for an edge `d` of a clockwise triangle: 0 where samples on the edge belong to the triangle, else 1.
fn fixed_bias(d: vec2i) -> i32 {
    return select(1, 0, d.y < 0 || (d.y == 0 && d.x > 0));
}

// Twice the signed area in i32: exact up to an extent of 181 px.
fn fixed_small_area(a: vec2i, b: vec2i, c: vec2i) -> i32 {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}
