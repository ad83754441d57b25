// Particle states: how they are stored between frames. States of even frames come first, then those of odd frames.
// Chosen by the accuracy axis `particle_storage`. Default: float32.
//
//@ declare fn state_load(frame_number: u32, id: u32) -> ParticleState
//@ declare fn state_store(frame_number: u32, id: u32, f: ParticleState)
// A state after it has been stored and loaded.
//@ declare fn state_rounded(frame_number: u32, f: ParticleState) -> ParticleState
