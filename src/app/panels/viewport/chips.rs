//! Over the picture: its state on the left, buttons of views on the right, and a hint while a file
//! hovers.

use egui::{self, Align2, Color32, FontId, Rect, RichText, Ui, pos2};

use crate::{
    app::{
        editing::session::FileId,
        files::open::cancel_loading,
        picture::{command::Picking, golden_check::Outcome},
        shell::{
            action::Action,
            command::{Commands, Edit},
            state::State,
        },
        widgets::{
            icons::{Icon, icon_button},
            theme,
        },
    },
    params::Value,
    preset::NO_CAMERA,
    scene::camera::Projection,
};

pub fn chips_ui(ui: &mut Ui, state: &State, commands: &Commands, rect: Rect, is_comparing: bool) {
    // Beside the buttons where there is room, and below them where there is not.
    let is_wide = rect.width() >= WIDE;
    let (below, beside) = if is_wide {
        (10.0, VIEWS + 12.0)
    } else {
        (46.0, 12.0)
    };
    let corner = Rect::from_min_max(
        rect.min + egui::vec2(12.0, below),
        rect.max - egui::vec2(beside, 0.0),
    );
    let mut left = ui.new_child(egui::UiBuilder::new().id_salt("state").max_rect(corner));
    left.vertical(|ui| {
        loading_ui(ui, state, commands);
        offers_ui(ui, state, commands);
        let notes = states(state).into_iter().map(|(color, text)| Note {
            color,
            text,
            hint: None,
        });
        notes_ui(ui, notes.chain(golden(state)));
    });
    let corner = Rect::from_min_max(
        pos2(rect.right() - VIEWS, rect.top() + 8.0),
        pos2(rect.right() - 12.0, rect.top() + 36.0),
    );
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    let mut right = ui.new_child(
        egui::UiBuilder::new()
            .id_salt("views")
            .max_rect(corner.intersect(rect))
            .layout(layout),
    );
    right.spacing_mut().item_spacing.x = 2.0;
    // The picture may have any color: the buttons have a ground of their own.
    let ground = right.painter().add(egui::Shape::Noop);
    views_ui(
        &mut right,
        state,
        commands,
        is_comparing,
        rect.width() < VIEWS + 12.0,
    );
    let covered = right.min_rect().expand2(egui::vec2(4.0, 1.0));
    right.painter().set(
        ground,
        egui::Shape::rect_filled(covered, 6.0, theme::bar().gamma_multiply(0.9)),
    );
    if ui.ctx().input(|i| !i.raw.hovered_files.is_empty()) {
        let (fill, stroke) = (
            theme::accent_ground().gamma_multiply(0.5),
            (2.0, theme::accent()),
        );
        ui.painter().rect(
            rect.shrink(8.0),
            8.0,
            fill,
            stroke,
            egui::StrokeKind::Inside,
        );
        ui.painter().text(
            rect.center(),
            Align2::CENTER_CENTER,
            "Drop to open",
            FontId::proportional(20.0),
            theme::text_strong(),
        );
    }
}

/// Between two looks at how far loading has come, seconds.
const LOOK_S: f32 = 0.1;

/// How far loading a scene has come, and a button that stops it.
fn loading_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let scenes = &state.session.scenes;
    if !scenes.is_loading() {
        return;
    }
    ui.ctx().request_repaint_after_secs(LOOK_S);
    let text = scenes
        .progress()
        .map_or("loading the scene".into(), |progress| {
            format!("loading the scene: {progress}")
        });
    if offer_ui(ui, &text, "Stop", "Stop loading (Esc)", "Stop loading") {
        commands.run(cancel_loading);
    }
}

/// A note with a button, which says `hint` and is called `name`. Returns true if it was clicked.
fn offer_ui(ui: &mut Ui, text: &str, button: &str, hint: &str, name: &str) -> bool {
    let frame =
        theme::toast_frame(theme::line()).inner_margin(egui::Margin::symmetric(NOTE_MARGIN, 4));
    let row = ui.horizontal(|ui| {
        frame.show(ui, |ui| {
            ui.label(RichText::new(text).size(NOTE_TEXT).color(theme::text()));
            let button = ui.small_button(button).on_hover_text(hint);
            button.accessible_name(name).clicked()
        })
    });
    row.inner.inner
}

