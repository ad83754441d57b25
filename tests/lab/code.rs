//! Promise: the text of an effect of one's own is edited beside the picture: it is compiled as it
//! is typed, its faults are told at their line, and the file changes only when it is saved.

use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;
use rasterlab::preset_file::Folders;

use crate::{
    harness::*,
    live::{INK, write},
};

const PRESET: &str = "schema = 2\n[scene]\nbuiltin = \"teapot\"\n[effects.ink]\n";

fn says(lab: &Lab, text: &str) -> bool {
    lab.query_all_by_label_contains(text).next().is_some()
}

/// Types at the end of the text, which has the focus.
fn type_text(lab: &mut Lab, text: &str) {
    lab.get_by_label("Text of ink").focus();
    lab.step();
    press(lab, Modifiers::COMMAND, Key::End);
    lab.get_by_label("Text of ink").type_text(text);
    lab.step();
}

#[test]
fn what_is_typed_is_seen_and_saved_on_demand() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("effects/ink.wgsl");
    write(&file, INK);
    let Some(mut lab) = lab_of(folder.path(), PRESET) else {
        return;
    };
    click(&mut lab, Role::Button, "More of ink");
    click(&mut lab, Role::Button, "Edit the text");
    wait_for(&mut lab, "the text is shown", |lab| says(lab, "ink.wgsl"));

    type_text(&mut lab, "fn late() -> f32 { return q; }\n");
    wait_for(&mut lab, "the fault is told", |lab| says(lab, "line 14: "));
    assert_eq!(std::fs::read_to_string(&file).expect("the file"), INK);

    for _ in 0.."q; }\n".len() {
        press(&mut lab, Modifiers::NONE, Key::Backspace);
    }
    type_text(&mut lab, "1.0; }\n");
    wait_for(&mut lab, "the text is sound", |lab| !says(lab, "line 14: "));
    wait_for(&mut lab, "it is compiled", |lab| {
        lab.state().log_text().contains("ink was reloaded")
    });
    assert_eq!(std::fs::read_to_string(&file).expect("the file"), INK);

    // Closing asks, since the text is not saved.
    click(&mut lab, Role::Button, "Close the text");
    click(&mut lab, Role::Button, "Discard them");
    lab.step();
    assert!(!says(&lab, "Close the text"));
    click(&mut lab, Role::Button, "More of ink");
    click(&mut lab, Role::Button, "Edit the text");
    wait_for(&mut lab, "the text is shown", |lab| says(lab, "ink.wgsl"));
    type_text(&mut lab, "fn late() -> f32 { return 1.0; }\n");
    click(&mut lab, Role::Button, "Close the text");
    assert!(says(&lab, "ink.wgsl has changes that are not saved."));
    click(&mut lab, Role::Button, "Save them");
    let typed = format!("{INK}fn late() -> f32 {{ return 1.0; }}\n");
    wait_for(&mut lab, "the file is written", |_| {
        std::fs::read_to_string(&file).is_ok_and(|text| text == typed)
    });

    click(&mut lab, Role::Button, "Close the text");
    assert!(!says(&lab, "Close the text"));
}

#[test]
fn in_a_small_window_the_text_takes_the_place_of_the_presets() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write(&folder.path().join("effects/ink.wgsl"), INK);
    let path = folder.path().join("mine.toml");
    write(&path, PRESET);
    let size = [900.0, 600.0];
    let Some(mut lab) = created(
        Some(&path.to_string_lossy()),
        Folders::default(),
        None,
        size,
    ) else {
        return;
    };
    settle(&mut lab);
    click(&mut lab, Role::Button, "More of ink");
    click(&mut lab, Role::Button, "Edit the text");
    wait_for(&mut lab, "the text is shown", |lab| says(lab, "ink.wgsl"));
    let picture = lab.get_by_label("Picture").rect();
    let menu = lab
        .get_by_role_and_label(Role::Button, "More of ink")
        .rect();
    assert!(
        picture.width() > 180.0 && picture.right() < menu.left() && menu.right() < size[0],
        "{picture} {menu}"
    );
    assert!(!says(&lab, "Preset "));
    click(&mut lab, Role::Button, "Close the text");
    lab.run_steps(4);
    assert!(says(&lab, "Preset "));
}
