// Particle states, float32: eight words per particle, every number unchanged.
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
