//! Promise: a preset lands on the user's own model, which keeps its camera and clip; its own scene
//! comes when that is asked for; nothing of the gallery is overwritten, and undo takes it back in
//! one step.

use std::path::{Path, PathBuf};

use egui::{Event, Key, Modifiers, Role, vec2};
use egui_kittest::kittest::Queryable as _;
use rasterlab::{
    preset::SceneSource,
    preset_file::{self, Folders, GalleryEntry, PresetFile},
    scene::{UpAxis, builtin},
};

use crate::{
    files::{drop_files, tiny_glb},
    harness::*,
};

fn model(folder: &Path) -> PathBuf {
    let path = folder.join("tri.glb");
    std::fs::write(&path, tiny_glb()).expect("a file");
    path
}

fn gallery(id: &str) -> PresetFile {
    preset_file::open(id, &Folders::default()).expect("a preset of the gallery")
}

/// Clicks on a preset of the browser.
fn choose(lab: &mut Lab, title: &str, modifiers: Modifiers) {
    let label = format!("Preset {title}");
    lab.get_by_role_and_label(Role::Button, &label)
        .scroll_to_me();
    lab.run_steps(20);
    lab.get_by_role_and_label(Role::Button, &label)
        .click_modifiers(modifiers);
    lab.run_steps(4);
    settle(lab);
}

fn stack(lab: &Lab) -> Vec<String> {
    stack_of(lab.state().preset_file())
}

fn stack_of(file: &PresetFile) -> Vec<String> {
    file.preset
        .stack
        .0
        .iter()
        .map(|enabled| enabled.effect.name.clone())
        .collect()
}

fn scene(lab: &Lab) -> SceneSource {
    lab.state().preset_file().preset.scene.clone()
}

#[test]
fn a_chosen_preset_lands_on_the_model_and_undo_takes_it_back_in_one_step() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = model(folder.path());
    let Some(mut lab) = lab(&model.to_string_lossy()) else {
        return;
    };
    let view = lab.get_by_label("Picture").rect();
    drag(&mut lab, view.center(), view.center() + vec2(40.0, 15.0));
    let (before, steps) = (lab.state().preset_file().clone(), lab.state().undo_steps());
    assert!(before.preset.camera.is_some());

    let hatch = gallery("hatch");
    choose(&mut lab, hatch.title(), Modifiers::NONE);
    let landed = lab.state().preset_file();
    assert_eq!(landed.preset.scene, SceneSource::File(model));
    assert_eq!(landed.preset.camera, before.preset.camera);
    assert_eq!(
        (&landed.preset.stack, landed.preset.output.background),
        (&hatch.preset.stack, hatch.preset.output.background)
    );
    assert_eq!(
        (landed.path.as_deref(), landed.title()),
        (None, format!("{} on tri", hatch.title()).as_str())
    );
    assert!(
        lab.state()
            .log_text()
            .contains(&format!("Opened {} on tri", hatch.title())),
        "{}",
        lab.state().log_text()
    );
    assert_eq!(lab.state().undo_steps(), steps + 1);

    undo(&mut lab);
    assert_eq!(
        (
            &lab.state().preset_file().preset,
            &lab.state().preset_file().id
        ),
        (&before.preset, &before.id)
    );
    assert!(error_lines(&lab).is_empty(), "{:?}", error_lines(&lab));
}

#[test]
fn the_presets_own_scene_comes_with_shift_and_with_the_menu() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = model(folder.path());
    let Some(mut lab) = lab(&model.to_string_lossy()) else {
        return;
    };
    let knot = gallery("facet-knot");
    choose(&mut lab, knot.title(), Modifiers::SHIFT);
    assert_eq!(
        (
            &lab.state().preset_file().preset,
            &lab.state().preset_file().id
        ),
        (&knot.preset, &knot.id)
    );
    undo(&mut lab);
    assert_eq!(scene(&lab), SceneSource::File(model.clone()));

    choose(&mut lab, knot.title(), Modifiers::NONE);
    assert_eq!(scene(&lab), SceneSource::File(model));
    click(&mut lab, Role::Button, "File");
    click(&mut lab, Role::Button, "Open with its scene");
    assert_eq!(
        (
            &lab.state().preset_file().preset,
            &lab.state().preset_file().id
        ),
        (&knot.preset, &knot.id)
    );
    // Now the scene is the preset's own, so the next preset brings its own as well.
    let hatch = gallery("hatch");
    choose(&mut lab, hatch.title(), Modifiers::NONE);
    assert_eq!(scene(&lab), hatch.preset.scene);
}

