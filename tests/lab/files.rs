//! Promise: presets, models and pictures are opened, dropped, saved and exported, and nothing is
//! lost when the device is.

use std::{
    path::Path,
    time::{Duration, Instant},
};

use egui::{self, Key, Modifiers, Role, vec2};
use egui_kittest::kittest::Queryable as _;
use rasterlab::{
    accuracy::RenderScale,
    preset::{Preset, SceneSource},
    preset_file::{self, Folders},
};

use crate::harness::*;

/// A file that hovers no more.
#[derive(Debug)]
struct Dropped(std::path::PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

pub fn drop_files(lab: &mut Lab, paths: &[&Path]) {
    let files = paths
        .iter()
        .map(|path| std::sync::Arc::new(Dropped(path.to_path_buf())) as egui::DroppedFileHandle);
    lab.input_mut().dropped_files.extend(files);
    lab.run_steps(3);
    settle(lab);
}

/// A model of one triangle, as small as a .glb can be.
pub fn tiny_glb() -> Vec<u8> {
    let mut json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]}"#
        .to_owned();
    json.extend(std::iter::repeat_n(
        ' ',
        json.len().next_multiple_of(4) - json.len(),
    ));
    let corners: Vec<u8> = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((12 + 8 + json.len() as u32 + 8 + corners.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json.as_bytes()), (b"BIN\0", &corners)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

#[test]
fn a_dropped_model_is_shown_and_undo_brings_the_preset_back() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = folder.path().join("tri.glb");
    std::fs::write(&model, tiny_glb()).expect("a file");
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let draws = lab.state().draws();
    drop_files(&mut lab, &[&model]);
    assert_eq!(
        lab.state().preset_file().preset.scene,
        SceneSource::File(model.clone())
    );
    assert!(
        lab.state().preset_file().title().ends_with(" on tri"),
        "{}",
        lab.state().preset_file().title()
    );
    assert!(lab.state().draws() > draws);
    let seen = picture(&mut lab);
    let background = *seen.get_pixel(seen.width() / 2, seen.height() - 20);
    let triangle = seen.pixels().filter(|pixel| **pixel != background).count();
    assert!(triangle > 10_000, "only {triangle} pixels show a triangle");
    assert!(
        !lab.state().log_text().contains("error"),
        "{}",
        lab.state().log_text()
    );
    undo(&mut lab);
    assert_eq!(lab.state().preset_file().id, "lambert");
}

#[test]
fn a_dropped_file_that_is_malformed_keeps_the_picture_and_is_one_sentence() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let before = picture(&mut lab);
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("a file");
        path
    };
    let glb = tiny_glb();
    let files = [
        write("cut.glb", &glb[..glb.len() - 9]),
        write("text.glb", b"no model at all"),
        write("bad.toml", b"schema = 2\n[effects.facet]\namount = 7\n"),
        write(
            "bare.png",
            &preset_file::png_bytes(&[[0; 4]], [1, 1]).expect("a picture"),
        ),
        write("notes.txt", b"hello"),
        folder.path().join("absent.glb"),
    ];
    for path in files {
        let (draws, errors) = (lab.state().draws(), error_lines(&lab));
        drop_files(&mut lab, &[&path]);
        let said = error_lines(&lab);
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        assert_eq!(said.len(), errors.len() + 1, "{name}: {said:?}");
        assert!(
            said.last().is_some_and(|line| line.contains(&name)),
            "{name}: {said:?}"
        );
        assert_eq!(lab.state().draws(), draws, "{name}");
    }
    wait_for_toasts(&mut lab);
    let below = |image: &image::RgbaImage| {
        image::imageops::crop_imm(image, 0, 48, image.width(), image.height() / 2).to_image()
    };
    assert!(
        below(&before) == below(&picture(&mut lab)),
        "the last good picture went away"
    );
}

