//! Promise: the parts that an effect changes are chosen in the inspector, from a list or by a click
//! on the model; every choice is a step of undo, and a part that the scene does not have is said.

use egui::{self, Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;

use crate::harness::*;

const PRESET: &str = "schema = 2\n[scene]\nbuiltin = \"cube-wall\"\n[camera]\neye = [0.0, 0.0, 12.0]\ntarget = [0.0, 0.0, 0.0]\n[effects.lambert]\n[effects.toon]\n[effects.outline]\n";

fn on(lab: &Lab, effect: &str) -> String {
    lab.state()
        .preset_file()
        .preset
        .stack
        .get(effect)
        .unwrap_or_else(|| panic!("{effect} is off"))
        .on
        .to_string()
}

#[test]
fn boxes_of_the_picker_set_the_scope_and_undo_takes_each_back() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), PRESET) else {
        return;
    };
    let everywhere = middle(&mut lab);
    assert!(
        lab.query_by_label("Parts of outline").is_none(),
        "an effect on pixels has no parts"
    );
    click(&mut lab, Role::Button, "Parts of toon");
    click(&mut lab, Role::CheckBox, "material:coral");
    assert_eq!(on(&lab, "toon"), "material:coral");
    click(&mut lab, Role::CheckBox, "material:teal");
    assert_eq!(on(&lab, "toon"), "material:coral, material:teal");
    assert_eq!(on(&lab, "lambert"), "whole scene");
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert_ne!(middle(&mut lab), everywhere);
    assert_eq!((lab.state().undo_steps(), error_lines(&lab)), (2, vec![]));
    undo(&mut lab);
    assert_eq!(on(&lab, "toon"), "material:coral");
    undo(&mut lab);
    assert_eq!(on(&lab, "toon"), "whole scene");
    assert_eq!(middle(&mut lab), everywhere);
}

#[test]
fn the_search_finds_parts_and_takes_patterns() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), PRESET) else {
        return;
    };
    click(&mut lab, Role::Button, "Parts of toon");
    click(&mut lab, Role::TextInput, "Search parts for toon");
    type_text(&mut lab, "ink");
    assert!(
        lab.query_by_role_and_label(Role::CheckBox, "material:coral")
            .is_none()
    );
    click(&mut lab, Role::CheckBox, "material:ink");
    click(&mut lab, Role::TextInput, "Search parts for toon");
    lab.key_press_modifiers(Modifiers::COMMAND, Key::A);
    lab.run_steps(2);
    type_text(&mut lab, "node:cube 1?");
    click(&mut lab, Role::Button, "Add node:cube 1?");
    assert_eq!(on(&lab, "toon"), "material:ink, node:cube 1?");
    // A pattern that is not the name of a part has a box of its own.
    click(&mut lab, Role::CheckBox, "node:cube 1?");
    assert_eq!(on(&lab, "toon"), "material:ink");
    click(&mut lab, Role::Button, "Whole scene");
    assert_eq!(on(&lab, "toon"), "whole scene");
    assert_eq!(error_lines(&lab), Vec::<String>::new());
}

#[test]
fn a_click_on_the_model_adds_the_part_under_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), PRESET) else {
        return;
    };
    for (kind, is_right) in [
        ("material", "material:"),
        ("node", "node:cube "),
        ("mesh", "mesh:cube"),
    ] {
        click(&mut lab, Role::Button, "Parts of toon");
        click(&mut lab, Role::Button, &format!("Pick a {kind} for toon"));
        // The center itself lies between four cubes.
        let center = lab.get_by_label("Picture").rect().center() + egui::vec2(24.0, 24.0);
        lab.hover_at(center);
        lab.run_steps(2);
        lab.drag_at(center);
        lab.run_steps(2);
        lab.drop_at(center);
        lab.run_steps(3);
        settle(&mut lab);
        assert!(
            on(&lab, "toon")
                .split(", ")
                .last()
                .expect("a pattern")
                .starts_with(is_right),
            "{kind}: {}",
            on(&lab, "toon")
        );
    }
    assert_eq!(
        lab.state()
            .preset_file()
            .preset
            .stack
            .get("toon")
            .expect("it is on")
            .on
            .patterns()
            .len(),
        3
    );
    // Nothing more is picked.
    undo(&mut lab);
    undo(&mut lab);
    undo(&mut lab);
    assert_eq!(on(&lab, "toon"), "whole scene");
}

#[test]
fn a_part_that_the_scene_does_not_have_is_said() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = PRESET.replace(
        "[effects.toon]\n",
        "[effects.toon]\non = \"material:corral\"\n",
    );
    let Some(lab) = lab_of(folder.path(), &text) else {
        return;
    };
    let said = |lab: &Lab, text: &str| lab.query_all_by_label_contains(text).count() > 0;
    assert!(
        said(&lab, "the scene has no material that matches \"corral\"")
            && said(&lab, "did you mean \"coral\"?")
    );
    assert_eq!(on(&lab, "toon"), "material:corral");
}
