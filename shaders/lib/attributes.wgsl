// Vertex attributes, pulled from the bytes of the file by offset, stride and component type.
// Format word: component type - 5120 in bits 0 to 2 (glTF's numbers), normalized in bit 3, component count from bit 8 on.
//@ use lib/triangle
//@ use variants/draw_records
//@ use variants/loads

const PULL_I8 = 0u;
const PULL_U8 = 1u;
const PULL_I16 = 2u;
const PULL_U16 = 3u;
const PULL_U32 = 5u;
const PULL_F32 = 6u;
const PULL_NORMALIZED = 8u;

// Bytes of a component.
fn pull_bytes(format: u32) -> u32 {
    let component = format & 7u;
    return select(select(1u, 2u, component >= PULL_I16), 4u, component >= PULL_U32);
}

// One component as a float; the bits of an f32 component do not change.
fn pull_component(format: u32, byte: u32) -> f32 {
    let word = load_word(byte / 4u);
    let component = format & 7u;
    if component == PULL_F32 { return bitcast<f32>(word); }
    let shift = (byte % 4u) * 8u;
    var value = f32(word);
    var one = 4294967295.0;
    switch component {
        case PULL_I8: { value = f32(extractBits(bitcast<i32>(word), shift, 8u)); one = 127.0; }
        case PULL_U8: { value = f32(extractBits(word, shift, 8u)); one = 255.0; }
        case PULL_I16: { value = f32(extractBits(bitcast<i32>(word), shift, 16u)); one = 32767.0; }
        case PULL_U16: { value = f32(extractBits(word, shift, 16u)); one = 65535.0; }
        default: {}
    }
    return select(value, max(value / one, -1.0), (format & PULL_NORMALIZED) != 0u);
}

fn pull_vec3(format: u32, byte: u32) -> vec3f {
    let step = pull_bytes(format);
    return vec3f(pull_component(format, byte), pull_component(format, byte + step), pull_component(format, byte + 2u * step));
}

// Three components as bits, so that NaN and infinity can be detected before any arithmetic.
fn pull_bits3(format: u32, byte: u32) -> vec3u {
    return bitcast<vec3u>(pull_vec3(format, byte));
}

// Class of three floats given by their bits: VERTEX_NONFINITE, VERTEX_OUT_OF_RANGE (a magnitude of 2^40 or more), or 0.
fn bit_class(bits: vec3u) -> u32 {
    let exponents = (bits >> vec3u(23u)) & vec3u(255u);
    let nonfinite = any(exponents == vec3u(255u));
    let beyond = any(exponents >= vec3u(167u));
    return select(select(0u, VERTEX_OUT_OF_RANGE, beyond), VERTEX_NONFINITE, nonfinite);
}

// The exponent of a float; all its bits are set in NaN and infinity.
const FLOAT_EXPONENT = 0x7f800000u;

// Floats from their bits: subnormal components are 0, and so are all components of a rejected class.
fn floats_of_class(bits: vec3u, class_of_bits: u32) -> vec3f {
    let is_zero = (bits & vec3u(FLOAT_EXPONENT)) == vec3u(0u);
    return select(bitcast<vec3f>(bits), vec3f(0.0), is_zero | vec3<bool>((class_of_bits & VERTEX_REJECTED) != 0u));
}

// Every draw's positions are f32, as core glTF demands.
override F32_POSITIONS: bool = false;
// Bits per component of packed positions, 10 or 16; 0 where positions are stored as in the file.
override PACKED_POSITION_BITS: u32 = 0u;

// Object-space position of a vertex as bits; NaN or 2^40 and more in a component where it is rejected.
fn position_bits(draw: u32, vertex: u32) -> vec3u {
    if PACKED_POSITION_BITS == 10u { return position_packed10(draw, vertex); }
    if PACKED_POSITION_BITS == 16u { return position_packed16(draw, vertex); }
    let positions = draw_positions(draw);
    let byte = positions.offset + vertex * positions.stride;
    if F32_POSITIONS {
        return load_words3(byte / 4u);
    }
    return pull_bits3(positions.format, byte);
}

// Rejected components of packed positions: NaN, and 2^127.
const POSITION_NAN = 0x7fc00000u;
const POSITION_OUT_OF_RANGE = 0x7f000000u;

// One word per vertex: ten bits per component, x lowest, in steps of the primitive's box. The two bits above tell that the
// file's position is rejected: 1 for NaN or infinity, 2 for out of range.
fn position_packed10(draw: u32, vertex: u32) -> vec3u {
    let word = load_word(draw_positions(draw).offset / 4u + vertex);
    let steps = vec3f((vec3u(word) >> vec3u(0u, 10u, 20u)) & vec3u(1023u));
    let position = draw_origin(draw) + draw_step(draw) * steps;
    let rejected = select(POSITION_OUT_OF_RANGE, POSITION_NAN, (word & 0x40000000u) != 0u);
    return select(bitcast<vec3u>(position), vec3u(rejected), vec3<bool>((word >> 30u) != 0u));
}

// Two words per vertex: sixteen bits per component, in steps of the primitive's box. The upper half of the second word tells
// that the file's position is rejected, as above.
fn position_packed16(draw: u32, vertex: u32) -> vec3u {
    let at = draw_positions(draw).offset / 4u + 2u * vertex;
    let words = vec2u(load_word(at), load_word(at + 1u));
    let steps = vec3f(vec3u(words.x & 0xffffu, words.x >> 16u, words.y & 0xffffu));
    let position = draw_origin(draw) + draw_step(draw) * steps;
    let rejected = select(POSITION_OUT_OF_RANGE, POSITION_NAN, (words.y & 0x10000u) != 0u);
    return select(bitcast<vec3u>(position), vec3u(rejected), vec3<bool>((words.y >> 16u) != 0u));
}

// Every draw's normals are f32.
override F32_NORMALS: bool = false;

// A stored normal, as bits.
fn normal_bits(draw: u32, vertex: u32) -> vec3u {
    let normals = draw_normals(draw);
    let byte = normals.offset + vertex * normals.stride;
    if F32_NORMALS {
        return load_words3(byte / 4u);
    }
    return pull_bits3(normals.format, byte);
}

// A normal from its bits; w is 0 where a component is not finite or 2^40 and more.
fn normal_from_bits(bits: vec3u) -> vec4f {
    let class_of_bits = bit_class(bits);
    return vec4f(floats_of_class(bits, class_of_bits), select(0.0, 1.0, class_of_bits == 0u));
}

// Some draw has vertex colors.
override HAS_COLORS: bool = false;

// Color of a vertex, RGBA; white where a component is not finite or 2^40 and more.
fn vertex_color(draw: u32, vertex: u32) -> vec4f {
    let colors = draw_colors(draw);
    let format = colors.format;
    if !HAS_COLORS || format == 0u { return vec4f(1.0); }
    let byte = colors.offset + vertex * colors.stride;
    let rgb = pull_vec3(format, byte);
    let alpha = select(1.0, pull_component(format, byte + 3u * pull_bytes(format)), (format >> 8u) == 4u);
    let bits = bitcast<vec4u>(vec4f(rgb, alpha));
    let class_of_bits = bit_class(bits.rgb) | bit_class(bits.aaa);
    return select(
        vec4f(1.0), vec4f(floats_of_class(bits.rgb, class_of_bits), floats_of_class(bits.aaa, class_of_bits).x), class_of_bits == 0u);
}
