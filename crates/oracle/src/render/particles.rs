//! Particles in f64, from the first frame to the one that is shown: curl noise of value noise
//! (Bridson et al. 2007), an attractor and drag, integrated implicitly in fixed steps
//! (`docs/exactness.md` §7).

use std::borrow::Cow;

use glam::{DVec3, I64Vec3};
use rayon::prelude::*;

use crate::{
    effects::{
        Stack,
        particles::{self, LATTICE_DRIFT, LATTICE_SHIFT, LEAN, Particles, SPEED_NORMALIZER},
        read,
    },
    frame::ParticleState,
    math::{HASH_GOLDEN, hash, hash_unit},
    scene::{
        Scene,
        draw::DrawError,
        particle_discs::{PARTICLE_DISC_WORDS, ParticleTimeline},
        view::View,
    },
    work::{Canceled, map_each},
};

/// A particle between two steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReferenceParticle {
    /// In the scene, meters.
    pub position: DVec3,
    /// Meters per second.
    pub velocity: DVec3,
    /// Steps since it was born.
    pub age: u32,
    /// How often it was born again.
    pub births: u32,
}

impl From<&ParticleState> for ReferenceParticle {
    fn from(state: &ParticleState) -> Self {
        let [position, velocity] =
            [state.position, state.velocity].map(|v| DVec3::from_array(v.map(f64::from)));
        Self {
            position,
            velocity,
            age: state.age,
            births: state.births,
        }
    }
}

/// Most octaves of flow that are evaluated for particles: one each for every octave, particle and
/// step since the first frame. Two cores took 18 s for them (2026-11-25).
const MAX_PARTICLE_WORK: u64 = 1 << 28;

/// The same for a CPU adapter, whose kernels compute in f32. Lavapipe took 25 s for 7.2e8 on two
/// cores (2026-11-25).
pub const MAX_PARTICLE_WORK_OF_CPU_ADAPTER: u64 = 1 << 29;

/// Refuses particles whose simulation up to `view` takes more work than the oracle may do.
/// Errors: [`DrawError::ParticleWork`].
pub fn check_particles(view: &View, stack: &Stack) -> Result<(), DrawError> {
    check_particle_work(view, stack, MAX_PARTICLE_WORK)
}

/// Refuses particles whose simulation up to `view` takes more than `limit` evaluations of an octave
/// of the flow.
/// Errors: [`DrawError::ParticleWork`].
pub fn check_particle_work(view: &View, stack: &Stack, limit: u64) -> Result<(), DrawError> {
    let Some(settings) = stack.particle_settings() else {
        return Ok(());
    };
    let timeline = timeline(view, stack);
    let octaves = (1..=timeline.len() as u32)
        .map(|step| read::<Particles>(timeline.words(step)).octaves)
        .max()
        .unwrap_or(1)
        .max(1);
    let work = u64::from(settings.count) * u64::from(timeline.frame) * u64::from(octaves);
    if work > limit {
        return Err(DrawError::ParticleWork {
            count: settings.count,
            steps: timeline.frame,
            octaves,
            work,
            limit,
        });
    }
    Ok(())
}

/// The scene with the particles of a stack as they are at `view`.
///
/// # Panics
/// If `words`, the discs that an adapter drew in their place, are those of another preset.
pub fn scene_with_particles<'a>(
    scene: &'a Scene,
    view: &View,
    stack: &Stack,
    words: Option<&[u32]>,
) -> Result<Cow<'a, Scene>, Canceled> {
    let mut scene = scene.with_particles(stack.particle_settings().as_ref());
    let range = scene.particle_disc_bytes();
    if !range.is_empty() {
        let words = match words {
            Some(words) => words.to_vec(),
            None => discs(&particles_at(view, stack)?, &drawn_params(stack), view),
        };
        assert_eq!(
            4 * words.len(),
            range.len(),
            "the particles are of another preset"
        );
        scene.to_mut().vertex_bytes[range].copy_from_slice(bytemuck::cast_slice(&words));
    }
    Ok(scene)
}

/// Parameters with which the particles of a stack are drawn.
pub fn drawn_params(stack: &Stack) -> Particles {
    stack.params(&particles::EFFECT.name).unwrap_or_default()
}

/// The timeline of parameters up to a view.
pub fn timeline(view: &View, stack: &Stack) -> ParticleTimeline {
    let default = &particles::EFFECT.defaults;
    let words = stack
        .get(&particles::EFFECT.name)
        .map_or(default, |enabled| &enabled.words);
    let given = view
        .scene_state
        .particles
        .as_deref()
        .filter(|timeline| timeline.stride == words.len());
    given
        .cloned()
        .unwrap_or_else(|| particles::constant_timeline(words, 0))
}

