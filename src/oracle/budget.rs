//! What a picture may cost the oracle, checked before anything is allocated: a small file can place a large mesh many times.

use std::sync::OnceLock;

use super::{
    render::{
        project::project,
        sample_tests::SampleTests,
        shadow::shadow_map_view,
        triangles::{OrientedTriangle, triangles},
    },
    shot::Shot,
};
use crate::{
    effects::Stack,
    scene::{
        Scene,
        draw::{Draw, DrawError, totals},
        view::View,
    },
};

/// Memory of a picture, GiB, unless the environment says otherwise.
const MEMORY_GIB: f64 = 4.0;

/// The variable of the environment that changes it.
const VARIABLE: &str = "RASTERLAB_ORACLE_GIB";

/// Most positions that are computed: each vertex of each instance once, and once more for each of its morph targets.
const MAX_POSITIONS: u64 = 1 << 32;

/// Most samples that are tested for one image: those of every triangle's bounding box. Two cores took 22 s for them (2026-11-25).
const MAX_SAMPLES: u64 = 1 << 31;

/// Most samples that are tested for all pictures on which one depends.
const MAX_SEQUENCE_SAMPLES: u64 = 1 << 32;

/// Bytes of each pixel: its sample, triangle id, depth key, color in f64 and in bytes.
const PIXEL_BYTES: u64 = 12 + 4 + 4 + 32 + 4;
/// More bytes of each pixel where layers are summed.
const LAYER_BYTES: u64 = 32 + 4;
/// Bytes of each texel of a shadow map: its depth in f64 and its key.
const TEXEL_BYTES: u64 = 8 + 4;
/// Bytes of each vertex of each instance: the record of its projection.
const VERTEX_BYTES: u64 = 20;
/// More bytes of each vertex that deforms: its position and normal.
const DEFORMED_BYTES: u64 = 64;
/// Bytes of each triangle of each instance, in a list that grows by doubling.
const TRIANGLE_BYTES: u64 = 2 * 80;

/// Who draws: the judge compares two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Draw,
    Judge,
}

/// Refuses a picture that takes more memory or work than the oracle may.
///
/// # Errors
/// [`DrawError::OracleMemory`] or [`DrawError::OracleWork`].
pub fn check(shot: &Shot, purpose: Purpose) -> Result<(), DrawError> {
    let needed_gib = bytes(shot) as f64 * if purpose == Purpose::Judge { 2.0 } else { 1.0 } / f64::from(1 << 30);
    let limit_gib = memory_gib();
    if needed_gib > limit_gib {
        return Err(DrawError::OracleMemory { needed_gib, limit_gib, variable: VARIABLE });
    }
    let positions = positions(shot);
    if positions > MAX_POSITIONS {
        return Err(DrawError::OracleWork { positions, limit: MAX_POSITIONS });
    }
    Ok(())
}

/// Refuses an image, "picture" or "shadow map", for which more samples would be tested than the oracle may test.
///
/// # Errors
/// [`DrawError::OracleSamples`].
pub fn check_samples(image: &'static str, triangles: &[OrientedTriangle], tests: &SampleTests, view: &View) -> Result<(), DrawError> {
    within_samples(image, samples(triangles, tests, view))
}

