// Fetch, indexed: corners come from a list of u8, u16 or u32, as the file has it.
//@ use common/draws

@group(0) @binding(3) var<storage, read> index_bytes: array<u32>;

// All draws have u32 indices.
override U32_INDICES: bool = false;

// Vertex of the draw at `place` of its list; out of range is held to the last vertex.
fn fetch_vertex(draw: u32, place: u32) -> u32 {
    let first = draws[draw].index_offset;
    if U32_INDICES { return min(index_bytes[first / 4u + place], draws[draw].vertex_count - 1u); }
    let bytes = draws[draw].index_format;
    if bytes == 0u { return place; }
    let byte = first + place * bytes;
    let index = extractBits(index_bytes[byte / 4u], (byte % 4u) * 8u, bytes * 8u);
    return min(index, draws[draw].vertex_count - 1u);
}
