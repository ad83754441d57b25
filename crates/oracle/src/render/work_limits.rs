//! How much work a picture is for a CPU, counted before it is drawn: samples in the bounding boxes
//! of triangles, and steps of particles.

use super::{
    super::{
        budget::{self, Purpose},
        shot::Shot,
    },
    particles::{MAX_PARTICLE_WORK_OF_CPU_ADAPTER, check_particle_work},
    project::project,
    sample_rules::SampleTests,
    triangles::{OrientedTriangle, triangles},
};
use crate::{
    effects::Stack,
    scene::{Scene, draw::DrawError, view::View},
};

/// Most samples that are tested for one image: those of every triangle's bounding box. Two cores
/// take about 40 s for them (2026-11-25).
const MAX_SAMPLES: u64 = 1 << 31;

/// Most samples that are tested for all pictures on which one depends.
const MAX_SEQUENCE_SAMPLES: u64 = 1 << 32;

/// Most triangles whose samples are counted for a sequence: more are small ones, as a rule, and
/// counting them would take long itself.
const MAX_COUNTED_TRIANGLES: u64 = 1 << 16;

/// Refuses an image, "picture" or "shadow map", for which more samples would be tested than the
/// oracle may test.
/// Errors: [`DrawError::OracleSamples`].
pub fn check_samples(
    image: &'static str,
    triangles: &[OrientedTriangle],
    tests: &SampleTests,
    view: &View,
) -> Result<(), DrawError> {
    within_samples(image, samples(triangles, tests, view))
}

fn within_samples(image: &'static str, samples: u64) -> Result<(), DrawError> {
    if samples > MAX_SAMPLES {
        return Err(DrawError::OracleSamples {
            image,
            samples,
            limit: MAX_SAMPLES,
        });
    }
    Ok(())
}

/// Samples in the bounding boxes of `triangles`.
fn samples(triangles: &[OrientedTriangle], tests: &SampleTests, view: &View) -> u64 {
    let of_triangle = |triangle: &OrientedTriangle| {
        let (columns, rows) = triangle.bounds(view, tests);
        columns.len() as u64 * rows.len() as u64
    };
    triangles.iter().map(of_triangle).sum()
}

/// Can a picture of `scene` at so many times the size of `view` be judged? A measurement that needs
/// verdicts asks before it begins. Particles are left out, since only an adapter knows where it
/// drew them.
pub fn can_judge(scene: &Scene, view: &View, stack: &Stack, scale: f64) -> Result<(), DrawError> {
    let (view, stack) = (&view.scaled(scale), &stack.scaled(scale));
    let draws = stack.draws(scene, view)?;
    budget::check(&Shot::new(scene, &draws, view, stack), Purpose::Judge)?;
    let [picture, shadow_map] = samples_of_images(scene, view, stack)?;
    within_samples("picture", picture)?;
    within_samples("shadow map", shadow_map)
}

/// Can a CPU draw `sequence`, views and stacks of which each needs the picture before it, at so
/// many times their size? Each is taken to be as much work as the last. The rasterizer of a CPU
/// adapter takes about as long for a sample as the oracle.
pub fn can_draw_sequence(
    scene: &Scene,
    sequence: &[(View, Stack)],
    scale: f64,
) -> Result<(), DrawError> {
    let Some((view, stack)) = sequence.last() else {
        return Ok(());
    };
    check_particle_work(view, stack, MAX_PARTICLE_WORK_OF_CPU_ADAPTER)?;
    let (view, stack) = (&view.scaled(scale), &stack.scaled(scale));
    let pictures = sequence.len() as u64;
    let texels = stack
        .shadow_map_view(scene, view)
        .map_or(0, |light| light.pixels());
    // Most pictures need no look at their triangles.
    let most = (view.pixels() + texels) as u64 * scene.triangle_count();
    if pictures.saturating_mul(most) <= MAX_SEQUENCE_SAMPLES
        || scene.triangle_count() > MAX_COUNTED_TRIANGLES
    {
        return Ok(());
    }
    let samples = pictures * samples_of_images(scene, view, stack)?.iter().sum::<u64>();
    if samples > MAX_SEQUENCE_SAMPLES {
        return Err(DrawError::SequenceSamples {
            pictures,
            samples,
            limit: MAX_SEQUENCE_SAMPLES,
        });
    }
    Ok(())
}

/// Samples that are tested for a picture and for its shadow map.
fn samples_of_images(scene: &Scene, view: &View, stack: &Stack) -> Result<[u64; 2], DrawError> {
    let count = |view: &View, stack: &Stack| {
        if view.pixels() == 0 {
            return Ok::<u64, DrawError>(0);
        }
        let draws = stack.draws(scene, view)?;
        let shot = Shot::new(scene, &draws, view, stack);
        let geometry = project(&shot)?;
        Ok(samples(
            &triangles(&shot, &geometry)?.0,
            &SampleTests::of_effects(stack, &geometry),
            view,
        ))
    };
    let light = stack.shadow_map_view(scene, view);
    Ok([
        count(view, stack)?,
        light.map_or(Ok(0), |light| count(&light, &stack.shadow_casters()))?,
    ])
}
