//! Particles on the device: their states from the frame that was computed to the one that a picture
//! shows, and the pass that takes steps.

use super::recording::{Device, Resources};
use crate::{
    accuracy::{CurlNoise, ParticleStorage},
    device::{Gpu, completion::idle, error::RenderError},
    effects::{
        Stack,
        particles::{self, Particles},
        read,
    },
    frame::{ParticleReadback, ParticleState},
    layout::{
        BufferId,
        dispatch::fold_groups,
        records::{ParticleStepUniform, StepParams},
    },
    resources::buffers::{self, Buffers},
    scene::{
        Scene,
        particle_discs::{PARTICLE_DISC_WORDS, ParticleTimeline},
        view::View,
    },
    scene_data::scene_resources::SceneResources,
    shader::{key::KernelKey, pass::Pass},
};

/// Most steps of single particles that one submission takes: a small part of a second on the
/// slowest adapter.
const STEPS_AT_ONCE: u64 = 1 << 21;

/// Most steps of one particle among them: Mesa's software rasterizer ends all loops of an
/// invocation after 65,535 iterations, of which a step takes up to thirteen.
const STEPS_OF_ONE: u64 = 4096;

/// Most steps that a picture of [`Wait::None`] takes, on a CPU adapter and on others; then it shows
/// an earlier frame.
const STEPS_PER_PICTURE: [u64; 2] = [1 << 21, 1 << 26];

/// What must be done before a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wait {
    /// Nothing: where many particle steps are missing, the picture shows an earlier frame.
    None,
    /// All particle steps, however long they take.
    Simulation,
}

/// Particles that the device has computed.
#[derive(Clone, Debug, PartialEq)]
struct Computed {
    /// The frame that was reached; the states of the one before it are there as well.
    particle_timeline: ParticleTimeline,
    count: u32,
    options: (CurlNoise, ParticleStorage),
}

/// The particles that a picture asks for.
struct Requested {
    count: u32,
    particle_timeline: ParticleTimeline,
    words: Vec<u32>,
}

impl Requested {
    /// None where no effect puts particles into the scene.
    fn of(view: &View, stack: &Stack) -> Option<Self> {
        let words = &stack.get(&particles::EFFECT.name)?.words;
        let count = stack.particle_settings()?.count;
        let particle_timeline = view
            .scene_state
            .particles
            .as_deref()
            .filter(|particle_timeline| particle_timeline.stride == words.len())
            .cloned();
        Some(Self {
            count,
            particle_timeline: particle_timeline
                .unwrap_or_else(|| particles::constant_timeline(words, 0)),
            words: words.clone(),
        })
    }

    /// A record for every step, and one for how the particles look.
    fn step_params(&self) -> Vec<StepParams> {
        let record = |words: &[u32]| {
            let p: Particles = read(words);
            let [life_steps, life_chance] = particles::life_steps(&p);
            StepParams {
                p,
                life_steps,
                life_chance,
                step_s: (1.0 / f64::from(p.rate)) as f32,
                spare: 0,
            }
        };
        let steps = (1..=self.particle_timeline.len() as u32)
            .map(|step| record(self.particle_timeline.words(step)));
        steps.chain([record(&self.words)]).collect()
    }

