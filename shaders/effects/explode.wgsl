// Explode: triangles fly out along their own normals, turning about them and shrinking as they go.
//@ use lib/vertex
//@ use lib/front
//@ use lib/hash
//@ use lib/angle

struct Explode {
    spread: Front,
    amount_m: f32,
    scatter: f32,
    spin_turns: f32,
    shrink: f32,
}

// What the seed is multiplied by, so that triangles scatter by other hashes than those of the front.
const EXPLODE_SCATTER_SEED = 0x85ebca6bu;

fn explode(vertex: Vertex, p: Explode) -> Vertex {
    var v = vertex;
    let reached = front_reached(p.spread, v.center, v.center_screen, v.triangle);
    let progress = reached * (1.0 - p.scatter * hash_unit(v.triangle ^ (p.spread.seed * EXPLODE_SCATTER_SEED)));
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

// What a turn about the unit axis `n` adds to `r` (Rodrigues).
fn explode_turn(n: vec3f, r: vec3f, sine: f32, versine: f32) -> vec3f {
    let across = cross(n, r);
    return across * sine + cross(n, across) * versine;
}
