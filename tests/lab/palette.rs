//! Promise: Ctrl+K opens a search over actions, effects, parameters, values, presets and accuracy
//! options; Enter carries out what is selected, Escape nothing, and no key that is typed there is a
//! shortcut.

use egui::{Event, Key, Modifiers, Role};
use egui_kittest::{
    Node,
    kittest::{NodeT as _, Queryable as _},
};
use rasterlab::preset_file::Folders;

use crate::harness::*;

const SEARCH: &str = "Search commands";

fn is_open(lab: &Lab) -> bool {
    lab.query_by_role_and_label(Role::TextInput, SEARCH)
        .is_some()
}

/// Opens the palette and types `text`.
fn search(lab: &mut Lab, text: &str) {
    press(lab, Modifiers::COMMAND, Key::K);
    assert!(is_open(lab));
    typing(lab, text);
}

fn typing(lab: &mut Lab, text: &str) {
    lab.event(Event::Text(text.into()));
    lab.run_steps(3);
}

fn key(lab: &mut Lab, key: Key) {
    press(lab, Modifiers::NONE, key);
}

/// The rows of the list, which are higher than buttons.
fn rows(lab: &Lab) -> impl Iterator<Item = Node<'_>> {
    lab.query_all_by_role(Role::Button)
        .filter(|node| (node.rect().height() - 28.0).abs() < 0.5)
}

/// The entry that Enter would carry out.
fn selected(lab: &Lab) -> String {
    let nodes: Vec<String> = rows(lab)
        .filter(is_on)
        .filter_map(|node| node.accesskit_node().label())
        .collect();
    assert_eq!(nodes.len(), 1, "{nodes:?}");
    nodes.concat()
}

#[test]
fn typed_letters_search_and_are_never_shortcuts() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    let before = lab.state().preset_file().preset.clone();
    // The key and the letters in one frame, as a fast typist on a slow machine has it: R would
    // randomize, V verify, O show overlays.
    let pressed = |key, modifiers| Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    };
    let letters = [Key::O, Key::V, Key::E, Key::R]
        .into_iter()
        .zip(["o", "v", "e", "r"]);
    let typed =
        letters.flat_map(|(key, text)| [pressed(key, Modifiers::NONE), Event::Text(text.into())]);
    lab.input_mut().events.extend(
        [pressed(Key::K, Modifiers::COMMAND)]
            .into_iter()
            .chain(typed),
    );
    lab.run_steps(6);
    settle(&mut lab);
    let field = lab
        .get_by_role_and_label(Role::TextInput, SEARCH)
        .accesskit_node()
        .value();
    assert_eq!(field.as_deref(), Some("over"));
    let found: Vec<_> = rows(&lab)
        .filter_map(|node| node.accesskit_node().label())
        .collect();
    let is_found = |label: &str| found.iter().any(|found| found == label);
    assert!(
        is_found("Show or hide overlays") && !is_found("Show or hide the log"),
        "{found:?}"
    );
    for key in [Key::Delete, Key::Space, Key::F11, Key::OpenBracket] {
        press(&mut lab, Modifiers::NONE, key);
    }
    assert_eq!(
        (&lab.state().preset_file().preset, lab.state().undo_steps()),
        (&before, 0),
        "a key reached a shortcut"
    );
    assert!(
        !lab.state().log_text().contains("seed"),
        "{}",
        lab.state().log_text()
    );
    key(&mut lab, Key::Escape);
    assert!(!is_open(&lab) && lab.state().preset_file().preset == before);
}

#[test]
fn arrows_select_and_enter_carries_out_actions_and_effects() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    search(&mut lab, "front view");
    assert_eq!(selected(&lab), "Front view, then back");
    let camera = lab.state().preset_file().preset.camera;
    key(&mut lab, Key::Enter);
    assert!(
        !is_open(&lab) && lab.state().preset_file().preset.camera != camera,
        "the view did not change"
    );
    undo(&mut lab);

    search(&mut lab, "enable toon");
    key(&mut lab, Key::Enter);
    assert!(has_slider(&lab, "toon.softness"));
    undo(&mut lab);
    assert!(!has_slider(&lab, "toon.softness"), "one step");

    search(&mut lab, "view");
    let first = selected(&lab);
    key(&mut lab, Key::ArrowDown);
    let second = selected(&lab);
    assert_ne!(first, second);
    key(&mut lab, Key::ArrowUp);
    assert_eq!(selected(&lab), first);
    key(&mut lab, Key::ArrowUp);
    assert_ne!(selected(&lab), first, "before the first comes the last");
    key(&mut lab, Key::Escape);

    // What was used last is listed first.
    press(&mut lab, Modifiers::COMMAND, Key::K);
    assert_eq!(selected(&lab), "Enable toon");
    press(&mut lab, Modifiers::COMMAND, Key::K);
    assert!(!is_open(&lab), "the key that opens it closes it");
}