#[test]
fn the_menu_of_the_browser_and_the_palette_open_presets_and_scenes_like_a_click() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = model(folder.path());
    let Some(mut lab) = lab(&model.to_string_lossy()) else {
        return;
    };
    let run = |lab: &mut Lab, entry: &str| {
        press(lab, Modifiers::COMMAND, Key::K);
        lab.event(Event::Text(entry.into()));
        lab.run_steps(3);
        press(lab, Modifiers::NONE, Key::Enter);
    };
    let knot = gallery("facet-knot");
    run(&mut lab, &format!("open {}", knot.title()));
    assert_eq!(
        (scene(&lab), lab.state().preset_file().look_id()),
        (SceneSource::File(model.clone()), "facet-knot"),
        "it lands"
    );

    let label = format!("Preset {}", knot.title());
    lab.get_by_role_and_label(Role::Button, &label)
        .scroll_to_me();
    lab.run_steps(20);
    lab.get_by_role_and_label(Role::Button, &label)
        .click_secondary();
    lab.run_steps(4);
    lab.get_by_role_and_label(Role::Button, "Open with its scene")
        .click();
    lab.run_steps(4);
    settle(&mut lab);
    assert_eq!(
        (scene(&lab), lab.state().preset_file().id.as_str()),
        (knot.preset.scene, "facet-knot")
    );

    // A built-in scene that is chosen takes the look that is open.
    run(&mut lab, "scene sphere");
    assert_eq!(
        (scene(&lab), stack(&lab)),
        (
            SceneSource::Builtin("sphere".into()),
            ["facet", "lambert"].map(String::from).to_vec()
        )
    );
    assert_eq!(error_lines(&lab), [""; 0]);
    assert!(
        lab.state().preset_file().has_own_scene(),
        "a built-in scene that was chosen is the user's own: {}\n{}",
        lab.state().preset_file().title(),
        lab.state().log_text()
    );
}

#[test]
fn the_keys_and_dropped_presets_land_too() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = model(folder.path());
    let Some(mut lab) = lab("hatch") else { return };
    drop_files(&mut lab, &[&model]);
    // In the order of their names, as the browser lists them.
    let title = |entry: &GalleryEntry| {
        entry
            .preset_file
            .as_ref()
            .expect("a preset")
            .title()
            .to_lowercase()
    };
    let mut entries = preset_file::gallery(&Folders::default());
    entries.sort_by_key(|entry| (title(entry), entry.id.clone()));
    let ids: Vec<String> = entries.into_iter().map(|entry| entry.id).collect();
    let here = ids
        .iter()
        .position(|id| id == "hatch")
        .expect("a preset of the gallery");
    for step in 1..=2 {
        press(&mut lab, Modifiers::NONE, Key::CloseBracket);
        assert_eq!(
            lab.state().preset_file().look_id(),
            ids[(here + step) % ids.len()]
        );
        assert_eq!(scene(&lab), SceneSource::File(model.clone()));
    }
    let dropped = folder.path().join("ink.toml");
    std::fs::write(
        &dropped,
        "schema = 2\nname = \"Ink\"\n[scene]\nbuiltin = \"cube-wall\"\n[effects.toon]\n",
    )
    .expect("a file");
    drop_files(&mut lab, &[&dropped]);
    assert_eq!(
        (scene(&lab), stack(&lab)),
        (
            SceneSource::File(model),
            ["toon"].map(String::from).to_vec()
        )
    );
    assert_eq!(lab.state().preset_file().title(), "Ink on tri");
}