/// A model that takes a while to load: a strip of so many triangles.
fn long_glb(triangles: u32) -> Vec<u8> {
    let count = triangles + 2;
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"mode":5}}]}}],"buffers":[{{"byteLength":{0}}}],
        "bufferViews":[{{"buffer":0,"byteLength":{0}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{count},"type":"VEC3","min":[0,0,0],"max":[1,1,1]}}]}}"#,
        12 * count
    );
    json.extend(std::iter::repeat_n(
        ' ',
        json.len().next_multiple_of(4) - json.len(),
    ));
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((12 + 8 + json.len() as u32 + 8 + 12 * count).to_le_bytes());
    bytes.extend((json.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(json.as_bytes());
    bytes.extend((12 * count).to_le_bytes());
    bytes.extend(b"BIN\0");
    (0..count).for_each(|i| {
        [i as f32 / count as f32, (i % 2) as f32, 0.0]
            .iter()
            .for_each(|value| bytes.extend(value.to_le_bytes()))
    });
    bytes
}

#[test]
fn loading_a_model_shows_its_progress_and_can_be_stopped_while_the_picture_stays() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("long.glb");
    std::fs::write(&path, long_glb(3_000_000)).expect("a file");
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let (before, draws) = (
        lab.state().preset_file().preset.clone(),
        lab.state().draws(),
    );
    for by_key in [false, true] {
        lab.input_mut()
            .dropped_files
            .push(std::sync::Arc::new(Dropped(path.clone())) as egui::DroppedFileHandle);
        lab.step();
        wait_for_label(&mut lab, " MB");
        let stopped = Instant::now();
        match by_key {
            true => lab.key_press(Key::Escape),
            false => lab
                .get_by_role_and_label(Role::Button, "Stop loading")
                .click(),
        }
        lab.run_steps(2);
        assert!(
            lab.query_by_role_and_label(Role::Button, "Stop loading")
                .is_none(),
            "it goes on loading"
        );
        assert!(
            stopped.elapsed() < Duration::from_secs(2),
            "{:?}",
            stopped.elapsed()
        );
        settle(&mut lab);
        assert!(
            lab.state().log_text().contains("Loading was stopped"),
            "{}",
            lab.state().log_text()
        );
        assert_eq!(
            (&lab.state().preset_file().preset, lab.state().draws()),
            (&before, draws),
            "the picture changed"
        );
    }
    assert!(error_lines(&lab).is_empty(), "{}", lab.state().log_text());
    // It can be opened later.
    drop_files(&mut lab, &[&path]);
    assert_eq!(
        lab.state().preset_file().preset.scene,
        SceneSource::File(path)
    );
}

/// Steps until a label with this text is there.
fn wait_for_label(lab: &mut Lab, text: &str) {
    let patience = Instant::now() + Duration::from_secs(120);
    while lab.query_all_by_label_contains(text).next().is_none() {
        assert!(
            Instant::now() < patience,
            "there is no label with {text:?}\n{}",
            lab.state().log_text()
        );
        lab.step();
    }
}

#[test]
fn a_model_that_cannot_be_read_leaves_preset_scene_and_title_and_is_not_said_to_be_open() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let path = folder.path().join("broken.glb");
    let glb = tiny_glb();
    std::fs::write(&path, &glb[..glb.len() - 9]).expect("a file");
    let (before, draws) = (
        lab.state().preset_file().preset.clone(),
        lab.state().draws(),
    );
    drop_files(&mut lab, &[&path]);
    assert_eq!(
        (
            lab.state().preset_file().id.as_str(),
            &lab.state().preset_file().preset
        ),
        ("lambert", &before)
    );
    assert_eq!((lab.state().undo_steps(), lab.state().draws()), (0, draws));
    let log = lab.state().log_text();
    assert!(
        !log.contains("Opened broken")
            && error_lines(&lab).len() == 1
            && error_lines(&lab)[0].contains("broken.glb"),
        "{log}"
    );
    assert!(
        lab.query_all_by_label_contains("cannot be shown")
            .next()
            .is_none()
    );

    // It is said when it is shown, and not before.
    std::fs::write(&path, &glb).expect("a file");
    lab.input_mut()
        .dropped_files
        .push(std::sync::Arc::new(Dropped(path.clone())) as egui::DroppedFileHandle);
    lab.step();
    assert!(
        !lab.state().log_text().contains("Opened broken"),
        "it is said before the model is read"
    );
    settle(&mut lab);
    assert!(
        lab.state().log_text().contains("Opened broken"),
        "{}",
        lab.state().log_text()
    );
    assert_eq!(
        lab.state().preset_file().preset.scene,
        SceneSource::File(path)
    );
}

