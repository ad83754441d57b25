//! The dialog for a new effect: its name and its hook.

use std::{path::PathBuf, sync::Arc};

use egui::Ui;

use crate::{
    app::{
        files::command::Origin,
        widgets::{form::name_ui, text::with_own_paths, theme},
    },
    effect_files::{Catalog, Hook, check_name},
    effects::Effect,
};

/// What is chosen so far.
pub struct NewEffect {
    pub name: String,
    pub origin: Origin,
    pub error: Option<String>,
    /// Where its file is written.
    folder: PathBuf,
    /// The suggested name is selected when the dialog opens, so that typing replaces it.
    selects: bool,
}

impl NewEffect {
    /// A new effect without a name, or a duplicate with a name that is free.
    pub fn new(duplicated: Option<Arc<Effect>>, catalog: &Catalog, folder: PathBuf) -> Self {
        let Some(effect) = duplicated else {
            return Self {
                name: String::new(),
                origin: Origin::Template(Hook::Surface),
                error: None,
                folder,
                selects: false,
            };
        };
        let first = format!("my_{}", effect.name);
        let further = (2..).map(|number| format!("{first}_{number}"));
        let is_free = |name: &String| catalog.names().all(|known| known != name);
        let name = std::iter::once(first.clone())
            .chain(further)
            .find(is_free)
            .unwrap_or(first);
        Self {
            name,
            origin: Origin::Duplicate(effect),
            error: None,
            folder,
            selects: true,
        }
    }

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
    let NewEffect {
        name,
        origin,
        error,
        folder,
        selects,
    } = dialog;
    let (title, about) = match origin {
        Origin::Template(_) => (
            "New effect".to_owned(),
            "Writes a commented WGSL file and shows its text beside the picture, which follows what you type.".to_owned(),
        ),
        Origin::Duplicate(effect) => (
            format!("Duplicate {} as my own", effect.name),
            "Writes its text as a WGSL file of yours and shows it beside the picture. The stack then uses your effect, with the same values."
                .to_owned(),
        ),
    };
    ui.label(theme::title(title));
    ui.label(theme::weak(about));
    ui.add_space(theme::HALF);
    let before = name.clone();
    let is_entered = name_ui(ui, "Name, for instance ink", name, selects);
    if *name != before {
        *error = None;
    }
    if let Origin::Template(hook) = origin {
        for option in Hook::ALL {
            ui.radio_value(hook, option, self::about(option))
                .accessible_name(option.name());
        }
    }
    let file = folder.join(format!("{}.wgsl", name.trim()));
    let file = with_own_paths(file.display().to_string());
    if !name.trim().is_empty() {
        ui.label(theme::small(format!("It is written to {file}.")));
    }
    if let Some(error) = error {
        theme::notice(ui, theme::amber(), error);
    }
    is_entered
}

const fn about(hook: Hook) -> &'static str {
    match hook {
        Hook::Surface => "Surface: colors what is visible",
        Hook::Vertex => "Vertex: moves vertices",
        Hook::Sample => "Sample: decides which samples are drawn",
        Hook::Pixel => "Pixel: changes the color of finished pixels",
        Hook::Image => "Image: passes over the finished picture, which read their neighbors",
    }
}
