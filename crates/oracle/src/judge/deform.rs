//! Judges the vertices that an adapter deformed.

use glam::DVec3;
use rayon::prelude::*;

use super::super::{
    bounds::deform::{self, Bounded},
    render::deform::vertex_count,
    shot::Shot,
};
use crate::{
    effects::hooks::ROUNDING,
    measure::ErrorReport,
    scene::draw::{Draw, MAX_MAGNITUDE},
};

/// What was found about one vertex.
#[derive(Default)]
struct DeformError {
    is_outside: bool,
    /// Distance in units of the last place of the largest coordinate.
    ulp: f64,
    /// Distance in the picture.
    px: f64,
}

/// Compares the vertices that an adapter deformed, in draw order, with their bounds.
///
/// # Panics
/// If their number is not that of the vertices which deform.
pub fn judge_deformed(report: &mut ErrorReport, shot: &Shot, deformed: &[[f32; 6]]) {
    let total: usize = shot
        .draws
        .iter()
        .map(|draw| vertex_count(shot.scene, draw) as usize)
        .sum();
    assert_eq!(
        deformed.len(),
        total,
        "the deformed vertices are of another scene"
    );
    let mut first = 0;
    for draw in shot.draws.iter().filter(|draw| draw.deform.is_some()) {
        let given = &deformed[first..first + vertex_count(shot.scene, draw) as usize];
        first += given.len();
        let errors: Vec<_> = given
            .par_iter()
            .enumerate()
            .map(|(i, given)| deform_error(shot, draw, i as u32, given))
            .collect();
        report.deformed_vertices += errors.len() as u64;
        for DeformError {
            is_outside,
            ulp,
            px,
        } in errors
        {
            report.deformed_outside_bound += u64::from(is_outside);
            report.max_deform_ulp = report.max_deform_ulp.max(ulp);
            report.max_deform_px = report.max_deform_px.max(px);
        }
    }
}

fn deform_error(shot: &Shot, draw: &Draw, vertex: u32, given: &[f32; 6]) -> DeformError {
    let [px, py, pz, nx, ny, nz] = given.map(f64::from);
    let (position, normal) = (DVec3::new(px, py, pz), DVec3::new(nx, ny, nz));
    // A vertex that is refused must be out of range in some component, with any bits: NaN is below
    // no limit.
    let Ok(reference) = deform::position(shot.scene, draw, vertex) else {
        return DeformError {
            is_outside: position.abs().cmplt(DVec3::splat(MAX_MAGNITUDE)).all(),
            ..DeformError::default()
        };
    };
    let reference_normal = deform::normal(shot.scene, draw, vertex);
    let is_outside = !is_near(position, &reference)
        || reference_normal.is_some_and(|reference| !is_near(normal, &reference));
    let largest = reference
        .value
        .abs()
        .max_element()
        .max(f64::from(f32::MIN_POSITIVE));
    let spacing = f64::from(f32::EPSILON) * libm::exp2(libm::floor(libm::log2(largest)));
    let on_screen = [position, reference.value].map(|position| projected(shot, draw, position));
    let px = on_screen[0]
        .zip(on_screen[1])
        .map_or(0.0, |(a, b)| libm::hypot(a[0] - b[0], a[1] - b[1]));
    DeformError {
        is_outside,
        ulp: (position - reference.value).abs().max_element() / spacing,
        px,
    }
}

fn is_near(given: DVec3, reference: &Bounded) -> bool {
    // The second term is the rounding to the f32 that the adapter stores.
    let error = reference.error
        + reference.value.abs() * ROUNDING
        + DVec3::splat(f64::from(f32::MIN_POSITIVE));
    (given - reference.value).abs().cmple(error).all()
}

/// An object-space position in the picture, in pixels from its center; none between the eye and the
/// near plane.
fn projected(shot: &Shot, draw: &Draw, position: DVec3) -> Option<[f64; 2]> {
    let p = position - draw.origin();
    let row = |r: usize| {
        let m = |column: usize| f64::from(draw.clip_from_object[column][r]);
        m(0) * p.x + m(1) * p.y + m(2) * p.z + m(3)
    };
    let (z, w) = (row(2), row(3));
    let [width, height] = [shot.view.width, shot.view.height].map(f64::from);
    (z <= w && w > 0.0).then(|| [row(0) / w * 0.5 * width, row(1) / w * 0.5 * height])
}
