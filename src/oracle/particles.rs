//! Particles in f64: from the first frame to the one that is shown, and how far an adapter's may be from that.
//!
//! A flow like this is chaotic: whatever rounding makes of a place, it drives apart further. So an adapter is judged step by
//! step, from its own place before the last one, within a bound; how far its whole flight has gone from the true one is
//! reported and not judged.

use std::borrow::Cow;

use glam::{DVec2, DVec3, I64Vec3};
use rayon::prelude::*;

use super::{project::gate, spread::Spread};
use crate::{
    effects::{
        Stack,
        hooks::ROUNDING,
        particles::{self, LATTICE_DRIFT, LATTICE_SHIFT, LEAN, Particles, SPEED_NORMALIZER},
        read,
    },
    frame::{ParticleReadback, ParticleState},
    math::{hash, hash_unit},
    scene::{
        Scene,
        particle_discs::{PARTICLE_DISC_WORDS, ParticleTimeline},
        view::View,
    },
};

/// A particle between two steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReferenceParticle {
    pub place: DVec3,
    pub velocity: DVec3,
    pub age: u32,
    pub births: u32,
}

impl From<&ParticleState> for ReferenceParticle {
    fn from(flight: &ParticleState) -> Self {
        let [place, velocity] = [flight.place, flight.velocity].map(|v| DVec3::from_array(v.map(f64::from)));
        Self { place, velocity, age: flight.age, births: flight.births }
    }
}

/// The scene with the particles that a stack puts there: those of an adapter, or where they truly are.
pub(super) fn dressed<'a>(scene: &'a Scene, view: &View, stack: &Stack, particle_readback: Option<&ParticleReadback>) -> Cow<'a, Scene> {
    let mut scene = scene.with_particles(stack.particle_settings().as_ref());
    let range = scene.particle_disc_bytes();
    if !range.is_empty() {
        let own = || particle_discs(&flights_of(view, stack), &shown(stack), view);
        let words = particle_readback.map_or_else(own, |particle_readback| particle_readback.words.clone());
        assert_eq!(4 * words.len(), range.len(), "the particles are of another preset");
        scene.to_mut().vertex_bytes[range].copy_from_slice(bytemuck::cast_slice(&words));
    }
    scene
}

/// Parameters by which the particles of a stack are shown.
fn shown(stack: &Stack) -> Particles {
    stack.params(particles::EFFECT.name).unwrap_or_default()
}

/// The flow that a view is at.
pub(super) fn flow_of(view: &View, stack: &Stack) -> ParticleTimeline {
    let default = (particles::EFFECT.defaults)();
    let words = stack.get(particles::EFFECT.name).map_or(&default, |enabled| &enabled.words);
    view.scene_state
        .particles
        .as_deref()
        .filter(|particle_timeline| particle_timeline.stride == words.len())
        .cloned()
        .unwrap_or_else(|| particles::constant_timeline(words, 0))
}

/// Where the particles of a stack truly are.
pub fn flights_of(view: &View, stack: &Stack) -> Vec<ReferenceParticle> {
    let particle_timeline = flow_of(view, stack);
    let steps: Vec<Particles> = (1..=particle_timeline.len() as u32).map(|step| read(particle_timeline.words(step))).collect();
    let of_step = |step: u32| &steps[(step.max(1) as usize - 1).min(steps.len() - 1)];
    let count = stack.particle_settings().map_or(0, |particle_settings| particle_settings.count);
    let fly = |id: u32| (1..=particle_timeline.frame).fold(first(of_step(0), id), |flight, step| stepped(of_step(step), id, &flight, step));
    (0..count).into_par_iter().map(fly).collect()
}

fn vector(v: [f32; 4]) -> DVec3 {
    DVec3::new(v[0].into(), v[1].into(), v[2].into())
}

fn base(p: &Particles, id: u32, births: u32) -> u32 {
    hash(hash(hash(p.seed).wrapping_add(id)) ^ births)
}

