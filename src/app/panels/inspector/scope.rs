//! The row "On" of an effect: the parts of the scene that it changes, chosen from a list or by a
//! click on the model.

use std::sync::Arc;

use egui::{self, Popup, PopupCloseBehavior, ScrollArea, TextEdit, Ui};

use crate::{
    app::{
        picture::command::Picking,
        shell::{
            command::{Commands, Edit},
            state::State,
        },
        widgets::theme,
    },
    effects::Effect,
    scene::{
        Scene,
        parts::{PartKind, PartPattern, Scope, parts},
    },
};

const LIST_WIDTH: f32 = 240.0;
const LIST_HEIGHT: f32 = 260.0;

/// An entry of the list: a part of the scene, or a pattern of the scope that is not the name of
/// one.
#[derive(Clone)]
pub(super) struct Entry {
    pub pattern: PartPattern,
    /// What the row shows: the name, indented below its parent, and the number of draws.
    pub text: String,
    pub indent: f32,
}

impl Entry {
    pub(super) fn of_pattern(pattern: &PartPattern) -> Self {
        Self {
            pattern: pattern.clone(),
            text: pattern.to_string(),
            indent: 0.0,
        }
    }

    pub(super) fn answers(&self, search: &str) -> bool {
        let name = self.pattern.to_string().to_lowercase();
        name.contains(&search.trim().to_lowercase())
    }
}

/// What is known of a scene while its parts are shown: finding them takes a while in a large scene.
#[derive(Clone)]
struct Known {
    scene: Arc<Scene>,
    entries: Arc<[Entry]>,
}

/// Warnings about a scope on a scene.
#[derive(Clone)]
struct Missing {
    scene: Arc<Scene>,
    on: Scope,
    sentences: Arc<[String]>,
}

/// The row of an effect that can be limited to parts.
pub fn scope_ui(ui: &mut Ui, state: &State, commands: &Commands, effect: &Arc<Effect>) {
    let Some(enabled) = state
        .session
        .preset()
        .stack
        .get(&effect.name)
        .filter(|enabled| enabled.effect.has_scope())
    else {
        return;
    };
    let on = enabled.on.clone();
    let is_picking =
        matches!(&state.picture.picking, Some(Picking::Part(picking, _)) if picking == effect);
    ui.horizontal(|ui| {
        ui.set_min_height(theme::ROW);
        ui.label(theme::weak("On"));
        let button = ui.button(if is_picking {
            "click on the model".to_owned()
        } else {
            format!("{}…", summary(&on))
        });
        let button = button
            .on_hover_text(format!("{}.on: {on}", effect.name))
            .accessible_name(format!("Parts of {}", effect.name));
        if button.clicked() {
            ui.memory_mut(|memory| memory.request_focus(search_id(effect)));
        }
        let popup = Popup::menu(&button).close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        popup.show(|ui| picker_ui(ui, state, commands, effect, &on));
    });
    if let Some(scene) = state.session.scene().filter(|_| !on.is_whole_scene()) {
        let prefix = format!("effects.{}.on: ", effect.name);
        for sentence in missing(ui, state, scene, effect, &on).iter() {
            theme::notice(
                ui,
                theme::amber(),
                sentence.strip_prefix(&prefix).unwrap_or(sentence),
            );
        }
    }
}

/// The field of the list, which has the keyboard when the list opens.
fn search_id(effect: &Effect) -> egui::Id {
    egui::Id::unique(("search of parts", &effect.name))
}

/// What the button shows of a scope.
fn summary(on: &Scope) -> String {
    match on.patterns() {
        [] => "whole scene".into(),
        [only] => short_name(only),
        several => format!("{} parts", several.len()),
    }
}

/// `mesh Lens`, not too long for a button.
pub(super) fn short_name(pattern: &PartPattern) -> String {
    let short: String = pattern.glob().chars().take(18).collect();
    format!("{} {short}", pattern.kind.name())
}

/// The list with its search, and the buttons below it.
fn picker_ui(ui: &mut Ui, state: &State, commands: &Commands, effect: &Arc<Effect>, on: &Scope) {
    let name = format!("Search parts for {}", effect.name);
    let hint = "Search parts, or write a pattern: mesh:Lens*";
    let search = part_search_ui(ui, search_id(effect), hint, name);
    let mut changed: Option<Scope> = None;
    // A pattern in the search field that is no name of the list.
    if let Ok(pattern) = search.trim().parse::<PartPattern>()
        && !on.patterns().contains(&pattern)
        && ui.button(format!("Add {pattern}")).clicked()
    {
        changed = Some(on.with(&pattern, true));
    }
    let entries = state.session.scene().map(|scene| entries(ui, scene));
    let entries = entries.unwrap_or_else(|| Arc::from([]));
    let own = on.patterns().iter();
    let own = own.filter(|pattern| !entries.iter().any(|entry| entry.pattern == **pattern));
    let is_found = |entry: &&Entry| entry.answers(&search);
    let found = entries.iter().filter(is_found).cloned();
    let listed: Vec<Entry> = own.map(Entry::of_pattern).chain(found).collect();
    let clicked = list_ui(ui, &listed, |ui, entry, shows_kind| {
        entry_ui(ui, on, entry, shows_kind)
    });
    if let Some((entry, is_on)) = clicked {
        changed = Some(on.with(&entry.pattern, is_on));
    }
    ui.separator();
    ui.horizontal(|ui| {
        ui.label(theme::weak("Pick a"));
        for kind in PartKind::ALL {
            let button = ui.button(kind.name()).on_hover_text(format!(
                "The next click on the model adds its {}",
                kind.name()
            ));
            if button
                .accessible_name(format!("Pick a {} for {}", kind.name(), effect.name))
                .clicked()
            {
                let picking = Some(Picking::Part(effect.clone(), kind));
                commands.run(|app| app.state.picture.picking = picking);
                ui.close();
            }
        }
        let whole = ui.add_enabled(!on.is_whole_scene(), egui::Button::new("Whole scene"));
        if whole
            .on_hover_text("Remove all parts from the list")
            .clicked()
        {
            changed = Some(Scope::default());
        }
    });
    if let Some(on) = changed {
        commands.edit(Edit::Scope(effect.clone(), on));
    }
}

