// Course: what every step of the particles goes by. Twins of `gpu::swarm::{SwarmUniform, CourseRecord}`.
//@ use effects/particles
//@ use common/frame

struct Swarm {
    right: vec4f,      // unit axes of the picture plane, in the scene
    up: vec4f,
    toward: vec4f,     // the viewer, unit, in the scene
    count: u32,
    first_frame: u32,  // whose flights are kept
    last_frame: u32,   // to which steps lead
    steps: u32,        // that `course` has words for; the last hold for all later ones
    target_word: u32,  // where the splats' words begin
    is_fresh: u32,     // nothing is kept: begin in frame 0
}

struct Course {
    p: Particles,
    life_steps: u32,   // longest life
    life_chance: u32,  // steps of it that are left to chance
    step_s: f32,
    spare: u32,
}

@group(0) @binding(20) var<uniform> swarm: Swarm;
// Behind the steps, once more, how the particles look in this picture.
@group(0) @binding(21) var<storage, read> course: array<Course>;

// The words of the step that leads to a frame.
fn course_of(frame_number: u32) -> u32 {
    return min(max(frame_number, 1u), swarm.steps) - 1u;
}
