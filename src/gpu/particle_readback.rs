//! ParticleReadback: the particles on the device, from the frame in which they are kept to the one that a picture shows. Mirrors of the
//! structs in `shaders/common/course.wgsl`.

use super::{
    RenderError, Renderer, STORAGE, buffers,
    dispatch::folded,
    uniforms::{GpuRecord, gpu_record},
};
use crate::{
    accuracy::{CurlNoise, ParticleStorage},
    effects::{
        Stack,
        particles::{self, Particles},
        read,
    },
    frame::{ParticleReadback, ParticleState},
    scene::{
        Scene,
        particle_discs::{PARTICLE_DISC_WORDS, ParticleTimeline},
        view::View,
    },
    shader::{key::KernelKey, pass::Pass},
};

gpu_record! {
    /// Which steps to take. Each member is explained in `shaders/common/course.wgsl`.
    pub struct ParticleStepUniform = "ParticleStep" {
        pub right: [f32; 4],
        pub up: [f32; 4],
        pub toward: [f32; 4],
        pub count: u32,
        pub first_frame: u32,
        pub last_frame: u32,
        pub steps: u32,
        pub target_word: u32,
        pub is_fresh: u32,
    }
}

gpu_record! {
    /// What one step goes by. Each member is explained in `shaders/common/course.wgsl`.
    pub struct StepParams = "Course" {
        pub p: Particles,
        pub life_steps: u32,
        pub life_chance: u32,
        pub step_s: f32,
        pub spare: u32,
    }
}

/// Most steps of single particles that one submission takes: a small part of a second on the slowest adapter.
const STEPS_AT_ONCE: u64 = 1 << 21;

/// Most steps of one particle among them: Mesa's software rasterizer ends all loops of an invocation after 65,535 iterations,
/// of which a step takes up to thirteen.
const STEPS_OF_ONE: u64 = 4096;

/// Most of them that a picture takes while somebody waits for the window, on a CPU adapter and on others; then it shows a frame
/// on the way.
const STEPS_IN_PASSING: [u64; 2] = [1 << 21, 1 << 26];

/// What the device keeps.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// The frame that was reached; the one before it is kept as well.
    particle_timeline: ParticleTimeline,
    count: u32,
    options: (CurlNoise, ParticleStorage),
}

/// The particles of a picture.
pub struct Flying {
    pub count: u32,
    pub particle_timeline: ParticleTimeline,
    words: Vec<u32>,
}

impl Flying {
    /// None where no effect puts particles into the scene.
    pub fn of(view: &View, stack: &Stack) -> Option<Self> {
        let words = &stack.get(particles::EFFECT.name)?.words;
        let count = stack.particle_settings()?.count;
        let particle_timeline =
            view.scene_state.particles.as_deref().filter(|particle_timeline| particle_timeline.stride == words.len()).cloned();
        Some(Self {
            count,
            particle_timeline: particle_timeline.unwrap_or_else(|| particles::constant_timeline(words, 0)),
            words: words.clone(),
        })
    }

    /// A record for every step, and one for how the particles look.
    fn step_params(&self) -> Vec<StepParams> {
        let record = |words: &[u32]| {
            let p: Particles = read(words);
            let [life_steps, life_chance] = particles::life_steps(&p);
            StepParams { p, life_steps, life_chance, step_s: (1.0 / f64::from(p.rate)) as f32, spare: 0 }
        };
        let steps = (1..=self.particle_timeline.len() as u32).map(|step| record(self.particle_timeline.words(step)));
        steps.chain([record(&self.words)]).collect()
    }