/// The search above a list of parts. Returns what is searched.
pub(super) fn part_search_ui(ui: &mut Ui, id: egui::Id, hint: &str, name: String) -> String {
    ui.set_width(LIST_WIDTH);
    let mut search: String = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let field = TextEdit::singleline(&mut search)
        .id(id)
        .hint_text(hint)
        .desired_width(f32::INFINITY);
    ui.add(field).accessible_name(name);
    ui.data_mut(|data| data.insert_temp(id, search.clone()));
    search
}

/// A list of parts; `show` is told whether an entry is the first of its kind. Returns the entry
/// that was changed, and how.
pub(super) fn list_ui<'a, T>(
    ui: &mut Ui,
    listed: &'a [Entry],
    mut show: impl FnMut(&mut Ui, &Entry, bool) -> Option<T>,
) -> Option<(&'a Entry, T)> {
    let mut changed = None;
    ScrollArea::vertical()
        .max_height(LIST_HEIGHT)
        .auto_shrink([false, true])
        .show_rows(ui, theme::ROW, listed.len(), |ui, rows| {
            for index in rows {
                let entry = &listed[index];
                let is_first = index == 0 || listed[index - 1].pattern.kind != entry.pattern.kind;
                let shown = ui.horizontal(|ui| {
                    ui.set_min_height(theme::ROW);
                    ui.add_space(entry.indent);
                    show(ui, entry, is_first)
                });
                changed = shown.inner.map(|change| (entry, change)).or(changed.take());
            }
        });
    if listed.is_empty() {
        ui.label(theme::weak("No part has this name."));
    }
    changed
}

/// Returns whether the entry is part of the scope, where that changed.
fn entry_ui(ui: &mut Ui, on: &Scope, entry: &Entry, shows_kind: bool) -> Option<bool> {
    let mut is_on = on.patterns().contains(&entry.pattern);
    let tick = ui.checkbox(&mut is_on, &entry.text);
    if shows_kind {
        ui.label(theme::weak(entry.pattern.kind.plural()));
    }
    let tick = tick.accessible_name(entry.pattern.to_string());
    tick.changed().then_some(is_on)
}

/// The parts of a scene.
pub(super) fn entries(ui: &Ui, scene: &Arc<Scene>) -> Arc<[Entry]> {
    const INDENT: f32 = 10.0;
    const MAX_DEPTH: usize = 6;
    let id = egui::Id::unique("parts of the scene");
    if let Some(known) = ui
        .data(|data| data.get_temp::<Known>(id))
        .filter(|known| Arc::ptr_eq(&known.scene, scene))
    {
        return known.entries;
    }
    let entry = |part: crate::scene::parts::Part| {
        let draws = if part.instances == 1 {
            String::new()
        } else {
            format!("  ×{}", part.instances)
        };
        let short: String = part.name.chars().take(28).collect();
        let end = if short.len() < part.name.len() {
            "…"
        } else {
            ""
        };
        Entry {
            pattern: part.pattern(),
            text: format!("{short}{end}{draws}"),
            indent: INDENT * part.depth.min(MAX_DEPTH) as f32,
        }
    };
    let entries: Arc<[Entry]> = parts(scene).into_iter().map(entry).collect();
    ui.data_mut(|data| {
        data.insert_temp(
            id,
            Known {
                scene: scene.clone(),
                entries: entries.clone(),
            },
        )
    });
    entries
}

/// Warnings about the patterns of an effect that match nothing.
fn missing(
    ui: &Ui,
    state: &State,
    scene: &Arc<Scene>,
    effect: &Effect,
    on: &Scope,
) -> Arc<[String]> {
    let id = egui::Id::unique(("missing parts", &effect.name));
    let is_known = |known: &Missing| Arc::ptr_eq(&known.scene, scene) && known.on == *on;
    if let Some(known) = ui
        .data(|data| data.get_temp::<Missing>(id))
        .filter(is_known)
    {
        return known.sentences;
    }
    let of_effect = format!("effects.{}.on: ", effect.name);
    let sentences = state
        .session
        .preset()
        .missing_parts(scene)
        .into_iter()
        .filter(|sentence| sentence.starts_with(&of_effect));
    let sentences: Arc<[String]> = sentences.collect();
    ui.data_mut(|data| {
        data.insert_temp(
            id,
            Missing {
                scene: scene.clone(),
                on: on.clone(),
                sentences: sentences.clone(),
            },
        )
    });
    sentences
}