fn within_samples(image: &'static str, samples: u64) -> Result<(), DrawError> {
    if samples > MAX_SAMPLES {
        return Err(DrawError::OracleSamples { image, samples, limit: MAX_SAMPLES });
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

/// Can a picture of `scene` at so many times the size of `view` be judged? A measurement that needs verdicts asks before it begins.
/// Particles are left out, since only an adapter knows where it drew them.
///
/// # Errors
/// As [`judge`](crate::oracle::judge).
pub fn can_judge(scene: &Scene, view: &View, stack: &Stack, scale: f64) -> Result<(), DrawError> {
    let (view, stack) = (&view.scaled(scale), &stack.scaled(scale));
    let draws = stack.draws(scene, view)?;
    check(&Shot::new(scene, &draws, view, stack), Purpose::Judge)?;
    let [picture, shadow_map] = samples_of_images(scene, view, stack)?;
    within_samples("picture", picture)?;
    within_samples("shadow map", shadow_map)
}

/// Can a processor draw `sequence`, views and stacks of which each needs the picture before it, at so many times their size? Each is
/// taken to be as much work as the last. The rasterizer of a CPU adapter takes about as long for a sample as the oracle.
///
/// # Errors
/// [`DrawError`] if a transform or the number of triangles is out of range, or if too many samples would be tested.
pub fn can_draw_sequence(scene: &Scene, sequence: &[(View, Stack)], scale: f64) -> Result<(), DrawError> {
    let Some((view, stack)) = sequence.last() else { return Ok(()) };
    let (view, stack) = (&view.scaled(scale), &stack.scaled(scale));
    let pictures = sequence.len() as u64;
    let texels = shadow_map_view(scene, view, stack).map_or(0, |light| light.pixels());
    // Most pictures need no look at their triangles.
    let most = (view.pixels() + texels) as u64 * scene.triangle_count();
    if pictures.saturating_mul(most) <= MAX_SEQUENCE_SAMPLES {
        return Ok(());
    }
    let draws = stack.draws(scene, view)?;
    if check(&Shot::new(scene, &draws, view, stack), Purpose::Draw).is_err() {
        return Ok(()); // Too large to be counted: the oracle refuses it, and an adapter finds out by itself.
    }
    let samples = pictures * samples_of_images(scene, view, stack)?.iter().sum::<u64>();
    if samples > MAX_SEQUENCE_SAMPLES {
        return Err(DrawError::SequenceSamples { pictures, samples, limit: MAX_SEQUENCE_SAMPLES });
    }
    Ok(())
}

/// Samples that are tested for a picture and for its shadow map.
fn samples_of_images(scene: &Scene, view: &View, stack: &Stack) -> Result<[u64; 2], DrawError> {
    let count = |view: &View, stack: &Stack| {
        let draws = stack.draws(scene, view)?;
        let shot = Shot::new(scene, &draws, view, stack);
        let geometry = project(&shot);
        Ok(samples(&triangles(&shot, &geometry).0, &SampleTests::of_effects(stack, &geometry), view))
    };
    let light = shadow_map_view(scene, view, stack);
    Ok([count(view, stack)?, light.map_or(Ok(0), |light| count(&light, &stack.shadow_casters()))?])
}

/// Memory of the picture at its peak, bytes, if no triangle is turned away.
fn bytes(shot: &Shot) -> u64 {
    let [vertices, triangles] = totals(shot.scene, shot.draws);
    let records = if shot.stack.unshares_vertices() { 3 * triangles } else { vertices };
    let pixel = PIXEL_BYTES + if shot.stack.layers(triangles).is_some() { LAYER_BYTES } else { 0 };
    let deforming = shot.draws.iter().map(|draw| &shot.scene.primitives[draw.primitive]).filter(|mesh| !mesh.deformation.is_none());
    let deformed: u64 = deforming.map(|mesh| u64::from(mesh.vertex_count())).sum();
    let texels = shadow_map_view(shot.scene, shot.view, shot.stack).map_or(0, |light| light.pixels() as u64);
    shot.view.pixels() as u64 * pixel
        + texels * TEXEL_BYTES
        + records * VERTEX_BYTES
        + deformed * DEFORMED_BYTES
        + triangles * TRIANGLE_BYTES
}

fn positions(shot: &Shot) -> u64 {
    let of_draw = |draw: &Draw| {
        let primitive = &shot.scene.primitives[draw.primitive];
        u64::from(primitive.vertex_count()) * (1 + primitive.deformation.morph_targets.len() as u64)
    };
    shot.draws.iter().map(of_draw).sum()
}

/// The memory that a picture may take, GiB.
fn memory_gib() -> f64 {
    static LIMIT: OnceLock<f64> = OnceLock::new();
    let given = || std::env::var(VARIABLE).ok()?.trim().parse::<f64>().ok().filter(|gib| *gib > 0.0);
    *LIMIT.get_or_init(|| given().unwrap_or(MEMORY_GIB))
}