/// The particles of a stack at a view.
pub fn particles_at(view: &View, stack: &Stack) -> Result<Vec<ReferenceParticle>, Canceled> {
    let timeline = timeline(view, stack);
    let params: Vec<Particles> = (1..=timeline.len() as u32)
        .map(|step| read(timeline.words(step)))
        .collect();
    let of_step = |step: u32| &params[(step.max(1) as usize - 1).min(params.len() - 1)];
    let count = stack
        .particle_settings()
        .map_or(0, |settings| settings.count);
    let simulated = |id: u32| {
        (1..=timeline.frame).fold(first(of_step(0), id), |particle, step| {
            stepped(of_step(step), id, &particle, step)
        })
    };
    map_each((0..count).into_par_iter(), simulated)
}

fn vector(v: [f32; 4]) -> DVec3 {
    DVec3::new(v[0].into(), v[1].into(), v[2].into())
}

/// The hash from which all random numbers of one life follow.
pub fn base(p: &Particles, id: u32, births: u32) -> u32 {
    hash(hash(hash(p.seed).wrapping_add(id)) ^ births)
}

/// `whole` times a random fraction, rounded down.
fn fraction_of(random: u32, whole: u32) -> u32 {
    ((u64::from(random) * u64::from(whole)) >> 32) as u32
}

/// Length of a life in steps.
pub fn life(p: &Particles, base: u32) -> u32 {
    let [steps, chance] = particles::life_steps(p);
    steps - fraction_of(hash(base.wrapping_add(12)), chance + 1)
}

/// A particle at its birth.
pub fn born(p: &Particles, id: u32, births: u32) -> ReferenceParticle {
    let base = base(p, id, births);
    let attempt = |t: u32| {
        let (xy, z) = (
            hash(base.wrapping_add(2 * t)),
            hash(base.wrapping_add(2 * t + 1)),
        );
        I64Vec3::new(
            i64::from(xy & 0xffff),
            i64::from(xy >> 16),
            i64::from(z & 0xffff),
        ) - 32768
    };
    let is_inside = |at: &I64Vec3| at.dot(*at) <= 1 << 30;
    let at = (0..6)
        .map(attempt)
        .find(is_inside)
        .unwrap_or_else(|| attempt(5) / 2);
    let room = DVec3::splat(p.room_m.into());
    let offset = (at.as_dvec3() / 32768.0 * vector(p.half_axes)).clamp(-room, room);
    ReferenceParticle {
        position: vector(p.center) + offset,
        velocity: DVec3::ZERO,
        age: 0,
        births,
    }
}

/// A particle in frame 0, which has a random age.
pub fn first(p: &Particles, id: u32) -> ReferenceParticle {
    let base = base(p, id, 0);
    ReferenceParticle {
        age: fraction_of(hash(base.wrapping_add(13)), life(p, base)),
        ..born(p, id, 0)
    }
}

/// A particle one step later.
pub fn stepped(
    p: &Particles,
    id: u32,
    particle: &ReferenceParticle,
    step: u32,
) -> ReferenceParticle {
    let Some(next) = moved(p, id, particle, step) else {
        return born(p, id, particle.births + 1);
    };
    let is_outside = (next.position - vector(p.center)).abs().max_element() > f64::from(p.room_m);
    if is_outside {
        born(p, id, particle.births + 1)
    } else {
        next
    }
}

/// A particle one step later even if it leaves the room; none if its life ends.
pub fn moved(
    p: &Particles,
    id: u32,
    particle: &ReferenceParticle,
    step: u32,
) -> Option<ReferenceParticle> {
    if particle.age + 1 >= life(p, base(p, id, particle.births)) {
        return None;
    }
    let (dt, drag) = (1.0 / f64::from(p.rate), f64::from(p.drag));
    let carried = drag * flow(p, particle.position, step) + pull(p, particle.position);
    let velocity = (particle.velocity + dt * carried) / (1.0 + dt * drag);
    Some(ReferenceParticle {
        position: particle.position + dt * velocity,
        velocity,
        age: particle.age + 1,
        births: particle.births,
    })
}

/// Acceleration towards the attractor, largest at its radius.
fn pull(p: &Particles, position: DVec3) -> DVec3 {
    let (toward, r) = (vector(p.attractor) - position, f64::from(p.attractor_m));
    f64::from(p.attraction) * 2.0 * r / (toward.length_squared() + r * r) * toward
}

/// Velocity of the flow at a position, at the step that leads to a frame.
pub fn flow(p: &Particles, position: DVec3, step: u32) -> DVec3 {
    let salt = hash(p.seed ^ HASH_GOLDEN);
    let (mut sum, mut amplitude, mut amplitudes) = (DVec3::ZERO, 1.0, 0.0);
    for octave in 0..p.octaves {
        sum += amplitude
            * curl(
                lattice_position(p, position, step, octave),
                salt.wrapping_add(octave),
            );
        amplitudes += amplitude;
        amplitude *= f64::from(p.persistence);
    }
    sum * (SPEED_NORMALIZER * f64::from(p.speed_mps) / amplitudes)
}

/// A position in the lattice of an octave.
fn lattice_position(p: &Particles, position: DVec3, step: u32, octave: u32) -> DVec3 {
    let drift = f64::from(step) / f64::from(p.rate) * f64::from(p.evolve);
    let shift = DVec3::from_array(LATTICE_SHIFT) * f64::from(octave + 1);
    position * (f64::from(1u32 << octave) / f64::from(p.swirl_m))
        + shift
        + DVec3::from_array(LATTICE_DRIFT) * drift
}

