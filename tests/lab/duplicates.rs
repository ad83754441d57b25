//! Promise: a built-in effect becomes a file of one's own from the inspector. The stack uses it in
//! the same place with the same values and keyframes, undo takes that back, and what cannot be
//! duplicated says why.

use std::path::Path;

use egui::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};

use crate::harness::*;

const PRESET: &str = "schema = 2\n[scene]\nbuiltin = \"teapot\"\n[effects.lambert]\n[effects.toon]\nsteps = 5\n[effects.outline]\n[effects.stipple]\n\
    [animation.toon]\nrim_width = [{ time_s = 0.0, value = 0.25 }, { time_s = 1.0, value = 0.5 }]\n";

fn open_menu(lab: &mut Lab, effect: &str) {
    click(lab, Role::Button, &format!("More of {effect}"));
}

fn names(lab: &Lab) -> Vec<String> {
    lab.state()
        .preset_file()
        .preset
        .stack
        .0
        .iter()
        .map(|enabled| enabled.effect.name.clone())
        .collect()
}

fn written(folder: &Path) -> Vec<String> {
    let files = std::fs::read_dir(folder.join("effects"))
        .into_iter()
        .flatten()
        .flatten();
    files
        .map(|file| file.file_name().to_string_lossy().into_owned())
        .collect()
}

#[test]
fn a_duplicate_takes_the_place_of_its_original_and_undo_brings_that_back() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), PRESET) else {
        return;
    };
    let before = middle(&mut lab);
    let stack = names(&lab);
    open_menu(&mut lab, "toon");
    click(&mut lab, Role::Button, "Duplicate as my own…");
    // The suggested name is selected, so that typing replaces it.
    type_text(&mut lab, "cel");
    click(&mut lab, Role::Button, "Duplicate");
    wait_for(&mut lab, "the duplicate is used", |lab| {
        names(lab).iter().any(|name| name == "cel")
    });
    assert_eq!(written(folder.path()), ["cel.wgsl"]);
    let expected: Vec<&str> = stack
        .iter()
        .map(|name| if *name == "toon" { "cel" } else { name })
        .collect();
    assert_eq!(names(&lab), expected);
    assert_eq!(value(&lab, "cel", "steps"), [5.0]);
    assert_eq!(key_times(&lab, "cel", "rim_width"), [0.0, 1.0]);
    // Its text stands beside the picture, which is smaller meanwhile.
    wait_for(&mut lab, "its text is shown", |lab| {
        lab.query_by_label("Close the text").is_some()
    });
    click(&mut lab, Role::Button, "Close the text");
    settle(&mut lab);
    let after = middle(&mut lab);
    let largest = before
        .pixels()
        .zip(after.pixels())
        .flat_map(|(a, b)| a.0.map(i16::from).into_iter().zip(b.0.map(i16::from)));
    let largest = largest.map(|(a, b)| (a - b).abs()).max().expect("pixels");
    assert!(
        largest <= 1,
        "the picture of the duplicate differs by {largest} of 255"
    );
    assert_eq!((lab.state().undo_steps(), error_lines(&lab)), (1, vec![]));
    undo(&mut lab);
    assert_eq!(
        (names(&lab), value(&lab, "toon", "steps")),
        (stack, vec![5.0])
    );
    assert_eq!(key_times(&lab, "toon", "rim_width"), [0.0, 1.0]);
    assert_eq!(written(folder.path()), ["cel.wgsl"], "undo leaves the file");

    // The next suggestion is free, and a name that is taken is refused in the dialog.
    open_menu(&mut lab, "toon");
    click(&mut lab, Role::Button, "Duplicate as my own…");
    assert_eq!(
        lab.get_by_role_and_label(Role::TextInput, "Name")
            .value()
            .as_deref(),
        Some("my_toon")
    );
    type_text(&mut lab, "cel");
    click(&mut lab, Role::Button, "Duplicate");
    assert!(
        lab.query_by_label("There is an effect cel already.")
            .is_some()
    );
    assert_eq!(written(folder.path()), ["cel.wgsl"]);
}

#[test]
fn an_effect_that_cannot_be_duplicated_says_why() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(
        folder.path(),
        "schema = 2\n[scene]\nbuiltin = \"teapot\"\n[effects.xray]\n",
    ) else {
        return;
    };
    open_menu(&mut lab, "xray");
    let entry = lab.get_by_role_and_label(Role::Button, "Duplicate as my own…");
    assert!(entry.accesskit_node().is_disabled());
    entry.hover();
    let is_said = |lab: &Lab| {
        lab.query_all_by_label_contains("xray replaces a part of the rasterizer")
            .next()
            .is_some()
    };
    lab.run_steps(60);
    assert!(is_said(&lab), "the reason is not shown");
    assert_eq!(written(folder.path()), [""; 0]);
}