#[test]
fn dropped_presets_and_exported_pictures_are_opened() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let toml = folder.path().join("moving.toml");
    std::fs::write(&toml, MOVING).expect("a file");
    drop_files(&mut lab, &[&toml]);
    assert_eq!(
        (
            lab.state().preset_file().id.as_str(),
            lab.state().preset_file().preset.animation.tracks().len()
        ),
        ("moving", 3)
    );
    let png = folder.path().join("shot.png");
    let preset_file =
        preset_file::open("facet-knot", &Folders::default()).expect("a built-in preset");
    let frame = rasterlab::frame::Frame {
        width: 1,
        height: 1,
        color: vec![[9; 4]],
        ..Default::default()
    };
    std::fs::write(
        &png,
        preset_file::png_with_preset(&frame, &preset_file, &preset_file::Provenance::default())
            .expect("a picture"),
    )
    .expect("a file");
    drop_files(&mut lab, &[&png]);
    assert_eq!(lab.state().preset_file().preset, preset_file.preset);
    // A model with its textures, and a preset among others: one is opened, and that is said.
    drop_files(&mut lab, &[&png, Path::new("/nowhere/readme.txt"), &toml]);
    assert_eq!(lab.state().preset_file().id, "moving");
    assert!(
        lab.state()
            .log_text()
            .contains("3 files were dropped. One is opened at a time: moving.toml")
    );
    assert_eq!(error_lines(&lab), [""; 0]);
    assert_eq!(lab.state().undo_steps(), 3);
}

#[test]
fn saving_writes_a_file_that_loads_equal() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_in("teapot", Some(folder.path())) else {
        return;
    };
    add_effect(&mut lab, "facet");
    let rail = slider(&lab, "facet.amount").rect();
    drag(
        &mut lab,
        rail.right_center() - vec2(8.0, 0.0),
        rail.center(),
    );
    let view = lab.get_by_label("Picture").rect();
    drag(&mut lab, view.center(), view.center() + vec2(33.0, 12.0));
    assert!(lab.state().preset_file().is_modified());
    press(&mut lab, Modifiers::COMMAND, Key::S); // Built in, so this asks for a name.
    press(&mut lab, Modifiers::NONE, Key::Enter);
    let path = folder.path().join("my-teapot.toml");
    let loaded = preset_file::load(&path)
        .unwrap_or_else(|error| panic!("{error}\n{}", lab.state().log_text()));
    assert_eq!(loaded.preset, lab.state().preset_file().preset);
    assert!(loaded.warnings.is_empty() && !lab.state().preset_file().is_modified());
    assert_eq!(lab.state().preset_file().id, "my-teapot");
    let Preset {
        name,
        about,
        tags,
        test,
        ..
    } = loaded.preset;
    assert_eq!(
        (name.as_str(), about.as_str(), tags.len(), test),
        ("my-teapot", "", 0, None),
        "what described and tested the old preset stays with it"
    );
    for name in ["Preset Teapot", "Preset my-teapot"] {
        assert_eq!(
            lab.query_all_by_label(name).count(),
            1,
            "the gallery shows the new preset beside the built-in one"
        );
    }
}