#[test]
fn a_model_takes_the_look_that_is_open_and_the_camera_shows_it_whole() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = model(folder.path());
    let Some(mut lab) = lab("facet-radial") else {
        return;
    };
    let look = gallery("facet-radial");
    drop_files(&mut lab, &[&model]);
    let landed = lab.state().preset_file().preset.clone();
    assert_eq!(
        (landed.scene, landed.camera),
        (SceneSource::File(model), None)
    );
    assert_eq!(
        (stack(&lab), landed.output.background),
        (
            ["facet", "lambert"].map(String::from).to_vec(),
            look.preset.output.background
        )
    );
    // Lengths fit the model, from the radius of the sphere to that of the triangle.
    let sphere = builtin::build("sphere?triangles=700")
        .expect("a scene")
        .bounds()
        .radius();
    let radius = value(&lab, "facet", "radius_m")[0];
    let wanted = 0.9 * 0.5f64.sqrt() / sphere;
    assert!((radius - wanted).abs() < 1e-5, "{radius} is not {wanted}");
}

#[test]
fn a_model_is_plain_until_a_look_is_chosen_and_after_a_click() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = model(folder.path());
    let Some(mut lab) = opened(None, None) else {
        return;
    };
    let plain = stack_of(preset_file::plain());
    assert_ne!(stack(&lab), plain);
    drop_files(&mut lab, &[&model]);
    assert_eq!(
        (stack(&lab), scene(&lab)),
        (plain.clone(), SceneSource::File(model))
    );
    assert!(lab.query_by_label("unsaved").is_none() && lab.state().preset_file().is_plain());
    let hatch = gallery("hatch");
    choose(&mut lab, hatch.title(), Modifiers::NONE);
    let other = folder.path().join("other.glb");
    std::fs::write(&other, tiny_glb()).expect("a file");
    drop_files(&mut lab, &[&other]);
    assert_eq!(
        stack(&lab),
        stack_of(&hatch),
        "it takes the look that was chosen"
    );
    assert!(lab.query_by_label("unsaved").is_none());
    press(&mut lab, Modifiers::NONE, Key::R);
    for _ in 0..2 {
        assert!(lab.query_by_label("unsaved").is_some(), "it stays changed");
        drop_files(&mut lab, &[&other]);
    }
    undo(&mut lab);
    paste(&mut lab, "[effects.toon]\nsteps = 3\n");
    settle(&mut lab);
    assert_eq!(scene(&lab), SceneSource::File(other.clone()));
    assert_eq!(stack(&lab), ["toon"]);
    assert!(lab.query_by_label("unsaved").is_some(), "no file has it");
    choose(&mut lab, hatch.title(), Modifiers::NONE);
    for label in ["Plain look", "New"] {
        match label {
            "New" => press(&mut lab, Modifiers::COMMAND, Key::N),
            _ => click(&mut lab, Role::Button, label),
        }
        settle(&mut lab);
        assert_eq!(
            (stack(&lab), scene(&lab)),
            (plain.clone(), SceneSource::File(other.clone()))
        );
        undo(&mut lab);
        assert_eq!(stack(&lab), stack_of(&hatch));
    }
    // Where a value of it was changed it is still on, and a click takes it as it was.
    let is_plain = |lab: &Lab| is_on(&lab.get_by_role_and_label(Role::Button, "Plain look"));
    assert!(!is_plain(&lab));
    click(&mut lab, Role::Button, "Plain look");
    let background = lab.state().preset_file().preset.output.background;
    lab.state_mut().preset_mut().output.background[0] += 0.25;
    settle(&mut lab);
    assert!(is_plain(&lab) && lab.query_by_label("unsaved").is_some());
    click(&mut lab, Role::Button, "Plain look");
    assert_eq!(
        lab.state().preset_file().preset.output.background,
        background
    );
    assert!(is_plain(&lab) && lab.query_by_label("unsaved").is_none());
    assert!(error_lines(&lab).is_empty(), "{:?}", error_lines(&lab));
}

