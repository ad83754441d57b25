//! The ruler: seconds from left to right, the range that plays, and the playhead that is dragged to
//! scrub.

use egui::{self, Align2, FontId, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};

use super::span::Span;
use crate::app::{editing::session::Session, shell::command::Commands, widgets::theme};

/// Least distance between labeled ticks, points.
const TICK_POINTS: f32 = 64.0;

/// 1, 2 or 5 times a power of ten, at least `least`.
fn round_step(least: f64) -> f64 {
    let decade = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * decade)
        .find(|step| *step >= least)
        .unwrap_or(10.0 * decade)
}

/// The ruler at `rail`. Pressing it shows the time there.
pub fn ruler_ui(ui: &mut Ui, rail: Rect, span: &Span, session: &Session, commands: &Commands) {
    let response = ui.interact(rail, egui::Id::unique("ruler"), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::slider(true, session.shown_time_s(), "Timeline"));
    let is_held = response.is_pointer_button_down_on();
    if let Some(at) = response
        .interact_pointer_pos()
        .filter(|_| is_held || response.clicked())
    {
        let time_s = span.time_s(at.x.clamp(span.rect().left(), span.rect().right()));
        let time_s = (time_s * 1000.0).round() / 1000.0;
        commands.run(move |app| app.state.session.playback.show(time_s));
    }
    if is_held != session.playback.is_held {
        commands.run(move |app| app.state.session.playback.is_held = is_held);
    }
    let response = response.on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
    let painter = ui.painter_at(rail);
    let clock = session.preset().clock;
    painter.rect_filled(rail, 4.0, theme::well());
    let [from, to] = clock.range_s.map(|time_s| span.x(time_s));
    let range = Rect::from_min_max(pos2(from, rail.top()), pos2(to, rail.bottom()));
    painter.rect_filled(
        range.intersect(rail),
        2.0,
        if response.hovered() {
            theme::raised_hover()
        } else {
            theme::raised()
        },
    );
    ticks(&painter, rail, span);
    let own = span.x(clock.time_s);
    let mark = [
        pos2(own - 3.5, rail.bottom()),
        pos2(own, rail.bottom() - 5.0),
        pos2(own + 3.5, rail.bottom()),
    ];
    painter.add(Shape::convex_polygon(
        mark.to_vec(),
        theme::text_weak(),
        Stroke::NONE,
    ));
}

/// The playhead: a line at `time_s` over the ruler and all tracks.
pub fn playhead_ui(ui: &Ui, rect: Rect, span: &Span, time_s: f64) {
    let x = span.x(time_s);
    if x < span.rect().left() - 1.0 || x > span.rect().right() + 1.0 {
        return;
    }
    let painter = ui.painter_at(rect);
    painter.vline(x, rect.top()..=rect.bottom(), (1.0, theme::accent()));
    let top = pos2(x, rect.top());
    let head = [
        top + vec2(-5.0, 0.0),
        top + vec2(5.0, 0.0),
        top + vec2(5.0, 5.0),
        top + vec2(0.0, 10.0),
        top + vec2(-5.0, 5.0),
    ];
    painter.add(Shape::convex_polygon(
        head.to_vec(),
        theme::accent(),
        Stroke::NONE,
    ));
}

fn ticks(painter: &egui::Painter, rail: Rect, span: &Span) {
    let step = round_step(f64::from(TICK_POINTS) * span.seconds_per_point());
    let decimals = (-step.log10().floor()).clamp(0.0, 6.0) as usize;
    let [from_s, to_s] = span.ends_s();
    let first = (from_s / step - 1e-9).ceil();
    let count = ((to_s - from_s) / step + 1e-9).floor() as u32;
    for i in 0..=count.min(200) {
        let time_s = (first + f64::from(i)) * step;
        let x = span.x(time_s);
        painter.vline(
            x,
            rail.bottom() - 6.0..=rail.bottom(),
            (1.0, theme::text_weak()),
        );
        for part in 1..5 {
            let x = span.x(time_s + step * f64::from(part) / 5.0);
            painter.vline(x, rail.bottom() - 3.0..=rail.bottom(), (1.0, theme::line()));
        }
        // At the right end there is no space on the right.
        let align = if x + 40.0 > rail.right() {
            Align2::RIGHT_CENTER
        } else {
            Align2::LEFT_CENTER
        };
        let aside = if align == Align2::RIGHT_CENTER {
            -4.0
        } else {
            4.0
        };
        let at = pos2(x + aside, rail.center().y - 1.0);
        painter.text(
            at,
            align,
            format!("{time_s:.decimals$}"),
            FontId::proportional(11.0),
            theme::text_weak(),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_at_round_seconds() {
        for (least, expected) in [
            (0.3, 0.5),
            (0.5, 0.5),
            (0.51, 1.0),
            (7.0, 10.0),
            (0.0012, 0.002),
        ] {
            assert!(
                (round_step(least) / expected - 1.0).abs() < 1e-9,
                "{least}: {}",
                round_step(least)
            );
        }
    }
}