    fn uniform(
        &self,
        scene: &Scene,
        view: &View,
        first_frame: Option<u32>,
        last_frame: u32,
    ) -> ParticleStepUniform {
        let scene_from_world = view.scene_state.world_from_scene.inverse();
        let [right, up] = view.ndc_axes.map(|axis| axis.normalize_or_zero());
        let [right, up, toward] = [right, up, -view.forward]
            .map(|axis| scene_from_world.transform_vector3(axis).normalize_or_zero());
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

/// The particles of a renderer.
#[derive(Default)]
pub struct ParticleSimulation {
    pub buffers: Buffers,
    computed: Option<Computed>,
    /// The last picture shows an earlier frame than it was asked for.
    pub is_pending: bool,
}

impl ParticleSimulation {
    /// Makes the buffers hold what the particle pass will read, and takes all steps but the last
    /// one, which is the picture's. `frame` has the frame uniform.
    pub async fn simulate(
        &mut self,
        device: &mut Device,
        scene: &SceneResources,
        frame: &Buffers,
        (key, view, stack): (&KernelKey, &View, &Stack),
        wait: Wait,
    ) -> Result<(), RenderError> {
        let Some(mut requested) =
            Requested::of(view, stack).filter(|_| key.generated.has_particles)
        else {
            *self = Self::default();
            return Ok(());
        };
        let gpu = device.gpu.clone();
        let options = (key.options.curl_noise, key.options.particle_storage);
        let bytes = 2 * state_bytes(options.1) * u64::from(requested.count);
        let is_new = self
            .buffers
            .ensure(&gpu, BufferId::ParticleStates, bytes)
            .await?;
        self.buffers
            .fill(
                &gpu,
                BufferId::StepParams,
                bytemuck::cast_slice(&requested.step_params()),
            )
            .await?;

        // What was computed can be continued only where all its steps were the same.
        let computed = self.computed.take().filter(|computed| {
            let reached = computed.particle_timeline.frame;
            let is_same = (computed.count, computed.options) == (requested.count, options)
                && computed
                    .particle_timeline
                    .shares_steps_with(&requested.particle_timeline, reached);
            !is_new && is_same && reached <= requested.particle_timeline.frame
        });
        let mut reached = computed.map(|computed| computed.particle_timeline.frame);
        let at_once = (STEPS_AT_ONCE / u64::from(requested.count)).clamp(1, STEPS_OF_ONE) as u32;
        let per_picture = STEPS_PER_PICTURE[usize::from(!gpu.caps.software)];
        let mut left = match wait {
            Wait::Simulation => u32::MAX,
            Wait::None => (per_picture / u64::from(requested.count)).max(1) as u32,
        };
        let goal = requested.particle_timeline.frame;
        while reached.unwrap_or(0) + 1 < goal && left > 0 {
            let next = reached
                .unwrap_or(0)
                .saturating_add(at_once.min(left))
                .min(goal - 1);
            left -= (next - reached.unwrap_or(0)).min(left);
            let uniform = requested.uniform(scene.scene(), view, reached, next);
            self.take_steps(device, scene, frame, key, &uniform).await?;
            reached = Some(next);
            if wait == Wait::Simulation {
                idle(&gpu).await?;
            }
        }
        self.is_pending = reached.unwrap_or(0) + 1 < goal;
        if self.is_pending {
            requested.particle_timeline.frame = reached.unwrap_or(0);
        }
        // The picture's own step begins at the frame before, whose states are there even when this
        // frame was drawn already.
        let last = requested.particle_timeline.frame;
        let before = last
            .checked_sub(1)
            .filter(|_| reached.is_some() || last > 1);
        let uniform = requested.uniform(scene.scene(), view, before, last);
        self.buffers
            .fill(&gpu, BufferId::ParticleStep, bytemuck::bytes_of(&uniform))
            .await?;
        self.computed = Some(Computed {
            particle_timeline: requested.particle_timeline,
            count: requested.count,
            options,
        });
        Ok(())
    }

    /// Takes steps in a submission that holds nothing else.
    async fn take_steps(
        &mut self,
        device: &mut Device,
        scene: &SceneResources,
        frame: &Buffers,
        key: &KernelKey,
        uniform: &ParticleStepUniform,
    ) -> Result<(), RenderError> {
        let Device { gpu, pipelines, .. } = device;
        self.buffers
            .fill(gpu, BufferId::ParticleStep, bytemuck::bytes_of(uniform))
            .await?;
        let pipeline = pipelines.get(gpu, key, Pass::Particles).await?;
        let resources = Resources {
            buffers: vec![frame, &scene.buffers, &self.buffers],
            textures: Vec::new(),
            light: None,
            stand_ins: Vec::new(),
        };
        let group = resources.bind_group(gpu, &pipeline)?;
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("particle steps"),
            });
        {
            let label = Some("particle steps");
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label,
                timestamp_writes: None,
            });
            pass.set_pipeline(&pipeline.pipeline);
            pass.set_bind_group(0, &group, &[]);
            let [x, y] = fold_groups(uniform.count.div_ceil(key.work.group_size));
            pass.dispatch_workgroups(x, y, 1);
        }
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// The particles of the last picture, and of the frame before; none where it has no particles.
    pub async fn read(
        &self,
        gpu: &Gpu,
        scene: &SceneResources,
        key: &KernelKey,
    ) -> Result<Option<ParticleReadback>, RenderError> {
        let Some(computed) = self
            .computed
            .as_ref()
            .filter(|_| key.generated.has_particles)
        else {
            return Ok(None);
        };
        let (count, (curl, storage)) = (computed.count as usize, computed.options);
        let frame = computed.particle_timeline.frame;
        let bytes = buffers::read(
            gpu,
            self.buffers.get(BufferId::ParticleStates)?,
            2 * state_bytes(storage) * count as u64,
        )
        .await?;
        // States of even frames come first, then those of odd ones.
        let states = |frame: u32| -> Vec<ParticleState> {
            let half = &bytes[(frame as usize & 1) * bytes.len() / 2..][..bytes.len() / 2];
            match storage {
                ParticleStorage::Float32 => bytemuck::pod_collect_to_vec::<u8, Float32State>(half)
                    .iter()
                    .map(Float32State::state)
                    .collect(),
                ParticleStorage::Half16 => {
                    let params: Particles = read(computed.particle_timeline.words(frame));
                    bytemuck::pod_collect_to_vec::<u8, Half16State>(half)
                        .iter()
                        .map(|state| state.state(&params))
                        .collect()
                }
            }
        };
        let range = scene.scene().particle_disc_bytes();
        let all = buffers::read(
            gpu,
            scene.buffers.get(BufferId::VertexBytes)?,
            range.end as u64,
        )
        .await?;
        debug_assert_eq!(range.len(), 4 * PARTICLE_DISC_WORDS * count);
        Ok(Some(ParticleReadback {
            before: frame.checked_sub(1).map(states).unwrap_or_default(),
            after: states(frame),
            words: bytemuck::pod_collect_to_vec(&all[range]),
            has_half_precision: storage == ParticleStorage::Half16,
            has_difference_curl: curl == CurlNoise::Difference,
        }))
    }
}

