//! The image of the overlays: transparent, with a texel per pixel of the picture.

use egui::{Color32, ColorImage};
use rayon::prelude::*;

use crate::{
    app::picture::{findings::Findings, overlay::Overlay},
    effects::overdraw::Overdraw,
    frame::NO_TRIANGLE,
    math::hash,
    measure::error_map::PixelError,
};

/// Brightness of the picture under errors, of 255, so that a single wrong pixel can be seen.
const DIMMED: u8 = 96;

/// Most pixels of an overlay that get rings; more can be seen without.
const MAX_RINGS: usize = 256;

/// The overlays `shown`, blended from the lowest to the topmost.
pub fn image(found: &Findings, shown: &[Overlay], gain: u8) -> ColorImage {
    let [width, height] = found.size.map(|side| side as usize);
    let is_opaque = |overlay: &&Overlay| matches!(overlay, Overlay::TriangleIds | Overlay::Layers);
    let dims = shown
        .iter()
        .any(|overlay| overlay.is_error() && found.count(*overlay) > 0)
        && !shown.iter().any(|o| is_opaque(&o));
    let ground = if dims {
        Color32::from_black_alpha(255 - DIMMED)
    } else {
        Color32::TRANSPARENT
    };
    let heat = Overdraw::default();
    let texel = |i: usize| {
        let layers = Overlay::ALL
            .iter()
            .filter(|overlay| shown.contains(overlay));
        layers
            .filter_map(|overlay| color(found, *overlay, i, gain, &heat))
            .fold(ground, Color32::blend)
    };
    ColorImage::new(
        [width, height],
        (0..width * height).into_par_iter().map(texel).collect(),
    )
}

/// What one overlay paints on pixel `i`.
fn color(
    found: &Findings,
    overlay: Overlay,
    i: usize,
    gain: u8,
    heat: &Overdraw,
) -> Option<Color32> {
    let has = |fault: PixelError| found.faults.has(i, fault);
    match overlay {
        Overlay::TriangleIds => {
            (found.triangle_ids[i] != NO_TRIANGLE).then(|| triangle_color(found.triangle_ids[i]))
        }
        Overlay::Layers => (found.layers[i] > 0).then(|| layers_color(heat, found.layers[i])),
        Overlay::Color => {
            let delta = found.faults.color_delta[i].saturating_mul(gain);
            (delta > 0).then(|| overlay.color().gamma_multiply(f32::from(delta) / 255.0))
        }
        Overlay::Edges => found.is_edge(i).then(|| overlay.color()),
        Overlay::NotReference => found.differs_from_reference(i).then(|| overlay.color()),
        Overlay::Ties => has(PixelError::DepthBand).then(|| overlay.color()),
        Overlay::Doubles => has(PixelError::DoubleHit).then(|| overlay.color()),
        Overlay::Holes => has(PixelError::Hole).then(|| overlay.color()),
        Overlay::WrongTriangle => has(PixelError::WrongTriangle).then(|| overlay.color()),
        Overlay::WrongDepth => has(PixelError::WrongDepthOrder).then(|| overlay.color()),
        Overlay::Unsound => found.is_unsound(i).then(|| overlay.color()),
    }
}

/// A color for every triangle, bright and different from that of its neighbors.
fn triangle_color(triangle_id: u32) -> Color32 {
    let h = hash(triangle_id);
    let channel = |shift: u32| 40 + ((h >> shift & 255) * 3 / 4) as u8;
    Color32::from_rgb(channel(0), channel(8), channel(16))
}

pub fn layers_color(heat: &Overdraw, layers: u32) -> Color32 {
    let [r, g, b] = heat
        .color(heat.heat(layers))
        .to_array()
        .map(|v| (v * 255.0 + 0.5) as u8);
    Color32::from_rgb(r, g, b)
}

/// Pixels that get a ring, by index, with its color: those of overlays that paint few.
pub fn rings(found: &Findings, shown: &[Overlay]) -> Vec<(usize, Color32)> {
    let mut rings = Vec::new();
    for overlay in shown
        .iter()
        .filter(|overlay| found.count(**overlay) as usize <= MAX_RINGS)
    {
        rings.extend(
            (0..found.faults.pixels())
                .filter(|&i| found.is_painted(*overlay, i))
                .map(|i| (i, overlay.color())),
        );
    }
    rings
}
