//! Overlays: where the picture is wrong, and what it is made of, laid over it in any subset with one legend.
//!
//! They come from the oracle's judgement of the picture, which runs in the background once the picture rests.

mod legend;
mod paint;

use std::sync::Arc;

use eframe::egui::{self, Color32, Rect, RichText, Sense, Ui, vec2};

use super::{App, presets::grouped, screen::Inputs, theme};
use crate::{
    frame::NO_TRIANGLE,
    gpu::Capture,
    measure::{
        ErrorReport, Verdict,
        faults::{ErrorMap, PixelError},
    },
};

/// One layer over the picture; those further down cover those further up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Overlay {
    TriangleIds,
    Layers,
    Colour,
    Edges,
    Ties,
    Reference,
    Doubles,
    Holes,
    TriangleId,
    Depth,
    Unsound,
}

/// Each with its name, what it shows, and its colour.
const TABLE: [(Overlay, &str, &str, Color32); 11] = [
    (Overlay::TriangleIds, "Triangle id ids", "A colour for every triangle, where it won the pixel", Color32::from_rgb(150, 120, 210)),
    (Overlay::Layers, "Layers", "How many triangles cover each pixel, in front or behind", Color32::from_rgb(214, 86, 60)),
    (
        Overlay::Colour,
        "Colour difference",
        "The largest difference of a channel from the right colour, times the gain",
        Color32::from_rgb(126, 255, 142),
    ),
    (Overlay::Edges, "Triangle edges", "Where the triangle id changes from one pixel to the next", Color32::from_rgb(150, 154, 164)),
    (
        Overlay::Ties,
        "Depth ties",
        "Two triangle ids are right: their depths are closer than a float key can tell. Not an error",
        Color32::from_rgb(96, 134, 255),
    ),
    (
        Overlay::Reference,
        "Not the true triangle id",
        "Another triangle id than in the exact picture on the finest grid: what the trade counts, the price of coarser options too",
        Color32::from_rgb(204, 156, 255),
    ),
    (Overlay::Doubles, "Drawn twice", "A triangle was drawn more often than it covers the sample", Color32::from_rgb(255, 233, 74)),
    (Overlay::Holes, "Holes", "A triangle covers the sample and was not drawn there", Color32::from_rgb(60, 225, 255)),
    (
        Overlay::TriangleId,
        "Wrong triangle id",
        "Another triangle than the exact one, outside every named band",
        Color32::from_rgb(255, 64, 224),
    ),
    (
        Overlay::Depth,
        "Wrong depth winner",
        "The triangle id covers the sample and is not the nearest; these are wrong triangle ids too",
        Color32::from_rgb(255, 150, 48),
    ),
    (
        Overlay::Unsound,
        "NaN, infinite, negative",
        "By the bits of the depth, and of depth, 1/w, normal and colour at the triangle id's corners",
        Color32::from_rgb(255, 48, 48),
    ),
];

/// What the key switches on when nothing was chosen yet.
const FIRST: [Overlay; 7] =
    [Overlay::Reference, Overlay::TriangleId, Overlay::Depth, Overlay::Holes, Overlay::Doubles, Overlay::Colour, Overlay::Unsound];

impl Overlay {
    /// From the lowest to the topmost.
    pub const ALL: [Self; 11] = [
        Self::TriangleIds,
        Self::Layers,
        Self::Colour,
        Self::Edges,
        Self::Ties,
        Self::Reference,
        Self::Doubles,
        Self::Holes,
        Self::TriangleId,
        Self::Depth,
        Self::Unsound,
    ];

    /// As people read them: faults first, and each list from the topmost to the lowest.
    fn listed() -> impl Iterator<Item = Self> {
        let of_kind = |is_fault: bool| Self::ALL.into_iter().rev().filter(move |overlay| overlay.is_fault() == is_fault);
        of_kind(true).chain(of_kind(false))
    }

