// Points: draws the corners of triangles as discs instead of the triangles.

struct Points {
    size_px: f32,
}
