// StepParams: what every step of the particles goes by. Twins of `gpu::swarm::{ParticleStepUniform, StepParams}`.
//@ use effects/particles
//@ use common/frame

struct ParticleStep {
    right: vec4f,      // unit axes of the picture plane, in the scene
    up: vec4f,
    toward: vec4f,     // the viewer, unit, in the scene
    count: u32,
    first_frame: u32,  // whose particle_states are kept
    last_frame: u32,   // to which steps lead
    steps: u32,        // that `course` has words for; the last hold for all later ones
    target_word: u32,  // where the splats' words begin
    is_fresh: u32,     // nothing is kept: begin in frame 0
}

struct StepParams {
    p: Particles,
    life_steps: u32,   // longest life
    life_chance: u32,  // steps of it that are left to chance
    step_s: f32,
    spare: u32,
}

@group(0) @binding(20) var<uniform> particle_step: ParticleStep;
// Behind the steps, once more, how the particles look in this picture.
@group(0) @binding(21) var<storage, read> step_params: array<StepParams>;

// The words of the step that leads to a frame.
fn step_params_of(frame_number: u32) -> u32 {
    return min(max(frame_number, 1u), particle_step.steps) - 1u;
}
