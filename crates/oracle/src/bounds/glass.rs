//! Which colors are right where something is seen through glass: each layer, and what lies behind,
//! has an interval of right answers, and composing is monotone in all of them.

use std::collections::HashMap;

use glam::{DVec3, DVec4};
use rayon::prelude::*;

use super::{
    super::render::{
        draw_order::ranks,
        glass::{GlassShader, linear_background},
        layers::LayerInput,
        shading::encoded,
        shadow::Light,
        surface::SurfaceTriangle,
    },
    layers::{LayerBounds, SampleShade},
    perturbations::{Search, WIDE_SLACK, of_layers},
    surface::{CornerErrors, Doubt},
};
use crate::{
    effects::{Surface, glass::GlassLayer},
    frame::GlassLayers,
    work::{Canceled, checkpoint},
};

/// Bound of the error of a shaded f32 color, of 1.
const COLOR_ERROR: f64 = 1.0 / (1 << 16) as f64;

/// Bound of the error of a number of a layer: shaded in f32, then rounded to steps of 1/65535.
const LAYER_ERROR: f64 = COLOR_ERROR + 0.51 / 65_535.0;

/// Of what all layers compose to, which is rounded once more.
const COMPOSED_ERROR: f64 = 0.51 / 65_535.0;

/// Right answers for a picture with these layers; of a wider search, at the pixels for which it is
/// asked.
pub fn glass_bounds(
    input: &LayerInput,
    layers: &GlassLayers,
    wider_at: Option<&[bool]>,
) -> Result<LayerBounds, Canceled> {
    let shot = &input.shot;
    let width = (shot.view.width as usize).max(1);
    let (ranks, light) = (
        ranks(shot, input.geometry)?,
        Light::of(shot, input.geometry),
    );
    let (background, shader) = (linear_background(shot), GlassShader::of(shot));
    let perturbations = of_layers(shot.scene, shot.view, shot.stack);
    let search = if wider_at.is_some() {
        Search::Wide
    } else {
        Search::Quick
    };
    let checkpoint = checkpoint();
    let row = |y: usize| {
        checkpoint.pass()?;
        let mut known: HashMap<u32, Option<(SurfaceTriangle, CornerErrors)>> = HashMap::new();
        let mut shaded = |id: u32, x: usize| {
            let of_triangle = || {
                Some((
                    SurfaceTriangle::new(shot, input.geometry, id)?,
                    CornerErrors::of(shot, id, input.geometry.packed_bits),
                ))
            };
            let (triangle, corners) = known.entry(id).or_insert_with(of_triangle).as_ref()?;
            let errors = corners.at(triangle, x, y);
            let shade = SampleShade {
                shot,
                light: light.as_ref(),
                rank: ranks.get(id as usize).copied().unwrap_or(0.0),
                perturbations: &perturbations,
                search,
            };
            let may_turn = corners.may_turn(triangle, x, y);
            let surfaces: Vec<Surface> = shade
                .surfaces(triangle, (errors, may_turn), [x, y])
                .collect();
            let slack = if errors.doubt() == Doubt::Wide {
                WIDE_SLACK
            } else {
                0.0
            };
            Some((surfaces, slack, triangle.scopes))
        };
        let pixel = |x: usize| {
            let pixel = y * width + x;
            if wider_at.is_some_and(|asked| !asked[pixel]) {
                return [DVec4::ZERO; 2];
            }
            let behind = shaded(layers.behind[pixel], x).map_or(
                [background[y]; 2],
                |(surfaces, slack, _)| {
                    let colors = surfaces.iter().map(|surface| surface.color);
                    widened(span4(colors), slack, COLOR_ERROR)
                },
            );
            let hits = layers.at(pixel);
            if hits.is_empty() {
                return behind.map(encoded);
            }
            let nothing = [GlassLayer::CLEAR; 2];
            let seen = hits.iter().fold(nothing, |seen, hit| {
                let Some((surfaces, slack, scopes)) = shaded(hit.triangle_id, x) else {
                    return seen;
                };
                let layers = surfaces.iter().map(|surface| shader.layer(surface, scopes));
                let span = layer_span(layers, slack);
                [0, 1].map(|end| seen[end].merged(&span[end]))
            });
            let error = 2.0 * COMPOSED_ERROR;
            let ends = [(0, -error), (1, error)];
            ends.map(|(end, error)| {
                let color = seen[end].over(behind[end].truncate()) + DVec3::splat(error);
                // The less passes, the more is covered.
                encoded(color.extend(seen[1 - end].alpha_over(behind[end].w) + error))
            })
        };
        Ok((0..width).map(pixel).collect::<Vec<_>>())
    };
    let rows = (0..shot.view.height as usize)
        .into_par_iter()
        .map(row)
        .collect::<Result<Vec<_>, Canceled>>()?;
    let counts = layers.counts();
    Ok(LayerBounds {
        colors: rows.concat(),
        counted: counts.iter().map(|&count| [count.into(); 2]).collect(),
    })
}

/// Smallest and largest value of each channel; there is a color.
fn span4(colors: impl Iterator<Item = DVec4>) -> [DVec4; 2] {
    colors
        .map(|color| [color; 2])
        .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
        .expect("a color")
}

/// An interval that is longer at both ends, by a fraction of its span and by an error; alpha stays.
fn widened([least, most]: [DVec4; 2], slack: f64, error: f64) -> [DVec4; 2] {
    let more = (most - least).truncate() * slack + DVec3::splat(error);
    [least - more.extend(0.0), most + more.extend(0.0)]
}

/// Between which layers those of f32 lie.
fn layer_span(layers: impl Iterator<Item = GlassLayer>, slack: f64) -> [GlassLayer; 2] {
    let [least, most] = layers
        .map(|layer| [layer; 2])
        .reduce(|a, b| {
            [
                GlassLayer {
                    passed: a[0].passed.min(b[0].passed),
                    added: a[0].added.min(b[0].added),
                },
                GlassLayer {
                    passed: a[1].passed.max(b[1].passed),
                    added: a[1].added.max(b[1].added),
                },
            ]
        })
        .expect("a layer");
    let ends = |least: DVec3, most: DVec3| {
        let more = (most - least) * slack + DVec3::splat(LAYER_ERROR);
        [
            (least - more).max(DVec3::ZERO),
            (most + more).min(DVec3::ONE),
        ]
    };
    let (passed, added) = (
        ends(least.passed, most.passed),
        ends(least.added, most.added),
    );
    [0, 1].map(|end| GlassLayer {
        passed: passed[end],
        added: added[end],
    })
}
