// Pulls attribute lanes straight from the bytes of the file, by offset, stride and component type.
// Format word: component type - 5120 in bits 0..2 (glTF's numbers), normalized in bit 3.
//@ use slot/bytes

const PULL_I8 = 0u;
const PULL_U8 = 1u;
const PULL_I16 = 2u;
const PULL_U16 = 3u;
const PULL_U32 = 5u;
const PULL_F32 = 6u;
const PULL_NORMALIZED = 8u;

fn pull_bytes(format: u32) -> u32 {
    let component = format & 7u;
    return select(select(1u, 2u, component >= PULL_I16), 4u, component >= PULL_U32);
}

// One lane as a float; an f32 lane with its bits unchanged.
fn pull_lane(format: u32, byte: u32) -> f32 {
    let word = vertex_bytes[byte / 4u];
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
    return vec3f(pull_lane(format, byte), pull_lane(format, byte + step), pull_lane(format, byte + 2u * step));
}

// Three f32 lanes as bits, so that NaN and infinity can be told apart before any arithmetic.
fn pull_bits3(format: u32, byte: u32) -> vec3u {
    return bitcast<vec3u>(pull_vec3(format, byte));
}

// A value whose exponent says NaN or infinity; floats may be assumed free of both, so ask the bits.
fn pull_is_finite(v: vec3f) -> bool {
    let exponents = bitcast<vec3u>(v) & vec3u(0x7f800000u);
    return all(exponents != vec3u(0x7f800000u));
}