    fn uniform(&self, scene: &Scene, view: &View, first_frame: Option<u32>, last_frame: u32) -> ParticleStepUniform {
        let scene_from_world = view.scene_state.world_from_scene.inverse();
        let [right, up] = view.ndc_axes.map(|axis| axis.normalize_or_zero());
        let [right, up, toward] = [right, up, -view.forward].map(|axis| scene_from_world.transform_vector3(axis).normalize_or_zero());
        let wide = |v: glam::DVec3| [v.x as f32, v.y as f32, v.z as f32, 0.0];
        ParticleStepUniform {
            right: wide(right),
            up: wide(up),
            toward: wide(toward),
            count: self.count,
            first_frame: first_frame.unwrap_or(0),
            last_frame,
            steps: self.particle_timeline.len() as u32,
            target_word: scene.particle_disc_bytes().start as u32 / 4,
            is_fresh: first_frame.is_none().into(),
        }
    }
}

impl Renderer {
    /// Makes the buffers of the particles hold what their pass will read, and takes all steps but the last one; true if
    /// the picture will show a frame on the way, because nobody wants to wait for all of them.
    pub(super) fn simulate_particles(
        &mut self,
        key: &KernelKey,
        view: &View,
        stack: &Stack,
        is_patient: bool,
    ) -> Result<bool, RenderError> {
        let Some(mut flying) = Flying::of(view, stack).filter(|_| key.generated.has_particles) else {
            self.kept = None;
            return Ok(false);
        };
        let scene = self.scene.clone().ok_or(RenderError::NoScene)?;
        let options = (key.options.curl_noise, key.options.particle_storage);
        let bytes = 2 * particle_state_bytes(options.1) * u64::from(flying.count);
        let gpu = self.gpu.clone();
        let is_new = self.buffers.ensure(&gpu, "particle_states", bytes, STORAGE, "particles before and after the last step")?;
        let why = "what the steps of the particles go by, and how they look";
        self.buffers.fill(&gpu, "step_params", bytemuck::cast_slice(&flying.step_params()), STORAGE, why)?;

        // Whatever is kept holds only for those that came the same way.
        let kept = self.kept.take().filter(|kept| {
            let reached = kept.particle_timeline.frame;
            let is_same = (kept.count, kept.options) == (flying.count, options)
                && kept.particle_timeline.shares_steps_with(&flying.particle_timeline, reached);
            !is_new && is_same && reached <= flying.particle_timeline.frame
        });
        let mut reached = kept.map(|kept| kept.particle_timeline.frame);
        let share = (STEPS_AT_ONCE / u64::from(flying.count)).clamp(1, STEPS_OF_ONE) as u32;
        let in_passing = STEPS_IN_PASSING[usize::from(!gpu.caps.software)];
        let mut left = if is_patient { u32::MAX } else { (in_passing / u64::from(flying.count)).max(1) as u32 };
        let goal = flying.particle_timeline.frame;
        while reached.unwrap_or(0) + 1 < goal && left > 0 {
            let next = reached.unwrap_or(0).saturating_add(share.min(left)).min(goal - 1);
            left -= (next - reached.unwrap_or(0)).min(left);
            self.step(key, view, &scene, &flying, reached, next)?;
            reached = Some(next);
            if is_patient {
                buffers::wait(&gpu)?;
            }
        }
        let simulation_pending = reached.unwrap_or(0) + 1 < goal;
        if simulation_pending {
            flying.particle_timeline.frame = reached.unwrap_or(0);
        }
        // The last step is the picture's own: from the frame before, which is kept even when this one was drawn already.
        let before = flying.particle_timeline.frame.checked_sub(1).filter(|_| reached.is_some() || flying.particle_timeline.frame > 1);
        let uniform = flying.uniform(&scene, view, before, flying.particle_timeline.frame);
        self.buffers.fill(
            &gpu,
            "particle_step",
            bytemuck::bytes_of(&uniform),
            wgpu::BufferUsages::UNIFORM,
            "which steps the particles take",
        )?;
        self.kept = Some(Kept { particle_timeline: flying.particle_timeline, count: flying.count, options });
        Ok(simulation_pending)
    }

