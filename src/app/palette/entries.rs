//! Everything that the palette offers, from the lists that menus, inspector and preset files use
//! too.

use std::sync::Arc;

use super::entry::{Choice, Entry, Kind, axis_path};
use crate::{
    accuracy::{AXES, AxisOption as _, RenderScale},
    app::{
        editing::session::Session,
        panels::inspector::rows::has_row,
        picture::anti_aliasing::{CHOICES, name},
        shell::action::{Action, actions},
        widgets::{fields::allowed_text, theme::ThemeChoice},
    },
    effects::Effect,
    params::{Field, Param, Value},
    preset::{
        Bookmark, Tier,
        settings::{Setting, settings},
    },
    preset_file::{GalleryEntry, toml_value},
    scene::builtin::BUILTINS,
};

/// Longest value that is shown behind a path, characters.
const MAX_VALUE: usize = 40;

/// Every entry, those of the open preset first.
pub fn entries(session: &Session, presets: &[GalleryEntry]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = actions()
        .filter(|(action, ..)| *action != Action::Palette)
        .map(|row| action(row.0))
        .collect();
    let enabled = session
        .preset()
        .stack
        .0
        .iter()
        .map(|enabled| &enabled.effect);
    let effects = session.preset_file.effects.effects_with(enabled);
    for effect in &effects {
        entries.extend(of_effect(session, effect));
    }
    entries.extend(session.preset().bookmarks.iter().map(bookmark));
    entries.extend(ThemeChoice::ALL.map(theme));
    for effect in &effects {
        entries.extend(parameters(session, effect));
    }
    let is_accuracy = |setting: &&Setting| setting.path().starts_with("accuracy.");
    entries.extend(
        settings()
            .filter(|setting| !is_accuracy(setting))
            .filter_map(|setting| of_setting(session, setting)),
    );
    entries.extend(accuracy(session));
    entries.extend(anti_aliasing(session));
    entries.extend(presets.iter().filter_map(preset));
    entries.extend(BUILTINS.iter().map(|builtin| {
        let text = format!("Scene {}", builtin.name);
        let entry = Entry::new(Kind::Scene, text, Choice::Builtin(builtin.name));
        entry.with(builtin.about, builtin.about)
    }));
    entries
}

fn action(action: Action) -> Entry {
    Entry {
        keys: action.shortcut_text(),
        ..Entry::new(Kind::Action, action.label(), Choice::Perform(action))
    }
}

fn bookmark(bookmark: &Bookmark) -> Entry {
    let text = format!("Camera: {}", bookmark.name);
    let entry = Entry::new(Kind::Action, text, Choice::GoTo(bookmark.camera));
    entry.with("", "bookmark of the preset")
}

fn theme(choice: ThemeChoice) -> Entry {
    let text = format!("Theme: {}", choice.label());
    Entry::new(Kind::Action, text, Choice::Theme(choice)).with("", "colors of the window")
}

/// What can be done with an effect. That it is found neither switches it on nor off.
fn of_effect(session: &Session, effect: &Arc<Effect>) -> Vec<Entry> {
    let stack = &session.preset().stack;
    let entry = |verb: &str, detail: String, choice: Choice| {
        let entry = Entry::new(Kind::Effect, format!("{verb} {}", effect.name), choice);
        entry.with(detail, effect.about.as_str())
    };
    let about = effect.about.clone();
    match (stack.get(&effect.name), stack.rival_of(effect)) {
        (Some(_), _) => vec![
            entry("Show", about.clone(), Choice::Reveal(effect.name.clone())),
            entry("Disable", about, Choice::Disable(effect.clone())),
        ],
        (None, Some(rival)) => vec![entry(
            "Enable",
            format!("instead of {}: {about}", rival.name),
            Choice::Replace(rival.name.clone(), effect.clone()),
        )],
        (None, None) => vec![entry("Enable", about, Choice::Enable(effect.clone()))],
    }
}

/// The parameters of an effect. One of an effect that is not in the stack leads to where it can be
/// added; one that is hidden says why.
fn parameters(session: &Session, effect: &Arc<Effect>) -> Vec<Entry> {
    let stack = &session.preset().stack;
    let words = session.shown_words(effect);
    let conflict = stack
        .conflict_with(effect)
        .map(|conflict| conflict.to_string())
        .filter(|_| words.is_none());
    let entry = |field: &Arc<Field>| {
        let path = format!("{}.{}", effect.name, field.name);
        let (detail, choice) = match (&words, &conflict) {
            (_, Some(conflict)) => (conflict.clone(), Choice::Refuse(conflict.clone())),
            (None, None) => (
                format!("{} is not in the stack", effect.name),
                Choice::Offer(effect.clone()),
            ),
            (Some(words), None) if field.is_shown(&effect.fields, words) => (
                value_text(field, &field.value(words)),
                Choice::Reveal(path.clone()),
            ),
            (Some(words), None) => {
                let condition = field
                    .when
                    .as_ref()
                    .map_or_else(String::new, |(choice, among)| {
                        format!("{}.{choice} is {}", effect.name, among.join(" or "))
                    });
                let reason = format!("{path} is shown while {condition}");
                (
                    format!("{}, hidden", value_text(field, &field.value(words))),
                    Choice::Refuse(reason),
                )
            }
        };
        Entry::new(Kind::Parameter, path, choice).with(detail, field.doc.as_str())
    };
    effect.fields.iter().map(entry).collect()
}

fn of_setting(session: &Session, setting: &'static Setting) -> Option<Entry> {
    // A setting that does not apply to the preset has no value; a value sets it up.
    let value = setting.get(session.preset());
    let detail = value
        .as_ref()
        .map_or_else(String::new, |value| value_text(setting, value));
    let path = setting.path();
    let choice = match value {
        Some(_) if has_row(&path) => Choice::Reveal(path.clone()),
        _ => Choice::Refuse(format!(
            "{path} has no row; type its value, {}",
            allowed_text(&setting.param)
        )),
    };
    Some(Entry::new(Kind::Setting, path, choice).with(detail, setting.doc.as_str()))
}

