//! Promise: the code that a preset brings runs in the window only after the user has allowed it.
//! Until then scene and picture stay.

use egui::Role;
use egui_kittest::kittest::Queryable as _;
use rasterlab::preset_file::{self, PresetFile};

use crate::{
    harness::*,
    live::{INK, write},
};

/// A preset that uses an effect of a file.
fn inked(folder: &std::path::Path) -> PresetFile {
    write(&folder.join("effects/ink.wgsl"), INK);
    write(
        &folder.join("mine.toml"),
        "schema = 2\nname = \"Mine\"\n[scene]\nbuiltin = \"knot\"\n[effects.lambert]\n[effects.ink]\n",
    );
    preset_file::load(&folder.join("mine.toml")).expect("a preset")
}

fn has_ink(lab: &Lab) -> bool {
    lab.state().preset_file().preset.stack.get("ink").is_some()
}

fn is_asked(lab: &Lab) -> bool {
    lab.query_by_label("Mine brings code").is_some()
}

#[test]
fn the_code_of_a_pasted_preset_runs_only_when_it_is_allowed() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let line = preset_file::to_line(&inked(folder.path()));
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let (before, draws) = (picture(&mut lab), lab.state().draws());
    paste(&mut lab, &line);
    assert!(is_asked(&lab), "{}", lab.state().log_text());
    let size = format!(
        "ink: {} lines, {} bytes, surface",
        INK.lines().count(),
        INK.len()
    );
    assert!(
        lab.query_by_label(&size).is_some(),
        "the effect is not listed as {size}"
    );
    assert_eq!(
        (lab.state().preset_file().id.as_str(), lab.state().draws()),
        ("lambert", draws)
    );

    click(&mut lab, Role::Button, "Cancel");
    assert_eq!(
        (
            lab.state().preset_file().id.as_str(),
            lab.state().undo_steps()
        ),
        ("lambert", 0)
    );
    assert!(before == picture(&mut lab), "the picture has changed");

    paste(&mut lab, &line);
    click(&mut lab, Role::Button, "Open without these effects");
    assert_eq!(lab.state().preset_file().title(), "Mine");
    assert!(
        !has_ink(&lab)
            && lab
                .state()
                .preset_file()
                .preset
                .stack
                .get("lambert")
                .is_some()
    );
    assert!(
        lab.query_by_role_and_label(Role::CheckBox, "ink").is_none(),
        "the effect can still be switched on"
    );
    assert!(
        !preset_file::to_toml(lab.state().preset_file()).contains("ink"),
        "{}",
        preset_file::to_toml(lab.state().preset_file())
    );

    paste(&mut lab, &line);
    click(&mut lab, Role::Button, "Run this code");
    assert!(has_ink(&lab));
    let seen = middle(&mut lab);
    assert!(
        seen.pixels()
            .any(|pixel| pixel.0[0] > 250 && pixel.0[1] < 5),
        "the effect does not show"
    );

    // What was allowed once is not asked again.
    undo(&mut lab);
    paste(&mut lab, &line);
    assert!(!is_asked(&lab) && has_ink(&lab));
    assert_eq!(error_lines(&lab), [""; 0]);
}

#[test]
fn a_picture_that_the_window_is_opened_with_is_asked_about() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let preset = inked(folder.path());
    let frame = rasterlab::frame::Frame {
        width: 1,
        height: 1,
        color: vec![[9; 4]],
        ..Default::default()
    };
    let png = preset_file::png_with_preset(&frame, &preset, &preset_file::Provenance::default())
        .expect("a picture");
    let path = folder.path().join("shot.png");
    std::fs::write(&path, png).expect("a file");
    let Some(mut lab) = lab(&path.to_string_lossy()) else {
        return;
    };
    assert!(is_asked(&lab) && !has_ink(&lab));
    assert_eq!(lab.state().preset_file().id, rasterlab::app::FIRST_PRESET);
    click(&mut lab, Role::Button, "Run this code");
    assert!(has_ink(&lab) && lab.state().preset_file().title() == "Mine");
}

#[test]
fn a_preset_whose_file_comes_to_bring_code_is_asked_about() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let shared = preset_file::to_shared_toml(&inked(folder.path()));
    let other = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(
        other.path(),
        "schema = 2\nname = \"Mine\"\n[scene]\nbuiltin = \"knot\"\n",
    ) else {
        return;
    };
    write(&other.path().join("mine.toml"), &shared);
    wait_for(&mut lab, "the question is asked", is_asked);
    assert!(!has_ink(&lab));
    click(&mut lab, Role::Button, "Open without these effects");
    assert!(
        !has_ink(&lab)
            && lab
                .state()
                .preset_file()
                .preset
                .stack
                .get("lambert")
                .is_some()
    );
}
