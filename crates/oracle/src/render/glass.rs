//! Glass: all layers of a pixel sorted by exact depth, shaded and composed in
//! f64, in linear light.

use std::{cmp::Reverse, collections::HashMap};

use glam::DVec4;
use rayon::prelude::*;

use super::{
    super::{arithmetic::depth_key::depth_key, perturbation::Perturbation, shot::Shot},
    background::background,
    coverage::{Hit, scatter},
    draw_order::ranks,
    layers::LayerInput,
    sample_rules::SampleTests,
    shading::{encoded, shade_runs},
    shadow::Light,
    surface::SurfaceTriangle,
    triangles::OrientedTriangle,
};
use crate::{
    effects::{
        Surface,
        glass::{Glass, GlassDraws, GlassLayer},
    },
    frame::{GlassHit, GlassLayers, NO_TRIANGLE},
    math::linear_light,
    work::{Canceled, checkpoint},
};

/// What lies on the sample of a pixel.
#[derive(Clone, Default)]
struct Cell {
    /// The nearest opaque triangle: its key, and the complement of its id; zeros without one.
    opaque: (u32, u32),
    glass: Vec<GlassHit>,
}

/// The nearer, the larger: by key, and of equal keys the smaller id is nearer.
pub fn nearness(hit: &GlassHit) -> (u32, u32) {
    (hit.depth_key, !hit.triangle_id)
}

/// The layers of glass of every pixel that nothing opaque hides, nearest first, and what lies
/// behind.
pub fn glass_layers(
    shot: &Shot,
    tests: &SampleTests,
    triangles: &[OrientedTriangle],
) -> Result<GlassLayers, Canceled> {
    let mut cells = vec![Cell::default(); shot.view.pixels()];
    scatter(tests, triangles, shot.view, &mut cells, |triangle| {
        let is_glass = shot.draw_of(triangle.id).is_some_and(|draw| draw.is_glass);
        move |cell: &mut Cell, _, _, hit: Hit| {
            let key = depth_key(hit.depth);
            if is_glass {
                cell.glass.push(GlassHit {
                    triangle_id: triangle.id,
                    depth_key: key,
                });
            } else {
                cell.opaque = cell.opaque.max((key, !triangle.id));
            }
        }
    })?;
    let mut layers = GlassLayers::default();
    for mut cell in cells {
        cell.glass.sort_by_key(|hit| Reverse(nearness(hit)));
        cell.glass.retain(|hit| nearness(hit) > cell.opaque);
        layers.layers.append(&mut cell.glass);
        layers.end_pixel(match cell.opaque {
            (0, _) => NO_TRIANGLE,
            (_, complement) => !complement,
        });
    }
    Ok(layers)
}

/// How the glass of a stack changes the color behind it.
#[derive(Clone, Copy)]
pub struct GlassShader {
    glass: Option<Glass>,
    draws: GlassDraws,
}

impl GlassShader {
    pub fn of(shot: &Shot) -> Self {
        Self {
            glass: shot.stack.params("glass"),
            draws: shot.stack.glass(),
        }
    }

    /// The layer of a shaded surface of a draw with these scopes.
    pub fn layer(&self, surface: &Surface, scopes: u32) -> GlassLayer {
        match &self.glass {
            Some(glass) if self.draws.has(false, scopes) => glass.layer(surface),
            _ => GlassLayer::blended(surface),
        }
    }
}

/// The background of every row, linear.
pub fn linear_background(shot: &Shot) -> Vec<DVec4> {
    background(shot.view)
        .into_iter()
        .map(|color| {
            DVec4::new(
                linear_light(color.x),
                linear_light(color.y),
                linear_light(color.z),
                color.w,
            )
        })
        .collect()
}

/// Gamma-encoded color of every pixel, given its layers.
pub fn glass_colors(input: &LayerInput, layers: &GlassLayers) -> Result<Vec<DVec4>, Canceled> {
    let shot = &input.shot;
    let width = (shot.view.width as usize).max(1);
    let (ranks, light) = (
        ranks(shot, input.geometry)?,
        Light::of(shot, input.geometry),
    );
    let (background, shader) = (linear_background(shot), GlassShader::of(shot));
    let checkpoint = checkpoint();
    let row = |y: usize| {
        checkpoint.pass()?;
        let mut known: HashMap<u32, Option<SurfaceTriangle>> = HashMap::new();
        let mut surface = |id: u32, x: usize| {
            let triangle = known
                .entry(id)
                .or_insert_with(|| SurfaceTriangle::new(shot, input.geometry, id))
                .as_ref()?;
            let surface = triangle.surface(x, y, &Perturbation::default());
            let lit = light.as_ref().map_or(0.0, |light| {
                light.arrives(&triangle.lit_point(&surface), id, 0.0)
            });
            let rank = ranks.get(id as usize).copied().unwrap_or(0.0);
            let surface = Surface {
                rank,
                lit,
                ..surface
            };
            Some((triangle.scopes, surface))
        };
        // What lies behind each pixel, and then its layers.
        let mut asked = Vec::new();
        for x in 0..width {
            let pixel = y * width + x;
            let ids = layers.at(pixel).iter().map(|hit| hit.triangle_id);
            asked.extend(
                [layers.behind[pixel]]
                    .into_iter()
                    .chain(ids)
                    .map(|id| surface(id, x)),
            );
        }
        let (scopes, mut surfaces): (Vec<u32>, Vec<Surface>) =
            asked.iter().flatten().copied().unzip();
        shade_runs(shot, &scopes, &mut surfaces);
        let mut surfaces = surfaces.into_iter();
        let mut shaded = asked.into_iter().map(|asked| {
            let (scopes, _) = asked?;
            Some((surfaces.next()?, scopes))
        });
        let mut next = || shaded.next().flatten();
        let pixel = |x: usize| {
            let pixel = y * width + x;
            let behind = next().map_or(background[y], |(surface, _)| surface.color);
            let seen = layers.at(pixel).iter().fold(GlassLayer::CLEAR, |seen, _| {
                next().map_or(seen, |(surface, scopes)| {
                    seen.merged(&shader.layer(&surface, scopes))
                })
            });
            let color = seen.over(behind.truncate());
            encoded(color.extend(seen.alpha_over(behind.w)))
        };
        Ok((0..width).map(pixel).collect::<Vec<_>>())
    };
    let rows = (0..shot.view.height as usize)
        .into_par_iter()
        .map(row)
        .collect::<Result<Vec<_>, Canceled>>()?;
    Ok(rows.concat())
}