    const fn entry(self) -> (Self, &'static str, &'static str, Color32) {
        TABLE[self as usize]
    }

    pub const fn name(self) -> &'static str {
        self.entry().1
    }

    pub const fn color(self) -> Color32 {
        self.entry().3
    }

    /// The mark that it shows, if it shows one.
    const fn fault(self) -> Option<PixelError> {
        match self {
            Self::TriangleId => Some(PixelError::TriangleId),
            Self::Depth => Some(PixelError::Depth),
            Self::Holes => Some(PixelError::Hole),
            Self::Doubles => Some(PixelError::Double),
            Self::Ties => Some(PixelError::Tie),
            Self::Unsound => Some(PixelError::Unsound),
            Self::TriangleIds | Self::Layers | Self::Colour | Self::Edges | Self::Reference => None,
        }
    }

    /// Does it show errors? The others show what the picture is made of.
    pub const fn is_fault(self) -> bool {
        !matches!(self, Self::TriangleIds | Self::Layers | Self::Edges | Self::Ties)
    }
}

/// What the oracle found in a picture, with the integers that it found it in.
pub struct Findings {
    pub accuracy: ErrorReport,
    pub size: [u32; 2],
    pub faults: ErrorMap,
    pub triangle_ids: Vec<u32>,
    pub color: Vec<[u8; 4]>,
    /// Triangle ids in the exact picture on the finest grid; none where chance decides.
    reference: Option<Vec<u32>>,
    /// Triangles that cover each pixel.
    pub layers: Vec<u32>,
    /// Pixels that each overlay paints, in the order of [`Overlay::ALL`].
    counts: [u64; Overlay::ALL.len()],
}

impl Findings {
    pub fn new(capture: Capture, verdict: Verdict, reference: Option<Vec<u32>>) -> Self {
        let pixels = capture.frame.triangle_id.len();
        let mut found = Self {
            accuracy: verdict.accuracy,
            size: [capture.frame.width, capture.frame.height],
            faults: verdict.faults,
            triangle_ids: capture.frame.triangle_id,
            color: capture.frame.color,
            reference: reference.filter(|reference| reference.len() == pixels),
            layers: capture.layers.unwrap_or_default(),
            counts: [0; Overlay::ALL.len()],
        };
        found.layers.resize(pixels, 0);
        found.counts = Overlay::ALL.map(|overlay| match (overlay, overlay.fault()) {
            (_, Some(fault)) => found.faults.count(fault),
            (Overlay::TriangleIds, _) => found.triangle_ids.iter().filter(|triangle_id| **triangle_id != NO_TRIANGLE).count() as u64,
            (Overlay::Layers, _) => found.layers.iter().filter(|layers| **layers > 0).count() as u64,
            (Overlay::Colour, _) => found.faults.differing(),
            (Overlay::Reference, _) => (0..pixels).filter(|&i| found.is_untrue(i)).count() as u64,
            _ => (0..pixels).filter(|&i| found.is_edge(i)).count() as u64,
        });
        found
    }

    /// Pixels that an overlay paints.
    pub fn count(&self, overlay: Overlay) -> u64 {
        self.counts[overlay as usize]
    }

    /// Has the exact picture another triangle id here?
    fn is_untrue(&self, i: usize) -> bool {
        self.reference.as_ref().is_some_and(|reference| reference[i] != self.triangle_ids[i])
    }

    /// One pixel in words.
    fn pixel_text(&self, i: usize) -> String {
        let layers = self.layers[i];
        let name = |triangle_id: u32| {
            if triangle_id == NO_TRIANGLE { "empty".into() } else { format!("triangle {}", grouped(triangle_id.into())) }
        };
        let reference = self
            .reference
            .as_ref()
            .filter(|_| self.is_untrue(i))
            .map_or(String::new(), |reference| format!(" (truly {})", name(reference[i])));
        format!(
            "{}{reference}, {layers} {}, Δ {}",
            name(self.triangle_ids[i]),
            if layers == 1 { "layer" } else { "layers" },
            self.faults.colour[i]
        )
    }