#[test]
fn the_axis_that_was_chosen_to_be_up_in_a_model_is_kept_for_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = model(folder.path());
    let Some(mut lab) = lab(&model.to_string_lossy()) else {
        return;
    };
    let up = |lab: &Lab| lab.state().preset_file().preset.parts.up;
    assert_eq!(up(&lab), UpAxis::Y);
    lab.state_mut().preset_mut().parts.up = UpAxis::X;
    settle(&mut lab);
    let other = folder.path().join("other.glb");
    std::fs::write(&other, tiny_glb()).expect("a file");
    for (opened, axis) in [(&other, UpAxis::Y), (&model, UpAxis::X)] {
        drop_files(&mut lab, &[opened]);
        assert_eq!(up(&lab), axis, "{}", opened.display());
    }
}

#[test]
fn lengths_of_a_chosen_preset_are_fitted_to_the_model() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab(&model(folder.path()).to_string_lossy()) else {
        return;
    };
    choose(&mut lab, gallery("facet-radial").title(), Modifiers::NONE);
    let sphere = builtin::build("sphere?triangles=700")
        .expect("a scene")
        .bounds();
    let scale = 0.5f64.sqrt() / sphere.radius();
    let center = value(&lab, "facet", "center");
    for (axis, (at, middle)) in [(0.4, 0.5), (0.4, 0.5), (0.9, 0.0)].into_iter().enumerate() {
        let wanted = middle + (at - sphere.center()[axis]) * scale;
        assert!((center[axis] - wanted).abs() < 1e-5, "{center:?}");
    }
    assert!((value(&lab, "facet", "width_m")[0] - 0.3 * scale).abs() < 1e-5);
}

#[test]
fn a_built_in_scene_that_was_chosen_is_the_users_own() {
    let Some(mut lab) = lab("hatch") else { return };
    let toon = gallery("toon");
    choose(&mut lab, toon.title(), Modifiers::NONE);
    assert_eq!(
        scene(&lab),
        toon.preset.scene,
        "presets of the gallery bring their scenes"
    );
    click(&mut lab, Role::Button, "Scene");
    click(&mut lab, Role::Button, "cube-wall");
    assert_eq!(
        (scene(&lab), stack(&lab).iter().any(|name| name == "toon")),
        (SceneSource::Builtin("cube-wall".into()), true)
    );
    click(&mut lab, Role::Button, "Presets");
    choose(&mut lab, gallery("hatch").title(), Modifiers::NONE);
    assert_eq!(
        (scene(&lab), stack(&lab).iter().any(|name| name == "hatch")),
        (SceneSource::Builtin("cube-wall".into()), true)
    );
    undo(&mut lab);
    undo(&mut lab);
    assert_eq!(lab.state().preset_file().preset, toon.preset);
}

#[test]
fn what_is_saved_afterwards_is_a_new_preset() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = model(folder.path());
    let presets = folder.path().join("presets");
    std::fs::create_dir(&presets).expect("a folder");
    let text =
        "schema = 2\nname = \"Ink\"\n[scene]\nbuiltin = \"cube-wall\"\n[effects.toon]\nsteps = 5\n";
    std::fs::write(presets.join("ink.toml"), text).expect("a file");
    let Some(mut lab) = lab_in(&model.to_string_lossy(), Some(&presets)) else {
        return;
    };
    choose(&mut lab, "Ink", Modifiers::NONE);
    press(&mut lab, Modifiers::COMMAND, Key::S); // It asks for a name.
    press(&mut lab, Modifiers::NONE, Key::Enter);
    let saved = preset_file::load(&presets.join("ink-tri.toml"))
        .unwrap_or_else(|error| panic!("{error}\n{}", lab.state().log_text()));
    assert!(saved.warnings.is_empty() && saved.preset.stack.get("toon").is_some());
    let SceneSource::File(path) = &saved.preset.scene else {
        panic!("{:?}", saved.preset.scene)
    };
    assert_eq!(
        std::fs::canonicalize(presets.join(path)).expect("the model"),
        std::fs::canonicalize(&model).expect("the model")
    );
    assert_eq!(
        std::fs::read_to_string(presets.join("ink.toml")).expect("the preset"),
        text,
        "the preset of the gallery is as it was"
    );
    assert!(!lab.state().preset_file().is_modified());
    // A preset of the same model comes back with its camera.
    let mut with_camera = saved.clone();
    with_camera.preset.camera = Some(rasterlab::scene::camera::Camera::default());
    preset_file::save(&mut with_camera, &presets.join("other.toml")).expect("a file");
    drop_files(&mut lab, &[&presets.join("other.toml")]);
    assert_eq!(
        lab.state().preset_file().preset.camera,
        with_camera.preset.camera
    );
}

