// State, float32: eight words a particle, every number as it is.
//@ use common/flight

@group(0) @binding(19) var<storage, read_write> particle_states: array<vec4u>;

// Flights of even frames come first, then those of odd ones.
fn state_load(frame_number: u32, id: u32) -> ParticleState {
    let at = 2u * ((frame_number & 1u) * particle_step.count + id);
    let place = particle_states[at];
    let motion = particle_states[at + 1u];
    return ParticleState(bitcast<vec3f>(place.xyz), bitcast<vec3f>(motion.xyz), place.w, motion.w);
}

fn state_store(frame_number: u32, id: u32, f: ParticleState) {
    let at = 2u * ((frame_number & 1u) * particle_step.count + id);
    particle_states[at] = vec4u(bitcast<vec3u>(f.place), f.age);
    particle_states[at + 1u] = vec4u(bitcast<vec3u>(f.velocity), f.births);
}

// A flight as it comes back from being kept.
fn state_kept(frame_number: u32, f: ParticleState) -> ParticleState {
    return f;
}
