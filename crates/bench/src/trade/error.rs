//! The error of a combination of options: its picture against the oracle's.

use crate::{
    effects::Stack,
    frame::{Frame, Geometry, NO_TRIANGLE, SnappedVertex},
    gpu::Capture,
    measure::{References, ShadowErrors, Verdict, compare},
    scene::view::View,
};

/// What pictures are held against: the oracle's, which this module never sees.
pub struct Reference<'a> {
    /// Pictures on the oracle's finest grid, at every size of the axes, their shadows by rays.
    pub references: &'a References,
    /// None if it was canceled.
    pub judge: &'a dyn Fn(&View, &Stack, &Capture) -> Option<Judged>,
}

/// What the oracle says of a picture, and of the light in it where an effect asks for one.
pub struct Judged {
    pub verdict: Verdict,
    pub light: Option<ShadowErrors>,
}

/// Error of a combination. None reads "not measured", never 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct TradeError {
    /// Pixels with another triangle id than in the oracle's picture on its finest grid, per
    /// million of those drawn.
    pub wrong_ppm: f64,
    /// Samples that a triangle covers, given its snapped corners, and that were not drawn, per
    /// million pixels.
    pub holes_per_mpx: f64,
    /// Samples drawn more often than they are covered, per million pixels.
    pub double_hits_per_mpx: f64,
    /// Pixels whose triangle id covers them but is not the nearest, per million.
    pub wrong_depth_ppm: f64,
    /// Largest difference of a color channel from the oracle's picture, of 255; where sizes are
    /// compared, from its picture of eight by eight samples to a pixel.
    pub max_color_delta: u8,
    pub rms_color_delta: f64,
    /// Of the pixels that face the light, those where the shadow map errs by more than half of it,
    /// per million; none without a light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrong_light_ppm: Option<f64>,
    /// Root mean square of the share of the light by which the map errs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rms_light: Option<f64>,
    /// Pixels that differ between two equal frames.
    pub changed_pixels: u64,
    /// Furthest that a corner in the picture lies from where it is on the oracle's finest grid,
    /// pixels.
    pub moved_px: f64,
    /// Pixels that were left empty well inside what the oracle's picture covers, per million:
    /// cracks between neighbors.
    pub cracks_per_mpx: f64,
    pub overflow: u64,
    pub depth_without_id: u64,
    /// Largest distance of a particle from its true flight, pixels; none without particles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_divergence_px: Option<f64>,
    /// Mean of that in the scene, meters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_divergence_m: Option<f64>,
}

impl TradeError {
    pub(super) fn of(
        capture: &Capture,
        again: &Frame,
        judged: &Judged,
        reference: &Reference,
    ) -> Self {
        let (frame, scale) = (&capture.frame, capture.geometry.scale);
        let (picture, corners) = reference
            .references
            .at(scale)
            .expect("a reference at every size that is drawn");
        let pixels = (frame.triangle_id.len() as f64).max(1.0);
        let per_million = |count: u64| count as f64 * 1e6 / pixels;
        // Where sizes are compared, colors are held against many samples a pixel, else against the
        // true picture's.
        let shown = capture.shown.as_ref().unwrap_or(frame);
        let colors = match &reference.references.smooth {
            Some(smooth) => compare::pictures(&shown.color, smooth, 0),
            None => compare::pictures(&frame.color, &picture.color, 0),
        };
        let differs = |i: &usize| {
            frame.triangle_id[*i] != again.triangle_id[*i] || frame.color[*i] != again.color[*i]
        };
        let a = &judged.verdict.report;
        let moved_px = moved_px(&capture.geometry, corners, [frame.width, frame.height]);
        Self {
            wrong_ppm: per_million(
                compare::triangle_ids(&frame.triangle_id, &picture.triangle_id).different,
            ),
            holes_per_mpx: per_million(a.holes),
            double_hits_per_mpx: per_million(a.double_hits),
            wrong_depth_ppm: per_million(a.wrong_nearest),
            max_color_delta: colors.max_delta,
            rms_color_delta: colors.rms,
            wrong_light_ppm: judged
                .light
                .map(|light| light.wrong as f64 * 1e6 / (light.pixels as f64).max(1.0)),
            rms_light: judged.light.map(|light| light.rms),
            changed_pixels: (0..frame.triangle_id.len()).filter(differs).count() as u64,
            moved_px: moved_px / scale,
            cracks_per_mpx: per_million(cracks(frame, picture, moved_px)),
            overflow: a.overflow,
            depth_without_id: a.depth_without_id,
            max_divergence_px: (a.particles > 0).then_some(a.max_divergence_px),
            mean_divergence_m: (a.particles > 0).then_some(a.mean_divergence_m),
        }
    }

    /// Is nothing of it larger than in `other`?
    pub fn is_at_most(&self, other: &Self) -> bool {
        let stats = |e: &Self| {
            let sample_counts =
                [e.changed_pixels, e.overflow, e.depth_without_id].map(|count| count as f64);
            let shares = [
                e.wrong_ppm,
                e.holes_per_mpx,
                e.double_hits_per_mpx,
                e.wrong_depth_ppm,
                e.rms_color_delta,
                e.cracks_per_mpx,
                e.mean_divergence_m.unwrap_or(0.0),
            ];
            let light = [e.wrong_light_ppm, e.rms_light].map(Option::unwrap_or_default);
            [
                shares.to_vec(),
                light.to_vec(),
                sample_counts.to_vec(),
                vec![e.max_color_delta.into()],
            ]
            .concat()
        };
        stats(self).iter().zip(stats(other)).all(|(a, b)| *a <= b)
    }
}

/// Furthest that a corner of `given` lies from its twin, of those that are in the picture; either
/// has a grid of its own.
fn moved_px(given: &Geometry, reference: &Geometry, size: [u32; 2]) -> f64 {
    let place = |geometry: &Geometry, at: &SnappedVertex| {
        [at.x, at.y].map(|v| f64::from(v) / f64::from(1 << geometry.subpixel_bits))
    };
    let distance = |(a, b): (&SnappedVertex, &SnappedVertex)| {
        let ([ax, ay], [bx, by]) = (place(given, a), place(reference, b));
        let is_seen = a.flags == 0
            && b.flags == 0
            && (0.0..=size[0].into()).contains(&bx)
            && (0.0..=size[1].into()).contains(&by);
        if is_seen {
            libm::hypot(ax - bx, ay - by)
        } else {
            0.0
        }
    };
    given
        .vertices
        .iter()
        .zip(&reference.vertices)
        .map(distance)
        .fold(0.0, f64::max)
}

/// Pixels that are empty although the true picture covers them and everything as near as an outline
/// may have moved.
fn cracks(frame: &Frame, reference: &Frame, moved_px: f64) -> u64 {
    let [width, height] = [frame.width, frame.height].map(i64::from);
    let reach = 1 + (moved_px.ceil() as i64).clamp(0, 15);
    let is_inside = |pixel: usize| {
        let (x, y) = (pixel as i64 % width, pixel as i64 / width);
        let rows = (y - reach).max(0)..=(y + reach).min(height - 1);
        let mut around = rows.flat_map(|y| {
            ((x - reach).max(0)..=(x + reach).min(width - 1)).map(move |x| (y * width + x) as usize)
        });
        around.all(|at| reference.triangle_id[at] != NO_TRIANGLE)
    };
    (0..frame.triangle_id.len())
        .filter(|&pixel| {
            frame.triangle_id[pixel] == NO_TRIANGLE
                && reference.triangle_id[pixel] != NO_TRIANGLE
                && is_inside(pixel)
        })
        .count() as u64
}
