//! The verdict about image passes: given the adapter's own picture before them, which has been
//! judged, every pixel after them must lie between the pictures that the passes make of it at the
//! ends of what f32 may err by.

use glam::DVec4;

use super::super::{
    bounds::perturbations::STEP,
    render::{
        passes::{PassPerturbation, passed_colors},
        resolve::{ResolveInput, TIE, bytes},
    },
    shot::Shot,
};
use crate::{
    effects::hooks::Signs,
    frame::Frame,
    measure::{Verdict, compare},
    work::Canceled,
};

/// The picture itself first, then those between which every right one lies.
const PERTURBATIONS: [PassPerturbation; 6] = {
    const fn at(step_offset: f64, signs: Signs) -> PassPerturbation {
        PassPerturbation { step_offset, signs }
    }
    [
        at(0.0, Signs::None),
        at(0.0, Signs::Up),
        at(0.0, Signs::Down),
        at(0.0, Signs::Checkered),
        at(-STEP, Signs::None),
        at(STEP, Signs::None),
    ]
};

/// Judges the passes of a picture and adds to the `verdict` about the picture before them.
///
/// # Errors
/// The work was canceled.
pub fn judge_passes(verdict: &mut Verdict, shot: &Shot, frame: &Frame) -> Result<(), Canceled> {
    let input = ResolveInput {
        triangle_ids: &frame.triangle_id,
        depth_keys: &frame.depth_key,
        dots: &[],
        previous: None,
    };
    let mut ends = vec![[DVec4::INFINITY, DVec4::NEG_INFINITY]; frame.color.len()];
    for perturbation in PERTURBATIONS {
        let colors = passed_colors(shot, &input, frame.resolved(), perturbation)?;
        for ([least, most], color) in ends.iter_mut().zip(colors) {
            (*least, *most) = (least.min(color), most.max(color));
        }
    }
    let right: Vec<[[u8; 4]; 2]> = ends
        .into_iter()
        .map(|[least, most]| [bytes(least - TIE), bytes(most + TIE)])
        .collect();
    let nearest: Vec<[u8; 4]> = right
        .iter()
        .zip(&frame.color)
        .map(|([least, most], color)| [0, 1, 2, 3].map(|c| color[c].clamp(least[c], most[c])))
        .collect();
    let report = &mut verdict.report;
    let [delta, beyond] = [0, 1].map(|step| compare::pictures(&nearest, &frame.color, step));
    report.max_color_delta = report.max_color_delta.max(delta.max_delta);
    report.rms_color_delta = report.rms_color_delta.max(delta.rms);
    let rounding = delta.pixels_over_tolerance - beyond.pixels_over_tolerance;
    report.rounding_pixels = report.rounding_pixels.max(rounding);
    // Pixels with right answers more than 1 of 255 apart.
    let is_band = |[least, most]: &[[u8; 4]; 2]| (0..4).any(|c| most[c] - least[c] > 1);
    let band: Vec<bool> = right.iter().map(is_band).collect();
    let mut sets: Vec<&[[u8; 4]; 2]> = right.iter().filter(|ends| is_band(ends)).collect();
    sets.sort_unstable();
    sets.dedup();
    report.step_band_colors = report.step_band_colors.max(sets.len() as u64);
    verdict.step_band.resize(band.len(), false);
    for (either, of_passes) in verdict.step_band.iter_mut().zip(band) {
        *either |= of_passes;
    }
    report.step_band_pixels = verdict.step_band.iter().filter(|is_band| **is_band).count() as u64;
    let map = &mut verdict.error_map.color_delta;
    for (i, delta) in map.iter_mut().enumerate() {
        let of_passes = (0..4)
            .map(|c| nearest[i][c].abs_diff(frame.color[i][c]))
            .max();
        *delta = (*delta).max(of_passes.unwrap_or(0));
    }
    let expected = &mut verdict.expected;
    expected.resolved = Some(std::mem::replace(&mut expected.color, nearest));
    Ok(())
}
