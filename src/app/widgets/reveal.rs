//! Showing a row of the inspector that the user has asked for by its path: folders open, the panel
//! scrolls there, and the control of the row has the focus.

use egui::{self, Align, Rect, Response, Ui};

use super::theme;

/// A row that is to be shown.
#[derive(Clone)]
struct Revealed {
    /// `facet.amount`, `clock.speed`.
    path: String,
    since_s: f64,
    is_focused: bool,
}

/// Folders take a moment to open, so the panel follows the row for this long, seconds.
const FOLLOW_S: f64 = 0.6;
/// How long the row is marked, seconds.
const MARK_S: f64 = 1.6;

fn id() -> egui::Id {
    egui::Id::unique("revealed row")
}

fn revealed_row(ctx: &egui::Context) -> Option<Revealed> {
    let revealed: Revealed = ctx.data(|data| data.get_temp(id()))?;
    let now_s = ctx.input(|i| i.time);
    (now_s - revealed.since_s <= MARK_S).then_some(revealed)
}

/// Shows the row of `path` from now on.
pub fn start(ctx: &egui::Context, path: String) {
    let since_s = ctx.input(|i| i.time);
    ctx.data_mut(|data| {
        data.insert_temp(
            id(),
            Revealed {
                path,
                since_s,
                is_focused: false,
            },
        )
    });
    ctx.request_repaint();
}

/// True while a row is shown whose path is `prefix` or begins with `prefix.`: folders with it must
/// be open.
pub fn is_within(ctx: &egui::Context, prefix: &str) -> bool {
    let is_of = |path: &str| {
        path.strip_prefix(prefix)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
    };
    revealed_row(ctx).is_some_and(|revealed| is_of(&revealed.path))
}

/// Marks the row of `path` and scrolls to it, if this row is to be shown.
pub fn row(ui: &Ui, path: &str, rect: Rect) {
    let ctx = ui.ctx();
    let Some(shown) = revealed_row(ctx).filter(|revealed| revealed.path == path) else {
        return;
    };
    let passed_s = ctx.input(|i| i.time) - shown.since_s;
    let strength = 1.0 - (passed_s / MARK_S).clamp(0.0, 1.0) as f32;
    ui.painter().rect_stroke(
        rect,
        4.0,
        egui::Stroke::new(1.5, theme::accent().gamma_multiply(strength)),
        egui::StrokeKind::Inside,
    );
    if passed_s <= FOLLOW_S {
        ui.scroll_to_rect_animation(
            rect,
            Some(Align::Center),
            egui::style::ScrollAnimation::none(),
        );
    }
    ctx.request_repaint();
}

/// Gives `control` the focus, once, if it belongs to the row that is to be shown.
pub fn focus(path: &str, control: &Response) {
    let Some(mut shown) =
        revealed_row(&control.ctx).filter(|revealed| revealed.path == path && !revealed.is_focused)
    else {
        return;
    };
    control.request_focus();
    shown.is_focused = true;
    control.ctx.data_mut(|data| data.insert_temp(id(), shown));
}