/// Curl of value noise. Each corner of the lattice cell has three random numbers and a weight,
/// which is a product of one blend per axis; for a partial derivative the derivative of that axis'
/// blend takes its place.
fn curl(q: DVec3, salt: u32) -> DVec3 {
    let cell = q.floor();
    let t = (q - cell).to_array();
    let at = cell.to_array().map(|c| c as i64 as u32);
    let blend = t.map(|t| t * t * t * (t * (6.0 * t - 15.0) + 10.0));
    let slope = t.map(|t| 30.0 * t * t * (t * (t - 2.0) + 1.0));
    let mut by = [DVec3::ZERO; 3];
    for corner in 0..8u32 {
        let bit = |axis: usize| corner >> axis & 1;
        let chained =
            |word: u32, axis: usize| hash(word.wrapping_add(at[axis]).wrapping_add(bit(axis)));
        let word = chained(
            chained(hash(at[0].wrapping_add(bit(0)).wrapping_add(salt)), 1),
            2,
        );
        let number = |axis: u32| f64::from(2 * (word >> (10 * axis) & 1023) + 1) / 1024.0 - 1.0;
        let value = DVec3::new(number(0), number(1), number(2));
        let weight = |axis: usize| {
            if bit(axis) == 1 {
                blend[axis]
            } else {
                1.0 - blend[axis]
            }
        };
        let change = |axis: usize| {
            if bit(axis) == 1 {
                slope[axis]
            } else {
                -slope[axis]
            }
        };
        by[0] += value * (change(0) * weight(1) * weight(2));
        by[1] += value * (weight(0) * change(1) * weight(2));
        by[2] += value * (weight(0) * weight(1) * change(2));
    }
    DVec3::new(by[1].z - by[2].y, by[2].x - by[0].z, by[0].y - by[1].x)
}

/// Words of the triangles of all discs.
fn discs(particles: &[ReferenceParticle], p: &Particles, view: &View) -> Vec<u32> {
    particles
        .par_iter()
        .enumerate()
        .flat_map_iter(|(id, particle)| disc(p, id as u32, particle, view))
        .collect()
}

/// Radius and color of a disc.
fn radius_and_color(p: &Particles, id: u32, particle: &ReferenceParticle) -> (f64, DVec3) {
    let base = base(p, id, particle.births);
    let smooth = |x: f64| x.clamp(0.0, 1.0).powi(2) * (3.0 - 2.0 * x.clamp(0.0, 1.0));
    let (age, fade) = (
        f64::from(particle.age) / f64::from(life(p, base)),
        f64::from(p.fade),
    );
    let grown = smooth(age / fade) * smooth((1.0 - age) / fade);
    let radius = f64::from(p.radius_m)
        * (1.0 - f64::from(p.radius_variation) * hash_unit(base.wrapping_add(14)))
        * grown;
    let heat = (particle.velocity.length() / f64::from(p.fast_mps)).min(1.0);
    (radius, vector(p.slow).lerp(vector(p.fast), heat))
}

/// Axes of the picture plane and the direction to the viewer, in the scene.
fn facing(view: &View) -> [DVec3; 3] {
    let scene_from_world = view.scene_state.world_from_scene.inverse();
    [view.ndc_axes[0], view.ndc_axes[1], -view.forward]
        .map(|axis| scene_from_world.transform_vector3(axis).normalize_or_zero())
}

/// Words of the triangle whose inscribed circle is a particle's disc: positions, color and normals
/// of its corners.
pub fn disc(
    p: &Particles,
    id: u32,
    particle: &ReferenceParticle,
    view: &View,
) -> [u32; PARTICLE_DISC_WORDS] {
    let (radius, color) = radius_and_color(p, id, particle);
    let [right, up, toward] = facing(view);
    let lean = LEAN * f64::from(p.roundness);
    let mut words = [0; PARTICLE_DISC_WORDS];
    for (corner, [x, y]) in [[-3f64.sqrt(), -1.0], [3f64.sqrt(), -1.0], [0.0, 2.0]]
        .into_iter()
        .enumerate()
    {
        let offset = right * x + up * y;
        let (position, normal) = (
            particle.position + radius * offset,
            (toward + lean * offset).normalize_or_zero(),
        );
        let shade = color
            .to_array()
            .map(|c| (c.clamp(0.0, 1.0) * 65535.0).round() as u32);
        let normal = normal
            .to_array()
            .map(|n| u32::from((n * 32767.0).round() as i16 as u16));
        let position = position.to_array().map(|at| (at as f32).to_bits());
        words[6 * corner..][..6].copy_from_slice(&[
            position[0],
            position[1],
            position[2],
            shade[0] | shade[1] << 16,
            shade[2] | normal[0] << 16,
            normal[1] | normal[2] << 16,
        ]);
    }
    words
}
