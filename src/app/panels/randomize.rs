//! The window Randomize: how far values vary, which are locked, and the newest seeds as pictures to
//! go back to.

use std::{collections::HashMap, sync::Arc};

use egui::{self, RichText, Sense, Ui, vec2};

use crate::app::panels::panel::Panel;
use crate::{
    app::{
        editing::apply::recall_seed,
        editing::randomize::Seeded,
        picture::{
            cells::{self, CellOf, CellResult, Cells},
            screen::Inputs,
        },
        shell::{
            action::Action,
            command::{Commands, Parameter},
            state::State,
        },
        widgets::{
            fields::label,
            panel::{describe_chosen, main_button, picture_ui, plate, window},
            theme,
        },
    },
    effects::{EnabledEffect, Stack},
};

/// Width of a thumbnail, points and pixels.
const THUMBNAIL: u32 = 96;

/// The window Randomize.
#[derive(Default)]
pub struct RandomizePanel {
    is_open: bool,
    /// Pictures of seeds; none where one could not be drawn.
    pictures: HashMap<u32, Option<egui::TextureHandle>>,
    /// The seed whose picture is being drawn.
    drawing: Option<u32>,
}

impl RandomizePanel {
    /// Shows or hides the window.
    pub fn toggle(&mut self) {
        self.is_open = !self.is_open;
    }

    pub fn is_open(&self) -> bool {
        self.is_open
    }

    pub fn is_drawing(&self) -> bool {
        self.drawing.is_some()
    }

    /// Takes the picture of a seed.
    pub fn take_picture(&mut self, ctx: &egui::Context, seed: u32, picture: CellResult) {
        if self.drawing == Some(seed) {
            self.drawing = None;
        }
        let texture = picture.ok().map(|image| {
            ctx.load_texture(format!("seed {seed}"), image, egui::TextureOptions::LINEAR)
        });
        self.pictures.insert(seed, texture);
    }

    /// Begins to draw the newest seed that has no picture, one at a time, when the picture is at
    /// rest.
    fn request(&mut self, state: &State, commands: &Commands) {
        let (Some(requested), false) = (
            state.picture.screen.requested(),
            self.is_drawing()
                || state
                    .picture
                    .screen
                    .is_awaited(state.session.playback.playing),
        ) else {
            return;
        };
        let seeds = &state.session.randomizer;
        self.pictures
            .retain(|seed, _| seeds.seeds().any(|seeded| seeded.seed == *seed));
        let Some(next) = seeds
            .seeds()
            .find(|seeded| !self.pictures.contains_key(&seeded.seed))
        else {
            return;
        };
        self.drawing = Some(next.seed);
        let cells = vec![(CellOf::Seed(next.seed), inputs(state, requested, next))];
        let cells = Cells {
            cells,
            is_canceled: Arc::default(),
        };
        commands.run(|app| app.state.draw_cells(cells));
    }
}

/// What the picture of a seed shows: the scene and the camera as they are now, with the values of
/// then.
fn inputs(state: &State, requested: &Inputs, seeded: &Seeded) -> Inputs {
    let size = cells::size(THUMBNAIL, [requested.view.width, requested.view.height]);
    let mut preset = state.session.visible_preset();
    preset.stack = Stack(
        seeded
            .stack
            .0
            .iter()
            .filter(|enabled| preset.stack.get(&enabled.effect.name).is_some())
            .cloned()
            .collect(),
    );
    let stack = preset
        .evaluated_stack()
        .drawn(state.session.length_scale(&preset, size));
    Inputs {
        view: state.session.view_of(preset, &requested.scene, size),
        stack,
        ..requested.clone()
    }
}

impl Panel for RandomizePanel {
    fn ui(&mut self, ui: &mut Ui, state: &State, commands: &Commands) {
        if !self.is_open {
            return;
        }
        self.request(state, commands);
        let mut is_open = true;
        let area = ui.ctx().content_rect();
        window("Randomize", &mut is_open)
            .default_pos(area.right_top() + vec2(-800.0, 96.0))
            .default_width(440.0)
            .show(ui.ctx(), |ui| {
                ui.set_width(440.0);
                controls_ui(ui, state, commands);
                egui::ScrollArea::vertical()
                    .max_height((area.height() - 420.0).max(96.0))
                    .auto_shrink([false, true])
                    .show(ui, |ui| {
                        state
                            .session
                            .preset()
                            .stack
                            .0
                            .iter()
                            .for_each(|enabled| locks_ui(ui, state, commands, enabled));
                    });
                self.strip_ui(ui, state, commands);
            });
        self.is_open = is_open;
    }
}