/// What the first look at a model could do better, each with a button that does it.
fn offers_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let (preset, Some(scene)) = (state.session.preset(), state.session.scene()) else {
        return;
    };
    if let Some(camera) = preset.cropping_camera(scene) {
        let text = "the file's camera crops the model";
        let hint = format!(
            "Show the whole model instead of the view of camera {}. The menu of cameras under Scene goes back",
            camera.name
        );
        if offer_ui(ui, text, "Show all", &hint, "Show the whole model") {
            commands.edit(Edit::SceneCamera(NO_CAMERA.into()));
        }
    }
    if let Some(dimmed) = preset.dimmed_lights(scene)
        && let Some(studio) = preset.stack.get("studio")
        && let Some(lights) = studio.effect.field("lights")
    {
        let text = "the file's lights are too strong";
        let hint = format!("Set studio.lights to {dimmed}, as the plain look does");
        if offer_ui(ui, text, "Dim", &hint, "Dim the lights") {
            let lights = (studio.effect.clone(), lights.clone());
            commands.edit(Edit::Parameter(lights, Value::number(dimmed)));
        }
    }
}

/// A note on the picture.
struct Note {
    color: Color32,
    text: String,
    /// Shown on hover.
    hint: Option<String>,
}

/// Size of the texts of notes, and the margin left and right of them, points.
const NOTE_TEXT: f32 = 12.0;
const NOTE_MARGIN: i8 = 8;

/// Shows notes from left to right, in as many rows as they need. A note that is wider than a row
/// has a row of its own and is wrapped.
fn notes_ui(ui: &mut Ui, notes: impl Iterator<Item = Note>) {
    let (all, gap) = (ui.available_width(), ui.spacing().item_spacing.x);
    let mut rows: Vec<(f32, Vec<Note>)> = Vec::new();
    for note in notes {
        let galley = ui.painter().layout_no_wrap(
            note.text.clone(),
            FontId::proportional(NOTE_TEXT),
            note.color,
        );
        // With the margins and the line round it.
        let width = galley.size().x + 2.0 * f32::from(NOTE_MARGIN) + 4.0;
        match rows
            .last_mut()
            .filter(|(taken, _)| taken + gap + width <= all)
        {
            Some((taken, row)) => {
                *taken += gap + width;
                row.push(note);
            }
            None => rows.push((width, vec![note])),
        }
    }
    for (_, row) in rows {
        ui.horizontal(|ui| row.iter().for_each(|note| note_ui(ui, note)));
    }
}

fn note_ui(ui: &mut Ui, note: &Note) {
    let text = RichText::new(&note.text).size(NOTE_TEXT).color(note.color);
    let frame =
        theme::toast_frame(theme::line()).inner_margin(egui::Margin::symmetric(NOTE_MARGIN, 4));
    let shown = frame
        .show(ui, |ui| ui.add(egui::Label::new(text).wrap()))
        .inner;
    if let Some(hint) = &note.hint {
        shown.on_hover_text(hint);
    }
}

/// Whether the preset still gives its golden, after a file was reloaded.
fn golden(state: &State) -> Option<Note> {
    let open = FileId::of(&state.session.preset_file);
    let check = state
        .files
        .live
        .golden
        .as_ref()
        .filter(|check| check.file == open)?;
    let color = if check.outcome == Outcome::Same {
        theme::green()
    } else {
        theme::amber()
    };
    Some(Note {
        color,
        text: check.text(),
        hint: Some(check.hint()),
    })
}