/// The tiers, and every option of every axis.
fn accuracy(session: &Session) -> impl Iterator<Item = Entry> {
    let accuracy = session.preset().accuracy;
    let tier = move |tier: Tier| {
        let choice = Choice::Set("accuracy.tier".into(), tier.name().into());
        let text = format!("accuracy.tier = {}", tier.name());
        let entry = Entry::new(Kind::Accuracy, text, choice);
        entry.with(present(accuracy.tier == tier), "tolerance")
    };
    let options = AXES.iter().flat_map(move |axis| {
        let pinned = accuracy.pins.get(axis).map_or(0, |index| index + 1);
        let options = axis.choices.iter().enumerate();
        options.map(move |(index, option)| {
            let choice = Choice::Set(axis_path(axis), (*option).to_owned());
            let text = format!("{} = {option}", axis_path(axis));
            let about = index
                .checked_sub(1)
                .and_then(|index| axis.option_abouts.get(index));
            let detail = match about {
                _ if index == pinned => "present",
                Some(about) => about.trim(),
                None => "the planner decides",
            };
            Entry::new(Kind::Accuracy, text, choice).with(detail, axis.about)
        })
    });
    Tier::ALL.into_iter().map(tier).chain(options)
}

/// The choices of the menu AA.
fn anti_aliasing(session: &Session) -> Vec<Entry> {
    let axis = &AXES[RenderScale::AXIS];
    let pinned = session.preset().accuracy.pins.option::<RenderScale>();
    let entry = |option: Option<RenderScale>| {
        let word = option.map_or(axis.choices[0], |option| option.name());
        let text = format!("AA {}", option.map_or("automatic", name));
        let choice = Choice::Set(axis_path(axis), word.to_owned());
        let about = "anti-aliasing: samples of a pixel";
        Entry::new(Kind::Accuracy, text, choice).with(present(pinned == option), about)
    };
    let options = CHOICES.iter().map(|(option, _)| Some(*option));
    [None].into_iter().chain(options).map(entry).collect()
}

/// The detail of an option that is in use.
const fn present(is_so: bool) -> &'static str {
    if is_so { "present" } else { "" }
}

fn preset(entry: &GalleryEntry) -> Option<Entry> {
    let found = entry.preset_file.as_ref().ok()?;
    let title = found.title();
    let id = if title == entry.id {
        String::new()
    } else {
        format!(" ({})", entry.id)
    };
    let text = format!("Open {title}{id}");
    let entry = Entry::new(Kind::Preset, text, Choice::Open(entry.id.clone()));
    Some(entry.with(found.preset.about.as_str(), ""))
}

/// A value with its unit, short enough for a row.
fn value_text(param: &Param, value: &Value) -> String {
    let text = toml_value::write_text(&param.value_type, value);
    let short: String = if text.chars().count() > MAX_VALUE {
        text.chars().take(MAX_VALUE).chain(['…']).collect()
    } else {
        text
    };
    if param.unit.is_empty() {
        short
    } else {
        format!("{short} {}", param.unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::shell::action::actions;
    use crate::{
        effects::EFFECTS,
        preset_file::{Folders, gallery},
    };

    fn all() -> Vec<Entry> {
        let presets = gallery(&Folders::default());
        let opened = presets
            .iter()
            .find(|entry| entry.id == "xray")
            .and_then(|entry| entry.preset_file.clone().ok());
        entries(&Session::new(opened.expect("a built-in preset")), &presets)
    }

    #[test]
    fn every_action_effect_parameter_preset_and_option_is_there_once() {
        let all = all();
        let has = |text: &str| all.iter().filter(|entry| entry.text == text).count() == 1;
        for (action, label, _) in actions().filter(|(action, ..)| *action != Action::Palette) {
            assert!(has(label), "{action:?}");
        }
        for effect in EFFECTS.iter() {
            let verb = if ["xray", "lambert"].contains(&effect.name.as_str()) {
                "Disable"
            } else {
                "Enable"
            };
            assert!(has(&format!("{verb} {}", effect.name)), "{}", effect.name);
            effect.fields.iter().for_each(|field| {
                assert!(
                    has(&format!("{}.{}", effect.name, field.name)),
                    "{}",
                    field.name
                )
            });
        }
        for axis in AXES {
            axis.choices.iter().for_each(|option| {
                assert!(
                    has(&format!("accuracy.{} = {option}", axis.name)),
                    "{option}"
                )
            });
        }
        let opens = |entry: &&Entry| matches!(entry.choice, Choice::Open(_));
        assert_eq!(
            all.iter().filter(opens).count(),
            gallery(&Folders::default()).len()
        );
    }

    #[test]
    fn a_rival_of_the_stack_is_offered_instead_and_its_parameters_say_why_not() {
        let all = all();
        let find = |text: &str| {
            all.iter()
                .find(|entry| entry.text == text)
                .expect("an entry")
                .choice
                .clone()
        };
        let overdraw = Effect::find("overdraw").expect("a built-in effect");
        assert_eq!(
            find("Enable overdraw"),
            Choice::Replace("xray".into(), overdraw.clone())
        );
        assert!(
            matches!(find("overdraw.max_layers"), Choice::Refuse(reason) if reason.contains("slot of the rasterizer"))
        );
        let facet = Effect::find("facet").expect("a built-in effect");
        assert_eq!(
            find("facet.amount"),
            Choice::Offer(facet.clone()),
            "to find a parameter switches nothing on"
        );
    }
}
