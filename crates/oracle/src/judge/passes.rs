//! The verdict about image passes: given the adapter's own picture before them, which has been
//! judged, every pixel after them must lie between the pictures that the passes make of it at the
//! ends of what f32 may err by.
//!
//! The ends are found pass by pass: the next one runs over all smallest values, all largest, and
//! both by turns like a chessboard. So a step that a pixel of an early pass may take to either side
//! bounds what later passes make of it, whichever of its neighbors take theirs.

use glam::DVec4;

use super::super::{
    bounds::perturbations::STEP,
    render::{
        passes::{PassPerturbation, PassStart, Step, begun, gamma_encoded, steps},
        resolve::{PictureTables, ResolveInput, TIE, bytes},
    },
    shot::Shot,
};
use crate::{
    effects::hooks::{Image, Picture, Signs},
    frame::Frame,
    measure::{Verdict, compare},
    work::Canceled,
};

/// How much a color that a pass reads may be off in f32, as a fraction of its largest channel:
/// what `pow` may err by, and some 2^6 operations.
const COLOR_ERROR: f64 = 1.0 / (1 << 17) as f64;

/// Between which values every pixel of an image lies: the smallest, and the largest.
struct Ends([Image; 2]);

impl Ends {
    /// Of colors that were written in f32.
    fn of(image: Image) -> Self {
        let mut ends = Self([image.clone(), image]);
        ends.err();
        ends
    }

    /// Moves the ends apart by what the colors that were written may be off.
    fn err(&mut self) {
        for (image, sign) in self.0.iter_mut().zip([-1.0, 1.0]) {
            for color in &mut image.colors {
                let rgb = color.truncate();
                let by = sign * COLOR_ERROR * rgb.abs().max_element();
                *color = (rgb + by).extend(color.w);
            }
        }
    }

    /// The smallest value where `signs` are down, the largest where they are up, else the middle.
    fn at(&self, signs: Signs) -> Image {
        let [least, most] = &self.0;
        let width = least.size[0] as usize;
        let each = least.colors.iter().zip(&most.colors).enumerate();
        let color = |(i, (&least, &most)): (usize, (&DVec4, &DVec4))| match signs
            .at((i % width) as i64, (i / width) as i64)
        {
            0.0 => 0.5 * (least + most),
            sign if sign < 0.0 => least,
            _ => most,
        };
        Image {
            size: least.size,
            colors: each.map(color).collect(),
        }
    }

    /// Moves the ends apart so that `image` lies between them.
    fn widen(&mut self, image: Image) {
        let Self([least, most]) = self;
        let ends = least.colors.iter_mut().zip(&mut most.colors);
        for ((least, most), color) in ends.zip(image.colors) {
            (*least, *most) = (least.min(color), most.max(color));
        }
    }
}

/// What an adapter may give where a channel is NaN or infinite, at most; at least 0, which the
/// kernel stores. A compiler may assume that neither occurs, so that `z / z` is 1 on NVIDIA cards.
const NO_NUMBER: f64 = 1.0;

/// How a pass is run: over which values, and how it errs itself.
const RUNS: [(Signs, PassPerturbation); 8] = {
    const fn at(signs: Signs, step_offset: f64) -> (Signs, PassPerturbation) {
        let no_number = match signs {
            Signs::Up => NO_NUMBER,
            _ => 0.0,
        };
        let perturbation = PassPerturbation {
            step_offset,
            signs,
            no_number,
        };
        (signs, perturbation)
    }
    [
        at(Signs::None, 0.0),
        at(Signs::Up, 0.0),
        at(Signs::Down, 0.0),
        at(Signs::Checkered, 0.0),
        at(Signs::Up, -STEP),
        at(Signs::Up, STEP),
        at(Signs::Down, -STEP),
        at(Signs::Down, STEP),
    ]
};

/// The ends of what a pass may write, given those of what it reads.
fn written(
    shot: &Shot,
    picture: &Picture,
    step: &Step,
    source: &Ends,
    last: Option<&Ends>,
) -> Result<Ends, Canceled> {
    let mut ends: Option<Ends> = None;
    for (signs, perturbation) in RUNS {
        let source = source.at(signs);
        let last = last.map(|last| last.at(signs));
        let read = [&source, last.as_ref().unwrap_or(&source)];
        let image = step.written(shot, picture, read, perturbation)?;
        match &mut ends {
            Some(ends) => ends.widen(image),
            None => ends = Some(Ends([image.clone(), image])),
        }
    }
    let mut ends = ends.expect("a pass runs");
    ends.err();
    Ok(ends)
}

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
    let tables = PictureTables::of(shot);
    let picture = tables.picture(shot, &input);
    let mut source = Ends::of(begun(shot, start.resolved)?);
    let mut last: Option<Ends> = None;
    let mut kept_delta = 0;
    for step in steps(shot, start.kept) {
        let ends = written(shot, &picture, &step, &source, last.as_ref())?;
        if let Some(kept) = kept.filter(|_| step.is_kept()) {
            kept_delta = delta_of_kept(&ends, &kept.after);
        }
        if step.ends_effect() {
            (source, last) = (ends, None);
        } else {
            last = Some(ends);
        }
    }
    let Ends([least, most]) = source;
    let ends = least.colors.into_iter().zip(most.colors);
    let right: Vec<[[u8; 4]; 2]> = ends
        .map(|(least, most)| {
            [(least, -TIE), (most, TIE)].map(|(c, by)| bytes(gamma_encoded(c) + by))
        })
        .collect();
    let nearest: Vec<[u8; 4]> = right
        .iter()
        .zip(&frame.color)
        .map(|([least, most], color)| [0, 1, 2, 3].map(|c| color[c].clamp(least[c], most[c])))
        .collect();
    let report = &mut verdict.report;
    let [delta, beyond] = [0, 1].map(|step| compare::pictures(&nearest, &frame.color, step));
    report.max_color_delta = report.max_color_delta.max(delta.max_delta).max(kept_delta);
    report.rms_color_delta = report.rms_color_delta.max(delta.rms);
    let rounding = delta.pixels_over_tolerance - beyond.pixels_over_tolerance;
    report.rounding_pixels = report.rounding_pixels.max(rounding);
    // Pixels with right answers more than 1 of 255 apart: what the passes can turn, however much
    // of the picture that is.
    let is_band = |[least, most]: &[[u8; 4]; 2]| (0..4).any(|c| most[c] - least[c] > 1);
    let band: Vec<bool> = right.iter().map(is_band).collect();
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

/// How far the farthest channel that the kept pass wrote lies from what is right, in steps of 1/255,
/// rounded up. Channels are not limited to 1, so an f32 may be off by a fraction of its size.
fn delta_of_kept(Ends([least, most]): &Ends, written: &[[f32; 4]]) -> u8 {
    let ends = least.colors.iter().zip(&most.colors);
    let beyond = ends.zip(written).map(|((&least, &most), written)| {
        let written = DVec4::from_array(written.map(f64::from));
        let room = TIE * (1.0 + written.abs().max_element());
        let outside = (least - written).max(written - most) - room;
        outside.max_element().max(0.0)
    });
    (255.0 * beyond.fold(0.0, f64::max)).ceil() as u8
}