/// What is unusual about the picture, each with its color.
fn states(state: &State) -> Vec<(Color32, String)> {
    let (session, screen) = (&state.session, &state.picture.screen);
    let mut states = Vec::new();
    if screen.picture().is_some() {
        if session.scenes.has_failed() {
            states.push((
                theme::red(),
                "last good picture: this scene cannot be shown".into(),
            ));
        } else if screen.is_refused() {
            states.push((
                theme::red(),
                "last good picture: this one cannot be drawn".into(),
            ));
        }
    }
    if screen.divisor() > 1 {
        states.push((
            theme::text_weak(),
            format!("1/{} resolution while moving", screen.divisor()),
        ));
    }
    if !session.muted.is_empty() {
        let names: Vec<_> = session.muted.iter().map(String::as_str).collect();
        states.push((theme::amber(), format!("muted: {}", names.join(", "))));
    }
    let full = screen
        .report()
        .map_or(0, |report| report.counters.full_pixels);
    if full > 0 {
        states.push((
            theme::red(),
            format!("x-ray overflow: {full} pixels have more layers than the sums hold"),
        ));
    }
    if let Some(order) = screen.report().and_then(|report| report.order) {
        let over = order.drawn.saturating_sub(order.limit);
        let percent = 100.0 * order.drawn as f64 / order.covered.max(1) as f64;
        if order.exceeds_sample_counter() {
            states.push((
                theme::red(),
                "more than 2^32 samples: the hardware order lost count. Use the submission order."
                    .into(),
            ));
        }
        states.push((
            theme::text(),
            format!(
                "drew {} of {} samples ({percent:.1} %), {over} too many",
                order.drawn, order.covered
            ),
        ));
    }
    if let Some(picking) = &state.picture.picking {
        let what = match picking {
            Picking::Point(_) => "a point".to_owned(),
            Picking::Part(_, kind) => format!("a {}", kind.name()),
        };
        states.push((
            theme::accent(),
            format!("click {what} of the model (Esc to cancel)"),
        ));
    }
    if !session.visible_stack().is_repeatable() {
        states.push((
            theme::amber(),
            "not reproducible: every frame may differ".into(),
        ));
    }
    if session.is_off_its_time() && !state.open.timeline {
        states.push((
            theme::text_weak(),
            format!("time {:.2} s", session.shown_time_s()),
        ));
    }
    states
}

/// Width of all buttons of views, and of a picture that has room for the state beside them, points.
const VIEWS: f32 = 352.0;
const WIDE: f32 = 640.0;

fn views_ui(ui: &mut Ui, state: &State, commands: &Commands, is_comparing: bool, is_narrow: bool) {
    let is_orthographic = state
        .session
        .camera()
        .is_some_and(|camera| matches!(camera.projection, Projection::Orthographic { .. }));
    if icon_button(ui, Icon::Frame, &Action::Frame.hint()).clicked() {
        commands.perform(Action::Frame);
    }
    if is_narrow {
        ui.menu_button("Views", |ui| sides_ui(ui, is_orthographic, commands))
            .response
            .on_hover_text("Look along an axis");
    } else {
        sides_ui(ui, is_orthographic, commands);
    }
    ui.add_space(theme::GAP);
    for (text, on, action) in [
        (
            "Overlays",
            state.picture.overlays.is_any(),
            Action::Overlays,
        ),
        ("Compare", is_comparing, Action::Compare),
    ] {
        let button = egui::Button::new(text).small().selected(on);
        if ui
            .add(button)
            .on_hover_text(action.hint())
            .accessible_name(action.label())
            .clicked()
        {
            commands.perform(action);
        }
    }
}

/// The kind of the camera, and views along the axes.
fn sides_ui(ui: &mut Ui, is_orthographic: bool, commands: &Commands) {
    let text = if is_orthographic { "Ortho" } else { "Persp" };
    if ui
        .small_button(text)
        .on_hover_text(Action::Orthographic.hint())
        .accessible_name("Orthographic")
        .clicked()
    {
        commands.perform(Action::Orthographic);
    }
    for (text, action) in [
        ("Top", Action::Top),
        ("Side", Action::Side),
        ("Front", Action::Front),
    ] {
        if ui
            .small_button(text)
            .on_hover_text(action.hint())
            .accessible_name(action.label())
            .clicked()
        {
            commands.perform(action);
        }
    }
}
