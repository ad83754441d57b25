//! Compare: A, the most exact picture of this preset or one that was kept, beside B, the preset as it stands. Same camera,
//! same clock; with a divider that a hand drags, side by side, one instead of the other, or as their difference. A label says
//! which side is which, and under each stand its milliseconds and its error.

mod bar;

use eframe::egui::{self, Color32, CursorIcon, Pos2, Rect, RichText, Sense, Ui, pos2, vec2};

use super::{
    App, Level, Verdict,
    icons::{Icon, icon_button},
    screen::{Inputs, Screen},
    theme,
    topbar::{error_line, time_text},
    viewport::fitted,
};
use crate::preset::{AccuracyRequest, Preset, Tier};

/// What is to be seen while A and B are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Show {
    /// A on the left of the divider, B on the right.
    Wipe,
    /// All of A in the left half, all of B in the right.
    Beside,
    /// How far they are apart.
    Difference,
    A,
    B,
}

/// Size of the plate under a side, points.
const PLATE: egui::Vec2 = vec2(312.0, 54.0);

/// The comparison; closed, it holds no renderer and costs nothing.
pub struct Compare {
    show: Option<Show>,
    /// Where the divider stands, as a share of the picture's width.
    split: f32,
    /// What A shows: a preset that was kept, or none for the reference.
    kept: Option<Box<Preset>>,
    screen: Option<Screen>,
    wanted: Option<Inputs>,
    verdict: Option<Verdict>,
    /// What a difference is multiplied by.
    gain: u8,
    /// How A and B differ, and the verdicts that tell.
    delta: Option<bar::Delta>,
}

impl Default for Compare {
    fn default() -> Self {
        Self { show: None, split: 0.5, kept: None, screen: None, wanted: None, verdict: None, gain: 16, delta: None }
    }
}

impl Compare {
    pub fn is_wiping(&self) -> bool {
        self.show == Some(Show::Wipe)
    }

    pub fn is_open(&self) -> bool {
        self.show.is_some()
    }

    /// Where B goes.
    pub fn side_b(&self, rect: Rect) -> Rect {
        if self.show == Some(Show::Beside) { rect.split_left_right_at_fraction(0.5).1 } else { rect }
    }

    /// Is B nowhere to be seen by itself?
    pub fn hides_b(&self) -> bool {
        matches!(self.show, Some(Show::A | Show::Difference))
    }

    /// Wipe, side by side, difference, and none of them.
    pub fn cycle(&mut self) {
        match self.show {
            Some(Show::Wipe) => self.show = Some(Show::Beside),
            Some(Show::Beside) => self.show = Some(Show::Difference),
            Some(Show::Difference) => self.close(),
            None | Some(Show::A | Show::B) => self.show = Some(Show::Wipe),
        }
    }

    /// A instead of B, and B instead of A.
    pub fn flip(&mut self) {
        self.show = Some(if self.show == Some(Show::A) { Show::B } else { Show::A });
    }

    /// Gives up A's renderer with all it holds.
    fn close(&mut self) {
        *self = Self { split: self.split, gain: self.gain, kept: self.kept.take(), ..Self::default() };
    }

    /// Are figures of A still to come?
    pub fn is_waiting(&self) -> bool {
        self.screen.as_ref().is_some_and(Screen::is_waiting)
    }

    /// What A's newest frame took, milliseconds; 0 while there is none.
    pub fn ms(&self) -> f64 {
        let report = self.screen.as_ref().and_then(Screen::report);
        if self.show == Some(Show::B) { 0.0 } else { report.and_then(|report| report.gpu_ms).unwrap_or(0.0) }
    }

    /// The picture of A, where its error was not measured yet.
    pub fn unjudged(&self) -> Option<Inputs> {
        let judged = self.verdict.as_ref().map(|verdict| &verdict.of);
        self.show.and(self.wanted.clone()).filter(|wanted| judged != Some(wanted))
    }

    /// Keeps a verdict if it is one on A.
    pub fn take_verdict(&mut self, verdict: &Verdict) -> bool {
        let is_ours = self.wanted.as_ref() == Some(&verdict.of);
        if is_ours {
            self.verdict = Some(verdict.clone());
        }
        is_ours
    }
}

impl App {
    /// Share of the picture's width that shows A while the wipe is open.
    pub fn wipe_split(&self) -> Option<f32> {
        self.compare.is_wiping().then_some(self.compare.split)
    }

