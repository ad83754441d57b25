// Order: where the drawing stops. Written by the passes over the counts, read by the raster passes as a uniform.
// Mirror of `gpu::uniforms::OrderRecord`.

struct Order {
    straddler: u32,   // triangles before it are drawn, those behind it are not
    cut: u32,         // of its own samples, those before this pixel, counted row by row
    limit_hi: u32,    // samples to be drawn
    limit_lo: u32,
    total_hi: u32,    // samples that there are
    total_lo: u32,
    before_hi: u32,   // samples of the triangles before the straddler
    before_lo: u32,
    drawn_hi: u32,    // samples drawn: `before` and what lies before the cut
    drawn_lo: u32,
    spare_0: u32,
    spare_1: u32,
}
