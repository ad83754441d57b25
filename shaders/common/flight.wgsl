// ParticleState: where a particle is and how it goes on, as src/effects/particles.rs says it. `c` is the step's place in `course`.
//@ use common/course
//@ use common/fixed
//@ use common/hash
//@ use slot/curl

struct ParticleState {
    place: vec3f,
    velocity: vec3f,
    age: u32,     // steps
    births: u32,
}

const FLIGHT_BALL = 1073741824u; // 2^30, the squared radius of the ball of births

fn flight_base(c: u32, id: u32, births: u32) -> u32 {
    return hash(hash(hash(step_params[c].p.seed) + id) ^ births);
}

// Length of a life in steps, at least 1.
fn flight_life(c: u32, base: u32) -> u32 {
    return step_params[c].life_steps - fixed_umul(hash(base + 12u), step_params[c].life_chance + 1u).hi;
}

fn flight_born(c: u32, id: u32, births: u32) -> ParticleState {
    let base = flight_base(c, id, births);
    var at: vec3i;
    for (var attempt = 0u; attempt < 6u; attempt += 1u) {
        let xy = hash(base + 2u * attempt);
        let z = hash(base + 2u * attempt + 1u);
        at = vec3i(vec3u(xy & 0xffffu, xy >> 16u, z & 0xffffu)) - 32768;
        let squares = vec3u(at * at);
        if squares.x + squares.y + squares.z <= FLIGHT_BALL { break; }
        if attempt == 5u { at /= 2; }
    }
    let room = vec3f(step_params[c].p.room_m);
    let offset = clamp(vec3f(at) / 32768.0 * step_params[c].p.half_axes.xyz, -room, room);
    return ParticleState(step_params[c].p.center.xyz + offset, vec3f(0.0), 0u, births);
}

// In frame 0 lives are already on their way.
fn flight_first(c: u32, id: u32) -> ParticleState {
    var f = flight_born(c, id, 0u);
    let base = flight_base(c, id, 0u);
    f.age = fixed_umul(hash(base + 13u), flight_life(c, base)).hi;
    return f;
}

fn flight_step(c: u32, id: u32, f: ParticleState, step: u32) -> ParticleState {
    if f.age + 1u >= flight_life(c, flight_base(c, id, f.births)) { return flight_born(c, id, f.births + 1u); }
    let dt = step_params[c].step_s;
    let away = step_params[c].p.attractor.xyz - f.place;
    let r = step_params[c].p.attractor_m;
    let pull = step_params[c].p.attraction * 2.0 * r / (dot(away, away) + r * r) * away;
    let carried = step_params[c].p.drag * flight_flow(c, f.place, step);
    let velocity = (f.velocity + dt * (carried + pull)) / (1.0 + dt * step_params[c].p.drag);
    let place = f.place + dt * velocity;
    if any(abs(place - step_params[c].p.center.xyz) > vec3f(step_params[c].p.room_m)) { return flight_born(c, id, f.births + 1u); }
    return ParticleState(place, velocity, f.age + 1u, f.births);
}

// Velocity of the flow.
fn flight_flow(c: u32, place: vec3f, step: u32) -> vec3f {
    let drift = f32(step) * step_params[c].step_s * step_params[c].p.evolve * vec3f(0.25, -0.5, 0.375);
    let salt = hash(step_params[c].p.seed ^ 0x9e3779b9u);
    var q = place / step_params[c].p.swirl_m;
    var flow = vec3f(0.0);
    var share = 1.0;
    var shares = 0.0;
    for (var octave = 0u; octave < step_params[c].p.octaves; octave += 1u) {
        flow += share * curl_of(q + f32(octave + 1u) * vec3f(0.3125, 0.4375, 0.71875) + drift, salt + octave);
        shares += share;
        share *= step_params[c].p.persistence;
        q *= 2.0;
    }
    return 0.625 * step_params[c].p.speed_mps / shares * flow;
}