    /// Takes the steps from one frame to another, in a submission of their own.
    fn step(
        &mut self,
        key: &KernelKey,
        view: &View,
        scene: &Scene,
        flying: &Flying,
        from: Option<u32>,
        to: u32,
    ) -> Result<(), RenderError> {
        let gpu = self.gpu.clone();
        let uniform = flying.uniform(scene, view, from, to);
        self.buffers.fill(
            &gpu,
            "particle_step",
            bytemuck::bytes_of(&uniform),
            wgpu::BufferUsages::UNIFORM,
            "which steps the particles take",
        )?;
        let pipeline = self.pipelines.get(&gpu, key, Pass::Particles)?;
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("steps") });
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("steps"), timestamp_writes: None });
            pipeline.bind(&gpu, &mut pass, |name| self.buffers.get(name).as_entire_binding());
            let [x, y] = folded(flying.count.div_ceil(key.work.group_size));
            pass.dispatch_workgroups(x, y, 1);
        }
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// The particles of the last picture, and the frame before.
    pub(super) fn read_particles(&self, key: &KernelKey) -> Result<Option<ParticleReadback>, RenderError> {
        let (Some(kept), Some(scene)) = (self.kept.as_ref().filter(|_| key.generated.has_particles), self.scene.as_ref()) else {
            return Ok(None);
        };
        let count = kept.count as usize;
        let bytes = buffers::read(&self.gpu, self.buffers.get("particle_states"), 2 * particle_state_bytes(kept.options.1) * count as u64)?;
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
        let frame = kept.particle_timeline.frame;
        let particle_states = |frame: u32| -> Vec<ParticleState> {
            let half = &words[(frame as usize & 1) * words.len() / 2..][..words.len() / 2];
            match kept.options.1 {
                ParticleStorage::Float32 => half.chunks_exact(8).map(whole).collect(),
                ParticleStorage::Half16 => {
                    half.chunks_exact(4).map(|words| rough(words, &read(kept.particle_timeline.words(frame)))).collect()
                }
            }
        };
        let range = scene.particle_disc_bytes();
        let all = buffers::read(&self.gpu, self.buffers.get("vertex_bytes"), range.end as u64)?;
        debug_assert_eq!(range.len(), 4 * PARTICLE_DISC_WORDS * count);
        Ok(Some(ParticleReadback {
            before: frame.checked_sub(1).map(particle_states).unwrap_or_default(),
            after: particle_states(frame),
            words: bytemuck::pod_collect_to_vec(&all[range]),
            has_half_precision: kept.options.1 == ParticleStorage::Half16,
            has_difference_curl: kept.options.0 == CurlNoise::Difference,
        }))
    }
}

const fn particle_state_bytes(state: ParticleStorage) -> u64 {
    match state {
        ParticleStorage::Half16 => 16,
        ParticleStorage::Float32 => 32,
    }
}

/// As `shaders/slots/state/float32.wgsl` keeps it.
fn whole(words: &[u32]) -> ParticleState {
    let [px, py, pz, vx, vy, vz] = [0, 1, 2, 4, 5, 6].map(|i| f32::from_bits(words[i]));
    ParticleState { place: [px, py, pz], velocity: [vx, vy, vz], age: words[3], births: words[7] }
}

/// As `shaders/slots/state/half16.wgsl` keeps it.
fn rough(words: &[u32], p: &Particles) -> ParticleState {
    let share = |word: u32| (f32::from(word as u16 as i16) / 32767.0).max(-1.0);
    let shares = [share(words[0]), share(words[0] >> 16), share(words[1])];
    let place = [0, 1, 2].map(|axis| p.center[axis] + p.room_m * shares[axis]);
    let velocity = [half(words[2]), half(words[2] >> 16), half(words[3])];
    ParticleState { place, velocity, age: words[1] >> 16, births: words[3] >> 16 }
}

/// IEEE binary16 in the lower half of a word.
fn half(word: u32) -> f32 {
    let (sign, exponent, fraction) = (word >> 15 & 1, word >> 10 & 31, (word & 1023) as f32);
    let magnitude = match exponent {
        0 => fraction * 2f32.powi(-24),
        31 => f32::INFINITY,
        _ => (1024.0 + fraction) * 2f32.powi(exponent as i32 - 25),
    };
    if sign == 1 { -magnitude } else { magnitude }
}