    /// What A shows, at full size: the preset's effects on the most exact options, or the kept look, under the live camera.
    fn reference_inputs(&self, live: &Inputs, full: [u32; 2]) -> Inputs {
        let Some(kept) = &self.compare.kept else {
            let accuracy = AccuracyRequest { tier: Tier::Reference, ..AccuracyRequest::default() };
            return Inputs { view: self.view_at(&live.scene, full), accuracy, ..live.clone() };
        };
        let Preset { stack, animation, accuracy, .. } = (**kept).clone();
        let preset = Preset { stack, animation, accuracy, ..self.shown_preset() };
        let stack = preset.evaluated_stack();
        Inputs { view: self.view_of(preset, &live.scene, full), stack, accuracy, scene: live.scene.clone() }
    }

    /// Draws A beside `live`, which may be coarser than `full` while a hand moves it.
    pub(super) fn draw_reference(&mut self, live: &Inputs, full: [u32; 2]) {
        if matches!(self.compare.show, None | Some(Show::B)) {
            return;
        }
        let wanted = self.reference_inputs(live, full);
        let mut inputs = wanted.clone();
        (inputs.view.width, inputs.view.height) = (live.view.width, live.view.height);
        self.compare.wanted = Some(wanted);
        let screen = self.compare.screen.get_or_insert_with(|| self.screen.sibling());
        let drawn = screen.poll(self.now_s).and_then(|()| screen.show(&inputs, self.now_s));
        if let Err(error) = drawn {
            self.log.tell(Level::Error, format!("The comparison cannot be drawn: {error}"), self.now_s);
        }
    }

    /// A over B as far as the divider, the overlays, the divider and both plates; returns
    /// what of `rect` they leave free for B.
    pub(super) fn compare_ui(&mut self, ui: &mut Ui, rect: Rect, at: Rect) -> Rect {
        let Some(show) = self.compare.show else {
            self.paint_overlays(ui, at, rect);
            return rect;
        };
        let (half_a, half_b) = rect.split_left_right_at_fraction(0.5);
        let divider = at.left() + at.width() * self.compare.split;
        let [side_a, side_b] = match show {
            Show::Wipe => [rect.with_max_x(divider), rect.with_min_x(divider)],
            Show::Beside => [half_a, half_b],
            Show::A | Show::Difference => [rect, Rect::NOTHING],
            Show::B => [Rect::NOTHING, rect],
        };
        let picture = self.compare.screen.as_ref().and_then(Screen::picture);
        if let Some((blit, size)) = picture.filter(|_| side_a.width() >= 1.0) {
            let blit = match show {
                Show::Difference => self.compare.screen.as_ref().and_then(|a| a.difference(&self.screen, self.compare.gain)),
                _ => Some(blit.clone()),
            };
            let place = fitted(if show == Show::Beside { half_a } else { rect }, size);
            if show == Show::Beside {
                ui.painter_at(half_a).rect_filled(half_a, 0.0, theme::VIEW);
            }
            ui.painter_at(side_a).extend(blit.map(|blit| blit.shape(place)));
        }
        if side_b.is_positive() {
            self.paint_overlays(ui, at, side_b);
        }
        match show {
            Show::Wipe => self.divider_ui(ui, at),
            Show::Beside => drop(ui.painter().vline(half_a.right(), rect.y_range(), (1.5, theme::LINE))),
            Show::Difference | Show::A | Show::B => {}
        }
        self.labels_ui(ui, [side_a, side_b], show == Show::Difference);
        self.compare_bar_ui(ui, rect);
        self.plates_ui(ui, rect, show)
    }

    /// The divider, to be dragged, or moved by the arrow keys while it has the focus.
    fn divider_ui(&mut self, ui: &Ui, at: Rect) {
        let x = (at.left() + at.width() * self.compare.split).round();
        let grip = Rect::from_min_max(pos2(x - 7.0, at.top()), pos2(x + 7.0, at.bottom()));
        let response = ui.interact(grip, egui::Id::unique("wipe"), Sense::click_and_drag()).on_hover_cursor(CursorIcon::ResizeHorizontal);
        response.widget_info(|| egui::WidgetInfo::slider(true, f64::from(self.compare.split), "Wipe divider"));
        let mut split = self.compare.split;
        if response.dragged()
            && let Some(pointer) = response.interact_pointer_pos()
        {
            split = (pointer.x - at.left()) / at.width().max(1.0);
            ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
        }
        if response.double_clicked() {
            split = 0.5;
        }
        if response.has_focus() {
            let arrows = egui::EventFilter { horizontal_arrows: true, ..Default::default() };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
            let presses = |key| ui.input(|i| i.num_presses(key)) as f32;
            split += 0.02 * (presses(egui::Key::ArrowRight) - presses(egui::Key::ArrowLeft));
        }
        self.compare.split = split.clamp(0.0, 1.0);
        let is_near = response.hovered() || response.dragged() || response.has_focus();
        paint_divider(ui, at, x, if is_near { theme::ACCENT } else { theme::TEXT_STRONG });
    }