/// The share of a whole number that a random number stands for, rounded down.
fn share_of(random: u32, whole: u32) -> u32 {
    ((u64::from(random) * u64::from(whole)) >> 32) as u32
}

/// Steps of a life.
fn life(p: &Particles, base: u32) -> u32 {
    let [steps, chance] = particles::life_steps(p);
    steps - share_of(hash(base.wrapping_add(12)), chance + 1)
}

fn born(p: &Particles, id: u32, births: u32) -> ReferenceParticle {
    let base = base(p, id, births);
    let attempt = |t: u32| {
        let (xy, z) = (hash(base.wrapping_add(2 * t)), hash(base.wrapping_add(2 * t + 1)));
        I64Vec3::new(i64::from(xy & 0xffff), i64::from(xy >> 16), i64::from(z & 0xffff)) - 32768
    };
    let is_inside = |at: &I64Vec3| at.dot(*at) <= 1 << 30;
    let at = (0..6).map(attempt).find(is_inside).unwrap_or_else(|| attempt(5) / 2);
    let room = DVec3::splat(p.room_m.into());
    let offset = (at.as_dvec3() / 32768.0 * vector(p.spread)).clamp(-room, room);
    ReferenceParticle { place: vector(p.origin) + offset, velocity: DVec3::ZERO, age: 0, births }
}

/// A particle in frame 0.
pub fn first(p: &Particles, id: u32) -> ReferenceParticle {
    let base = base(p, id, 0);
    ReferenceParticle { age: share_of(hash(base.wrapping_add(13)), life(p, base)), ..born(p, id, 0) }
}

/// A particle one step later.
pub fn stepped(p: &Particles, id: u32, flight: &ReferenceParticle, step: u32) -> ReferenceParticle {
    let Some(next) = moved(p, id, flight, step) else { return born(p, id, flight.births + 1) };
    let is_outside = (next.place - vector(p.origin)).abs().max_element() > f64::from(p.room_m);
    if is_outside { born(p, id, flight.births + 1) } else { next }
}

/// The same if it may leave the room; none when its life ends.
fn moved(p: &Particles, id: u32, flight: &ReferenceParticle, step: u32) -> Option<ReferenceParticle> {
    if flight.age + 1 >= life(p, base(p, id, flight.births)) {
        return None;
    }
    let (dt, drag) = (1.0 / f64::from(p.rate), f64::from(p.drag));
    let carried = drag * particle_timeline(p, flight.place, step) + pull(p, flight.place);
    let velocity = (flight.velocity + dt * carried) / (1.0 + dt * drag);
    Some(ReferenceParticle { place: flight.place + dt * velocity, velocity, age: flight.age + 1, births: flight.births })
}

fn pull(p: &Particles, place: DVec3) -> DVec3 {
    let (away, r) = (vector(p.attractor) - place, f64::from(p.attractor_m));
    f64::from(p.attraction) * 2.0 * r / (away.length_squared() + r * r) * away
}

/// Velocity of the flow at a place, at the step that leads to a frame.
pub fn particle_timeline(p: &Particles, place: DVec3, step: u32) -> DVec3 {
    let salt = hash(p.seed ^ 0x9e37_79b9);
    let (mut sum, mut share, mut shares) = (DVec3::ZERO, 1.0, 0.0);
    for octave in 0..p.octaves {
        sum += share * curl(lattice_place(p, place, step, octave), salt.wrapping_add(octave));
        shares += share;
        share *= f64::from(p.persistence);
    }
    sum * (SPEED_NORMALIZER * f64::from(p.speed_mps) / shares)
}

/// Where a place lies in the lattice of an octave.
fn lattice_place(p: &Particles, place: DVec3, step: u32, octave: u32) -> DVec3 {
    let drift = f64::from(step) / f64::from(p.rate) * f64::from(p.evolve);
    let shift = DVec3::from_array(LATTICE_SHIFT) * f64::from(octave + 1);
    place * (f64::from(1u32 << octave) / f64::from(p.swirl_m)) + shift + DVec3::from_array(LATTICE_DRIFT) * drift
}

