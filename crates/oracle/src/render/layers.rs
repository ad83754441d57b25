//! Layers: pictures in which a pixel shows more than its nearest triangle (`docs/exactness.md` §7).
//! Every covered sample is shaded in f64, rounded to whole steps, and summed in u64.

use glam::{DVec3, DVec4};

use super::{
    super::{perturbation::Perturbation, shot::Shot},
    background::background,
    coverage::{Hit, scatter_rows},
    draw_order::ranks,
    glass::{glass_colors, glass_layers},
    sample_rules::SampleTests,
    shading::encoded,
    shadow::Light,
    surface::SurfaceTriangle,
    triangles::OrientedTriangle,
};
use crate::{
    effects::{Surface, hooks::Layers, overdraw::Overdraw, xray, xray::Xray},
    frame::{Geometry, GlassLayers},
    math::linear_light,
    work::Canceled,
};

/// A picture of layers. Images are row-major.
pub struct LayerImage {
    /// Gamma-encoded RGBA, each from 0 to 1.
    pub colors: Vec<DVec4>,
    /// Sums of weights, or numbers of layers.
    pub counted: Vec<u32>,
    /// How the layers were combined.
    pub mode: LayerMode,
}

/// How layers are combined.
pub enum LayerMode {
    /// Averaged, in fixed point of this many bits.
    Xray { params: Xray, bits: u32 },
    /// Counted.
    Overdraw,
    /// Seen one through the other.
    Glass(GlassLayers),
}

/// What is drawn, and what is nearest at each pixel.
pub struct LayerInput<'a> {
    pub shot: Shot<'a>,
    pub geometry: &'a Geometry,
    pub tests: &'a SampleTests<'a>,
    pub triangles: &'a [OrientedTriangle],
    pub triangle_ids: &'a [u32],
    pub depth_keys: &'a [u32],
    /// The layers of glass that an adapter found; none to find them.
    pub glass: Option<&'a GlassLayers>,
}

/// The picture that glass or the effect in the visibility slot makes, given the number of layers
/// per pixel; none if the nearest triangle is shown.
pub fn layer_image(
    input: &LayerInput,
    layers: impl FnOnce() -> Vec<u32>,
) -> Result<Option<LayerImage>, Canceled> {
    let stack = input.shot.stack;
    if input.shot.has_glass() {
        return seen_through(input).map(Some);
    }
    Ok(match stack.layers(input.shot.scene.triangle_count()) {
        Some(Layers::Xray { bits }) => stack
            .params("xray")
            .map(|params| averaged(input, params, bits))
            .transpose()?,
        Some(Layers::Overdraw) => stack
            .params("overdraw")
            .map(|params| heat(input, layers(), &params)),
        Some(Layers::Race | Layers::Glass) | None => None,
    })
}

fn seen_through(input: &LayerInput) -> Result<LayerImage, Canceled> {
    let layers = match input.glass {
        Some(layers) => layers.clone(),
        None => glass_layers(&input.shot, input.tests, input.triangles)?,
    };
    Ok(LayerImage {
        colors: glass_colors(input, &layers)?,
        counted: layers.counts(),
        mode: LayerMode::Glass(layers),
    })
}

fn heat(input: &LayerInput, layers: Vec<u32>, params: &Overdraw) -> LayerImage {
    let background = background(input.shot.view);
    let width = input.shot.view.width as usize;
    let color = |(pixel, &layers): (usize, &u32)| match layers {
        0 => background[pixel / width],
        _ => params.color(params.heat(layers)).extend(1.0),
    };
    LayerImage {
        colors: layers.iter().enumerate().map(color).collect(),
        counted: layers,
        mode: LayerMode::Overdraw,
    }
}

fn averaged(input: &LayerInput, params: Xray, bits: u32) -> Result<LayerImage, Canceled> {
    let sums = sums(input, &params, bits)?;
    let largest = sums.iter().map(|sum| sum.weight).max().unwrap_or(0);
    // An overflow in any pixel draws the whole picture again with fewer bits.
    if let (true, Some(fewer)) = (largest > xray::capacity(bits).into(), xray::fewer(bits)) {
        return averaged(input, params, fewer);
    }
    let (background, width) = (background(input.shot.view), input.shot.view.width as usize);
    let pixel = |(pixel, sum): (usize, &LayerSum)| match sum.weight {
        0 => background[pixel / width],
        weight => {
            let average = sum
                .sums
                .map(|channel| xray::average(channel, weight) as f64 / steps(bits));
            xray_color(
                background[pixel / width],
                &params,
                DVec3::from_array(average),
                weight,
            )
        }
    };
    Ok(LayerImage {
        colors: sums.iter().enumerate().map(pixel).collect(),
        counted: sums
            .iter()
            .map(|sum| u32::try_from(sum.weight).unwrap_or(u32::MAX))
            .collect(),
        mode: LayerMode::Xray { params, bits },
    })
}