    /// Does the next pixel, right or below, belong to another triangle id?
    fn is_edge(&self, i: usize) -> bool {
        let width = self.size[0].max(1) as usize;
        let differs = |j: usize| self.triangle_ids.get(j).is_some_and(|triangle_id| *triangle_id != self.triangle_ids[i]);
        !(i + 1).is_multiple_of(width) && differs(i + 1) || differs(i + width)
    }
}

/// Which overlays are on, and the newest image of them.
pub struct Overlays {
    shown: Vec<Overlay>,
    /// What the key brings back.
    last: Vec<Overlay>,
    pub gain: u8,
    painted: Option<Painted>,
    /// The picture that could not be judged: not tried again until it changes.
    unjudged: Option<Inputs>,
}

impl Default for Overlays {
    fn default() -> Self {
        Self { shown: Vec::new(), last: FIRST.to_vec(), gain: 32, painted: None, unjudged: None }
    }
}

/// An image of overlays, and what it was painted from.
struct Painted {
    found: Arc<Findings>,
    shown: Vec<Overlay>,
    gain: u8,
    texture: egui::TextureHandle,
    rings: Vec<(usize, Color32)>,
}

impl Overlays {
    pub fn is_any(&self) -> bool {
        !self.shown.is_empty()
    }

    fn set(&mut self, overlay: Overlay, on: bool) {
        self.shown.retain(|shown| *shown != overlay);
        if on {
            self.shown.push(overlay);
        }
    }

    /// All off, or those that were on before.
    pub fn toggle(&mut self) {
        if self.is_any() {
            self.last = std::mem::take(&mut self.shown);
        } else {
            self.shown = self.last.clone();
        }
    }

    /// The image as it is asked for, painted anew where it is another one.
    fn painted(&mut self, ctx: &egui::Context, found: &Arc<Findings>) -> &Painted {
        let Self { shown, gain, painted, .. } = self;
        let is_same = |old: &Painted| Arc::ptr_eq(&old.found, found) && old.shown == *shown && old.gain == *gain;
        let old = painted.take().filter(is_same);
        painted.insert(old.unwrap_or_else(|| Painted {
            texture: ctx.load_texture("overlays", paint::image(found, shown, *gain), egui::TextureOptions::NEAREST),
            rings: paint::rings(found, shown),
            found: found.clone(),
            shown: shown.clone(),
            gain: *gain,
        }))
    }
}

impl App {
    /// Has the picture been judged that is shown, where overlays want to know?
    pub(super) fn overlays_are_settled(&self) -> bool {
        !self.overlays.is_any() || self.findings().is_some() || self.overlays.unjudged == self.motion.wanted
    }

    /// The judgement failed; nobody asks for it again.
    pub(super) fn judgement_failed(&mut self, of: Inputs) {
        self.overlays.unjudged = Some(of);
    }

    /// Asks for a judgement when overlays are on and the picture rests.
    pub(super) fn feed_overlays(&mut self, ctx: &egui::Context) {
        if self.overlays_are_settled() || self.verifying > 0 || self.playback.playing {
            return;
        }
        let wanted = self.motion.wanted.as_ref();
        if wanted.is_none() || self.screen.drawn() != wanted || self.screen.is_waiting() || ctx.input(|i| i.pointer.any_down()) {
            return; // What ends this asks for another frame.
        }
        match self.motion.rest_in_s(self.now_s) {
            Some(wait_s) => ctx.request_repaint_after_secs(wait_s as f32 + 0.01),
            None => self.judge_shown(),
        }
    }

