// The material atlas: images, and the records of materials that look them up, as words of one texture (`gpu::material_atlas`). Values
// are filtered here, in linear light, from whole texels: the arithmetic of hardware samplers is not specified, so the oracle
// could not check it. Mirrors `gpu::records::{MaterialRecord, LookupRecord}`.
//@ use lib/triangle

@group(0) @binding(32) var material_atlas: texture_2d_array<u32>;

// Words before the records: linear light of every byte value.
const ATLAS_RECORDS = 256u;
const ATLAS_RECORD = 30u;   // words per primitive: its material,
const ATLAS_MATERIAL = 6u;
const ATLAS_LOOKUP = 12u;   // and the lookups of its base color and its emission

// The material of a primitive.
struct Material {
    flags: u32,        // MATERIAL_* bits
    red: f32,          // emitted light
    green: f32,
    blue: f32,
    alpha_threshold: u32, // least alpha that is drawn, in 2^-16 of a byte's step
    first_corner: u32, // word of the first vertex's position in the image of the alpha mask: two words each, in 1/256 of a texel
}

const MATERIAL_BASE_TEXTURE = 1u;
const MATERIAL_EMISSION_TEXTURE = 2u;
const MATERIAL_UNLIT = 4u;
const MATERIAL_MASKED = 8u;

// How a texture is looked up.
struct Lookup {
    levels: u32,   // word of the list of the first words of its levels, the largest level first
    size: u32,     // width, and height from bit 16 on
    sampling: u32, // wrap mode of u in bits 0 and 1, of v in 2 and 3; linear magnification in 4, minification in 5; mip filter in 6 and 7; levels from bit 8 on
    format: u32,   // of the texture coordinates: format word of lib/attributes
    offset: u32,
    stride: u32,
    u_per_u: f32,  // transform from the file's coordinates to the image's, whose edges are 0 and 1
    u_per_v: f32,
    u_offset: f32,
    v_per_u: f32,
    v_per_v: f32,
    v_offset: f32,
}

const WRAP_MIRRORED = 1u;
const WRAP_CLAMP = 2u;
const MIP_NEAREST = 1u;
const MIP_LINEAR = 2u;

// A word by its index: 4096 words in a row, 4096 rows in a layer.
fn atlas_word(index: u32) -> u32 {
    return textureLoad(material_atlas, vec2u(index & 4095u, (index >> 12u) & 4095u), index >> 24u, 0).x;
}

fn atlas_float(index: u32) -> f32 { return bitcast<f32>(atlas_word(index)); }

// Word of the record of a draw's primitive.
fn atlas_record(draw: u32) -> u32 {
    return ATLAS_RECORDS + ATLAS_RECORD * (draws[draw].flags >> DRAW_PRIMITIVE_SHIFT);
}

fn atlas_material(record: u32) -> Material {
    return Material(
        atlas_word(record), atlas_float(record + 1u), atlas_float(record + 2u), atlas_float(record + 3u),
        atlas_word(record + 4u), atlas_word(record + 5u));
}

fn atlas_lookup(first: u32) -> Lookup {
    return Lookup(
        atlas_word(first), atlas_word(first + 1u), atlas_word(first + 2u), atlas_word(first + 3u),
        atlas_word(first + 4u), atlas_word(first + 5u), atlas_float(first + 6u), atlas_float(first + 7u),
        atlas_float(first + 8u), atlas_float(first + 9u), atlas_float(first + 10u), atlas_float(first + 11u));
}

// A texel coordinate brought into 0..side by the wrap mode.
fn atlas_wrapped(at: i32, side: i32, wrap: u32) -> i32 {
    if wrap == WRAP_CLAMP { return clamp(at, 0, side - 1); }
    let period = select(side, 2 * side, wrap == WRAP_MIRRORED);
    let within = ((at % period) + period) % period;
    return select(within, period - 1 - within, within >= side);
}

// Linear RGBA of a texel of a level that begins at word `first`, of a color or of data.
fn atlas_texel(lookup: Lookup, first: u32, size: vec2i, at: vec2i, is_color: bool) -> vec4f {
    let x = atlas_wrapped(at.x, size.x, lookup.sampling & 3u);
    let y = atlas_wrapped(at.y, size.y, (lookup.sampling >> 2u) & 3u);
    let texel = atlas_word(first + u32(y * size.x + x));
    let data = vec4f((vec4u(texel) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u)) / 255.0;
    if !is_color { return data; }
    return vec4f(atlas_float(texel & 255u), atlas_float((texel >> 8u) & 255u), atlas_float((texel >> 16u) & 255u), data.a);
}

// Linear RGBA at texture coordinates, from one level.
fn atlas_level(lookup: Lookup, level: u32, uv: vec2f, is_linear: bool, is_color: bool) -> vec4f {
    let first = atlas_word(lookup.levels + level);
    let size = max(vec2u(lookup.size & 0xffffu, lookup.size >> 16u) >> vec2u(level), vec2u(1u));
    // Clamped so that pixels which are computed but not shown cannot overflow.
    let at = clamp(uv * vec2f(size), vec2f(-1073741824.0), vec2f(1073741824.0));
    if !is_linear { return atlas_texel(lookup, first, vec2i(size), vec2i(floor(at)), is_color); }
    let low = floor(at - 0.5);
    let fraction = at - 0.5 - low;
    let corner = vec2i(low);
    let above = mix(
        atlas_texel(lookup, first, vec2i(size), corner, is_color),
        atlas_texel(lookup, first, vec2i(size), corner + vec2i(1, 0), is_color), fraction.x);
    let below = mix(
        atlas_texel(lookup, first, vec2i(size), corner + vec2i(0, 1), is_color),
        atlas_texel(lookup, first, vec2i(size), corner + vec2i(1, 1), is_color), fraction.x);
    return mix(above, below, fraction.y);
}

// Linear RGBA at texture coordinates, where a pixel spans 2^detail texels of the largest level.
fn atlas_filtered(lookup: Lookup, uv: vec2f, detail: f32, is_color: bool) -> vec4f {
    if !(detail > 0.0) { return atlas_level(lookup, 0u, uv, ((lookup.sampling >> 4u) & 1u) != 0u, is_color); }
    let is_linear = ((lookup.sampling >> 5u) & 1u) != 0u;
    let mip_filter = (lookup.sampling >> 6u) & 3u;
    let last = f32((lookup.sampling >> 8u) - 1u);
    if mip_filter == MIP_NEAREST { return atlas_level(lookup, u32(min(floor(detail + 0.5), last)), uv, is_linear, is_color); }
    let low = min(floor(detail), last);
    if mip_filter != MIP_LINEAR { return atlas_level(lookup, 0u, uv, is_linear, is_color); }
    let nearer = atlas_level(lookup, u32(low), uv, is_linear, is_color);
    if low >= last { return nearer; }
    return mix(nearer, atlas_level(lookup, u32(low) + 1u, uv, is_linear, is_color), detail - low);
}
