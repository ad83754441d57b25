// Strata: a world of cut paper, sheet upon sheet, whose coasts follow noise.
//
// Two hooks, one height: the vertex function raises the sheets, the surface function colors them. Both ask `height`, which depends on
// the direction from the center alone, and a vertex moves along that direction; so both find the same answer for the same place.
//@ use lib/vertex
//@ use lib/surface
//@ use lib/hash
//@ use lib/lattice

struct Strata {
    /// Color of the lowest sheet.
    @color(0.015, 0.05, 0.13) low: vec4f,
    /// Color of the sheets at the coast.
    @color(0.12, 0.42, 0.42) coast: vec4f,
    /// Color of the highest sheet.
    @color(0.95, 0.62, 0.38) high: vec4f,
    /// How far the highest sheet rises above the lowest.
    @range(0.0, 1.0, 0.24) @hard(0.0, 10.0) @unit(m) relief_m: f32,
    /// Number of sheets.
    @range(2, 32, 9) @hard(1, 64) sheets: u32,
    /// How many lands there are: cells of the noise along the radius.
    @range(0.5, 6.0, 1.6) @hard(0.1, 50.0) @log lands: f32,
    /// Another seed gives another world.
    @range(0, 999, 7) seed: u32,
}

// Smooth noise, about -1 to 1: random numbers at whole coordinates, blended by Perlin's curve, which has no kinks.
fn noise(at: vec3f, seed: u32) -> f32 {
    let cell = floor(at);
    let t = at - cell;
    let blend = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let corner = vec3u(vec3i(cell));
    var rows: array<f32, 4>;
    for (var i = 0u; i < 4u; i += 1u) {
        let column = hash(hash(corner.x + (i & 1u) + seed) + corner.y + (i >> 1u));
        let pair = lattice_pair(column, corner.z);
        rows[i] = mix(pair[0].x, pair[1].x, blend.z);
    }
    return mix(mix(rows[0], rows[1], blend.x), mix(rows[2], rows[3], blend.x), blend.y);
}

// Height in sheets, 0 to `sheets`, of the place in this direction.
fn height(toward: vec3f, p: Strata) -> f32 {
    let at = toward * p.lands + 7.0;
    let sum = noise(at, p.seed) + 0.5 * noise(at * 2.0, p.seed + 1u) + 0.22 * noise(at * 4.0, p.seed + 2u);
    return clamp(0.5 + 0.62 * sum, 0.0, 0.999) * f32(p.sheets);
}

fn strata_vertex(vertex: Vertex, p: Strata) -> Vertex {
    var v = vertex;
    let toward = normalize(v.position + vec3f(0.0, 1e-9, 0.0));
    let sheet = height(toward, p);
    // Flat on top, steep at the rim: a jump would be torn by rounding, a ramp is not.
    let level = floor(sheet) + smoothstep(0.0, 0.2, fract(sheet)) - 1.0;
    v.offset += toward * (p.relief_m * max(level, 0.0) / f32(p.sheets));
    return v;
}

fn strata_surface(surface: Surface, p: Strata) -> Surface {
    var s = surface;
    let sheet = height(normalize(s.position), p);
    let along = floor(sheet) / max(f32(p.sheets) - 1.0, 1.0);
    var paper = mix(p.low.rgb, p.coast.rgb, min(2.0 * along, 1.0));
    if along > 0.5 { paper = mix(p.coast.rgb, p.high.rgb, 2.0 * along - 1.0); }
    s.color = vec4f(paper, s.color.a);
    return s;
}
