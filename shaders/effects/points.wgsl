// Points: draws the corners of triangles as discs.

struct Points {
    /// Diameter of the discs.
    @range(0.5, 16, 3) @hard(0, 64) @unit(px) size_px: f32,
}
