// The draw order: after how many samples drawing stops. Written by the passes that count samples, read as a uniform by the
// raster passes. Mirrors `gpu::records::OrderRecord`.
//@ use lib/frame

struct Order {
    boundary_triangle: u32,   // id of the boundary triangle: triangles before it are drawn, later ones are not
    cut: u32,         // of the boundary triangle's samples, those at pixels before this one are drawn, counted row by row
    limit_hi: u32,    // samples to draw, a 64-bit number as are those below
    limit_lo: u32,
    total_hi: u32,    // samples of all triangles
    total_lo: u32,
    before_hi: u32,   // samples of the triangles before the boundary triangle
    before_lo: u32,
    drawn_hi: u32,    // samples drawn
    drawn_lo: u32,
    spare_0: u32,
    spare_1: u32,
}

const ORDER_BLOCK = 1024u; // triangles in a block whose samples are summed

// Words of the bits, one for each pixel, that mark the samples of the boundary triangle.
fn order_bit_words() -> u32 {
    return (frame.size.x * frame.size.y + 31u) / 32u;
}
