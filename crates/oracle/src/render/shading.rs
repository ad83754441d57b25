//! Shading of whole rows in f64: surface effects on what is known of each sample
//! (`docs/exactness.md` §7).

use std::ops::Range;

use glam::DVec4;
use rayon::prelude::*;

use super::{
    super::{perturbation::Perturbation, shot::Shot},
    background::background,
    draw_order::ranks,
    shadow::Light,
    surface::SurfaceTriangle,
};
use crate::{
    effects::Surface,
    frame::Geometry,
    math::srgb,
    work::{Canceled, checkpoint},
};

/// Surface colors of all pixels in `rows`, given the triangle of each pixel of the picture; the
/// background without one. Row-major, gamma-encoded.
///
/// `geometry` supplies the snapped corners from which weights follow; triangles that were clipped
/// are weighted in clip space.
pub fn surface_colors(
    shot: &Shot,
    triangle_ids: &[u32],
    geometry: &Geometry,
    perturbation: &Perturbation,
    rows: Range<u32>,
) -> Result<Vec<DVec4>, Canceled> {
    let background = background(shot.view);
    let ranks = ranks(shot, geometry)?;
    let light = Light::of(shot, geometry);
    let visit = |y: usize, found: Option<(&SurfaceTriangle, Surface)>| {
        let (triangle, surface) = found.ok_or(background[y])?;
        let id = surface.triangle_id;
        let rank = ranks.get(id as usize).copied().unwrap_or(0.0);
        let surface = Surface { rank, ..surface };
        let step = perturbation.color_step;
        Ok((
            triangle.scopes,
            lit_surface(triangle, surface, light.as_ref(), step),
        ))
    };
    let shade = |row: Vec<Result<(u32, Surface), DVec4>>| {
        let (scopes, mut surfaces): (Vec<u32>, Vec<Surface>) =
            row.iter().flatten().copied().unzip();
        shade_runs(shot, &scopes, &mut surfaces);
        let mut colors = surfaces.into_iter().map(|surface| encoded(surface.color));
        let of_pixel = |pixel: Result<_, DVec4>| match pixel {
            Ok(_) => colors.next().unwrap_or_default(),
            Err(background) => background,
        };
        row.into_iter().map(of_pixel).collect()
    };
    each_row(
        rows,
        shot,
        triangle_ids,
        geometry,
        perturbation,
        visit,
        shade,
    )
}

/// Pixels that are shaded together, so that an effect's text is evaluated for all of them at once.
pub const TOGETHER: usize = 64;

/// Shades surfaces by the effects that act on their draws, whose scopes are given.
pub fn shade_runs(shot: &Shot, scopes: &[u32], mut surfaces: &mut [Surface]) {
    for run in scopes.chunk_by(|a, b| a == b) {
        let (own, others) = surfaces.split_at_mut(run.len());
        for together in own.chunks_mut(TOGETHER) {
            shot.stack.shade_all(together, run[0], &shot.light());
        }
        surfaces = others;
    }
}

/// A surface of `triangle` as the light reaches it, whose steps are moved by `color_step`.
pub fn lit_surface(
    triangle: &SurfaceTriangle,
    surface: Surface,
    light: Option<&Light>,
    color_step: f64,
) -> Surface {
    let lit = light.map_or(0.0, |light| {
        light.arrives(&triangle.lit_point(&surface), triangle.id, color_step)
    });
    Surface {
        lit,
        step_offset: color_step,
        ..surface
    }
}

/// Visits the row and the surface of every pixel before any surface effect, given the triangle of
/// each; none without one. Row-major.
pub fn each_surface<T: Send>(
    shot: &Shot,
    triangle_ids: &[u32],
    geometry: &Geometry,
    perturbation: &Perturbation,
    visit: impl Fn(usize, Option<(&SurfaceTriangle, Surface)>) -> T + Sync,
) -> Result<Vec<T>, Canceled> {
    let (rows, all) = (0..shot.view.height, |row| row);
    each_row(rows, shot, triangle_ids, geometry, perturbation, visit, all)
}

/// The same, only in `rows`, and what `of_row` makes of all that `visit` gives in a row.
fn each_row<V, T: Send>(
    rows: Range<u32>,
    shot: &Shot,
    triangle_ids: &[u32],
    geometry: &Geometry,
    perturbation: &Perturbation,
    visit: impl Fn(usize, Option<(&SurfaceTriangle, Surface)>) -> V + Sync,
    of_row: impl Fn(Vec<V>) -> Vec<T> + Sync,
) -> Result<Vec<T>, Canceled> {
    let width = shot.view.width.max(1) as usize;
    let checkpoint = checkpoint();
    let row = |(y, ids): (usize, &[u32])| {
        checkpoint.pass()?;
        let mut triangle: Option<SurfaceTriangle> = None;
        let pixel = |(x, &id): (usize, &u32)| {
            // Neighbors usually show the same triangle.
            if triangle.as_ref().is_none_or(|triangle| triangle.id != id) {
                triangle = SurfaceTriangle::new(shot, geometry, id);
            }
            visit(
                y,
                triangle
                    .as_ref()
                    .map(|triangle| (triangle, triangle.surface(x, y, perturbation))),
            )
        };
        Ok(of_row(ids.iter().enumerate().map(pixel).collect()))
    };
    let found = triangle_ids
        .par_chunks(width)
        .enumerate()
        .skip(rows.start as usize)
        .take(rows.len())
        .map(row)
        .collect::<Result<Vec<_>, Canceled>>()?;
    let mut all = Vec::with_capacity(rows.len() * width);
    found.into_iter().for_each(|row| all.extend(row));
    Ok(all)
}

/// Linear RGBA as sRGB, each channel from 0 to 1; alpha is not gamma-encoded.
pub fn encoded(color: DVec4) -> DVec4 {
    DVec4::new(
        srgb(color.x),
        srgb(color.y),
        srgb(color.z),
        color.w.clamp(0.0, 1.0),
    )
}
