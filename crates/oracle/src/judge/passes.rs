//! The verdict about image passes: given the adapter's own picture before them, which has been
//! judged, every pixel after them must lie between the pictures that the passes make of it at the
//! ends of what f32 may err by.

use glam::DVec4;

use super::super::{
    bounds::perturbations::STEP,
    render::{
        passes::{PassPerturbation, PassStart, passed_colors},
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
pub fn judge_passes(verdict: &mut Verdict, shot: &Shot, frame: &Frame) -> Result<(), Canceled> {
    let input = ResolveInput {
        triangle_ids: &frame.triangle_id,
        depth_keys: &frame.depth_key,
        dots: &[],
        previous: None,
    };
    let kept = frame.kept.as_ref();
    let start = PassStart {
        resolved: frame.resolved(),
        kept: kept.map_or(&[], |kept| &kept.before),
    };
    let mut ends = unknown(frame.color.len());
    let mut kept_ends = unknown(kept.map_or(0, |kept| kept.after.len()));
    for perturbation in PERTURBATIONS {
        let passed = passed_colors(shot, &input, start, perturbation)?;
        widen(&mut ends, passed.colors);
        widen(&mut kept_ends, passed.kept.unwrap_or_default());
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
    let kept_delta = kept.map_or(0, |kept| kept_delta(&kept_ends, &kept.after));
    report.max_color_delta = report.max_color_delta.max(delta.max_delta).max(kept_delta);
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

/// The ends of what is right for each of so many pixels, before any is known.
fn unknown(pixels: usize) -> Vec<[DVec4; 2]> {
    vec![[DVec4::INFINITY, DVec4::NEG_INFINITY]; pixels]
}

/// Moves the ends apart so that `colors` are right too.
fn widen(ends: &mut [[DVec4; 2]], colors: Vec<DVec4>) {
    for ([least, most], color) in ends.iter_mut().zip(colors) {
        (*least, *most) = (least.min(color), most.max(color));
    }
}

/// How far the farthest channel that the kept pass wrote lies from what is right, in steps of 1/255,
/// rounded up. Channels are not limited to 1, so an f32 may be off by a fraction of its size.
fn kept_delta(ends: &[[DVec4; 2]], written: &[[f32; 4]]) -> u8 {
    let beyond = ends.iter().zip(written).map(|([least, most], written)| {
        let written = DVec4::from_array(written.map(f64::from));
        let room = TIE * (1.0 + written.abs().max_element());
        let outside = (least - written).max(written - most) - room;
        outside.max_element().max(0.0)
    });
    (255.0 * beyond.fold(0.0, f64::max)).ceil() as u8
}
