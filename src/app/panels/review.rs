//! The review of goldens: the queue of presets whose picture differs from its golden, and both
//! pictures with a wipe, their difference, or one after the other.

use std::sync::Arc;

use egui::{self, Color32, Pos2, Rect, RichText, Sense, Ui, pos2, vec2};

use super::viewport::compare_ui::divider_ui;
use crate::app::panels::panel::{Panel, performs};
use crate::{
    app::{
        picture::apply::begin_review,
        picture::review::{Drawn, Entry, Review},
        shell::{action::Action, command::Commands, state::State},
        widgets::{
            form::modes_ui,
            panel::{describe, main_button, window},
            theme,
        },
    },
    measure::compare::difference_picture,
};

/// Width of the queue and of the picture, points.
const QUEUE: f32 = 190.0;
const PICTURE: f32 = 480.0;

/// Seconds that each picture is shown when they alternate.
const BLINK_S: f64 = 0.5;

/// Factor of the difference.
const GAIN: u8 = 16;

/// How golden and picture are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Mode {
    /// The golden on the left of a divider, the picture of now on the right.
    #[default]
    Wipe,
    Difference,
    /// One after the other.
    Blink,
}

const MODES: [(Mode, &str, &str); 3] = [
    (
        Mode::Wipe,
        "Wipe",
        "The golden on the left of the divider, the picture of now on the right",
    ),
    (
        Mode::Difference,
        "Difference",
        "The difference of every channel, times 16",
    ),
    (
        Mode::Blink,
        "Blink",
        "The golden and the picture of now, one after the other",
    ),
];

/// The window with the queue.
pub struct ReviewPanel {
    is_open: bool,
    mode: Mode,
    /// Position of the divider, as a fraction of the picture's width.
    split: f32,
    textures: Option<Textures>,
}

/// Textures of the entry that is shown: golden, picture and difference.
struct Textures {
    of: Arc<Drawn>,
    golden: Option<[egui::TextureHandle; 2]>,
    now: egui::TextureHandle,
}

impl Default for ReviewPanel {
    fn default() -> Self {
        Self {
            is_open: false,
            mode: Mode::default(),
            split: 0.5,
            textures: None,
        }
    }
}

impl ReviewPanel {
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// Shows or hides the window.
    pub fn toggle(&mut self) {
        self.is_open = !self.is_open;
    }

    fn textures(&mut self, ctx: &egui::Context, drawn: &Arc<Drawn>) -> &Textures {
        let known = self.textures.take();
        let known = known.filter(|textures| Arc::ptr_eq(&textures.of, drawn));
        self.textures
            .insert(known.unwrap_or_else(|| Textures::new(ctx, drawn)))
    }

    /// The picture of the entry that is shown, in its mode.
    fn picture_ui(&mut self, ui: &mut Ui, drawn: &Arc<Drawn>) {
        let [width, height] = drawn.size.map(|side| side.max(1) as f32);
        let width_pt = PICTURE.min(ui.available_width());
        let size = vec2(width_pt, width_pt * height / width);
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let (mode, split) = (self.mode, self.split);
        let Textures { golden, now, .. } = self.textures(ui.ctx(), drawn);
        let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        let painter = ui.painter_at(rect);
        let put = |texture: &egui::TextureHandle, clip: Rect| {
            let painter = painter.with_clip_rect(clip.intersect(painter.clip_rect()));
            painter.image(texture.id(), rect, whole, Color32::WHITE);
        };
        put(now, rect);
        let mut shown = "golden and now";
        match (golden, mode) {
            (None, _) => shown = "now",
            (Some([golden, _]), Mode::Wipe) => {
                put(golden, rect.with_max_x(rect.left() + rect.width() * split));
            }
            (Some([_, difference]), Mode::Difference) => {
                put(difference, rect);
                shown = "difference";
            }
            (Some([golden, _]), Mode::Blink) => {
                let turn = ui.input(|i| i.time) / BLINK_S;
                shown = "now";
                if (turn as u64).is_multiple_of(2) {
                    put(golden, rect);
                    shown = "golden";
                }
                let wait_s = (1.0 - turn.fract()) * BLINK_S;
                ui.ctx().request_repaint_after_secs(wait_s as f32 + 0.01);
            }
        }
        let has_golden = golden.is_some();
        describe(&response, egui::Role::Image, format!("Review: {shown}"));
        if has_golden && mode == Mode::Wipe {
            divider_ui(ui, "review wipe", &mut self.split, rect);
        }
    }

