//! Painting the overlays: one image over the picture, with rings round errors that are few.

use std::sync::Arc;

use egui::{self, Color32, Pos2, Rect, Ui, pos2, vec2};

use super::overlay_image::{image, rings};
use crate::app::{
    picture::{findings::Findings, overlay::OverlaySelection},
    shell::state::State,
};

/// Keeps the newest image of the overlays.
#[derive(Default)]
pub struct OverlayPainter(Option<Painted>);

/// An image of overlays, and what it was painted from.
struct Painted {
    findings: Arc<Findings>,
    selection: OverlaySelection,
    texture: egui::TextureHandle,
    rings: Vec<(usize, Color32)>,
}

impl OverlayPainter {
    /// Paints the overlays over the picture at `at`, inside `clip`. Nothing while the picture has
    /// no verdict.
    pub fn paint(&mut self, ui: &Ui, state: &State, at: Rect, clip: Rect) {
        if !state.picture.overlays.is_any() || state.picture.screen.divisor() > 1 {
            return;
        }
        let Some(findings) = state.picture.findings() else {
            return;
        };
        let painted = self.painted(ui.ctx(), findings, &state.picture.overlays);
        let painter = ui.painter_at(at).with_clip_rect(clip.intersect(at));
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        painter.image(painted.texture.id(), at, whole, Color32::WHITE);
        let width = findings.size[0].max(1) as usize;
        let texel = at.size()
            / vec2(
                findings.size[0].max(1) as f32,
                findings.size[1].max(1) as f32,
            );
        for (i, color) in &painted.rings {
            let center = vec2((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
            painter.circle_stroke(at.min + center * texel, 8.0, (1.5, *color));
        }
    }

    /// The image, painted again if something in it has changed.
    fn painted(
        &mut self,
        ctx: &egui::Context,
        findings: &Arc<Findings>,
        selection: &OverlaySelection,
    ) -> &Painted {
        let is_same =
            |old: &Painted| Arc::ptr_eq(&old.findings, findings) && old.selection == *selection;
        let old = self.0.take().filter(is_same);
        let shown = selection.shown();
        self.0.insert(old.unwrap_or_else(|| Painted {
            texture: ctx.load_texture(
                "overlays",
                image(findings, shown, selection.gain),
                egui::TextureOptions::NEAREST,
            ),
            rings: rings(findings, shown),
            findings: findings.clone(),
            selection: selection.clone(),
        }))
    }
}