#[test]
fn a_look_on_a_model_that_is_saved_under_another_name_is_called_by_it() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab(&model(folder.path()).to_string_lossy()) else {
        return;
    };
    choose(&mut lab, "Comic", Modifiers::NONE);
    assert_eq!(lab.state().preset_file().title(), "Comic on tri");
    press(&mut lab, Modifiers::COMMAND, Key::S);
    lab.run_steps(2);
    lab.event(Event::Text(
        folder
            .path()
            .join("my ink.toml")
            .to_string_lossy()
            .into_owned(),
    ));
    lab.run_steps(2);
    press(&mut lab, Modifiers::NONE, Key::Enter);
    assert_eq!(
        (
            lab.state().preset_file().title(),
            lab.state().preset_file().is_modified()
        ),
        ("my ink", false),
        "{}",
        lab.state().log_text()
    );
    assert_eq!(
        preset_file::load(&folder.path().join("my ink.toml"))
            .expect("a file")
            .preset
            .name,
        "my ink"
    );
}

#[test]
fn what_is_left_out_is_said_once_and_the_rest_is_shown() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab(&model(folder.path()).to_string_lossy()) else {
        return;
    };
    let look = folder.path().join("herd.toml");
    let text = "schema = 2\nname = \"Herd\"\n[scene]\nbuiltin = \"walker?tess=2\"\nclip = \"Walk\"\n[effects.hatch]\non = [\"node:walker 1\"]\n[effects.lambert]\n";
    std::fs::write(&look, text).expect("a file");
    drop_files(&mut lab, &[&look]);
    assert_eq!(stack(&lab).len(), 2);
    let log = lab.state().log_text();
    let words = "effects.hatch.on: the scene has none of its parts";
    assert_eq!(
        log.lines()
            .filter(|line| line.starts_with("warning") && line.contains(words))
            .count(),
        1,
        "{log}"
    );
    assert!(
        log.contains("info: Opened Herd on tri; ") && error_lines(&lab).is_empty(),
        "{log}"
    );
    assert!(
        !log.contains("was left out"),
        "a model that cannot move misses no clip: {log}"
    );

    // A scene with clips of its own could have another one.
    let Some(mut lab) = self::lab("builtin:tentacle?tess=3") else {
        return;
    };
    drop_files(&mut lab, &[&look]);
    let log = lab.state().log_text();
    assert!(log.contains("clip \"Walk\" was left out"), "{log}");
}

#[test]
fn a_model_in_place_of_a_moving_scene_is_said_to_be_open_and_nothing_is_missed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = "schema = 2\nname = \"Herd\"\n[scene]\nbuiltin = \"walker?tess=2\"\nclip = \"Walk\"\n[effects.lambert]\n";
    let Some(mut lab) = lab_of(folder.path(), text) else {
        return;
    };
    drop_files(&mut lab, &[&model(folder.path())]);
    let log = lab.state().log_text();
    assert!(
        log.contains("info: Opened tri") && !log.contains("left out"),
        "{log}"
    );
}

