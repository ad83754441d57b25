// Particles: the state of one and the steps that it takes, as crates/model/src/effects/particles.rs defines them. `c` is the index of a step's
// parameters. Mirrors `gpu::records::{ParticleStepUniform, StepParams}`.
//@ use lib/fixed
//@ use lib/hash
//@ use effects/particles
//@ use variants/curl
//@ use glue/particle_step

struct ParticleStep {
    right: vec4f,      // unit axes of the picture plane, in the scene
    up: vec4f,
    toward: vec4f,     // towards the viewer, unit length, in the scene
    count: u32,
    first_frame: u32,  // whose particle states are stored
    last_frame: u32,   // the frame to simulate
    steps: u32,        // steps that have parameters of their own; all later steps use the last one's
    target_word: u32,  // first word of the particle discs in `vertex_bytes`
    is_fresh: u32,     // no states are stored: begin in frame 0
}

struct StepParams {
    p: Particles,
    life_steps: u32,   // longest life
    life_chance: u32,  // steps of it that vary at random
    step_s: f32,
    spare: u32,
}

// Behind the parameters of the steps, the parameters with which particles are drawn.
@group(0) @binding(21) var<storage, read> step_params: array<StepParams>;

// Index of the parameters of the step that leads to a frame.
fn step_params_of(frame_number: u32) -> u32 {
    return min(max(frame_number, 1u), particle_step.steps) - 1u;
}

struct ParticleState {
    position: vec3f,
    velocity: vec3f,
    age: u32,     // steps
    births: u32,
}

const PARTICLE_BALL = 1073741824u; // 2^30, the squared radius of the ball in which particles are born

fn particle_seed(c: u32, id: u32, births: u32) -> u32 {
    return hash(hash(hash(step_params[c].p.seed) + id) ^ births);
}

// Length of a life in steps, at least 1.
fn particle_life(c: u32, seed: u32) -> u32 {
    return step_params[c].life_steps - fixed_umul(hash(seed + 12u), step_params[c].life_chance + 1u).hi;
}

fn particle_born(c: u32, id: u32, births: u32) -> ParticleState {
    let seed = particle_seed(c, id, births);
    var at: vec3i;
    for (var attempt = 0u; attempt < 6u; attempt += 1u) {
        let xy = hash(seed + 2u * attempt);
        let z = hash(seed + 2u * attempt + 1u);
        at = vec3i(vec3u(xy & 0xffffu, xy >> 16u, z & 0xffffu)) - 32768;
        let squares = vec3u(at * at);
        if squares.x + squares.y + squares.z <= PARTICLE_BALL { break; }
        if attempt == 5u { at /= 2; }
    }
    let room = vec3f(step_params[c].p.room_m);
    let offset = clamp(vec3f(at) / 32768.0 * step_params[c].p.half_axes.xyz, -room, room);
    return ParticleState(step_params[c].p.center.xyz + offset, vec3f(0.0), 0u, births);
}

// The state in frame 0, where particles already have different ages.
fn particle_first(c: u32, id: u32) -> ParticleState {
    var f = particle_born(c, id, 0u);
    let seed = particle_seed(c, id, 0u);
    f.age = fixed_umul(hash(seed + 13u), particle_life(c, seed)).hi;
    return f;
}

fn particle_stepped(c: u32, id: u32, f: ParticleState, step: u32) -> ParticleState {
    if f.age + 1u >= particle_life(c, particle_seed(c, id, f.births)) { return particle_born(c, id, f.births + 1u); }
    let dt = step_params[c].step_s;
    let away = step_params[c].p.attractor.xyz - f.position;
    let r = step_params[c].p.attractor_m;
    let pull = step_params[c].p.attraction * 2.0 * r / (dot(away, away) + r * r) * away;
    let carried = step_params[c].p.drag * particle_flow(c, f.position, step);
    let velocity = (f.velocity + dt * (carried + pull)) / (1.0 + dt * step_params[c].p.drag);
    let position = f.position + dt * velocity;
    if any(abs(position - step_params[c].p.center.xyz) > vec3f(step_params[c].p.room_m)) { return particle_born(c, id, f.births + 1u); }
    return ParticleState(position, velocity, f.age + 1u, f.births);
}

// Velocity of the flow at a position: octaves of curl noise.
fn particle_flow(c: u32, position: vec3f, step: u32) -> vec3f {
    let drift = f32(step) * step_params[c].step_s * step_params[c].p.evolve * vec3f(0.25, -0.5, 0.375);
    let salt = hash(step_params[c].p.seed ^ HASH_GOLDEN);
    var q = position / step_params[c].p.swirl_m;
    var flow = vec3f(0.0);
    var amplitude = 1.0;
    var amplitudes = 0.0;
    for (var octave = 0u; octave < step_params[c].p.octaves; octave += 1u) {
        flow += amplitude * curl_noise(q + f32(octave + 1u) * vec3f(0.3125, 0.4375, 0.71875) + drift, salt + octave);
        amplitudes += amplitude;
        amplitude *= step_params[c].p.persistence;
        q *= 2.0;
    }
    return 0.625 * step_params[c].p.speed_mps / amplitudes * flow;
}