fn controls_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    ui.horizontal(|ui| {
        let is_possible = !state.session.preset().stack.0.is_empty();
        let keys = Action::Randomize.shortcut_text();
        let hint = format!("Give every parameter that is not locked a random value ({keys})");
        let button = ui.add_enabled(is_possible, main_button("Randomize"));
        let button = button.on_hover_text(hint).accessible_name("Randomize now");
        if button.clicked() {
            commands.perform(Action::Randomize);
        }
        ui.label("vary by");
        let mut percent = state.session.randomizer.vary_percent;
        let slider = egui::Slider::new(&mut percent, 1.0..=100.0).step_by(1.0).suffix(" %");
        let hint = "How far a value may go from where it is, in percent of its slider. At 100 % it may go anywhere on it.";
        let slider = ui.add(slider).on_hover_text(hint);
        if slider.accessible_name("Vary by percent").changed() {
            commands.run(move |app| app.state.session.randomizer.vary_percent = percent.clamp(1.0, 100.0));
        }
    });
    ui.add_space(theme::HALF);
}

/// Keeps a parameter as it is when the effects are randomized, or lets it vary.
fn lock(commands: &Commands, (effect, field): Parameter, is_locked: bool) {
    commands.run(move |app| {
        let randomizer = &mut app.state.session.randomizer;
        randomizer.lock(&effect, &field, is_locked);
    });
}

/// A box for each parameter of an effect: with a mark, it varies.
fn locks_ui(ui: &mut Ui, state: &State, commands: &Commands, enabled: &EnabledEffect) {
    let (effect, seeds) = (&enabled.effect, &state.session.randomizer);
    let shown: Vec<_> = effect
        .fields
        .iter()
        .filter(|field| field.is_shown(&effect.fields, &enabled.words))
        .collect();
    if shown.is_empty() {
        return;
    }
    let locked = shown
        .iter()
        .filter(|field| seeds.is_locked(effect, field))
        .count();
    let all_locked = locked == shown.len();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 10.0;
        let mut varies = locked < shown.len();
        let title = theme::strong(&effect.name).strong();
        let all = ui
            .checkbox(&mut varies, title)
            .on_hover_text("Let all of its parameters vary, or lock them all");
        if all
            .accessible_name(format!("Vary {}", effect.name))
            .clicked()
        {
            shown
                .iter()
                .for_each(|field| lock(commands, (effect.clone(), (*field).clone()), !all_locked));
        }
        for field in shown {
            let is_animated = state
                .session
                .preset()
                .animation
                .get(&effect.name, &field.name)
                .is_some();
            let mut varies = !seeds.is_locked(effect, field) && !is_animated;
            let name = RichText::new(label(&field.name, &field.unit)).size(12.0);
            let response = ui.add_enabled(!is_animated, egui::Checkbox::new(&mut varies, name));
            let response = response
                .on_hover_text(&field.doc)
                .on_disabled_hover_text("Its keyframes decide");
            if response
                .accessible_name(format!("Vary {}.{}", effect.name, field.name))
                .clicked()
            {
                lock(commands, (effect.clone(), field.clone()), !varies);
            }
        }
    });
}

impl RandomizePanel {
    /// The newest seeds, newest first; a click goes back to one.
    fn strip_ui(&self, ui: &mut Ui, state: &State, commands: &Commands) {
        ui.add_space(theme::HALF);
        if state.session.randomizer.seeds().len() == 0 {
            ui.label(theme::weak(
                "The last twelve seeds appear here, to go back to.",
            ));
            return;
        }
        ui.label(theme::weak("The last seeds; click one to go back to it."));
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(8.0, 8.0);
            for Seeded { seed, stack } in state.session.randomizer.seeds() {
                let is_current = state.session.preset().stack.0 == stack.0;
                if seed_ui(ui, *seed, self.pictures.get(seed), is_current).clicked() {
                    let seed = *seed;
                    commands.step(move |app| recall_seed(&mut app.state, seed));
                }
            }
        });
    }
}

fn seed_ui(
    ui: &mut Ui,
    seed: u32,
    picture: Option<&Option<egui::TextureHandle>>,
    is_current: bool,
) -> egui::Response {
    let width = THUMBNAIL as f32;
    let (rect, response) = ui.allocate_exact_size(vec2(width, 0.625 * width), Sense::click());
    picture_ui(ui, rect, picture.and_then(Option::as_ref));
    let edge = match () {
        () if is_current => theme::accent(),
        () if response.hovered() || response.has_focus() => theme::text_strong(),
        () => theme::line(),
    };
    ui.painter().rect_stroke(
        rect,
        4.0,
        (if is_current { 2.0 } else { 1.0 }, edge),
        egui::StrokeKind::Inside,
    );
    plate(
        ui.painter(),
        rect.min,
        egui::Align2::LEFT_TOP,
        rect.shrink(4.0),
        &seed.to_string(),
    );
    describe_chosen(
        &response,
        egui::Role::Button,
        is_current,
        format!("Seed {seed}"),
    );
    response.on_hover_text(format!("Go back to seed {seed}"))
}
