// Explode: triangles fly out along their own normals, turn and shrink.
//@ use lib/vertex
//@ use lib/front
//@ use lib/hash
//@ use lib/angle

struct Explode {
    /// How far a triangle flies along its normal; negative: inwards.
    @range(-1, 2, 0.3) @hard(-1000, 1000) @unit(m) amount_m: f32,
    /// How much the distances differ: at 0 all triangles move equally far, at 1 some do not move at all.
    @range(0, 1, 0) scatter: f32,
    /// Turns that a triangle makes about its normal on its path.
    @range(-1, 1, 0) @hard(-100, 100) @unit(turns) spin_turns: f32,
    /// Fraction of its size that a triangle loses on its path.
    @range(0, 1, 0) shrink: f32,
    /// Center of the radial front, world space.
    @point(0, 0, 0) @soft(-3, 3) @unit(m) @when(pattern, radial) center: vec4f,
    /// How the effect is spread over the triangles.
    @choice(uniform, sweep, radial, random) pattern: u32,
    /// Progress of the front: 0 before the first triangle, 1 past the last.
    @range(0, 1, 0.5) @when(pattern, sweep, random) front: f32,
    /// Softness of the front, as a fraction of its path.
    @range(0.001, 2, 0.5) @hard(0.001, 100) @log @when(pattern, sweep, random) width: f32,
    /// Direction of the sweep in the picture: part to the right.
    @range(-1, 1, 1) @when(pattern, sweep) along_x: f32,
    /// Direction of the sweep in the picture: part downwards.
    @range(-1, 1, 0) @when(pattern, sweep) along_y: f32,
    /// Distance of the front from the center.
    @range(0, 5, 1) @hard(0, 1e6) @unit(m) @when(pattern, radial) radius_m: f32,
    /// Thickness of the front.
    @range(0.01, 5, 0.5) @hard(0.001, 1e6) @unit(m) @log @when(pattern, radial) width_m: f32,
    /// Seed of everything random in the effect.
    @range(0, 999, 1) @hard(0, 4294967295) seed: u32,
}

// What the seed is multiplied by, so that triangles scatter by other hashes than those of the front.
const EXPLODE_SCATTER_SEED = 0x85ebca6bu;

fn explode(vertex: Vertex, p: Explode) -> Vertex {
    var v = vertex;
    let reached = front_reached(explode_front(p), v.center, v.center_screen, v.triangle);
    let progress = reached * (1.0 - p.scatter * hash_unit(v.triangle ^ (p.seed * EXPLODE_SCATTER_SEED)));
    let sine = sine_turns(p.spin_turns * progress);
    let half_sine = sine_turns(p.spin_turns * progress * 0.5);
    let versine = 2.0 * half_sine * half_sine; // 1 - cosine, without a difference
    let n = v.flat_normal;

    let arm = v.arm + v.offset;
    let turn = explode_turn(n, arm, sine, versine);
    v.offset += n * (p.amount_m * progress) + turn - (arm + turn) * (p.shrink * progress);
    v.normal += explode_turn(n, v.normal, sine, versine);
    return v;
}

// No corner is farther from its triangle's center than the model is wide, and a turn takes it at most twice as far.
@reach
fn explode_reach(radius_m: f32, p: Explode) -> f32 {
    let turned = select(2.0, 0.0, p.spin_turns == 0.0);
    return abs(p.amount_m) + (turned + p.shrink) * 2.0 * radius_m;
}

// What a turn about the unit axis `n` adds to `r` (Rodrigues).
fn explode_turn(n: vec3f, r: vec3f, sine: f32, versine: f32) -> vec3f {
    let across = cross(n, r);
    return across * sine + cross(n, across) * versine;
}

fn explode_front(p: Explode) -> Front {
    return Front(p.center, p.pattern, p.front, p.width, p.along_x, p.along_y, p.radius_m, p.width_m, p.seed);
}
