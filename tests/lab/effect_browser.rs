//! Promise: effects are found in their groups with pictures on the open model, dragged to their
//! place in the stack, and their values are copied between presets and kept under names.

use std::path::Path;

use egui::{Event, Key, Modifiers, OutputCommand, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use rasterlab::preset_file::Folders;

use crate::harness::*;

/// A still preset whose effects have values of their own.
const DRAWN: &str = "schema = 2\nname = \"Drawn\"\n[scene]\nbuiltin = \"teapot?tess=4\"\n[effects.lambert]\n[effects.toon]\n\
    softness = 0.05\nshadow = 0.42\nlight = 0.98\n[effects.outline]\n";

fn own(folder: &Path, open: &str) -> Option<Lab> {
    std::fs::create_dir_all(folder.join("presets")).expect("a folder");
    std::fs::write(folder.join("presets/drawn.toml"), DRAWN).expect("a file");
    lab_with(
        open,
        Folders {
            user: Some(folder.to_owned()),
            ..Folders::default()
        },
    )
}

/// Names of the effects of the stack.
fn stack(lab: &Lab) -> Vec<String> {
    lab.state()
        .preset_file()
        .preset
        .stack
        .0
        .iter()
        .map(|enabled| enabled.effect.name.clone())
        .collect()
}

/// The effects that the browser lists.
fn listed(lab: &Lab) -> Vec<String> {
    let labels = lab
        .query_all_by_role(Role::Button)
        .filter_map(|node| node.accesskit_node().label());
    labels
        .filter_map(|label| label.strip_prefix("Effect ").map(str::to_owned))
        .collect()
}

/// Chooses an entry of the menu of an enabled effect.
fn choose(lab: &mut Lab, effect: &str, entry: &str) {
    let menu = format!("More of {effect}");
    lab.get_by_role_and_label(Role::Button, &menu)
        .scroll_to_me();
    lab.run_steps(20);
    lab.get_by_role_and_label(Role::Button, &menu).click();
    lab.run_steps(4);
    lab.get_by_role_and_label(Role::Button, entry).click();
    lab.run_steps(4);
}

/// The text that was put on the clipboard in the newest frames.
fn copied(lab: &mut Lab, effect: &str) -> String {
    let menu = format!("More of {effect}");
    lab.get_by_role_and_label(Role::Button, &menu).click();
    lab.run_steps(4);
    lab.get_by_role_and_label(Role::Button, "Copy effect")
        .click();
    for _ in 0..6 {
        lab.step();
        for command in &lab.output().platform_output.commands {
            if let OutputCommand::CopyText(text) = command {
                return text.clone();
            }
        }
    }
    panic!("nothing was copied");
}

#[test]
fn effects_are_found_enabled_and_starred_in_the_browser() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = own(folder.path(), "builtin:teapot?tess=4") else {
        return;
    };
    click(&mut lab, Role::Button, "Effects");
    let all = listed(&lab).len();
    assert!(all >= 27, "{all}");
    for group in [
        "Surface", "Vertex", "Sample", "Layers", "Lines", "Image", "Inspect",
    ] {
        assert!(lab.query_by_label(group).is_some(), "{group}");
    }
    let field = lab.get_by_role_and_label(Role::TextInput, "Search effects");
    field.click();
    lab.run_steps(2);
    lab.event(Event::Text("hatching".into()));
    lab.run_steps(3);
    settle(&mut lab);
    assert_eq!(listed(&lab), ["hatch"], "by a word of its description");
    click(&mut lab, Role::Button, "Effect hatch");
    assert!(stack(&lab).iter().any(|name| name == "hatch") && lab.state().undo_steps() == 1);
    click(&mut lab, Role::Button, "Effect hatch");
    assert!(
        !stack(&lab).iter().any(|name| name == "hatch"),
        "a second click takes it out"
    );
    click(&mut lab, Role::CheckBox, "Favorite effect hatch");
    click(&mut lab, Role::Button, "Clear: Search effects");
    click(&mut lab, Role::CheckBox, "Favorite effects only");
    assert_eq!(listed(&lab), ["hatch"]);
    click(&mut lab, Role::CheckBox, "Favorite effects only");
    assert_eq!(
        std::fs::read_to_string(folder.path().join("favorites.toml")).expect("a file"),
        "effects = [\"hatch\"]\n"
    );

    // Of two effects of one slot the chosen one replaces the other, as one step.
    click(&mut lab, Role::Button, "Effect xray");
    click(&mut lab, Role::Button, "Effect overdraw");
    assert!(
        stack(&lab).iter().any(|name| name == "overdraw")
            && !stack(&lab).iter().any(|name| name == "xray")
    );
    undo(&mut lab);
    assert!(
        stack(&lab).iter().any(|name| name == "xray")
            && !stack(&lab).iter().any(|name| name == "overdraw")
    );
}

