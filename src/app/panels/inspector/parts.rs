//! The button "Parts" of the scene: which of them are shown.

use eframe::egui::{self, Popup, PopupCloseBehavior, ScrollArea, TextEdit, Ui};

use super::scope::{Entry, LIST_HEIGHT, LIST_WIDTH, entries};
use crate::{
    app::{
        shell::{
            command::{Commands, Edit},
            state::State,
        },
        widgets::theme,
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
        [only] => {
            let short: String = only.glob().chars().take(18).collect();
            format!("only {} {short}", only.kind.name())
        }
        several => format!("only {}", several.len()),
    }
}

/// The list with its search, and the button below it. Hidden parts come first, since the scene that
/// is shown has them no more.
fn list_ui(ui: &mut Ui, state: &State, commands: &Commands, shown: &ShownParts) {
    ui.set_width(LIST_WIDTH);
    let id = search_id();
    let mut search: String = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let field = TextEdit::singleline(&mut search)
        .id(id)
        .hint_text("Search parts")
        .desired_width(f32::INFINITY);
    ui.add(field).accessible_name("Search parts of the scene");
    ui.data_mut(|data| data.insert_temp(id, search.clone()));
    let needle = search.trim().to_lowercase();
    let hidden = shown.hidden.patterns().iter().map(|pattern| Entry {
        pattern: pattern.clone(),
        text: pattern.to_string(),
        indent: 0.0,
    });
    let seen = state
        .session
        .scene()
        .map_or_else(|| [].into(), |scene| entries(ui, scene));
    let listed: Vec<Entry> = hidden
        .chain(
            seen.iter()
                .filter(|entry| !shown.hidden.patterns().contains(&entry.pattern))
                .cloned(),
        )
        .filter(|entry| {
            needle.is_empty() || entry.pattern.to_string().to_lowercase().contains(&needle)
        })
        .collect();
    let mut changed = None;
    ScrollArea::vertical()
        .max_height(LIST_HEIGHT)
        .auto_shrink([false, true])
        .show_rows(ui, theme::ROW, listed.len(), |ui, rows| {
            for index in rows {
                let is_first =
                    index == 0 || listed[index - 1].pattern.kind != listed[index].pattern.kind;
                if let Some(parts) = entry_ui(ui, shown, &listed[index], is_first) {
                    changed = Some(parts);
                }
            }
        });
    if listed.is_empty() {
        ui.label(theme::weak("No part has this name."));
    }
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
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        ui.add_space(entry.indent);
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
        let at_the_end = egui::Layout::right_to_left(egui::Align::Center);
        let alone = ui.with_layout(at_the_end, |ui| {
            let alone = ui
                .selectable_label(is_alone, "only")
                .on_hover_text("Show this part alone")
                .accessible_name(format!("Only {pattern}"));
            if shows_kind {
                ui.label(theme::weak(pattern.kind.plural()));
            }
            alone.clicked()
        });
        alone.inner.then(|| ShownParts {
            only: if is_alone {
                Scope::default()
            } else {
                Scope::new([pattern.clone()])
            },
            hidden: Scope::default(),
            ..shown.clone()
        })
    })
    .inner
}