#[test]
fn an_exported_picture_contains_its_preset() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    let path = folder.path().join("shot"); // The extension is added.
    press(&mut lab, Modifiers::NONE, Key::F12);
    let field = lab.get_by_role_and_label(Role::TextInput, "Path");
    field.focus();
    lab.step();
    lab.key_press_modifiers(Modifiers::COMMAND, Key::A);
    lab.event(egui::Event::Text(path.to_string_lossy().into_owned()));
    lab.run_steps(3);
    lab.get_by_role_and_label(Role::Button, "Save").click();
    let path = path.with_extension("png");
    let patience = Instant::now() + Duration::from_secs(60);
    while !path.exists() {
        lab.step();
        assert!(Instant::now() < patience, "{}", lab.state().log_text());
        std::thread::sleep(Duration::from_millis(10));
    }
    let png = std::fs::read(&path).expect("the picture");
    // Stills have four samples for each pixel.
    let mut drawn = lab.state().preset_file().preset.clone();
    drawn.accuracy.pins = drawn.accuracy.pins.with(RenderScale::Double);
    assert_eq!(
        preset_file::preset_from_png(&png, "shot.png")
            .expect("a preset inside")
            .preset,
        drawn
    );
    let view = lab.get_by_label("Picture").rect();
    let decoded = image::load_from_memory(&png).expect("a PNG");
    assert_eq!(
        [decoded.width(), decoded.height()],
        [view.width().round() as u32, view.height().round() as u32]
    );
}

#[test]
fn undo_after_saving_is_an_unsaved_change_again() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mine.toml");
    let mut preset_file =
        preset_file::open("lambert", &Folders::default()).expect("a built-in preset");
    preset_file::save(&mut preset_file, &path).expect("a file");
    let Some(mut lab) = lab_in(&path.to_string_lossy(), Some(folder.path())) else {
        return;
    };
    add_effect(&mut lab, "facet");
    press(&mut lab, Modifiers::COMMAND, Key::S);
    assert!(!lab.state().preset_file().is_modified());
    undo(&mut lab);
    assert!(
        lab.state().preset_file().is_modified(),
        "the file has the facets, the preset has not"
    );
    press(&mut lab, Modifiers::COMMAND, Key::S);
    assert!(
        preset_file::load(&path)
            .expect("a preset")
            .preset
            .stack
            .get("facet")
            .is_none()
    );
}

/// Run by the next test in a separate process, whose environment decides where the recovered preset
/// is saved.
#[test]
#[ignore = "run by a_lost_device_rescues_the_preset_and_closes_the_window"]
fn child_that_loses_its_device() {
    let mut lab = lab("facet-sweep").expect("the parent has an adapter");
    lab.state_mut().preset_mut().spin_deg_per_s = 12.5;
    lab.state().gpu().device.destroy();
    // The driver says so in its own time.
    let patience = Instant::now() + Duration::from_secs(60);
    loop {
        lab.step();
        if lab.output().viewport_output[&egui::ViewportId::ROOT]
            .commands
            .contains(&egui::ViewportCommand::Close)
        {
            break;
        }
        assert!(
            Instant::now() < patience,
            "the window does not close\n{}",
            lab.state().log_text()
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_lost_device_rescues_the_preset_and_closes_the_window() {
    if crate::common::gpu().is_none() {
        return;
    }
    let home = tempfile::tempdir().expect("a temporary folder");
    let child = std::process::Command::new(std::env::current_exe().expect("this test"))
        .args(["--exact", "files::child_that_loses_its_device", "--ignored"])
        .env("XDG_CONFIG_HOME", home.path())
        .env("HOME", home.path())
        .output()
        .expect("the child starts");
    let said = String::from_utf8_lossy(&child.stdout).into_owned()
        + &String::from_utf8_lossy(&child.stderr);
    assert!(child.status.success(), "{said}");
    let folder = if cfg!(target_os = "macos") {
        "Library/Application Support/rasterlab"
    } else {
        "rasterlab"
    };
    let rescued = preset_file::load(&home.path().join(folder).join("recovery.toml"))
        .unwrap_or_else(|error| panic!("{error}\n{said}"));
    assert_eq!(rescued.preset.spin_deg_per_s, 12.5);
}
