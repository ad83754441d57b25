//! The ruler: seconds from left to right, the range that plays, and the hand that is dragged to scrub.

use eframe::egui::{self, Align2, FontId, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};

use super::super::theme;
use crate::{app::App, preset::animation::Track};

/// Least distance of labelled ticks, points.
const TICK_POINTS: f32 = 64.0;

/// Seconds on the screen.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    from_s: f64,
    to_s: f64,
    rect: Rect,
}

impl Span {
    pub fn new([from_s, to_s]: [f64; 2], rect: Rect) -> Self {
        Self { from_s, to_s, rect }
    }

    pub fn x(&self, time_s: f64) -> f32 {
        let share = (time_s - self.from_s) / (self.to_s - self.from_s);
        self.rect.left() + (share.clamp(-1.0, 2.0) * f64::from(self.rect.width())) as f32
    }

    pub fn time_s(&self, x: f32) -> f64 {
        self.from_s + f64::from(x - self.rect.left()) * self.seconds_per_point()
    }

    pub fn seconds_per_point(&self) -> f64 {
        (self.to_s - self.from_s) / f64::from(self.rect.width().max(1.0))
    }

    /// First and last moment.
    pub fn ends_s(&self) -> [f64; 2] {
        [self.from_s, self.to_s]
    }

    pub fn rect(&self) -> Rect {
        self.rect
    }
}

/// What the timeline shows: the range, and every key outside it.
pub fn extent([from_s, to_s]: [f64; 2], tracks: &[Track]) -> [f64; 2] {
    let times = tracks.iter().flat_map(|track| track.keys()).map(|key| key.time_s);
    times.fold([from_s, to_s], |[low, high], time_s| [low.min(time_s), high.max(time_s)])
}

/// 1, 2 or 5 times a power of ten, at least `least`.
fn round_step(least: f64) -> f64 {
    let decade = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|factor| factor * decade).find(|step| *step >= least).unwrap_or(10.0 * decade)
}

impl App {
    pub(super) fn ruler_ui(&mut self, ui: &mut Ui, rail: Rect, span: &Span) {
        let response = ui.interact(rail, egui::Id::unique("ruler"), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::slider(true, self.shown_time_s(), "Timeline"));
        if let Some(at) = response.interact_pointer_pos().filter(|_| response.is_pointer_button_down_on() || response.clicked()) {
            let time_s = span.time_s(at.x.clamp(span.rect().left(), span.rect().right()));
            self.show_time((time_s * 1000.0).round() / 1000.0);
        }
        self.playback.held = response.is_pointer_button_down_on();
        let response = response.on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
        let painter = ui.painter_at(rail);
        let clock = self.preset_file.preset.clock;
        painter.rect_filled(rail, 4.0, theme::WELL);
        let [from, to] = clock.range_s.map(|time_s| span.x(time_s));
        let range = Rect::from_min_max(pos2(from, rail.top()), pos2(to, rail.bottom()));
        painter.rect_filled(range.intersect(rail), 2.0, if response.hovered() { theme::RAISED_HOVER } else { theme::RAISED });
        ticks(&painter, rail, span);
        let own = span.x(clock.time_s);
        let mark = [pos2(own - 3.5, rail.bottom()), pos2(own, rail.bottom() - 5.0), pos2(own + 3.5, rail.bottom())];
        painter.add(Shape::convex_polygon(mark.to_vec(), theme::TEXT_WEAK, Stroke::NONE));
    }

    /// The hand: the time that is shown, over the ruler and all tracks.
    pub(super) fn hand_ui(&self, ui: &Ui, rect: Rect, span: &Span) {
        let x = span.x(self.shown_time_s());
        if x < span.rect().left() - 1.0 || x > span.rect().right() + 1.0 {
            return;
        }
        let painter = ui.painter_at(rect);
        painter.vline(x, rect.top()..=rect.bottom(), (1.0, theme::ACCENT));
        let top = pos2(x, rect.top());
        let head = [top + vec2(-5.0, 0.0), top + vec2(5.0, 0.0), top + vec2(5.0, 5.0), top + vec2(0.0, 10.0), top + vec2(-5.0, 5.0)];
        painter.add(Shape::convex_polygon(head.to_vec(), theme::ACCENT, Stroke::NONE));
    }
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
        painter.vline(x, rail.bottom() - 6.0..=rail.bottom(), (1.0, theme::TEXT_WEAK));
        for part in 1..5 {
            let x = span.x(time_s + step * f64::from(part) / 5.0);
            painter.vline(x, rail.bottom() - 3.0..=rail.bottom(), (1.0, theme::LINE));
        }
        // At the right end there is room on the left alone.
        let align = if x + 40.0 > rail.right() { Align2::RIGHT_CENTER } else { Align2::LEFT_CENTER };
        let aside = if align == Align2::RIGHT_CENTER { -4.0 } else { 4.0 };
        let at = pos2(x + aside, rail.center().y - 1.0);
        painter.text(at, align, format!("{time_s:.decimals$}"), FontId::proportional(11.0), theme::TEXT_WEAK);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_stand_on_round_seconds() {
        for (least, wanted) in [(0.3, 0.5), (0.5, 0.5), (0.51, 1.0), (7.0, 10.0), (0.0012, 0.002)] {
            assert!((round_step(least) / wanted - 1.0).abs() < 1e-9, "{least}: {}", round_step(least));
        }
    }

    #[test]
    fn a_place_leads_back_to_its_time() {
        let span = Span::new([-1.0, 3.0], Rect::from_min_max(pos2(100.0, 0.0), pos2(900.0, 10.0)));
        for time_s in [-1.0, 0.0, 1.234, 3.0] {
            assert!((span.time_s(span.x(time_s)) - time_s).abs() < 1e-3, "{time_s}");
        }
    }
}
