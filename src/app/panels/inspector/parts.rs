//! The button "Parts" of the scene: which of them are shown.

use egui::{self, Popup, PopupCloseBehavior, Ui};

use super::scope::{Entry, entries, list_ui as parts_list_ui, part_search_ui, short_name};
use crate::{
    app::{
        shell::{
            command::{Commands, Edit},
            state::State,
        },
        widgets::{panel::at_right, theme},
    },
    scene::parts::{PartPattern, Scope, ShownParts},
};

/// The button with the list of parts, in a row with others.
pub fn parts_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let shown = &state.session.preset().parts;
    ui.label(theme::weak("Parts"));
    let button = ui
        .button(format!("{}…", summary(shown)))
        .on_hover_text("Hide parts of the scene, or show one of them alone")
        .accessible_name("Parts of the scene");
    if button.clicked() {
        ui.memory_mut(|memory| memory.request_focus(search_id()));
    }
    Popup::menu(&button)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show(|ui| list_ui(ui, state, commands, shown));
}

/// The field of the list, which has the keyboard when the list opens.
fn search_id() -> egui::Id {
    egui::Id::unique("search of the scene's parts")
}

/// What the button shows.
fn summary(shown: &ShownParts) -> String {
    let hidden = shown.hidden.patterns().len();
    match shown.only.patterns() {
        [] if hidden == 0 => "all shown".into(),
        [] => format!("{hidden} hidden"),
        [only] => format!("only {}", short_name(only)),
        several => format!("only {}", several.len()),
    }
}

/// The list with its search, and the button below it. Hidden parts come first, since the scene that
/// is shown has them no more.
fn list_ui(ui: &mut Ui, state: &State, commands: &Commands, shown: &ShownParts) {
    let name = "Search parts of the scene".to_owned();
    let search = part_search_ui(ui, search_id(), "Search parts", name);
    let hidden = shown.hidden.patterns();
    let seen = state.session.scene().map(|scene| entries(ui, scene));
    let seen = seen.iter().flat_map(|seen| seen.iter());
    let seen = seen
        .filter(|entry| !hidden.contains(&entry.pattern))
        .cloned();
    let listed = hidden.iter().map(Entry::of_pattern).chain(seen);
    let listed: Vec<Entry> = listed.filter(|entry| entry.answers(&search)).collect();
    let changed = parts_list_ui(ui, &listed, |ui, entry, shows_kind| {
        entry_ui(ui, shown, entry, shows_kind)
    });
    let mut changed = changed.map(|(_, parts)| parts);
    ui.separator();
    let all = ShownParts {
        variant: shown.variant.clone(),
        ..ShownParts::default()
    };
    if ui
        .add_enabled(*shown != all, egui::Button::new("Show all"))
        .clicked()
    {
        changed = Some(all);
    }
    if let Some(parts) = changed {
        commands.edit(Edit::Parts(parts));
    }
}

/// The parts that are shown from now on, where a click changed them.
fn entry_ui(
    ui: &mut Ui,
    shown: &ShownParts,
    entry: &Entry,
    shows_kind: bool,
) -> Option<ShownParts> {
    let pattern: &PartPattern = &entry.pattern;
    let mut is_shown = !shown.hidden.patterns().contains(pattern);
    let tick = ui
        .checkbox(&mut is_shown, &entry.text)
        .on_hover_text("Shown or hidden")
        .accessible_name(format!("Show {pattern}"));
    if tick.changed() {
        return Some(ShownParts {
            hidden: shown.hidden.with(pattern, !is_shown),
            ..shown.clone()
        });
    }
    let is_alone = shown.only.patterns() == [pattern.clone()];
    let is_clicked = at_right(ui, |ui| {
        let alone = ui
            .selectable_label(is_alone, "only")
            .on_hover_text("Show this part alone")
            .accessible_name(format!("Only {pattern}"));
        if shows_kind {
            ui.label(theme::weak(pattern.kind.plural()));
        }
        alone.clicked()
    });
    is_clicked.then(|| ShownParts {
        only: match is_alone {
            true => Scope::default(),
            false => Scope::new([pattern.clone()]),
        },
        hidden: Scope::default(),
        ..shown.clone()
    })
}
