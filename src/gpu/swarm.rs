//! Swarm: the particles on the device, from the frame in which they are kept to the one that a picture shows. Twins of the
//! structs in `shaders/common/course.wgsl`.

use super::{
    RenderError, Renderer, STORAGE, buffers,
    dispatch::folded,
    uniforms::{Twin, twin},
};
use crate::{
    effects::{
        Stack,
        particles::{self, Particles},
        read,
    },
    frame::{Flight, Swarm},
    ladder::{Curl, State},
    scene::{
        Scene,
        camera::View,
        splats::{Flow, SPLAT_WORDS},
    },
    shader::key::{KernelKey, Pass},
};

twin! {
    /// Which steps to take. Each member is explained in `shaders/common/course.wgsl`.
    pub struct SwarmUniform = "Swarm" {
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

twin! {
    /// What one step goes by. Each member is explained in `shaders/common/course.wgsl`.
    pub struct CourseRecord = "Course" {
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
    flow: Flow,
    count: u32,
    rungs: (Curl, State),
}

/// The particles of a picture.
pub struct Flying {
    pub count: u32,
    pub flow: Flow,
    words: Vec<u32>,
}

impl Flying {
    /// None where no effect puts particles into the scene.
    pub fn of(view: &View, stack: &Stack) -> Option<Self> {
        let words = &stack.get(particles::EFFECT.name)?.words;
        let count = stack.cloud()?.count;
        let flow = view.flow.as_deref().filter(|flow| flow.stride == words.len()).cloned();
        Some(Self { count, flow: flow.unwrap_or_else(|| particles::steady(words, 0)), words: words.clone() })
    }

    /// A record for every step, and one for how the particles look.
    fn course(&self) -> Vec<CourseRecord> {
        let record = |words: &[u32]| {
            let p: Particles = read(words);
            let [life_steps, life_chance] = particles::life_steps(&p);
            CourseRecord { p, life_steps, life_chance, step_s: (1.0 / f64::from(p.rate)) as f32, spare: 0 }
        };
        let steps = (1..=self.flow.len() as u32).map(|step| record(self.flow.words(step)));
        steps.chain([record(&self.words)]).collect()
    }

    fn uniform(&self, scene: &Scene, view: &View, first_frame: Option<u32>, last_frame: u32) -> SwarmUniform {
        let scene_from_world = view.world_from_scene.inverse();
        let [right, up] = view.ndc_axes.map(|axis| axis.normalize_or_zero());
        let [right, up, toward] = [right, up, -view.forward].map(|axis| scene_from_world.transform_vector3(axis).normalize_or_zero());
        let wide = |v: glam::DVec3| [v.x as f32, v.y as f32, v.z as f32, 0.0];
        SwarmUniform {
            right: wide(right),
            up: wide(up),
            toward: wide(toward),
            count: self.count,
            first_frame: first_frame.unwrap_or(0),
            last_frame,
            steps: self.flow.len() as u32,
            target_word: scene.splat_bytes().start as u32 / 4,
            is_fresh: first_frame.is_none().into(),
        }
    }
}

impl Renderer {
    /// Makes the buffers of the particles hold what their pass will read, and takes all steps but the last one; true if
    /// the picture will show a frame on the way, because nobody wants to wait for all of them.
    pub(super) fn fly(&mut self, key: &KernelKey, view: &View, stack: &Stack, is_patient: bool) -> Result<bool, RenderError> {
        let Some(mut flying) = Flying::of(view, stack).filter(|_| key.has_particles) else {
            self.kept = None;
            return Ok(false);
        };
        let scene = self.scene.clone().ok_or(RenderError::NoScene)?;
        let rungs = (key.rungs.curl, key.rungs.state);
        let bytes = 2 * flight_bytes(rungs.1) * u64::from(flying.count);
        let gpu = self.gpu.clone();
        let is_new = self.buffers.ensure(&gpu, "flights", bytes, STORAGE, "particles before and after the last step")?;
        let why = "what the steps of the particles go by, and how they look";
        self.buffers.fill(&gpu, "course", bytemuck::cast_slice(&flying.course()), STORAGE, why)?;

        // Whatever is kept holds only for those that came the same way.
        let kept = self.kept.take().filter(|kept| {
            let reached = kept.flow.frame;
            let is_same = (kept.count, kept.rungs) == (flying.count, rungs) && kept.flow.begins_like(&flying.flow, reached);
            !is_new && is_same && reached <= flying.flow.frame
        });
        let mut reached = kept.map(|kept| kept.flow.frame);
        let share = (STEPS_AT_ONCE / u64::from(flying.count)).clamp(1, STEPS_OF_ONE) as u32;
        let in_passing = STEPS_IN_PASSING[usize::from(!gpu.caps.software)];
        let mut left = if is_patient { u32::MAX } else { (in_passing / u64::from(flying.count)).max(1) as u32 };
        let goal = flying.flow.frame;
        while reached.unwrap_or(0) + 1 < goal && left > 0 {
            let next = reached.unwrap_or(0).saturating_add(share.min(left)).min(goal - 1);
            left -= (next - reached.unwrap_or(0)).min(left);
            self.step(key, view, &scene, &flying, reached, next)?;
            reached = Some(next);
            if is_patient {
                buffers::wait(&gpu)?;
            }
        }
        let is_behind = reached.unwrap_or(0) + 1 < goal;
        if is_behind {
            flying.flow.frame = reached.unwrap_or(0);
        }
        // The last step is the picture's own: from the frame before, which is kept even when this one was drawn already.
        let before = flying.flow.frame.checked_sub(1).filter(|_| reached.is_some() || flying.flow.frame > 1);
        let uniform = flying.uniform(&scene, view, before, flying.flow.frame);
        self.buffers.fill(&gpu, "swarm", bytemuck::bytes_of(&uniform), wgpu::BufferUsages::UNIFORM, "which steps the particles take")?;
        self.kept = Some(Kept { flow: flying.flow, count: flying.count, rungs });
        Ok(is_behind)
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
        self.buffers.fill(&gpu, "swarm", bytemuck::bytes_of(&uniform), wgpu::BufferUsages::UNIFORM, "which steps the particles take")?;
        let pipeline = self.pipelines.get(&gpu, key, Pass::Particles)?;
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("steps") });
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("steps"), timestamp_writes: None });
            pipeline.bind(&gpu, &mut pass, |name| self.buffers.get(name).as_entire_binding());
            let [x, y] = folded(flying.count.div_ceil(key.list_group));
            pass.dispatch_workgroups(x, y, 1);
        }
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// The particles of the last picture, and the frame before.
    pub(super) fn read_swarm(&self, key: &KernelKey) -> Result<Option<Swarm>, RenderError> {
        let (Some(kept), Some(scene)) = (self.kept.as_ref().filter(|_| key.has_particles), self.scene.as_ref()) else { return Ok(None) };
        let count = kept.count as usize;
        let bytes = buffers::read(&self.gpu, self.buffers.get("flights"), 2 * flight_bytes(kept.rungs.1) * count as u64)?;
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
        let frame = kept.flow.frame;
        let flights = |frame: u32| -> Vec<Flight> {
            let half = &words[(frame as usize & 1) * words.len() / 2..][..words.len() / 2];
            match kept.rungs.1 {
                State::Float32 => half.chunks_exact(8).map(whole).collect(),
                State::Half16 => half.chunks_exact(4).map(|words| rough(words, &read(kept.flow.words(frame)))).collect(),
            }
        };
        let range = scene.splat_bytes();
        let all = buffers::read(&self.gpu, self.buffers.get("vertex_bytes"), range.end as u64)?;
        debug_assert_eq!(range.len(), 4 * SPLAT_WORDS * count);
        Ok(Some(Swarm {
            before: frame.checked_sub(1).map(flights).unwrap_or_default(),
            after: flights(frame),
            words: bytemuck::pod_collect_to_vec(&all[range]),
            is_rough: kept.rungs.1 == State::Half16,
            is_difference: kept.rungs.0 == Curl::Difference,
        }))
    }
}

const fn flight_bytes(state: State) -> u64 {
    match state {
        State::Half16 => 16,
        State::Float32 => 32,
    }
}

/// As `shaders/slots/state/float32.wgsl` keeps it.
fn whole(words: &[u32]) -> Flight {
    let [px, py, pz, vx, vy, vz] = [0, 1, 2, 4, 5, 6].map(|i| f32::from_bits(words[i]));
    Flight { place: [px, py, pz], velocity: [vx, vy, vz], age: words[3], births: words[7] }
}

/// As `shaders/slots/state/half16.wgsl` keeps it.
fn rough(words: &[u32], p: &Particles) -> Flight {
    let share = |word: u32| (f32::from(word as u16 as i16) / 32767.0).max(-1.0);
    let shares = [share(words[0]), share(words[0] >> 16), share(words[1])];
    let place = [0, 1, 2].map(|axis| p.origin[axis] + p.room_m * shares[axis]);
    let velocity = [half(words[2]), half(words[2] >> 16), half(words[3])];
    Flight { place, velocity, age: words[1] >> 16, births: words[3] >> 16 }
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