#[test]
fn pictures_show_the_open_model_and_closing_the_browser_gives_up_the_rest() {
    draw_pictures();
    let Some(mut lab) = lab("builtin:teapot?tess=4") else {
        return;
    };
    let tile = |lab: &mut Lab| {
        let rect = lab
            .get_by_role_and_label(Role::Button, "Effect lambert")
            .rect();
        let window = lab.screenshot();
        let [x, y, w, h] = [
            rect.min.x + 4.0,
            rect.min.y + 4.0,
            rect.width() - 8.0,
            rect.height() - 26.0,
        ]
        .map(|v| v.round() as u32);
        image::imageops::crop_imm(&window, x, y, w, h).to_image()
    };
    click(&mut lab, Role::Button, "Effects");
    lab.remove_cursor();
    lab.run_steps(2);
    let teapot = tile(&mut lab);
    let colors: std::collections::HashSet<_> = teapot.pixels().map(|pixel| pixel.0).collect();
    assert!(
        colors.len() > 20,
        "a picture, not a plain tile: {} colors",
        colors.len()
    );
    lab.state_mut().preset_mut().scene =
        rasterlab::preset::SceneSource::Builtin("sphere?triangles=400".into());
    settle(&mut lab);
    lab.run_steps(2);
    assert!(tile(&mut lab) != teapot, "the picture follows the scene");

    // What is not drawn yet is given up: the window is at rest at once.
    lab.state_mut().preset_mut().scene =
        rasterlab::preset::SceneSource::Builtin("knot?tess=6".into());
    while lab.state().is_idle() {
        lab.step();
    }
    lab.get_by_role_and_label(Role::Button, "Scene").click();
    lab.run_steps(3);
    settle(&mut lab);
    assert_eq!(error_lines(&lab), Vec::<String>::new());
}

#[test]
fn effects_are_dragged_to_their_place_in_the_stack() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = own(folder.path(), "drawn") else {
        return;
    };
    assert_eq!(stack(&lab), ["lambert", "toon", "outline"]);
    for effect in ["lambert", "toon", "outline"] {
        let fold = format!("Fold {effect}");
        click(&mut lab, Role::Button, &fold);
    }
    let at = |lab: &Lab, name: &str| {
        lab.get_by_role_and_label(Role::Button, name)
            .rect()
            .center()
    };
    let (from, to) = (
        at(&lab, "Drag toon"),
        at(&lab, "Drag lambert") - egui::vec2(0.0, 10.0),
    );
    drag(&mut lab, from, to);
    assert_eq!(
        (stack(&lab), lab.state().undo_steps()),
        (["toon", "lambert", "outline"].map(String::from).to_vec(), 1)
    );
    let (from, to) = (
        at(&lab, "Drag toon"),
        at(&lab, "Drag outline") + egui::vec2(0.0, 14.0),
    );
    drag(&mut lab, from, to);
    assert_eq!(stack(&lab), ["lambert", "outline", "toon"]);
    undo(&mut lab);
    undo(&mut lab);
    assert_eq!(stack(&lab), ["lambert", "toon", "outline"]);
    // Dropped beside the stack, nothing moves.
    let (from, view) = (
        at(&lab, "Drag toon"),
        lab.get_by_label("Picture").rect().center(),
    );
    drag(&mut lab, from, view);
    assert_eq!(stack(&lab), ["lambert", "toon", "outline"]);

    click(&mut lab, Role::Button, "Effects");
    let (from, to) = (
        at(&lab, "Effect facet"),
        at(&lab, "Drag outline") - egui::vec2(0.0, 10.0),
    );
    drag(&mut lab, from, to);
    assert_eq!(
        stack(&lab),
        ["lambert", "toon", "facet", "outline"],
        "from the browser to its place"
    );
    assert_eq!(error_lines(&lab), Vec::<String>::new());
}

