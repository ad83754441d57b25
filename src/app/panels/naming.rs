//! The dialog that asks for a name: of a preset, of saved values of an effect, or of a bookmark.

use egui::Ui;

use super::dialogs::buttons::buttons;
use crate::app::panels::panel::Panel;
use crate::app::{
    files::{command::Naming, library},
    shell::{command::Commands, state::State},
    widgets::{form::name_ui, panel::modal, theme},
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

impl Panel for NameDialog {
    fn ui(&mut self, ui: &mut Ui, _: &State, commands: &Commands) {
        let Some(open) = &mut self.0 else { return };
        let modal = modal(ui.ctx(), "name", 16.0).show(ui.ctx(), |ui| {
            ui.set_width(WIDTH.min(ui.ctx().content_rect().width() - 64.0));
            dialog_ui(ui, open)
        });
        let is_closed = modal.should_close();
        match modal.inner.or(is_closed.then_some(false)) {
            Some(true) if !open.name.trim().is_empty() => {
                if let Some(Open { naming, name, .. }) = self.0.take() {
                    commands.run(|app| library::use_name(app, naming, name));
                }
            }
            Some(true) => open.error = Some("Type a name.".into()),
            Some(false) => self.0 = None,
            None => {}
        }
    }
}

/// Returns true if the name is accepted, and false if the dialog is to be closed.
fn dialog_ui(ui: &mut Ui, open: &mut Open) -> Option<bool> {
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
    ui.label(theme::title(title));
    ui.label(theme::weak(about));
    ui.add_space(theme::HALF);
    let before = open.name.clone();
    let is_entered = name_ui(ui, "Name", &mut open.name, &mut open.selects);
    if open.name != before {
        open.error = None;
    }
    if let Some(error) = &open.error {
        theme::notice(ui, theme::amber(), error);
    }
    let options = [(verb, true, true), ("Cancel", false, false)];
    buttons(ui, &options, |_| None).or(is_entered.then_some(true))
}