/// Curl of value noise: each corner of the cell has three numbers and a weight that is a product of one blend per axis, of
/// which a derivative replaces the one of its axis.
fn curl(q: DVec3, salt: u32) -> DVec3 {
    let cell = q.floor();
    let t = (q - cell).to_array();
    let at = cell.to_array().map(|c| c as i64 as u32);
    let blend = t.map(|t| t * t * t * (t * (6.0 * t - 15.0) + 10.0));
    let slope = t.map(|t| 30.0 * t * t * (t * (t - 2.0) + 1.0));
    let mut by = [DVec3::ZERO; 3];
    for corner in 0..8u32 {
        let bit = |axis: usize| corner >> axis & 1;
        let chained = |word: u32, axis: usize| hash(word.wrapping_add(at[axis]).wrapping_add(bit(axis)));
        let word = chained(chained(hash(at[0].wrapping_add(bit(0)).wrapping_add(salt)), 1), 2);
        let number = |lane: u32| f64::from(2 * (word >> (10 * lane) & 1023) + 1) / 1024.0 - 1.0;
        let value = DVec3::new(number(0), number(1), number(2));
        let weight = |axis: usize| if bit(axis) == 1 { blend[axis] } else { 1.0 - blend[axis] };
        let change = |axis: usize| if bit(axis) == 1 { slope[axis] } else { -slope[axis] };
        by[0] += value * (change(0) * weight(1) * weight(2));
        by[1] += value * (weight(0) * change(1) * weight(2));
        by[2] += value * (weight(0) * weight(1) * change(2));
    }
    DVec3::new(by[1].z - by[2].y, by[2].x - by[0].z, by[0].y - by[1].x)
}

/// Words of the triangles of all discs.
fn particle_discs(particle_states: &[ReferenceParticle], p: &Particles, view: &View) -> Vec<u32> {
    particle_states.par_iter().enumerate().flat_map_iter(|(id, flight)| splat(p, id as u32, flight, view)).collect()
}

/// Radius of a disc and its colour.
fn disc(p: &Particles, id: u32, flight: &ReferenceParticle) -> (f64, DVec3) {
    let base = base(p, id, flight.births);
    let smooth = |x: f64| x.clamp(0.0, 1.0).powi(2) * (3.0 - 2.0 * x.clamp(0.0, 1.0));
    let (share, fade) = (f64::from(flight.age) / f64::from(life(p, base)), f64::from(p.fade));
    let grown = smooth(share / fade) * smooth((1.0 - share) / fade);
    let radius = f64::from(p.size_m) * (1.0 - f64::from(p.size_spread) * hash_unit(base.wrapping_add(14))) * grown;
    let heat = (flight.velocity.length() / f64::from(p.bright_mps)).min(1.0);
    (radius, vector(p.slow).lerp(vector(p.fast), heat))
}

/// Axes of the picture plane and the way to the viewer, in the scene.
fn facing(view: &View) -> [DVec3; 3] {
    let scene_from_world = view.scene_state.world_from_scene.inverse();
    [view.ndc_axes[0], view.ndc_axes[1], -view.forward].map(|axis| scene_from_world.transform_vector3(axis).normalize_or_zero())
}

fn splat(p: &Particles, id: u32, flight: &ReferenceParticle, view: &View) -> [u32; PARTICLE_DISC_WORDS] {
    let (radius, color) = disc(p, id, flight);
    let [right, up, toward] = facing(view);
    let lean = LEAN * f64::from(p.roundness);
    let mut words = [0; PARTICLE_DISC_WORDS];
    for (corner, aside) in [[-3f64.sqrt(), -1.0], [3f64.sqrt(), -1.0], [0.0, 2.0]].into_iter().enumerate() {
        let offset = right * aside[0] + up * aside[1];
        let (place, normal) = (flight.place + radius * offset, (toward + lean * offset).normalize_or_zero());
        let shade = color.to_array().map(|c| (c.clamp(0.0, 1.0) * 65535.0).round() as u32);
        let lanes = normal.to_array().map(|n| u32::from((n * 32767.0).round() as i16 as u16));
        let place = place.to_array().map(|at| (at as f32).to_bits());
        words[6 * corner..][..6].copy_from_slice(&[
            place[0],
            place[1],
            place[2],
            shade[0] | shade[1] << 16,
            shade[2] | lanes[0] << 16,
            lanes[1] | lanes[2] << 16,
        ]);
    }
    words
}

