//! An entry of the palette: what it shows, and the commands that carry it out.

use std::sync::Arc;

use crate::{
    accuracy::Axis,
    app::{
        editing::apply::set_text,
        shell::{
            action::Action,
            command::{Commands, Edit},
            log::Level,
        },
        widgets::theme::ThemeChoice,
    },
    effects::Effect,
    scene::camera::Camera,
};

/// What kind of thing an entry is, for its first column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Action,
    Effect,
    Parameter,
    Setting,
    Accuracy,
    Preset,
    Scene,
}

impl Kind {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Action => "action",
            Self::Effect => "effect",
            Self::Parameter => "parameter",
            Self::Setting => "setting",
            Self::Accuracy => "accuracy",
            Self::Preset => "preset",
            Self::Scene => "scene",
        }
    }
}

/// What an entry does.
#[derive(Clone, Debug, PartialEq)]
pub enum Choice {
    Perform(Action),
    Enable(Arc<Effect>),
    Disable(Arc<Effect>),
    /// Disables the first effect and enables the second, since both take the same slot.
    Replace(String, Arc<Effect>),
    /// Shows the row of this path, or the effect of this name, in the inspector.
    Reveal(String),
    /// Shows this effect, which is not in the stack, among those that can be added.
    Offer(Arc<Effect>),
    /// Looks from this camera.
    GoTo(Camera),
    Theme(ThemeChoice),
    /// Gives the value at this path.
    Set(String, String),
    /// Opens the preset of this id.
    Open(String),
    Builtin(&'static str),
    /// Nothing can be done, for this reason.
    Refuse(String),
}

/// An entry of the palette.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub kind: Kind,
    /// What is searched first, for instance `facet.amount` or `Enable toon`.
    pub text: String,
    /// Shown behind it: the present value, or what it is about.
    pub detail: String,
    /// What is searched, too.
    pub about: String,
    /// Its keys, for instance `Ctrl+Z`.
    pub keys: String,
    pub choice: Choice,
}

impl Entry {
    /// An entry without detail, description and keys.
    pub fn new(kind: Kind, text: impl Into<String>, choice: Choice) -> Self {
        let (detail, about, keys) = Default::default();
        Self {
            kind,
            text: text.into(),
            detail,
            about,
            keys,
            choice,
        }
    }

    pub fn with(self, detail: impl Into<String>, about: impl Into<String>) -> Self {
        Self {
            detail: detail.into(),
            about: about.into(),
            ..self
        }
    }
}

/// What the texts of entries begin with, before the name of what they are about.
const VERBS: [&str; 7] = [
    "Enable ", "Disable ", "Show ", "Open ", "Scene ", "Camera: ", "Theme: ",
];

impl Entry {
    /// Is `query` the whole text, or the name of the effect, preset, action, scene or theme?
    pub fn is_called(&self, query: &str) -> bool {
        let plain = |text: &str| {
            text.trim()
                .trim_end_matches('…')
                .replace('_', " ")
                .to_lowercase()
        };
        let query = plain(query);
        let name = VERBS
            .iter()
            .find_map(|verb| self.text.strip_prefix(verb))
            .unwrap_or(&self.text);
        let (title, id) = match name
            .strip_suffix(')')
            .and_then(|name| name.rsplit_once(" ("))
        {
            Some((title, id)) if self.kind == Kind::Preset => (title, id),
            _ => (name, name),
        };
        [&self.text, title, id]
            .iter()
            .any(|name| plain(name) == query)
    }
}

/// Carries out `choice`.
pub fn perform(choice: Choice, commands: &Commands) {
    match choice {
        Choice::Perform(action) => commands.perform(action),
        Choice::Enable(effect) => {
            commands.edit(Edit::Enable(effect.clone()));
            commands.reveal(effect.name.clone());
        }
        Choice::Disable(effect) => commands.edit(Edit::Disable(effect)),
        Choice::Replace(other, effect) => {
            commands.edit(Edit::Replace(other, effect.clone()));
            commands.reveal(effect.name.clone());
        }
        Choice::Reveal(path) => commands.reveal(path),
        Choice::Offer(effect) => commands.run(move |app| {
            let browser = &mut app.panels.browser.effects;
            browser.begin_adding(effect.name.clone());
        }),
        Choice::GoTo(camera) => commands.edit(Edit::Camera(Some(camera))),
        Choice::Theme(theme) => {
            commands.run(move |app| app.change_settings(|settings| settings.theme = theme));
        }
        Choice::Set(path, value) => {
            commands.step(move |app| set_text(&mut app.state, &path, &value));
        }
        Choice::Open(id) => commands.open(id),
        Choice::Builtin(name) => commands.open(format!("builtin:{name}")),
        Choice::Refuse(reason) => commands.notify(Level::Warning, reason),
    }
}

/// The path of an accuracy axis among the settings.
pub fn axis_path(axis: &Axis) -> String {
    format!("accuracy.{}", axis.name)
}
