// ClippedTriangles, kept: what clipping left of triangles; a queue entry may name one instead of a triangle.
//@ use common/triangle

struct ClippedTriangle {
    a: vec4u,
    b: vec4u,
    c: vec4u,
    parent: vec4u, // id of the clipped triangle, its draw, place in the fan, outline as in `Triangle`
}

const PIECES_ENTRY = 0x80000000u;

@group(0) @binding(9) var<storage, read> pieces: array<ClippedTriangle>;

// The triangle that a queue entry names.
fn pieces_load(entry: u32) -> Triangle {
    if (entry & PIECES_ENTRY) != 0u {
        let piece = pieces[entry & ~PIECES_ENTRY];
        let slot = entry & ~PIECES_ENTRY;
        return Triangle(piece.a, piece.b, piece.c, piece.parent.x, piece.parent.y, frame.triangle_count + slot, piece.parent.w);
    }
    return triangle_load(entry);
}