#[test]
fn the_palette_names_and_obeys_the_keys_of_the_user_and_closes_before_panels() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(
        folder.path().join("settings.toml"),
        "[keys]\nrandomize = [\"J\"]\npalette = [\"Ctrl+P\"]\n",
    )
    .expect("a file");
    let Some(mut lab) = created(
        Some("facet-knot"),
        Folders::default(),
        Some(folder.path().to_owned()),
        SIZE,
    ) else {
        return;
    };
    settle(&mut lab);
    press(&mut lab, Modifiers::NONE, Key::L); // The log.
    press(&mut lab, Modifiers::COMMAND, Key::K);
    assert!(!is_open(&lab), "the key is bound to nothing");
    press(&mut lab, Modifiers::COMMAND, Key::P);
    typing(&mut lab, "randomize effects");
    assert_eq!(selected(&lab), "Randomize effects");
    let row = lab
        .get_by_role_and_label(Role::Button, "Randomize effects")
        .accesskit_node();
    assert_eq!(row.data().keyboard_shortcut(), Some("J"));
    press(&mut lab, Modifiers::COMMAND, Key::P);
    assert!(!is_open(&lab), "the key that opens it closes it");

    press(&mut lab, Modifiers::COMMAND, Key::P);
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(
        !is_open(&lab) && lab.query_by_label("Clear the log").is_some(),
        "Escape closed the palette alone"
    );
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(lab.query_by_label("Clear the log").is_none());
}

#[test]
fn a_value_behind_a_path_is_set_as_one_step_and_a_wrong_one_is_refused_in_words() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    let before = value(&lab, "facet", "amount");
    search(&mut lab, "facet.amount 0.5");
    assert_eq!(selected(&lab), "Set facet.amount to 0.5");
    key(&mut lab, Key::Enter);
    assert_eq!(
        (value(&lab, "facet", "amount"), lab.state().undo_steps()),
        (vec![0.5], 1)
    );
    undo(&mut lab);
    assert_eq!(value(&lab, "facet", "amount"), before);

    search(&mut lab, "facet.amount 7");
    key(&mut lab, Key::Enter);
    assert_eq!(value(&lab, "facet", "amount"), before);
    assert!(
        lab.state()
            .log_text()
            .contains("facet.amount takes 0 to 1, not 7"),
        "{}",
        lab.state().log_text()
    );

    search(&mut lab, "depth = log16");
    assert_eq!(selected(&lab), "accuracy.depth = log16");
    key(&mut lab, Key::Enter);
    assert_eq!(
        lab.state().preset_file().preset.accuracy.pins.words(),
        "depth=log16"
    );
}

#[test]
fn a_path_leads_to_its_row_which_has_the_focus() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    assert!(
        lab.query_by_label("clock.speed value").is_none(),
        "the folder is closed"
    );
    search(&mut lab, "clock.speed");
    assert_eq!(selected(&lab), "clock.speed");
    key(&mut lab, Key::Enter);
    let row = lab.get_by_label("clock.speed value");
    assert!(row.is_focused(), "the number has the focus");
    let inspector = lab.get_by_label("Picture").rect().right()..1280.0;
    assert!(
        inspector.contains(&row.rect().center().x)
            && (60.0..700.0).contains(&row.rect().center().y),
        "{:?}",
        row.rect()
    );

    // A parameter of an effect that is not in the stack leads to where that can be added.
    search(&mut lab, "toon.softness");
    key(&mut lab, Key::Enter);
    assert!(!has_slider(&lab, "toon.softness") && lab.state().undo_steps() == 0);
    assert!(
        lab.query_by_role_and_label(Role::Button, "Effect toon")
            .is_some()
    );
    key(&mut lab, Key::Enter);
    assert!(has_slider(&lab, "toon.softness"));
    // A folded effect unfolds.
    click(&mut lab, Role::Button, "Fold facet");
    search(&mut lab, "facet.amount");
    key(&mut lab, Key::Enter);
    assert!(lab.get_by_label("facet.amount value").is_focused());
}

