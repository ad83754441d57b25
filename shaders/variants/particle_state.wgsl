// Particle states: how they are stored between frames. States of even frames come first, then those of odd frames.
// Chosen by the accuracy axis `particle_storage`. Default: float32.
//
//@ declare fn state_load(frame_number: u32, id: u32) -> ParticleState
//@ declare fn state_store(frame_number: u32, id: u32, f: ParticleState)
// A state after it has been stored and loaded.
//@ declare fn state_rounded(frame_number: u32, f: ParticleState) -> ParticleState

//@ variant float32
// Eight words per particle, every number unchanged.
//@ use lib/particle

@group(0) @binding(19) var<storage, read_write> particle_states: array<vec4u>;

fn state_load(frame_number: u32, id: u32) -> ParticleState {
    let at = 2u * ((frame_number & 1u) * particle_step.count + id);
    let position = particle_states[at];
    let motion = particle_states[at + 1u];
    return ParticleState(bitcast<vec3f>(position.xyz), bitcast<vec3f>(motion.xyz), position.w, motion.w);
}

fn state_store(frame_number: u32, id: u32, f: ParticleState) {
    let at = 2u * ((frame_number & 1u) * particle_step.count + id);
    particle_states[at] = vec4u(bitcast<vec3u>(f.position), f.age);
    particle_states[at + 1u] = vec4u(bitcast<vec3u>(f.velocity), f.births);
}

fn state_rounded(frame_number: u32, f: ParticleState) -> ParticleState {
    return f;
}

//@ variant half16
// Four words per particle. Positions are fractions of the room's half width, velocities are half floats.
//@ use lib/particle

@group(0) @binding(19) var<storage, read_write> particle_states: array<vec4u>;

fn state_load(frame_number: u32, id: u32) -> ParticleState {
    return state_unpacked(frame_number, particle_states[(frame_number & 1u) * particle_step.count + id]);
}

fn state_store(frame_number: u32, id: u32, f: ParticleState) {
    particle_states[(frame_number & 1u) * particle_step.count + id] = state_packed(frame_number, f);
}

fn state_rounded(frame_number: u32, f: ParticleState) -> ParticleState {
    return state_unpacked(frame_number, state_packed(frame_number, f));
}

fn state_packed(frame_number: u32, f: ParticleState) -> vec4u {
    let c = step_params_of(frame_number);
    let at = (f.position - step_params[c].p.center.xyz) / step_params[c].p.room_m;
    let v = state_halves(f.velocity);
    return vec4u(
        pack2x16snorm(at.xy),
        (pack2x16snorm(vec2f(at.z, 0.0)) & 0xffffu) | (f.age << 16u),
        v.x | (v.y << 16u),
        v.z | (f.births << 16u));
}

fn state_unpacked(frame_number: u32, words: vec4u) -> ParticleState {
    let c = step_params_of(frame_number);
    let at = vec3f(unpack2x16snorm(words.x), unpack2x16snorm(words.y).x);
    let v = state_floats(vec3u(words.z, words.z >> 16u, words.w));
    return ParticleState(step_params[c].p.center.xyz + step_params[c].p.room_m * at, v, words.y >> 16u, words.w >> 16u);
}

const HALF_LARGEST = 0x477fe000u;   // bits of 65504 as a float
const HALF_LEAST = 0x38801000u;     // bits of 2^-14, rounded as below
const HALF_REBIAS = 0x38000000u;    // a float's exponent is 112 more than a half float's
const HALF_ROUNDING = 0x1000u;      // half of a half float's last bit

// Floats as half floats, rounded to nearest; those below 2^-14 are 0, and none is infinite.
fn state_halves(v: vec3f) -> vec3u {
    let bits = bitcast<vec3u>(v);
    let size = min(bits & vec3u(0x7fffffffu), vec3u(HALF_LARGEST)) + vec3u(HALF_ROUNDING);
    let half = select((size - vec3u(HALF_REBIAS)) >> vec3u(13u), vec3u(0u), size < vec3u(HALF_LEAST));
    return ((bits >> vec3u(16u)) & vec3u(0x8000u)) | half;
}

fn state_floats(halves: vec3u) -> vec3f {
    let size = halves & vec3u(0x7fffu);
    let bits = select((size << vec3u(13u)) + vec3u(HALF_REBIAS), vec3u(0u), size == vec3u(0u));
    return bitcast<vec3f>(((halves & vec3u(0x8000u)) << vec3u(16u)) | bits);
}
