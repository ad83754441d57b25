// Wobble: a wave runs through the model and sways it.
//@ use lib/vertex
//@ use lib/angle

struct Wobble {
    /// Direction in which the wave runs, of any length.
    @point(0, 1, 0) @hard(-1000, 1000) @soft(-1, 1) direction: vec4f,
    /// Direction in which it sways the model, of any length.
    @point(1, 0, 0) @hard(-1000, 1000) @soft(-1, 1) sway: vec4f,
    /// How far it sways to either side.
    @range(0, 0.5, 0.08) @hard(0, 1000) @unit(m) amplitude_m: f32,
    /// Distance from one crest to the next.
    @range(0.05, 10, 1) @hard(0.001, 1e6) @unit(m) @log wavelength_m: f32,
    /// How far the wave has run, turns of one wavelength; 1 is 0 again.
    @range(0, 1, 0) @unit(turns) phase_turns: f32,
}

fn wobble(vertex: Vertex, p: Wobble) -> Vertex {
    var v = vertex;
    let direction = wobble_unit(p.direction.xyz, vec3f(0.0, 1.0, 0.0));
    let sway = wobble_unit(p.sway.xyz, vec3f(1.0, 0.0, 0.0));
    let turns = dot(v.position + v.offset, direction) / p.wavelength_m - p.phase_turns;
    v.offset += sway * (p.amplitude_m * sine_turns(turns));

    // The displacement changes along `direction` by `slope`; normals transform with the cofactors of its Jacobian, 1 + slope sway direction'.
    let slope = 6.283185307179586 * (p.amplitude_m / p.wavelength_m) * cosine_turns(turns);
    let turned = v.normal + (v.normal * dot(sway, direction) - direction * dot(sway, v.normal)) * slope;
    let squared = dot(turned, turned);
    if slope != 0.0 && squared > 1e-12 { v.normal = turned / sqrt(squared); }
    return v;
}

@reach
fn wobble_reach(p: Wobble) -> f32 {
    return p.amplitude_m;
}

// Direction of `v`; `otherwise` where it has none.
fn wobble_unit(v: vec3f, otherwise: vec3f) -> vec3f {
    let largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
    if !(largest > 0.0) { return otherwise; }
    return v / largest / length(v / largest);
}