#[test]
fn presets_and_scenes_open() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    search(&mut lab, "open hatch");
    assert!(
        selected(&lab).ends_with("(hatch)") || selected(&lab) == "Open hatch",
        "{}",
        selected(&lab)
    );
    key(&mut lab, Key::Enter);
    assert_eq!(lab.state().preset_file().id, "hatch");
    undo(&mut lab);
    assert_eq!(lab.state().preset_file().id, "facet-knot");
    search(&mut lab, "scene sphere");
    let row = lab.get_by_role_and_label(Role::Button, "Scene sphere");
    row.click();
    lab.run_steps(4);
    settle(&mut lab);
    assert!(!is_open(&lab));
    assert_eq!(
        lab.state().preset_file().preset.scene,
        rasterlab::preset::SceneSource::Builtin("sphere".into())
    );
}

#[test]
fn the_exact_name_of_an_effect_or_theme_comes_first_and_switches_nothing() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    for (typed, first) in [
        ("facet", "Show facet"),
        ("toon", "Enable toon"),
        ("dark", "Theme: Dark"),
        ("facet-knot", "Open Cut knot (facet-knot)"),
        ("aa 2×2", "AA 2×2"),
    ] {
        search(&mut lab, typed);
        assert_eq!(selected(&lab), first, "{typed}");
        key(&mut lab, Key::Escape);
    }
    search(&mut lab, "facet");
    key(&mut lab, Key::Enter);
    assert!(has_slider(&lab, "facet.amount") && lab.state().undo_steps() == 0);
}

/// Labels of buttons, without what stands for a key or for more to come.
fn plain(label: &str) -> String {
    let label = label.split(" (").next().unwrap_or(label);
    label.trim_end_matches('…').trim().to_lowercase()
}

#[test]
fn every_button_and_menu_entry_is_in_the_palette() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    let buttons = |lab: &Lab| -> Vec<String> {
        lab.query_all_by_role(Role::Button)
            .filter_map(|node| node.accesskit_node().label())
            .collect()
    };
    let mut labels = buttons(&lab);
    for menu in ["File", "Edit", "Time", "View", "Judge", "Help"] {
        lab.get_by_role_and_label(Role::Button, menu).click();
        lab.run_steps(4);
        labels.extend(buttons(&lab));
        press(&mut lab, Modifiers::NONE, Key::Escape);
    }
    // What belongs to one thing among many is found by the name of that thing.
    let of_one = [
        "preset ",
        "effect ",
        "reset ",
        "key ",
        "fold ",
        "mute ",
        "apply ",
        "f32 error: ",
        "drag ",
        "more of ",
        "keys of ",
        "tag ",
        "scene ",
        "animate ",
        "parts of ",
        "more tags",
        "command palette",
    ];
    // What opens a list whose entries are there, or leads to a place.
    let leads = [
        "file",
        "edit",
        "time",
        "view",
        "judge",
        "help",
        "open recent",
        "theme and size",
        "presets",
        "effects",
        "scene",
        "anti-aliasing",
    ];
    labels.sort();
    labels.dedup();
    let wanted: Vec<String> = labels
        .iter()
        .map(|label| plain(label))
        .filter(|label| !label.is_empty())
        .filter(|label| !leads.contains(&label.as_str()) && !label.starts_with("go to "))
        .filter(|label| !of_one.iter().any(|of| label.starts_with(of)))
        .collect();
    assert!(wanted.len() > 30, "{wanted:?}");
    let mut missing = Vec::new();
    for label in wanted {
        search(&mut lab, &label);
        let is_there = rows(&lab)
            .filter_map(|node| node.accesskit_node().label())
            .any(|found| label.split(' ').all(|word| plain(&found).contains(word)));
        if !is_there {
            missing.push(label);
        }
        key(&mut lab, Key::Escape);
    }
    assert!(missing.is_empty(), "{missing:#?}");
}
