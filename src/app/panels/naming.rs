//! The dialog that asks for a name: of a preset, of saved values of an effect, or of a bookmark.

use eframe::egui::{self, Button, Key, RichText, TextEdit, Ui};

use crate::{
    app::{
        files::command::Naming,
        files::library,
        shell::{command::Commands, state::State},
        widgets::{panel::Panel, theme},
    },
    preset_file::MAX_NAME,
};

const WIDTH: f32 = 400.0;

/// The dialog that asks for a name.
#[derive(Default)]
pub struct NameDialog(Option<Open>);

struct Open {
    naming: Naming,
    name: String,
    error: Option<String>,
    /// The suggested name is selected when the dialog opens, so that typing replaces it.
    selects: bool,
}

impl NameDialog {
    pub fn is_open(&self) -> bool {
        self.0.is_some()
    }

    /// Asks for a name.
    pub fn ask(&mut self, naming: Naming) {
        let name = match &naming {
            Naming::Preset { title, .. } => title.clone(),
            Naming::Values(_) => String::new(),
            Naming::Bookmark(name) => name.clone(),
        };
        self.0 = Some(Open {
            naming,
            name,
            error: None,
            selects: true,
        });
    }

    /// The name cannot be used: the dialog stays open and says why.
    pub fn refuse(&mut self, naming: Naming, name: String, error: String) {
        self.0 = Some(Open {
            naming,
            name,
            error: Some(error),
            selects: false,
        });
    }
}

/// The choice of a button.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Choice {
    Accept,
    Cancel,
}

impl Panel for NameDialog {
    fn ui(&mut self, ui: &mut Ui, _: &State, commands: &Commands) {
        let Some(open) = &mut self.0 else { return };
        let frame = egui::Frame::window(&ui.ctx().global_style()).inner_margin(16.0);
        let modal = egui::Modal::new(egui::Id::unique("name"))
            .frame(frame)
            .show(ui.ctx(), |ui| {
                ui.set_width(WIDTH.min(ui.ctx().content_rect().width() - 64.0));
                dialog_ui(ui, open)
            });
        let choice = modal
            .inner
            .or_else(|| modal.should_close().then_some(Choice::Cancel));
        match choice {
            Some(Choice::Accept) => {
                if let Some(Open { naming, name, .. }) = self.0.take() {
                    commands.run(|app| library::use_name(app, naming, name));
                }
            }
            Some(Choice::Cancel) => self.0 = None,
            None => {}
        }
    }
}

fn dialog_ui(ui: &mut Ui, open: &mut Open) -> Option<Choice> {
    let (title, about, verb) = match &open.naming {
        Naming::Preset { path, title } => (
            format!("Rename {title}"),
            format!("The file {} is named after it.", path.display()),
            "Rename",
        ),
        Naming::Values(effect) => (
            format!("Save the values of {}", effect.name),
            "They are kept for every preset, in the menu of the effect.".to_owned(),
            "Save",
        ),
        Naming::Bookmark(name) => (
            format!("Rename {name}"),
            "The preset keeps the camera under this name.".to_owned(),
            "Rename",
        ),
    };
    ui.label(
        RichText::new(title)
            .size(15.0)
            .color(theme::text_strong())
            .strong(),
    );
    ui.label(theme::weak(about));
    ui.add_space(theme::HALF);
    let mut shown = TextEdit::singleline(&mut open.name)
        .hint_text("Name")
        .char_limit(MAX_NAME)
        .desired_width(f32::INFINITY)
        .show(ui);
    if std::mem::take(&mut open.selects) {
        let end = egui::text::CCursor::new(open.name.chars().count());
        shown
            .state
            .cursor
            .set_char_range(Some(egui::text::CCursorRange::two(
                egui::text::CCursor::new(0),
                end,
            )));
        shown.state.store(ui.ctx(), shown.response.id);
    }
    let field = shown.response.response.accessible_name("Name");
    let is_entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
    if !is_entered && ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
    if let Some(error) = &open.error {
        theme::notice(ui, theme::amber(), error);
    }
    ui.add_space(theme::HALF);
    let mut choice = is_entered.then_some(Choice::Accept);
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let accept = Button::new(verb)
            .fill(theme::accent_ground())
            .min_size(egui::vec2(72.0, theme::ROW));
        if ui
            .add_enabled(!open.name.trim().is_empty(), accept)
            .clicked()
        {
            choice = Some(Choice::Accept);
        }
        if ui
            .add(Button::new("Cancel").min_size(egui::vec2(72.0, theme::ROW)))
            .clicked()
        {
            choice = Some(Choice::Cancel);
        }
    });
    choice
}
