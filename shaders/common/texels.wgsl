// Texels: images and the records of materials that preset them up, as words of one texture (`gpu::texels`). Every value is mixed
// here, in linear light, from whole texels: what a sampler's own arithmetic would make of them no judge could tell.
//@ use common/draws

@group(0) @binding(32) var texels: texture_2d_array<u32>;

// Words before the records: linear light of every byte.
const TEXELS_RECORDS = 256u;
const TEXELS_RECORD = 30u; // words of a primitive's record: its paint,
const TEXELS_PAINT = 6u;
const TEXELS_LOOKUP = 12u; // and how its base colour and its emission are looked up
const DRAW_PRIMITIVE = 8u; // bits of a draw's flags from which its primitive is told

// The material of a primitive.
struct Paint {
    flags: u32,
    red: f32,      // emitted light
    green: f32,
    blue: f32,
    alpha_threshold: u32,  // that is drawn, in 2^-16 of a byte's step
    first_corner: u32, // word of the first vertex's place in the image that masks it, in 1/256 of a texel, two words each
}

const PAINT_BASE_TEXTURE = 1u;
const PAINT_EMISSION_TEXTURE = 2u;
const PAINT_UNLIT = 4u;
const PAINT_MASKED = 8u;

// How a texture is looked up.
struct Lookup {
    levels: u32,   // word of the list of words where the image's levels begin, the largest first
    size: u32,     // width, and height in bits 16 and up
    sampling: u32, // wrap across in bits 0 and 1, down in 2 and 3; linear where magnified in 4, minified in 5; copies in 6 and 7; levels from 8 on
    format: u32,   // coordinates as the file has them (common/pull)
    offset: u32,
    stride: u32,
    u_per_u: f32,  // what takes them to the image's, whose edges are 0 and 1
    u_per_v: f32,
    u_offset: f32,
    v_per_u: f32,
    v_per_v: f32,
    v_offset: f32,
}

const WRAP_MIRRORED = 1u;
const WRAP_CLAMP = 2u;
const COPIES_NEAREST = 1u;
const COPIES_MIXED = 2u;

// A word by its place: 4096 a line, 4096 lines a layer.
fn texels_word(place: u32) -> u32 {
    return textureLoad(texels, vec2u(place & 4095u, (place >> 12u) & 4095u), place >> 24u, 0).x;
}

fn texels_float(place: u32) -> f32 { return bitcast<f32>(texels_word(place)); }

fn texels_paint(place: u32) -> Paint {
    return Paint(
        texels_word(place), texels_float(place + 1u), texels_float(place + 2u), texels_float(place + 3u),
        texels_word(place + 4u), texels_word(place + 5u));
}

// Word of the record of a draw's primitive.
fn texels_record(draw: u32) -> u32 {
    return TEXELS_RECORDS + TEXELS_RECORD * (draws[draw].flags >> DRAW_PRIMITIVE);
}

fn texels_lookup(place: u32) -> Lookup {
    return Lookup(
        texels_word(place), texels_word(place + 1u), texels_word(place + 2u), texels_word(place + 3u),
        texels_word(place + 4u), texels_word(place + 5u), texels_float(place + 6u), texels_float(place + 7u),
        texels_float(place + 8u), texels_float(place + 9u), texels_float(place + 10u), texels_float(place + 11u));
}

// Place of a texel along a side, wherever it is asked for.
fn texels_wrapped(at: i32, side: i32, wrap: u32) -> i32 {
    if wrap == WRAP_CLAMP { return clamp(at, 0, side - 1); }
    let period = select(side, 2 * side, wrap == WRAP_MIRRORED);
    let within = ((at % period) + period) % period;
    return select(within, period - 1 - within, within >= side);
}

// Linear RGB of a texel of a level that begins at word `first`.
fn texels_light(look: Lookup, first: u32, size: vec2i, at: vec2i) -> vec3f {
    let x = texels_wrapped(at.x, size.x, look.sampling & 3u);
    let y = texels_wrapped(at.y, size.y, (look.sampling >> 2u) & 3u);
    let texel = texels_word(first + u32(y * size.x + x));
    return vec3f(texels_float(texel & 255u), texels_float((texel >> 8u) & 255u), texels_float((texel >> 16u) & 255u));
}

// Linear RGB at a place of the image, in one of its levels.
fn texels_level(look: Lookup, level: u32, place: vec2f, is_linear: bool) -> vec3f {
    let first = texels_word(look.levels + level);
    let size = max(vec2u(look.size & 0xffffu, look.size >> 16u) >> vec2u(level), vec2u(1u));
    // Held where it is a number: what no pixel shows may be none.
    let at = clamp(place * vec2f(size), vec2f(-1073741824.0), vec2f(1073741824.0));
    if !is_linear { return texels_light(look, first, vec2i(size), vec2i(floor(at))); }
    let low = floor(at - 0.5);
    let part = at - 0.5 - low;
    let corner = vec2i(low);
    let above = mix(texels_light(look, first, vec2i(size), corner), texels_light(look, first, vec2i(size), corner + vec2i(1, 0)), part.x);
    let below = mix(
        texels_light(look, first, vec2i(size), corner + vec2i(0, 1)), texels_light(look, first, vec2i(size), corner + vec2i(1, 1)), part.x);
    return mix(above, below, part.y);
}

// Linear RGB at a place, where a pixel spans 2^detail texels of the largest level.
fn texels_seen(look: Lookup, place: vec2f, detail: f32) -> vec3f {
    if !(detail > 0.0) { return texels_level(look, 0u, place, ((look.sampling >> 4u) & 1u) != 0u); }
    let is_linear = ((look.sampling >> 5u) & 1u) != 0u;
    let copies = (look.sampling >> 6u) & 3u;
    let last = f32((look.sampling >> 8u) - 1u);
    if copies == COPIES_NEAREST { return texels_level(look, u32(min(floor(detail + 0.5), last)), place, is_linear); }
    let low = min(floor(detail), last);
    if copies != COPIES_MIXED { return texels_level(look, 0u, place, is_linear); }
    let nearer = texels_level(look, u32(low), place, is_linear);
    if low >= last { return nearer; }
    return mix(nearer, texels_level(look, u32(low) + 1u, place, is_linear), detail - low);
}