    /// Under each side what it is, what it cost and how wrong it is; returns what of `rect` is left for B.
    fn plates_ui(&mut self, ui: &mut Ui, rect: Rect, show: Show) -> Rect {
        let size = vec2(((rect.width() - 36.0) / 2.0).min(PLATE.x), PLATE.y);
        let corner = rect.left_bottom() + vec2(12.0, -12.0 - size.y);
        let place = |x: f32| egui::UiBuilder::new().max_rect(Rect::from_min_size(pos2(x, corner.y), size));
        if show != Show::B {
            self.plate_a_ui(&mut ui.new_child(place(corner.x).id_salt("A")));
        }
        let mut left = rect.left();
        if show != Show::A {
            left = rect.right() - 12.0 - size.x;
            self.plate_b_ui(&mut ui.new_child(place(left).id_salt("B")));
        }
        Rect::from_min_max(pos2(left - 12.0, rect.top()), pos2(rect.right(), corner.y + 4.0))
    }

    fn plate_a_ui(&mut self, ui: &mut Ui) {
        let kept = self.compare.kept.as_ref().map(|kept| if kept.name.is_empty() { "kept look" } else { &kept.name }.to_owned());
        let refused = self.compare.screen.as_ref().zip(self.compare.wanted.as_ref()).is_some_and(|(s, wanted)| s.is_refused(wanted));
        let (color, error, hint) = match refused {
            true => (theme::RED, "cannot be drawn".into(), "The log says why.".into()),
            false => error_line(self.compare.verdict.as_ref(), self.compare.wanted.as_ref()),
        };
        let time = time_text(self.compare.screen.as_ref().and_then(Screen::report));
        let title = format!("A · {}", kept.as_deref().unwrap_or("reference"));
        let doc = if kept.is_some() { "A preset as it was kept" } else { "This preset with the most exact option on every axis" };
        plate(ui, &title, doc, (&time, &error, color, &hint), |ui| {
            if ui.small_button("Keep B").on_hover_text("Make the preset as it stands now the other side").clicked() {
                let preset = Preset { stack: self.visible_stack(), animation: Default::default(), ..self.shown_preset() };
                // With nothing muted its movement is kept too.
                let whole = if self.muted.is_empty() { self.preset_file.preset.clone() } else { preset };
                self.compare.kept = Some(Box::new(whole));
            }
            if kept.is_some() && ui.small_button("Reference").on_hover_text("Compare with the most exact options again").clicked() {
                self.compare.kept = None;
            }
        });
    }

    fn plate_b_ui(&mut self, ui: &mut Ui) {
        let (color, error, hint) = error_line(self.verdict.as_ref(), self.motion.wanted.as_ref());
        let time = time_text(self.screen.report());
        let key = self.screen.explanation().map_or(String::new(), |explanation| explanation.key.clone());
        plate(ui, "B · this preset", &key, (&time, &error, color, &hint), |ui| {
            if icon_button(ui, Icon::Cross, "Close the comparison").clicked() {
                self.compare.close();
            }
        });
    }
}

/// A side's title with its buttons, and below them time and error.
fn plate(ui: &mut Ui, title: &str, doc: &str, (time, error, color, hint): (&str, &str, Color32, &str), buttons: impl FnOnce(&mut Ui)) {
    theme::toast_frame(theme::LINE).inner_margin(egui::Margin::symmetric(10, 6)).show(ui, |ui| {
        ui.set_min_width(ui.available_width());
        ui.spacing_mut().item_spacing.y = 2.0;
        ui.horizontal(|ui| {
            ui.add(egui::Label::new(RichText::new(title).strong().color(theme::TEXT_STRONG)).truncate()).on_hover_text(doc);
            buttons(ui);
        });
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 6.0;
            ui.label(RichText::new(time).size(12.0).color(theme::TEXT));
            ui.label(theme::weak("·"));
            ui.add(egui::Label::new(RichText::new(error).size(12.0).color(color)).truncate()).on_hover_text(hint);
        });
    });
}

/// A line with dark edges, seen on any picture, and a knob with two arrows.
fn paint_divider(ui: &Ui, at: Rect, x: f32, color: Color32) {
    let painter = ui.painter_at(at);
    painter.vline(x, at.y_range(), (4.0, Color32::from_black_alpha(140)));
    painter.vline(x, at.y_range(), (1.5, color));
    let knob = pos2(x, at.center().y);
    painter.circle(knob, 12.0, theme::BAR, (1.5, color));
    for side in [-1.0, 1.0] {
        let tip = knob + vec2(7.0 * side, 0.0);
        let points: [Pos2; 3] = [tip, tip + vec2(-4.0 * side, -4.0), tip + vec2(-4.0 * side, 4.0)];
        painter.add(egui::Shape::convex_polygon(points.to_vec(), color, egui::Stroke::NONE));
    }
}
