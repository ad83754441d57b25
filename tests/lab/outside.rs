//! Promise: a picture and a copied line open on the machine that made them. A model outside of their
//! folder that the user has not opened is asked about once, by name.

use std::path::Path;

use egui::Role;
use egui_kittest::kittest::Queryable as _;
use rasterlab::{
    preset::SceneSource,
    preset_file::{self, PresetFile},
};

use crate::{
    files::{drop_files, tiny_glb},
    harness::*,
};

fn shows(lab: &Lab, model: &Path) -> bool {
    lab.state().preset_file().scene_source() == SceneSource::File(model.to_owned())
}

fn is_asked(lab: &Lab) -> bool {
    lab.query_by_label("Open its model too?").is_some()
}

/// A preset of the model in `models`, and a picture of it in another folder.
fn model_and_picture(folder: &Path) -> (PresetFile, std::path::PathBuf, std::path::PathBuf) {
    let (model, picture) = (
        folder.join("models/tri.glb"),
        folder.join("pictures/shot.png"),
    );
    for name in ["models", "pictures"] {
        std::fs::create_dir(folder.join(name)).expect("a folder");
    }
    std::fs::write(&model, tiny_glb()).expect("a file");
    let mut preset = PresetFile::of_scene("tri", SceneSource::File(model.clone()));
    preset_file::set(&mut preset, "toon", "").expect("an effect");
    let frame = rasterlab::frame::Frame {
        width: 1,
        height: 1,
        color: vec![[1, 2, 3, 255]],
        ..Default::default()
    };
    let png = preset_file::png_with_preset(
        &frame,
        &preset.for_picture(&picture),
        &preset_file::Provenance::default(),
    )
    .expect("a picture");
    std::fs::write(&picture, png).expect("a file");
    (preset, model, picture)
}

#[test]
fn a_model_elsewhere_is_asked_about_once_and_may_be_left_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let (preset, model, picture) = model_and_picture(folder.path());
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let before = lab.state().preset_file().preset.scene.clone();
    drop_files(&mut lab, &[&picture]);
    assert!(is_asked(&lab), "{}", lab.state().log_text());
    assert!(
        lab.query_by_label(&model.display().to_string()).is_some(),
        "the model is not named"
    );
    click(&mut lab, Role::Button, "Look only");
    let file = lab.state().preset_file();
    assert!(file.preset.stack.get("toon").is_some() && file.preset.scene == before);

    drop_files(&mut lab, &[&picture]);
    click(&mut lab, Role::Button, "Open");
    assert!(shows(&lab, &model), "{}", lab.state().log_text());
    // It is not asked about again, neither for the picture nor for a line.
    undo(&mut lab);
    drop_files(&mut lab, &[&picture]);
    assert!(!is_asked(&lab) && shows(&lab, &model));
    undo(&mut lab);
    paste(&mut lab, &preset_file::to_line(&preset));
    assert!(
        !is_asked(&lab) && shows(&lab, &model),
        "{}",
        lab.state().log_text()
    );
    assert!(error_lines(&lab).is_empty());
}

#[test]
fn what_the_user_has_opened_needs_no_answer_and_what_is_gone_gives_its_look() {
    let folder = tempfile::tempdir().expect("a folder");
    let (preset, model, picture) = model_and_picture(folder.path());
    let Some(mut lab) = lab(&model.to_string_lossy()) else {
        return;
    };
    drop_files(&mut lab, &[&picture]);
    assert!(!is_asked(&lab) && shows(&lab, &model));
    paste(&mut lab, &preset_file::to_line(&preset));
    assert!(!is_asked(&lab) && shows(&lab, &model));

    let gone = PresetFile::of_scene("gone", SceneSource::File(folder.path().join("gone.glb")));
    paste(&mut lab, &preset_file::to_line(&gone));
    assert!(is_asked(&lab));
    assert!(
        lab.query_by_role_and_label(Role::Button, "Open").is_none(),
        "a model that is not there cannot be opened"
    );
    click(&mut lab, Role::Button, "Look only");
    assert!(shows(&lab, &model) && error_lines(&lab).is_empty());
}

#[test]
fn orbiting_is_no_unsaved_change() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let view = lab.get_by_label("Picture").rect();
    let camera = lab.state().preset_file().preset.camera;
    drag(
        &mut lab,
        view.center(),
        view.center() + egui::vec2(40.0, 10.0),
    );
    assert_ne!(lab.state().preset_file().preset.camera, camera);
    assert!(lab.query_by_label("unsaved").is_none());
    add_effect(&mut lab, "toon");
    assert!(lab.query_by_label("unsaved").is_some());
}
