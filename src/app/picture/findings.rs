//! Findings: what the oracle found in a picture, pixel by pixel.

use std::sync::Arc;

use super::overlay::Overlay;
use crate::{
    app::widgets::text::group_digits,
    effect_files::Crossing,
    frame::{Geometry, NO_TRIANGLE},
    gpu::Capture,
    measure::{
        ErrorReport, Verdict,
        error_map::{ErrorMap, PixelError},
    },
};

/// The oracle's judgement of a picture, and the data that overlays are painted from. All lists have
/// one entry per pixel.
pub struct Findings {
    pub accuracy: ErrorReport,
    /// Width and height, pixels.
    pub size: [u32; 2],
    pub faults: ErrorMap,
    pub triangle_ids: Vec<u32>,
    pub color: Vec<[u8; 4]>,
    /// What decided the picture: what a probe looks into. None where the picture was drawn in
    /// another process.
    pub geometry: Option<Arc<Geometry>>,
    /// Triangle ids in the exact picture on the finest grid; none if the effects are not
    /// reproducible.
    pub(super) reference: Option<Vec<u32>>,
    /// Pixels at which an effect makes no color of a color, by row.
    pub(super) crossings: Vec<Crossing>,
    /// Triangles that cover each pixel.
    pub layers: Vec<u32>,
    /// Pixels that each overlay paints, in the order of [`Overlay::ALL`].
    pub(super) counts: [u64; Overlay::ALL.len()],
}

impl Findings {
    pub fn new(
        capture: Capture,
        verdict: Verdict,
        reference: Option<Vec<u32>>,
        crossings: Vec<Crossing>,
    ) -> Self {
        let pixels = capture.frame.triangle_id.len();
        let mut found = Self {
            accuracy: verdict.report,
            size: [capture.frame.width, capture.frame.height],
            faults: verdict.error_map,
            triangle_ids: capture.frame.triangle_id,
            color: capture.frame.color,
            geometry: Some(Arc::new(capture.geometry)),
            reference: reference.filter(|reference| reference.len() == pixels),
            crossings,
            layers: capture.layers.unwrap_or_default(),
            counts: [0; Overlay::ALL.len()],
        };
        found.layers.resize(pixels, 0);
        found.counts = Overlay::ALL.map(|overlay| match (overlay, overlay.fault()) {
            (Overlay::Unsound, _) => (0..pixels).filter(|&i| found.is_unsound(i)).count() as u64,
            (_, Some(fault)) => found.faults.count(fault),
            (Overlay::TriangleIds, _) => found
                .triangle_ids
                .iter()
                .filter(|triangle_id| **triangle_id != NO_TRIANGLE)
                .count() as u64,
            (Overlay::Layers, _) => {
                found.layers.iter().filter(|layers| **layers > 0).count() as u64
            }
            (Overlay::Color, _) => found.faults.differing(),
            (Overlay::NotReference, _) => (0..pixels)
                .filter(|&i| found.differs_from_reference(i))
                .count() as u64,
            _ => (0..pixels).filter(|&i| found.is_edge(i)).count() as u64,
        });
        found
    }

    /// Pixels that show another triangle than the exact picture of the true positions; none if the
    /// effects are not reproducible.
    pub fn wrong_against_true(&self) -> Option<u64> {
        self.reference
            .as_ref()
            .map(|_| self.count(Overlay::NotReference))
    }

    /// Pixels that an overlay paints.
    pub fn count(&self, overlay: Overlay) -> u64 {
        self.counts[overlay as usize]
    }

    /// What an effect made of the color of pixel `i`, if that is no color.
    pub fn crossing(&self, i: usize) -> Option<&Crossing> {
        let width = self.size[0].max(1) as usize;
        let at = self.crossings.binary_search_by_key(&i, |crossing| {
            crossing.pixel[1] as usize * width + crossing.pixel[0] as usize
        });
        at.ok().map(|at| &self.crossings[at])
    }

    /// The effects that make no color of a color, with a crossing that stands for all and their
    /// number; the most frequent first.
    pub fn crossed(&self) -> Vec<(&Crossing, u64)> {
        let mut crossed: Vec<(&Crossing, u64)> = Vec::new();
        for crossing in &self.crossings {
            match crossed
                .iter_mut()
                .find(|(known, _)| known.effect == crossing.effect)
            {
                Some((known, count)) => {
                    *count += 1;
                    if known.parameter.is_none() {
                        *known = crossing;
                    }
                }
                None => crossed.push((crossing, 1)),
            }
        }
        crossed.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        crossed
    }

