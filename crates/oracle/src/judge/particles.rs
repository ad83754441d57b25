//! Judges the particles of an adapter.
//!
//! The flow is chaotic: it amplifies every rounding error. So each particle is judged by its last
//! step, from the adapter's own position before it, within a bound; the distance from the particle
//! that the oracle simulates from the first frame is reported and not judged (`docs/exactness.md`
//! §9).

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::super::{
    arithmetic::bits::classified,
    bounds::particles::StepBounds,
    render::particles::{
        ReferenceParticle, born, disc, drawn_params, first, moved, particles_at, timeline,
    },
};
use crate::{
    effects::{Stack, hooks::ROUNDING, particles::Particles, read},
    frame::{ParticleReadback, ParticleState},
    measure::ErrorReport,
    scene::{particle_discs::PARTICLE_DISC_WORDS, view::View},
    work::Canceled,
};

/// What was found about one particle.
#[derive(Clone, Copy, Debug, Default)]
struct ParticleError {
    is_outside: bool,
    /// Distance from the simulated particle.
    divergence_px: f64,
    divergence_m: f64,
}

/// Compares an adapter's particles with their bounds.
///
/// # Panics
/// If the particles are of another preset.
pub fn judge_particles(
    report: &mut ErrorReport,
    view: &View,
    stack: &Stack,
    readback: &ParticleReadback,
) -> Result<(), Canceled> {
    let judged = particle_errors(view, stack, readback)?;
    report.particles = judged.len() as u64;
    report.particles_outside_bound = judged.iter().filter(|one| one.is_outside).count() as u64;
    report.particles_diverged = judged.iter().filter(|one| one.divergence_px > 1.0).count() as u64;
    report.max_divergence_px = judged
        .iter()
        .map(|one| one.divergence_px)
        .fold(0.0, f64::max);
    report.mean_divergence_m =
        judged.iter().map(|one| one.divergence_m).sum::<f64>() / judged.len().max(1) as f64;
    Ok(())
}

fn particle_errors(
    view: &View,
    stack: &Stack,
    readback: &ParticleReadback,
) -> Result<Vec<ParticleError>, Canceled> {
    let (timeline, drawn_params, references) = (
        timeline(view, stack),
        drawn_params(stack),
        particles_at(view, stack)?,
    );
    assert_eq!(
        readback.after.len(),
        references.len(),
        "the particles are of another preset"
    );
    let params: Particles = read(timeline.words(timeline.frame));
    let bounds = StepBounds::new(&params, readback, timeline.frame);
    let step_is_right = |id: u32, after: &ReferenceParticle| match readback.before.get(id as usize)
    {
        None => bounds.is_first(&first(&params, id), after),
        Some(before) => {
            let before = ReferenceParticle::from(before);
            let moved = moved(&params, id, &before, timeline.frame);
            bounds.allows(
                &before,
                moved.as_ref(),
                &born(&params, id, before.births + 1),
                after,
            )
        }
    };
    let judged = |(index, (given, reference)): (usize, (&ParticleState, &ReferenceParticle))| {
        let (id, after) = (index as u32, ReferenceParticle::from(given));
        let words = &readback.words[PARTICLE_DISC_WORDS * index..][..PARTICLE_DISC_WORDS];
        let disc_is_right = disc_fits(
            words,
            &disc(&drawn_params, id, &after, view),
            &drawn_params,
            &after,
        );
        let on_screen =
            [after.position, reference.position].map(|position| projected(view, position));
        ParticleError {
            is_outside: !(step_is_right(id, &after) && disc_is_right),
            divergence_px: on_screen[0]
                .zip(on_screen[1])
                .map_or(0.0, |(a, b)| a.distance(b)),
            divergence_m: after.position.distance(reference.position),
        }
    };
    Ok(readback
        .after
        .par_iter()
        .zip(&references)
        .enumerate()
        .map(judged)
        .collect())
}

/// A position of the scene in the picture, in pixels from its center; none between the eye and the
/// near plane.
fn projected(view: &View, position: DVec3) -> Option<DVec2> {
    let clip =
        view.clip_from_world * view.scene_state.world_from_particles() * position.extend(1.0);
    let half = DVec2::new(f64::from(view.width), f64::from(view.height)) * 0.5;
    (clip.z <= clip.w && clip.w > 0.0).then(|| clip.truncate().truncate() / clip.w * half)
}

/// Returns true if the words of a disc are within their bounds.
fn disc_fits(
    given: &[u32],
    reference: &[u32; PARTICLE_DISC_WORDS],
    p: &Particles,
    particle: &ReferenceParticle,
) -> bool {
    let size = f64::from(p.radius_m);
    let position_error = 16.0 * ROUNDING * (particle.position.abs().max_element() + 4.0 * size)
        + size * 64.0 * ROUNDING * (1.0 + 1.0 / f64::from(p.fade))
        + f64::from(f32::MIN_POSITIVE);
    let position_fits = |a: u32, b: u32| {
        classified(a).is_ok_and(|a| (a - f64::from(f32::from_bits(b))).abs() <= position_error)
    };
    let halves_fit = |a: u32, b: u32| {
        let halves = |word: u32| {
            [
                i32::from(word as u16 as i16),
                i32::from((word >> 16) as u16 as i16),
            ]
        };
        // The difference of unsigned 16-bit colors is taken modulo 65536: two colors this far apart
        // are never neighbors.
        halves(a)
            .into_iter()
            .zip(halves(b))
            .all(|(a, b)| (a - b).abs().min(65536 - (a - b).abs()) <= 1)
    };
    given
        .iter()
        .zip(reference)
        .enumerate()
        .all(|(index, (&a, &b))| match index % 6 {
            0..3 => position_fits(a, b),
            _ => halves_fit(a, b),
        })
}