    /// The overlays themselves, where the picture is at `at`, cut to `clip`.
    pub(super) fn paint_overlays(&mut self, ui: &Ui, at: Rect, clip: Rect) {
        if !self.overlays.is_any() || self.motion.divisor > 1 {
            return;
        }
        let Some(found) = self.findings().cloned() else { return };
        let painted = self.overlays.painted(ui.ctx(), &found);
        let painter = ui.painter_at(at).with_clip_rect(clip.intersect(at));
        let whole = Rect::from_min_max(egui::Pos2::ZERO, egui::pos2(1.0, 1.0));
        painter.image(painted.texture.id(), at, whole, Color32::WHITE);
        let width = found.size[0].max(1) as usize;
        let texel = at.size() / vec2(found.size[0].max(1) as f32, found.size[1].max(1) as f32);
        for (i, color) in &painted.rings {
            let place = vec2((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
            painter.circle_stroke(at.min + place * texel, 8.0, (1.5, *color));
        }
    }

    /// The folder of the inspector.
    pub(super) fn overlays_ui(&mut self, ui: &mut Ui) {
        let found = self.findings().cloned();
        for overlay in Overlay::listed() {
            let (_, name, doc, color) = overlay.entry();
            if overlay == Overlay::Ties {
                ui.add_space(theme::HALF);
            }
            ui.horizontal(|ui| {
                ui.set_min_height(theme::ROW);
                ui.spacing_mut().item_spacing.x = 6.0;
                let mut on = self.overlays.shown.contains(&overlay);
                let label = format!("Overlay {}", name.to_lowercase());
                if ui.checkbox(&mut on, name).on_hover_text(doc).accessible_name(label).clicked() {
                    self.overlays.set(overlay, on);
                }
                swatch(ui, color);
                if overlay == Overlay::Colour {
                    let gain = egui::DragValue::new(&mut self.overlays.gain).range(1..=255).prefix("× ").speed(0.3);
                    ui.add(gain).accessible_name("Overlay gain").on_hover_text("How much a difference of colour is amplified");
                }
                if let Some(found) = &found {
                    let count = found.count(overlay);
                    let is_bad = overlay.is_fault() && overlay.fault().is_some() && count > 0;
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        let text = RichText::new(grouped(count)).monospace();
                        ui.label(text.color(if is_bad { theme::RED } else { theme::TEXT_WEAK })).on_hover_text("pixels");
                    });
                }
            });
        }
        if found.is_none() {
            ui.label(theme::weak("Pixels are counted once the oracle has judged the picture: switch one on, or press Verify."));
        }
    }
}

/// A square of an overlay's colour.
fn swatch(ui: &mut Ui, color: Color32) {
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
    ui.painter().rect_filled(rect, 2.0, color);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_stands_in_the_order_of_the_list() {
        for (place, overlay) in Overlay::ALL.into_iter().enumerate() {
            assert_eq!((overlay as usize, TABLE[place].0), (place, overlay));
        }
    }

    #[test]
    fn an_edge_lies_where_the_owner_changes_and_not_across_the_border_of_the_picture() {
        let mut capture = Capture { frame: Default::default(), geometry: Default::default(), layers: None, previous: None, shown: None };
        (capture.frame.width, capture.frame.height) = (3, 2);
        capture.frame.triangle_id = vec![1, 1, 2, 1, 1, 1];
        capture.frame.color = vec![[0; 4]; 6];
        let faults = ErrorMap::new(&capture.frame.color, &capture.frame.color, |_| Vec::new());
        let found = Findings::new(capture, Verdict { faults, ..Default::default() }, Some(vec![1, 1, 2, 1, 7, 1]));
        let edges: Vec<_> = (0..6).filter(|&i| found.is_edge(i)).collect();
        assert_eq!(edges, [1, 2]);
        assert_eq!((found.count(Overlay::Edges), found.count(Overlay::Reference)), (2, 1));
        assert_eq!(found.pixel_text(4), "triangle 1 (truly triangle 7), 0 layers, Δ 0");
    }
}