/// What the judge found of one particle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Judged {
    pub is_outside: bool,
    /// Distance from its true flight, pixels and metres.
    pub astray_px: f64,
    pub astray_m: f64,
}

/// Holds an adapter's particles against the step that they took last, and against the flight that is true from the start.
pub(super) fn judged(view: &View, stack: &Stack, particle_readback: &ParticleReadback) -> Vec<Judged> {
    let (particle_timeline, shown, reference) = (flow_of(view, stack), shown(stack), flights_of(view, stack));
    assert_eq!(particle_readback.after.len(), reference.len(), "the particles are of another preset");
    let p: Particles = read(particle_timeline.words(particle_timeline.frame));
    let spread = Spread::new(&p, particle_readback, particle_timeline.frame);
    let clip_from_scene = view.clip_from_world * view.scene_state.world_from_scene;
    let screen = |place: DVec3| {
        let clip = clip_from_scene * place.extend(1.0);
        let half = DVec2::new(f64::from(view.width), f64::from(view.height)) * 0.5;
        (clip.z <= clip.w && clip.w > 0.0).then(|| clip.truncate().truncate() / clip.w * half)
    };
    let one = |(id, (given, reference)): (usize, (&ParticleState, &ReferenceParticle))| {
        let (number, after) = (id as u32, ReferenceParticle::from(given));
        let step_is_right = match particle_readback.before.get(id) {
            None => spread.is_first(&first(&p, number), &after),
            Some(before) => {
                let before = ReferenceParticle::from(before);
                spread.allows(
                    &before,
                    moved(&p, number, &before, particle_timeline.frame).as_ref(),
                    &born(&p, number, before.births + 1),
                    &after,
                )
            }
        };
        let words = &particle_readback.words[PARTICLE_DISC_WORDS * id..][..PARTICLE_DISC_WORDS];
        let is_drawn_right = is_particle_disc(words, &splat(&shown, number, &after, view), &shown, &after);
        let astray = screen(after.place).zip(screen(reference.place)).map_or(0.0, |(a, b)| a.distance(b));
        Judged { is_outside: !(step_is_right && is_drawn_right), astray_px: astray, astray_m: after.place.distance(reference.place) }
    };
    particle_readback.after.par_iter().zip(&reference).enumerate().map(one).collect()
}

/// Are the words of a splat those that its flight asks for?
fn is_particle_disc(given: &[u32], reference: &[u32; PARTICLE_DISC_WORDS], p: &Particles, flight: &ReferenceParticle) -> bool {
    let size = f64::from(p.size_m);
    let error_bound = 16.0 * ROUNDING * (flight.place.abs().max_element() + 4.0 * size)
        + size * 64.0 * ROUNDING * (1.0 + 1.0 / f64::from(p.fade))
        + f64::from(f32::MIN_POSITIVE);
    let is_near = |a: u32, b: u32, most: i32| {
        let halves = |word: u32| [i32::from(word as u16 as i16), i32::from((word >> 16) as u16 as i16)];
        // Colours run round from 65535 to 0, which two neighbours never are.
        halves(a).into_iter().zip(halves(b)).all(|(a, b)| (a - b).abs().min(65536 - (a - b).abs()) <= most)
    };
    given.iter().zip(reference).enumerate().all(|(place, (&a, &b))| match place % 6 {
        0..3 => gate(a).is_ok_and(|a| (a - f64::from(f32::from_bits(b))).abs() <= error_bound),
        _ => is_near(a, b, 1),
    })
}