    /// True if pixel `i` has something that is NaN, infinite or negative where that cannot be.
    pub fn is_unsound(&self, i: usize) -> bool {
        self.faults.has(i, PixelError::Unsound) || self.crossing(i).is_some()
    }

    /// True if the exact picture shows another triangle at pixel `i`.
    pub fn differs_from_reference(&self, i: usize) -> bool {
        self.reference
            .as_ref()
            .is_some_and(|reference| reference[i] != self.triangle_ids[i])
    }

    /// Does an overlay of errors or ties paint pixel `i`?
    pub fn is_painted(&self, overlay: Overlay, i: usize) -> bool {
        match overlay.fault() {
            _ if overlay == Overlay::Unsound => self.is_unsound(i),
            Some(fault) => self.faults.has(i, fault),
            None if overlay == Overlay::NotReference => self.differs_from_reference(i),
            None => overlay == Overlay::Color && self.faults.color_delta[i] > 0,
        }
    }

    /// The pixels that these overlays of errors and ties paint, in reading order. Those of colors count only
    /// where nothing else is painted, since a last bit may differ everywhere.
    pub fn painted(&self, overlays: &[Overlay]) -> Vec<usize> {
        let of = |overlays: &[Overlay]| -> Vec<usize> {
            (0..self.faults.pixels())
                .filter(|&i| overlays.iter().any(|overlay| self.is_painted(*overlay, i)))
                .collect()
        };
        let (colors, errors): (Vec<Overlay>, Vec<Overlay>) = overlays
            .iter()
            .filter(|overlay| overlay.is_doubt())
            .partition(|overlay| **overlay == Overlay::Color);
        let found = of(&errors);
        if found.is_empty() { of(&colors) } else { found }
    }

    /// Pixel `i` in words.
    pub fn pixel_text(&self, i: usize) -> String {
        let layers = self.layers[i];
        let name = |triangle_id: u32| {
            if triangle_id == NO_TRIANGLE {
                "empty".into()
            } else {
                format!("triangle {}", group_digits(triangle_id.into()))
            }
        };
        let reference = self
            .reference
            .as_ref()
            .filter(|_| self.differs_from_reference(i));
        let reference = reference.map_or(String::new(), |reference| {
            format!(" (reference: {})", name(reference[i]))
        });
        format!(
            "{}{reference}, {layers} {}, Δ {}",
            name(self.triangle_ids[i]),
            if layers == 1 { "layer" } else { "layers" },
            self.faults.color_delta[i]
        )
    }

    /// True if the next pixel to the right or below shows another triangle.
    pub fn is_edge(&self, i: usize) -> bool {
        let width = self.size[0].max(1) as usize;
        let differs = |j: usize| {
            self.triangle_ids
                .get(j)
                .is_some_and(|triangle_id| *triangle_id != self.triangle_ids[i])
        };
        !(i + 1).is_multiple_of(width) && differs(i + 1) || differs(i + width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_is_where_the_triangle_changes_and_not_across_the_border_of_the_picture() {
        let mut capture = Capture {
            frame: Default::default(),
            geometry: Default::default(),
            layers: None,
            previous: None,
            shown: None,
        };
        (capture.frame.width, capture.frame.height) = (3, 2);
        capture.frame.triangle_id = vec![1, 1, 2, 1, 1, 1];
        capture.frame.color = vec![[0; 4]; 6];
        let faults = ErrorMap::new(&capture.frame.color, &capture.frame.color, |_| Vec::new());
        let found = Findings::new(
            capture,
            Verdict {
                error_map: faults,
                ..Default::default()
            },
            Some(vec![1, 1, 2, 1, 7, 1]),
            Vec::new(),
        );
        let edges: Vec<_> = (0..6).filter(|&i| found.is_edge(i)).collect();
        assert_eq!(edges, [1, 2]);
        assert_eq!(
            (
                found.count(Overlay::Edges),
                found.count(Overlay::NotReference)
            ),
            (2, 1)
        );
        assert_eq!(
            found.pixel_text(4),
            "triangle 1 (reference: triangle 7), 0 layers, Δ 0"
        );
    }
}
