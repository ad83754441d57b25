// Type: cuts the picture into a checkered pattern of holes.
//
// A sample effect says whether a sample of a triangle is drawn. Its inputs are
// integers, so that every adapter decides alike; compute with integers wherever
// you can. docs/effects.md lists the members of `Sample`.
//@ use lib/sample

struct Type {
    /// Side of a square.
    @range(1, 64, 8) @unit(px) side_px: u32,
    /// Draws the other squares.
    @toggle(0) invert: u32,
}

fn NAME(sample: Sample, p: Type) -> bool {
    let square = sample.at / vec2u(p.side_px);
    return ((square.x + square.y + p.invert) & 1u) == 0u;
}