/// The gamma-encoded color of a pixel whose layers have this average and sum of weights, over a
/// gamma-encoded background.
pub fn xray_color(background: DVec4, params: &Xray, average: DVec3, weight: u64) -> DVec4 {
    let [red, green, blue] = [background.x, background.y, background.z].map(linear_light);
    encoded(params.seen(
        average,
        DVec4::new(red, green, blue, background.w),
        weight as f64,
    ))
}

/// Largest value of a channel in fixed point.
pub fn steps(bits: u32) -> f64 {
    f64::from((1u32 << bits) - 1)
}

/// Smallest depth that the depth window of a pixel contains.
pub fn window_depth(input: &LayerInput, params: &Xray, pixel: usize) -> f64 {
    f64::from(f32::from_bits(params.threshold(
        input.depth_keys[pixel],
        input.shot.view.linear_depth_m.is_none(),
    )))
}

/// How far the depth of the front may lie above the exact one, as a fraction of it.
const FRONT: f64 = 1.0 / 1024.0;

/// Returns true for the hit whose depth is that of a pixel's front, which the depth window always
/// contains; `depth` is the largest that a renderer may compute for it. A clipped triangle that is
/// drawn as boxes may have other hits, farther behind.
pub fn is_front(input: &LayerInput, pixel: usize, id: u32, depth: f64) -> bool {
    input.triangle_ids[pixel] == id && depth >= f64::from(f32::from_bits(input.depth_keys[pixel]))
}

/// Sums of one pixel.
#[derive(Clone, Default)]
struct LayerSum {
    sums: [u64; 3],
    weight: u64,
}

fn sums(input: &LayerInput, params: &Xray, bits: u32) -> Result<Vec<LayerSum>, Canceled> {
    let Shot { view, stack, .. } = input.shot;
    let mut sums = vec![LayerSum::default(); view.pixels()];
    let (ranks, light) = (
        ranks(&input.shot, input.geometry)?,
        Light::of(&input.shot, input.geometry),
    );
    let (ranks, light) = (&ranks, light.as_ref());
    scatter_rows(input.tests, input.triangles, view, &mut sums, |triangle| {
        let mut surface: Option<Option<SurfaceTriangle<'_>>> = None;
        let rank = ranks.get(triangle.id as usize).copied().unwrap_or(0.0);
        move |sums: &mut [LayerSum], y: usize, hits: &[(usize, Hit)]| {
            let counts = |(x, hit): &&(usize, Hit)| {
                let pixel = y * view.width as usize + x;
                hit.depth >= window_depth(input, params, pixel)
                    || is_front(input, pixel, triangle.id, hit.depth * (1.0 + FRONT))
            };
            let columns: Vec<usize> = hits.iter().filter(counts).map(|(x, _)| *x).collect();
            if columns.is_empty() {
                return;
            }
            let Some(known) = surface.get_or_insert_with(|| {
                SurfaceTriangle::new(&input.shot, input.geometry, triangle.id)
            }) else {
                return;
            };
            let layer = |&x: &usize| {
                let surface = known.surface(x, y, &Perturbation::default());
                let lit = light.map_or(0.0, |light| {
                    light.arrives(&known.lit_point(&surface), triangle.id, 0.0)
                });
                Surface {
                    rank,
                    lit,
                    ..surface
                }
            };
            let mut layers: Vec<Surface> = columns.iter().map(layer).collect();
            stack.shade_all(&mut layers, known.scopes, &input.shot.light());
            for (x, shaded) in columns.into_iter().zip(layers) {
                let (sum, weight) = (&mut sums[x], fixed_weight(params.weight_of(&shaded), 0.0));
                let color = fixed_color(shaded.color.truncate(), 0.0, bits);
                (0..3).for_each(|c| sum.sums[c] += color[c] * weight);
                sum.weight += weight;
            }
        }
    })?;
    Ok(sums)
}

/// A color plus an error, rounded to whole steps.
pub fn fixed_color(color: DVec3, error: f64, bits: u32) -> [u64; 3] {
    color
        .to_array()
        .map(|c| ((c + error).clamp(0.0, 1.0) * steps(bits) + 0.5).floor() as u64)
}

/// A weight plus an error, rounded to a whole number, at least 1.
pub fn fixed_weight(weight: f64, error: f64) -> u64 {
    (weight + error + 0.5).floor().max(1.0) as u64
}