#[test]
fn an_effect_is_copied_with_its_values_into_another_preset() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = own(folder.path(), "drawn") else {
        return;
    };
    let values = [value(&lab, "toon", "steps"), value(&lab, "toon", "shadow")];
    let text = copied(&mut lab, "toon");
    assert!(
        text.starts_with("effects.toon = { softness = 0.05, shadow = 0.42")
            && text.lines().count() == 1,
        "{text}"
    );
    press(&mut lab, Modifiers::COMMAND, Key::K);
    lab.event(Event::Text("open cut knot".into()));
    lab.run_steps(3);
    press(&mut lab, Modifiers::NONE, Key::Enter);
    assert!(!stack(&lab).iter().any(|name| name == "toon"));
    let steps = lab.state().undo_steps();
    lab.event(Event::Paste(text));
    lab.run_steps(4);
    settle(&mut lab);
    assert_eq!(
        [value(&lab, "toon", "steps"), value(&lab, "toon", "shadow")],
        values
    );
    assert_eq!(lab.state().undo_steps(), steps + 1);
    lab.event(Event::Paste("effects.toon = { steps = 300 }".into()));
    lab.run_steps(4);
    settle(&mut lab);
    assert!(
        lab.state().log_text().contains("effects.toon.steps takes"),
        "{}",
        lab.state().log_text()
    );
    assert_eq!(value(&lab, "toon", "steps"), values[0]);
}

#[test]
fn values_are_saved_under_a_name_and_recalled_in_another_preset() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = own(folder.path(), "drawn") else {
        return;
    };
    choose(&mut lab, "toon", "Saved values");
    lab.get_by_role_and_label(Role::Button, "Save these values…")
        .click();
    lab.run_steps(6);
    lab.event(Event::Text("Three tones".into()));
    lab.run_steps(3);
    press(&mut lab, Modifiers::NONE, Key::Enter);
    let file = folder.path().join("effect-values/toon/three-tones.toml");
    assert!(
        std::fs::read_to_string(&file)
            .expect("a file")
            .contains("shadow = 0.42")
    );

    lab.state_mut()
        .preset_mut()
        .stack
        .get_mut("toon")
        .expect("it is enabled")
        .words = {
        let effect = rasterlab::effects::Effect::find("toon").expect("a built-in effect");
        effect.defaults.clone()
    };
    settle(&mut lab);
    assert_ne!(value(&lab, "toon", "shadow"), [f64::from(0.42f32)]);
    choose(&mut lab, "toon", "Saved values");
    lab.get_by_role_and_label(Role::Button, "Use Three tones for toon")
        .click();
    lab.run_steps(4);
    settle(&mut lab);
    assert_eq!(value(&lab, "toon", "shadow"), [f64::from(0.42f32)]);
    choose(&mut lab, "toon", "Saved values");
    lab.get_by_role_and_label(Role::Button, "Delete Three tones of toon")
        .click();
    lab.run_steps(4);
    settle(&mut lab);
    assert!(!file.exists());
    remove_from_trash(file.parent().expect("a folder"));
    assert_eq!(error_lines(&lab), Vec::<String>::new());
}
