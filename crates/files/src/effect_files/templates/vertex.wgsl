// Type: swells the model in rings that rise along y.
//
// A vertex effect moves the corners of triangles, in world space and meters. It
// changes `offset` and `normal` alone, and moves a vertex by at most the sum of
// its parameters in meters. docs/effects.md lists the members of `Vertex`.
//@ use lib/vertex

struct Type {
    /// How far the rings stand out.
    @range(0.0, 0.5, 0.05) @hard(0.0, 10.0) @unit(m) height_m: f32,
    /// Rings in a meter. Its unit is not m, so it does not count as a length.
    @range(0.05, 100.0, 2.5) @unit(per m) @log rings: f32,
    /// Where the rings begin, in turns.
    @range(0.0, 1.0, 0.0) phase: f32,
}

fn NAME(vertex: Vertex, p: Type) -> Vertex {
    var v = vertex;
    let turns = v.position.y * p.rings - p.phase;
    let wave = 0.5 - 0.5 * cos(6.2831853 * fract(turns));
    v.offset += v.normal * (p.height_m * wave);
    return v;
}
