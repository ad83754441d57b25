//! Dragging effects: to another place of the stack, or from the browser of effects into it.

use std::sync::Arc;

use egui::{self, DragAndDrop, Pos2, Rect, Stroke, Ui};

use crate::{
    app::{
        shell::command::{Commands, Edit},
        widgets::theme,
    },
    effects::Effect,
};

/// What is dragged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StackDrag {
    /// The effect at this index of the stack.
    Move(usize),
    /// An effect that is to be enabled.
    Enable(Arc<Effect>),
}

/// How far above and below the stack an effect can be dropped, points.
const REACH: f32 = 28.0;

/// The index of the stack before which something at height `y` is dropped. `rects` are those of the
/// effects, from top to bottom.
fn index_at(rects: &[Rect], y: f32) -> usize {
    rects.iter().filter(|rect| y > rect.center().y).count()
}

/// Shows where a dragged effect would land among the effects at `rects`, and moves it there when it
/// is dropped. `area` is where the stack is.
pub fn drop_ui(ui: &Ui, commands: &Commands, names: &[&str], rects: &[Rect], area: Rect) {
    let ctx = ui.ctx();
    let Some(dragged) = DragAndDrop::payload::<StackDrag>(ctx) else {
        return;
    };
    let Some(at) = ctx.pointer_interact_pos() else {
        return;
    };
    let name = match &*dragged {
        StackDrag::Move(index) => names.get(*index).copied().unwrap_or_default(),
        StackDrag::Enable(effect) => &effect.name,
    };
    ghost(ctx, name, at);
    if !area
        .expand2(egui::vec2(0.0, REACH))
        .intersect(ui.clip_rect())
        .contains(at)
    {
        return;
    }
    let index = index_at(rects, at.y);
    let y = match (rects.get(index), rects.last()) {
        (Some(below), _) => below.top() - theme::HALF / 2.0 - 1.0,
        (None, Some(above)) => above.bottom() + theme::HALF / 2.0,
        (None, None) => area.bottom(),
    };
    ui.painter()
        .hline(area.x_range(), y, Stroke::new(2.5, theme::accent()));
    if !ctx.input(|i| i.pointer.any_released()) {
        return;
    }
    DragAndDrop::clear_payload(ctx);
    match &*dragged {
        &StackDrag::Move(from) if index == from || index == from + 1 => {}
        &StackDrag::Move(from) => commands.edit(Edit::Move(from, index)),
        StackDrag::Enable(effect) => commands.edit(Edit::EnableAt(effect.clone(), index)),
    }
}

/// The name of what is dragged, beside the pointer.
fn ghost(ctx: &egui::Context, name: &str, at: Pos2) {
    let painter = ctx.layer_painter(egui::LayerId::new(
        egui::Order::Tooltip,
        egui::Id::unique("dragged effect"),
    ));
    let text = painter.layout_no_wrap(
        name.to_owned(),
        egui::FontId::proportional(13.0),
        theme::text_strong(),
    );
    let rect =
        Rect::from_min_size(at + egui::vec2(12.0, -8.0), text.size()).expand2(egui::vec2(8.0, 4.0));
    painter.rect(
        rect,
        6.0,
        theme::raised(),
        Stroke::new(1.0, theme::accent()),
        egui::StrokeKind::Inside,
    );
    painter.galley(rect.min + egui::vec2(8.0, 4.0), text, theme::text_strong());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effect_lands_before_the_first_one_whose_middle_is_below_the_pointer() {
        let rects = [(0.0, 40.0), (44.0, 200.0), (204.0, 240.0)]
            .map(|(top, bottom)| Rect::from_x_y_ranges(0.0..=10.0, top..=bottom));
        let at = [-5.0, 10.0, 30.0, 100.0, 150.0, 210.0, 230.0, 500.0].map(|y| index_at(&rects, y));
        assert_eq!(at, [0, 0, 1, 1, 2, 2, 3, 3]);
        assert_eq!(index_at(&[], 5.0), 0);
    }
}