/// A particle as the variant float32 of `shaders/variants/particle_state.wgsl` stores it.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Float32State {
    place: [f32; 3],
    age: u32,
    velocity: [f32; 3],
    births: u32,
}

impl Float32State {
    fn state(&self) -> ParticleState {
        let Self {
            place,
            age,
            velocity,
            births,
        } = *self;
        ParticleState {
            position: place,
            velocity,
            age,
            births,
        }
    }
}

/// A particle as the variant half16 of `shaders/variants/particle_state.wgsl` stores it: the
/// position as signed fractions of the room, the velocity as halves.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Half16State {
    place: [i16; 3],
    age: u16,
    velocity: [u16; 3],
    births: u16,
}

impl Half16State {
    fn state(&self, p: &Particles) -> ParticleState {
        let fraction = |v: i16| (f32::from(v) / 32767.0).max(-1.0);
        let place = [0, 1, 2].map(|axis| p.center[axis] + p.room_m * fraction(self.place[axis]));
        ParticleState {
            position: place,
            velocity: self.velocity.map(half),
            age: self.age.into(),
            births: self.births.into(),
        }
    }
}

/// Bytes of a particle.
const fn state_bytes(storage: ParticleStorage) -> u64 {
    match storage {
        ParticleStorage::Half16 => size_of::<Half16State>() as u64,
        ParticleStorage::Float32 => size_of::<Float32State>() as u64,
    }
}

/// IEEE binary16.
fn half(bits: u16) -> f32 {
    let (sign, exponent, fraction) = (bits >> 15 & 1, bits >> 10 & 31, f32::from(bits & 1023));
    let magnitude = match exponent {
        0 => fraction * 2f32.powi(-24),
        31 => f32::INFINITY,
        _ => (1024.0 + fraction) * 2f32.powi(i32::from(exponent) - 25),
    };
    if sign == 1 { -magnitude } else { magnitude }
}
