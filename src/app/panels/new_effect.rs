//! The dialog for a new effect: its name and its hook.

use eframe::egui::{self, RichText, Ui};

use crate::{
    app::theme,
    effect_files::{Catalog, Hook, check_name},
};

/// What is chosen so far.
pub struct NewEffect {
    pub name: String,
    pub hook: Hook,
    pub error: Option<String>,
}

impl Default for NewEffect {
    fn default() -> Self {
        Self { name: String::new(), hook: Hook::Surface, error: None }
    }
}

impl NewEffect {
    /// True if an effect can have this name; otherwise the dialog says why not.
    pub fn check(&mut self, catalog: &Catalog) -> bool {
        let name = self.name.trim().to_owned();
        let checked = if name.is_empty() {
            Err("Type a name.".into())
        } else if catalog.names().any(|known| known == name) {
            Err(format!("There is an effect {name} already."))
        } else {
            check_name(&name).map_err(|reason| format!("{name:?} {reason}."))
        };
        self.name = name;
        self.error = checked.err();
        self.error.is_none()
    }
}

/// Shows the fields. Returns true if Enter was pressed in the name.
pub fn fields_ui(ui: &mut Ui, dialog: &mut NewEffect) -> bool {
    let NewEffect { name, hook, error } = dialog;
    ui.label(RichText::new("New effect").size(15.0).color(theme::TEXT_STRONG).strong());
    ui.label(theme::weak("Writes a commented WGSL file and opens it in your editor. The picture changes whenever you save the file."));
    ui.add_space(theme::HALF);
    let field = ui.add(egui::TextEdit::singleline(name).hint_text("Name, for instance ink").desired_width(f32::INFINITY));
    let field = field.accessible_name("Name");
    let is_entered = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
    if !is_entered && ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
    for option in Hook::ALL {
        ui.radio_value(hook, option, about(option)).accessible_name(option.name());
    }
    if let Some(error) = error {
        theme::notice(ui, theme::AMBER, error);
    }
    ui.add_space(theme::HALF);
    is_entered
}

const fn about(hook: Hook) -> &'static str {
    match hook {
        Hook::Surface => "Surface: colors what is visible",
        Hook::Vertex => "Vertex: moves vertices",
        Hook::Sample => "Sample: decides which samples are drawn",
        Hook::Pixel => "Pixel: changes the finished picture",
    }
}