#[test]
fn thumbnails_show_the_presets_on_the_users_model() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab("hatch") else { return };
    assert!(
        lab.query_by_role_and_label(Role::CheckBox, "Thumbnails on tri")
            .is_none()
    );
    drop_files(&mut lab, &[&model(folder.path())]);
    // Its scene is small, so that its thumbnail is there at once.
    let gallery = preset_file::gallery(&Folders::default());
    let boxes = gallery.iter().find(|entry| entry.id == "boxes");
    let first = boxes
        .and_then(|entry| entry.preset_file.as_ref().ok())
        .expect("a preset")
        .title()
        .to_owned();
    let thumbnail = |lab: &mut Lab| {
        lab.remove_cursor();
        lab.run_steps(3);
        let row = lab
            .get_by_role_and_label(Role::Button, &format!("Preset {first}"))
            .rect();
        let [x, y] = [row.min.x + 8.0, row.min.y + 8.0].map(|v| v.round() as u32);
        image::imageops::crop_imm(&lab.screenshot(), x, y, 64, 46).to_image()
    };
    lab.get_by_role_and_label(Role::Button, &format!("Preset {first}"))
        .scroll_to_me();
    lab.run_steps(20);
    settle(&mut lab);
    let own = thumbnail(&mut lab);
    click(&mut lab, Role::CheckBox, "Thumbnails on tri");
    assert!(
        thumbnail(&mut lab) != own,
        "the thumbnail shows another scene"
    );
    click(&mut lab, Role::CheckBox, "Thumbnails on tri");
    assert!(
        thumbnail(&mut lab) == own,
        "the preset's own thumbnail is kept"
    );

    // Large pictures show the model, too.
    click(&mut lab, Role::CheckBox, "Large pictures");
    lab.get_by_role_and_label(Role::Button, &format!("Preset {first}"))
        .scroll_to_me();
    lab.run_steps(20);
    settle(&mut lab);
    let own = thumbnail(&mut lab);
    click(&mut lab, Role::CheckBox, "Thumbnails on tri");
    assert!(
        thumbnail(&mut lab) != own,
        "the large picture shows another scene"
    );
}

#[test]
fn a_look_brings_its_ground_and_its_gradient_to_the_model() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab(&model(folder.path()).to_string_lossy()) else {
        return;
    };
    let alone = lab.state().scene_triangles();
    let studio = lab.state().preset_file().preset.ground;
    let plinth = gallery("plinth");
    choose(&mut lab, plinth.title(), Modifiers::NONE);
    let landed = &lab.state().preset_file().preset;
    assert_eq!(
        (landed.ground, landed.output.background_bottom),
        (plinth.preset.ground, plinth.preset.output.background_bottom)
    );
    let ground = plinth.preset.ground.expect("it stands on a ground");
    assert_eq!(
        lab.state().scene_triangles(),
        1 + u64::from(6 * ground.cells * ground.cells),
        "its ground instead of the studio's"
    );
    undo(&mut lab);
    settle(&mut lab);
    assert_eq!(
        (
            lab.state().preset_file().preset.ground,
            lab.state().scene_triangles()
        ),
        (studio, alone)
    );
}

#[test]
fn lengths_in_radii_of_the_scene_are_drawn_as_those_lengths_in_meters() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let radius = builtin::build("knot?tess=4")
        .expect("a scene")
        .bounds()
        .radius();
    assert!(
        (radius - 1.0).abs() > 0.2,
        "a radius of {radius} m tells nothing"
    );
    let mut drawn = [("scene", 0.25), ("m", 0.25 * radius)].map(|(unit, amount)| {
        let text = format!(
            "schema = 2\n[scene]\nbuiltin = \"knot?tess=4\"\nunit = \"{unit}\"\n[effects.inflate]\namount_m = {amount}\n[effects.lambert]\n"
        );
        lab_of(folder.path(), &text).map(|mut lab| middle(&mut lab))
    });
    let [Some(radii), Some(meters)] = &mut drawn else {
        return;
    };
    let differing = radii
        .pixels()
        .zip(meters.pixels())
        .filter(|(a, b)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 8))
        .count();
    assert!(differing < 200, "{differing} pixels differ");
}
