// Ruffle: every triangle rises like a scale or a feather, in waves that run over the model.
//
// A vertex effect sees one corner at a time, but it knows the triangle: its plane, its center, and the arm from there to the corner.
// Corners in the direction of growth are lifted and drawn out, the others stay, and so a triangle becomes a scale.
//@ use lib/vertex
//@ use lib/angle
//@ use lib/hash

struct Ruffle {
    /// Direction in which the scales point.
    @point(-0.6, -0.8, 0.0) @hard(-1, 1) growth: vec4f,
    /// How far the tips rise from the surface.
    @range(0.0, 0.3, 0.06) @hard(0.0, 10.0) @unit(m) lift_m: f32,
    /// How far the tips are drawn out over the next scale.
    @range(0.0, 0.3, 0.05) @hard(0.0, 10.0) @unit(m) length_m: f32,
    /// Distance from wave to wave, meters. Not @unit(m): that is for lengths by which a vertex moves.
    @range(0.1, 5.0, 1.4) @hard(0.01, 1000.0) @log wave: f32,
    /// Where the waves stand. One turn is one wave.
    @range(0.0, 1.0, 0.0) phase: f32,
    /// How much the scales differ from each other.
    @range(0.0, 1.0, 0.3) unrest: f32,
    /// Triangles whose corners lie farther from their center stay as they are: walls and floors.
    @range(1.0, 100.0, 20.0) @hard(0.0, 10000.0) @unit(cm) @log coarsest_cm: f32,
}

fn ruffle(vertex: Vertex, p: Ruffle) -> Vertex {
    var v = vertex;
    if length(v.arm) * 100.0 > p.coarsest_cm { return v; }
    let growth = unit(p.growth.xyz, vec3f(0.0, -1.0, 0.0));
    // 0 at the root of the scale, 1 at its tip. Two corners of most triangles are roots.
    let tip = smoothstep(0.1, 0.9, dot(unit(v.arm, vec3f(0.0)), growth));
    // The wave is taken at the center, so that all corners of a triangle agree.
    let wave = 0.5 + 0.5 * sine_turns(dot(v.center, growth) / p.wave - p.phase);
    let own = 1.0 - p.unrest * hash_unit(v.triangle);
    let rise = p.lift_m * tip * (0.25 + 0.75 * wave) * own;
    // Growth along the surface: the part of the direction that lies in the triangle's plane.
    let along = growth - v.flat_normal * dot(growth, v.flat_normal);
    v.offset += v.flat_normal * rise + along * (p.length_m * tip * own);
    return v;
}

// Direction of `v`; `otherwise` where it has none. Dividing by the largest component first keeps the square from vanishing.
fn unit(v: vec3f, otherwise: vec3f) -> vec3f {
    let largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
    if !(largest > 0.0) { return otherwise; }
    return normalize(v / largest);
}
