// Positions, stored: pulled from the bytes of the file, whatever their format, with f32 lanes as they are.
//@ use common/draws
//@ use common/pull

// Every draw's positions are f32, as glTF's core demands.
override F32_POSITIONS: bool = false;

fn positions_bits(draw: u32, vertex: u32) -> vec3u {
    let byte = draws[draw].position_offset + vertex * draws[draw].position_stride;
    if F32_POSITIONS {
        let word = byte / 4u;
        return vec3u(vertex_bytes[word], vertex_bytes[word + 1u], vertex_bytes[word + 2u]);
    }
    return pull_bits3(draws[draw].position_format, byte);
}
