//! Reference pictures, against which accuracy options are measured: on the finest grid, with traced
//! shadows, at every render scale.

use rayon::prelude::*;

use super::{
    super::shot::Shot,
    picture::{render, render_rows, render_sequence},
    project::project,
    resample::resampled,
    shadow::leaves_samples_out,
};
use crate::{
    effects::Stack,
    frame::{Frame, Geometry, LightSum, linear_bytes},
    math::{GUARD_BAND, SUBPIXEL_BITS},
    measure::References,
    scene::{Scene, draw::DrawError, shadow_resolution::ShadowResolution, view::View},
};

/// The exact picture of the last of `sequence`, drawn with `factor` times as many pixels along a
/// side and shown at the size of its view.
///
/// # Panics
/// If `sequence` is empty.
pub fn render_scaled(
    scene: &Scene,
    sequence: &[(View, Stack)],
    factor: f64,
) -> Result<Frame, DrawError> {
    let (view, _) = sequence.last().expect("a sequence has a picture");
    if factor == 1.0 || view.pixels() == 0 {
        return render_sequence(scene, sequence);
    }
    let drawn: Vec<_> = sequence
        .iter()
        .map(|(view, stack)| (view.scaled(factor), stack.scaled(factor)))
        .collect();
    let frame = render_sequence(scene, &drawn)?;
    let size = [view.width, view.height];
    Ok(frame.shown(
        size,
        resampled(&frame.color, [frame.width, frame.height], size),
    ))
}

/// Row `row` of the picture of [`render_scaled`], without shading the others where a row depends on
/// none of them; empty if there is no such row.
///
/// # Panics
/// If `sequence` is empty.
pub fn render_scaled_row(
    scene: &Scene,
    sequence: &[(View, Stack)],
    factor: f64,
    row: u32,
) -> Result<Vec<[u8; 4]>, DrawError> {
    let ((view, stack), before) = sequence.split_last().expect("a sequence has a picture");
    let side = factor as u32;
    if f64::from(side) != factor || row >= view.height {
        // Between two rows of a smaller picture lie the colors of both.
        let color = render_scaled(scene, sequence, factor)?.color;
        let mut rows = color.chunks(view.width.max(1) as usize);
        return Ok(rows.nth(row as usize).unwrap_or_default().to_vec());
    }
    let scaled = |(view, stack): &(View, Stack)| (view.scaled(factor), stack.scaled(factor));
    let before: Vec<_> = before.iter().map(scaled).collect();
    let earlier = match &before[..] {
        [] => None,
        before => Some(render_sequence(scene, before)?),
    };
    let (drawn, stack) = scaled(&(view.clone(), stack.clone()));
    let rows = row * side..(row + 1) * side;
    let earlier = earlier.as_ref().map(Frame::earlier);
    let color = render_rows(scene, &drawn, &stack, earlier, rows)?.color;
    Ok(match side {
        1 => color,
        _ => resampled(&color, [drawn.width, side], [view.width, 1]),
    })
}

/// The largest number of sub-pixel bits, at most 12, with which every pixel of `view` lies inside
/// the guard band.
pub fn finest_bits(view: &View) -> u32 {
    let side = i64::from(view.width.max(view.height)).max(1);
    (SUBPIXEL_BITS..=12)
        .rev()
        .find(|bits| side << bits <= i64::from(GUARD_BAND))
        .unwrap_or(SUBPIXEL_BITS)
}

/// The exact picture on the finest grid that holds it, with positions relative to the eye before
/// any rounding: the reference for coarser grids and rounded positions.
pub fn render_finest(scene: &Scene, view: &View, stack: &Stack) -> Result<Frame, DrawError> {
    render(scene, &finest(view, stack), stack)
}

/// The geometry of that picture.
pub fn project_finest(scene: &Scene, view: &View, stack: &Stack) -> Result<Geometry, DrawError> {
    let view = finest(view, stack);
    Ok(project(&Shot::new(
        scene,
        &stack.draws(scene, &view)?,
        &view,
        stack,
    ))?)
}

/// The picture of [`render_finest`] with traced shadows: the reference for shadow maps. If effects
/// leave samples out, of which rays know nothing, shadows come from the map of `view`.
pub fn render_reference(scene: &Scene, view: &View, stack: &Stack) -> Result<Frame, DrawError> {
    render_finest(scene, &traced(view, stack), stack)
}

fn finest(view: &View, stack: &Stack) -> View {
    // Sample effects measure triangles in 1/256 px.
    let is_measured =
        stack.each(|hooks| hooks.sample.as_ref()).next().is_some() || stack.point_radius() > 0;
    let subpixel_bits = if is_measured {
        SUBPIXEL_BITS
    } else {
        finest_bits(view)
    };
    view.with_grid(subpixel_bits, true)
}

fn traced(view: &View, stack: &Stack) -> View {
    let has_rays = stack.light().is_some() && !leaves_samples_out(stack);
    view.with_shadow(if has_rays {
        ShadowResolution::TRACED
    } else {
        view.precision.shadow
    })
}

/// The references of a picture: exact pictures and geometry on the finest grid for every render
/// scale in `factors`, and, if there are several, the picture with 64 samples per pixel.
pub fn references(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    factors: &[f64],
) -> Result<References, DrawError> {
    let view = &traced(view, stack);
    let at = |&factor: &f64| {
        let (view, stack) = (view.scaled(factor), stack.scaled(factor));
        Ok((
            factor,
            render_finest(scene, &view, &stack)?,
            project_finest(scene, &view, &stack)?,
        ))
    };
    let pictures = factors
        .iter()
        .map(at)
        .collect::<Result<Vec<_>, DrawError>>()?;
    let smooth = if factors.len() > 1 {
        Some(supersampled(scene, view, stack)?)
    } else {
        None
    };
    Ok(References { pictures, smooth })
}

/// Samples along a side of a pixel.
const SAMPLES: u32 = 8;

/// The mean of 64 pictures, each shifted by a fraction of a pixel: eight by eight samples per
/// pixel, with image effects as large as in a single picture.
fn supersampled(scene: &Scene, view: &View, stack: &Stack) -> Result<Vec<[u8; 4]>, DrawError> {
    let light = linear_bytes();
    let mut sums = vec![LightSum::default(); view.pixels()];
    for sample in 0..SAMPLES * SAMPLES {
        let shift = [sample % SAMPLES, sample / SAMPLES]
            .map(|i| 0.5 - (f64::from(i) + 0.5) / f64::from(SAMPLES));
        let frame = render_finest(scene, &view.shifted(shift), stack)?;
        let weight = 1.0 / f64::from(SAMPLES * SAMPLES);
        sums.par_iter_mut()
            .zip(&frame.color)
            .for_each(|(sum, color)| sum.add(color, weight, &light));
    }
    Ok(sums.iter().map(LightSum::bytes).collect())
}