    fn entry_ui(&mut self, ui: &mut Ui, entry: &Entry, commands: &Commands) {
        ui.set_width(PICTURE);
        ui.label(theme::strong(&entry.name));
        match &entry.drawn {
            None => drop(ui.label(theme::weak("The oracle draws it"))),
            Some(Err(error)) => theme::notice(ui, theme::red(), error),
            Some(Ok(drawn)) => {
                ui.horizontal(|ui| {
                    modes_ui(ui, "Review", &mut self.mode, MODES);
                });
                self.picture_ui(ui, drawn);
                ui.label(theme::weak(drawn.text.as_str()));
            }
        }
        if entry.is_rejected {
            let text = "Rejected: the golden stays, the picture is to be mended";
            ui.label(RichText::new(text).color(theme::amber()));
        }
        ui.horizontal(|ui| {
            for (action, text) in [
                (Action::AcceptGolden, "Accept"),
                (Action::RejectGolden, "Keep the golden"),
                (Action::NextGolden, "Next"),
            ] {
                let is_ready = action != Action::AcceptGolden || matches!(entry.drawn, Some(Ok(_)));
                let button = ui.add_enabled(is_ready, egui::Button::new(text));
                performs(button, commands, action);
            }
        });
    }
}

impl Textures {
    fn new(ctx: &egui::Context, drawn: &Arc<Drawn>) -> Self {
        let texture = |name: &str, colors: &[[u8; 4]]| {
            let size = drawn.size.map(|side| side as usize);
            let image = egui::ColorImage::from_rgba_unmultiplied(size, colors.as_flattened());
            ctx.load_texture(
                format!("review {name}"),
                image,
                egui::TextureOptions::NEAREST,
            )
        };
        let golden = drawn.golden.as_ref().map(|golden| {
            let difference = difference_picture(golden, &drawn.now, GAIN);
            [
                texture("golden", golden),
                texture("difference", &difference),
            ]
        });
        Self {
            of: drawn.clone(),
            golden,
            now: texture("now", &drawn.now),
        }
    }
}

/// The button that looks for differences, and how far it is.
fn begin_ui(ui: &mut Ui, review: &Review, commands: &Commands) {
    ui.horizontal(|ui| match review.progress() {
        Some([done, planned]) => {
            if ui.button("Stop looking").clicked() {
                commands.run(|app| app.state.picture.review.stop());
            }
            ui.label(theme::weak(format!("{done} of {planned} presets drawn")));
        }
        None => {
            let button = main_button("Look for differences");
            let hint = "The oracle draws every preset that has a golden, beside the window";
            if ui.add(button).on_hover_text(hint).clicked() {
                commands.run(begin_review);
            }
            match (review.entries().is_empty(), review.is_complete()) {
                (true, true) => {
                    let text = "Every preset has the picture of its golden";
                    ui.label(RichText::new(text).color(theme::green()));
                }
                (true, false) => {
                    ui.label(theme::weak(hint));
                }
                (false, _) => {}
            }
        }
    });
}

/// The queue as a list.
fn queue_ui(ui: &mut Ui, review: &Review, commands: &Commands, height: f32) {
    egui::ScrollArea::vertical()
        .id_salt("review queue")
        .max_height(height)
        .show(ui, |ui| {
            ui.set_width(QUEUE);
            for (index, entry) in review.entries().iter().enumerate() {
                let name = std::path::Path::new(&entry.name)
                    .file_stem()
                    .map_or(entry.name.clone().into(), |stem| stem.to_string_lossy());
                let color = match (&entry.drawn, entry.is_rejected) {
                    (_, true) => theme::amber(),
                    (Some(Err(_)), _) => theme::red(),
                    _ => theme::text(),
                };
                let label = egui::Button::selectable(
                    index == review.shown(),
                    RichText::new(&*name).color(color),
                );
                if ui.add(label.truncate()).clicked() {
                    commands.run(move |app| app.state.picture.review.show(index));
                }
            }
        });
}

impl Panel for ReviewPanel {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        if !self.is_open {
            self.textures = None;
            return;
        }
        let mut is_open = true;
        let area = ui.ctx().content_rect();
        let review = &state.picture.review;
        window("Review", &mut is_open)
            .default_pos(area.left_top() + vec2(280.0, 72.0))
            .show(ui.ctx(), |ui| {
                ui.set_width((QUEUE + PICTURE + 2.0 * theme::GAP).min(area.width() - 48.0));
                begin_ui(ui, review, commands);
                ui.add_space(theme::HALF);
                ui.horizontal_top(|ui| {
                    let height = (area.height() - 200.0).max(160.0);
                    if !review.entries().is_empty() {
                        ui.vertical(|ui| queue_ui(ui, review, commands, height));
                    }
                    if let Some(entry) = review.shown_entry() {
                        ui.vertical(|ui| self.entry_ui(ui, entry, commands));
                    }
                });
            });
        self.is_open = is_open;
    }
}
