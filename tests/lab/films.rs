//! Promise: the window exports a film of the preset it shows, in every format, off its own thread:
//! with progress, canceled at once, never over other files unasked, and a failure stays in the
//! dialog with its reason.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use egui::{self, Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;
use rasterlab::preset_file::{self, Folders};

use crate::harness::*;

/// Eight frames at eight a second.
const SECOND: &str = "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\n[clock]\nrange_s = [0.0, 1.0]\n[effects.facet]\n[effects.lambert]\n\
    [animation.facet]\namount = [{ time_s = 0.0, value = 0.0 }, { time_s = 1.0, value = 1.0 }]\n";

/// Types `text` into the field of this name in place of what it has.
fn fill(lab: &mut Lab, role: Role, label: &str, text: &str) {
    // A number becomes a text field by a click.
    lab.get_by_role_and_label(role, label).click();
    lab.run_steps(3);
    if role == Role::TextInput {
        lab.get_by_role_and_label(role, label).focus();
        lab.run_steps(2);
    }
    lab.key_press_modifiers(Modifiers::COMMAND, Key::A);
    lab.run_steps(2);
    lab.event(egui::Event::Text(text.to_owned()));
    lab.run_steps(2);
    // Enter in the path would export.
    lab.key_press_modifiers(
        Modifiers::NONE,
        if role == Role::TextInput {
            Key::Tab
        } else {
            Key::Enter
        },
    );
    lab.run_steps(3);
}

/// The dialog for a film of 64x48 pixels at `path`, with `fps` frames a second.
fn open_dialog(lab: &mut Lab, format: &str, path: &Path, fps: &str) {
    press(lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    lab.get_by_label(format).click();
    lab.run_steps(3);
    fill(
        lab,
        Role::TextInput,
        "Path of the film",
        &path.to_string_lossy(),
    );
    fill(lab, Role::SpinButton, "Width of the film", "64");
    fill(lab, Role::SpinButton, "Height of the film", "48");
    fill(lab, Role::SpinButton, "Frames per second", fps);
}

fn is_open(lab: &Lab) -> bool {
    lab.query_by_label("Path of the film").is_some()
}

/// Is this text shown anywhere? A failure is in the dialog and, for a moment, in a message.
fn shows(lab: &Lab, text: &str) -> bool {
    lab.query_all_by_label_contains(text).next().is_some()
}

fn files_in(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    files.retain(|path| {
        path.extension()
            .is_some_and(|extension| extension != "toml")
    });
    files.sort();
    files
}

#[test]
fn a_size_is_rounded_when_its_field_is_left_and_a_message_says_so() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    click(&mut lab, Role::Button, "MP4");
    fill(&mut lab, Role::SpinButton, "Width of the film", "1920");
    assert!(!shows(&lab, "became"), "{}", lab.state().log_text());
    fill(&mut lab, Role::SpinButton, "Height of the film", "1081");
    assert!(
        shows(&lab, "1081 became 1080"),
        "{}",
        lab.state().log_text()
    );
    let width = lab.get_by_role_and_label(Role::SpinButton, "Width of the film");
    assert_eq!(width.value().as_deref(), Some("1920 px"));
}

#[test]
fn the_next_film_begins_as_the_last_one_was_exported_also_after_a_new_start() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let preset = folder.path().join("mine.toml");
    std::fs::write(&preset, SECOND).expect("a file");
    let config = folder.path().join("config");
    let start = |open: &str| {
        let mut lab = created(Some(open), Folders::default(), Some(config.clone()), SIZE)?;
        settle(&mut lab);
        Some(lab)
    };
    let Some(mut lab) = start(&preset.to_string_lossy()) else {
        return;
    };
    open_dialog(&mut lab, "PNG frames", &folder.path().join("walk"), "4");
    fill(&mut lab, Role::SpinButton, "End of the film", "0.5");
    click(&mut lab, Role::ComboBox, "Anti-aliasing of the film");
    click(&mut lab, Role::Button, "2×2");
    click(&mut lab, Role::Button, "Export film");
    assert!(
        lab.state().log_text().contains("2 frames drawn"),
        "{}",
        lab.state().log_text()
    );
    drop(lab);

    let Some(mut lab) = start(&preset.to_string_lossy()) else {
        return;
    };
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    assert!(
        lab.query_by_label("2 frames, 0.50 s: mine-film_0000.png to mine-film_0001.png")
            .is_some(),
        "range, rate or format is another"
    );
    let path = lab.get_by_role_and_label(Role::TextInput, "Path of the film");
    let first = folder.path().join("mine-film.png");
    assert_eq!(path.value().as_deref(), first.to_str());
    let path = folder.path().join("again");
    fill(
        &mut lab,
        Role::TextInput,
        "Path of the film",
        &path.to_string_lossy(),
    );
    click(&mut lab, Role::Button, "Export film");
    let frame = files_in(folder.path())
        .into_iter()
        .find(|file| file.to_string_lossy().contains("again"))
        .expect("a frame");
    let picture = image::open(&frame).expect("a PNG");
    assert_eq!((picture.width(), picture.height()), (64, 48));
    let saved = preset_file::preset_from_png(&std::fs::read(&frame).expect("a file"), "frame")
        .expect("a preset inside");
    assert_eq!(saved.preset.accuracy.scale().factor(), 2.0);
    drop(lab);

    // The range belongs to the preset.
    let Some(mut lab) = start("facet-sweep") else {
        return;
    };
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    assert!(lab.query_by_label_contains(" frames, 0.50 s").is_none());
}

#[test]
fn the_dialog_is_filled_in_and_confirmed_without_the_mouse() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), SECOND) else {
        return;
    };
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    let rect = |lab: &Lab, role: Role, label: &str| lab.get_by_role_and_label(role, label).rect();
    let [row, buttons] = [
        rect(&lab, Role::Button, "Turntable None"),
        rect(&lab, Role::Button, "Export film"),
    ];
    assert!(
        buttons.top() - row.bottom() < 40.0,
        "the dialog has a hole of {} points",
        buttons.top() - row.bottom()
    );
    // The path has the focus.
    let path = folder.path().join("out.png");
    press(&mut lab, Modifiers::COMMAND, Key::A);
    lab.event(egui::Event::Text(path.to_string_lossy().into_owned()));
    lab.run_steps(2);
    // The home folder, width, height, the list of sizes with names, frames a second.
    for text in ["", "64", "48", "", "2"] {
        press(&mut lab, Modifiers::NONE, Key::Tab);
        if !text.is_empty() {
            lab.event(egui::Event::Text(text.to_owned()));
            lab.run_steps(2);
        }
    }
    for _ in 0..5 {
        press(&mut lab, Modifiers::SHIFT, Key::Tab);
    }
    assert!(lab.query_by_label("2 frames, 1.00 s").is_some());
    press(&mut lab, Modifiers::NONE, Key::Enter);
    settle(&mut lab);
    assert!(
        path.exists() && !is_open(&lab),
        "{}",
        lab.state().log_text()
    );
    // Once more: Enter alone replaces nothing.
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    fill(&mut lab, Role::SpinButton, "Frames per second", "3");
    let before = std::fs::read(&path).expect("the film");
    for _ in 0..2 {
        lab.get_by_role_and_label(Role::TextInput, "Path of the film")
            .focus();
        lab.run_steps(2);
        press(&mut lab, Modifiers::NONE, Key::Enter);
        settle(&mut lab);
    }
    assert!(
        is_open(&lab) && shows(&lab, "Replace overwrites it"),
        "{}",
        lab.state().log_text()
    );
    assert_eq!(std::fs::read(&path).expect("the film"), before);
}

#[test]
fn a_film_of_the_shown_preset_is_written_and_replaced_only_when_asked() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), SECOND) else {
        return;
    };
    let path = folder.path().join("out.png");
    open_dialog(&mut lab, "Animated PNG", &path, "8");
    assert!(
        lab.query_by_label("8 frames, 1.00 s").is_some(),
        "the dialog says how long the film is"
    );
    click(&mut lab, Role::Button, "Export film");
    assert!(!is_open(&lab), "{}", lab.state().log_text());
    assert!(
        lab.state().log_text().contains("8 frames drawn"),
        "{}",
        lab.state().log_text()
    );
    let bytes = std::fs::read(&path).expect("the film");
    let film = png::Decoder::new(std::io::Cursor::new(&bytes))
        .read_info()
        .expect("a PNG");
    assert_eq!(
        (
            film.info().size(),
            film.info()
                .animation_control()
                .expect("an animation")
                .num_frames
        ),
        ((64, 48), 8)
    );
    let saved = preset_file::preset_from_png(&bytes, "out.png").expect("a preset inside");
    assert_eq!(
        saved.preset.animation,
        lab.state().preset_file().preset.animation
    );
    assert_eq!(
        (
            lab.state().undo_steps(),
            lab.state().preset_file().is_modified()
        ),
        (0, false),
        "the preset is as it was"
    );

    // The same film again is there already; anything else stays until the person agrees.
    std::fs::write(&path, "precious").expect("a file");
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    click(&mut lab, Role::Button, "Export film");
    assert!(
        is_open(&lab) && shows(&lab, "out.png exists"),
        "{}",
        lab.state().log_text()
    );
    assert_eq!(std::fs::read(&path).expect("a file"), b"precious");
    click(&mut lab, Role::Button, "Replace");
    assert!(
        !is_open(&lab) && std::fs::read(&path).expect("a file") == bytes,
        "{}",
        lab.state().log_text()
    );
}

#[test]
fn a_turntable_is_one_click_and_does_not_change_the_preset() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), SECOND) else {
        return;
    };
    open_dialog(&mut lab, "PNG frames", &folder.path().join("turn.png"), "2");
    lab.get_by_label("Turntable Camera").click();
    lab.run_steps(3);
    // No key changes the preset behind the form.
    press(&mut lab, Modifiers::NONE, Key::R);
    click(&mut lab, Role::Button, "Export film");
    let files = files_in(folder.path());
    assert_eq!(files.len(), 2, "{}", lab.state().log_text());
    let cameras = files.iter().map(|path| {
        let preset_file =
            preset_file::preset_from_png(&std::fs::read(path).expect("a frame"), "frame")
                .expect("a preset inside");
        preset_file.preset.camera.expect("a turntable has a camera")
    });
    let [front, back] = cameras.collect::<Vec<_>>().try_into().expect("two frames");
    let (front, back) = (front.eye - front.target, back.eye - back.target);
    assert!(
        (front + back).with_y(0.0).length() < 1e-3 * front.length(),
        "after half of the film it looks from behind: {front} {back}"
    );
    assert_eq!(
        (
            lab.state().preset_file().preset.camera,
            lab.state().undo_steps()
        ),
        (None, 0)
    );
}

#[test]
fn a_film_goes_from_the_kept_preset_to_the_open_one() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), SECOND) else {
        return;
    };
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    assert!(
        lab.query_by_label("From A to B").is_none(),
        "nothing is kept"
    );
    press(&mut lab, Modifiers::NONE, Key::Escape);
    press(&mut lab, Modifiers::SHIFT, Key::Backslash);
    click(&mut lab, Role::Button, "Keep B");
    click(&mut lab, Role::Button, "Mute facet");
    open_dialog(&mut lab, "PNG frames", &folder.path().join("way.png"), "3");
    lab.get_by_label("From A to B").click();
    lab.run_steps(3);
    click(&mut lab, Role::Button, "Export film");
    let files = files_in(folder.path());
    let has_facet = files.iter().map(|path| {
        let bytes = std::fs::read(path).expect("a frame");
        let frame = preset_file::preset_from_png(&bytes, "frame").expect("a preset inside");
        frame.preset.stack.get("facet").is_some()
    });
    let has_facet: Vec<bool> = has_facet.collect();
    assert_eq!(
        has_facet,
        [true, false, false],
        "{}",
        lab.state().log_text()
    );
}

#[test]
fn frames_are_kept_after_a_cancel_that_takes_effect_at_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), SECOND) else {
        return;
    };
    open_dialog(
        &mut lab,
        "PNG frames",
        &folder.path().join("walk.png"),
        "240",
    );
    assert!(
        lab.query_by_label("240 frames, 1.00 s: walk_0000.png to walk_0239.png")
            .is_some()
    );
    lab.get_by_role_and_label(Role::Button, "Export film")
        .click();
    let patience = Instant::now() + Duration::from_secs(120);
    while files_in(folder.path()).len() < 4 {
        lab.step();
        assert!(Instant::now() < patience, "{}", lab.state().log_text());
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(
        shows(&lab, " left") || shows(&lab, "first frame"),
        "the time left is told"
    );
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(3);
    assert!(
        shows(&lab, "Stopped. Frames kept") && is_open(&lab),
        "the dialog is there again"
    );
    settle(&mut lab);
    let drawn = files_in(folder.path()).len();
    assert!(drawn < 240, "{drawn} frames");
    // What was drawn stays; the end of the range is cut so that the rest is quick.
    fill(&mut lab, Role::SpinButton, "End of the film", "0.05");
    lab.get_by_role_and_label(Role::Button, "Export film")
        .click();
    lab.run_steps(3);
    settle(&mut lab);
    assert!(
        !is_open(&lab) && lab.state().log_text().contains(" were there"),
        "{}",
        lab.state().log_text()
    );
    for path in files_in(folder.path())
        .iter()
        .filter(|path| !path.to_string_lossy().contains("/."))
    {
        preset_file::png_pixels(path).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn nothing_plays_behind_a_film_and_a_canceled_animation_promises_no_frames() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), SECOND) else {
        return;
    };
    open_dialog(&mut lab, "Animated PNG", &folder.path().join("out"), "240");
    lab.get_by_role_and_label(Role::Button, "Close").click();
    lab.run_steps(3);
    lab.key_press(Key::Space);
    lab.run_steps(5);
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::E);
    let playing_s = lab.state().shown_time_s();
    lab.get_by_role_and_label(Role::Button, "Export film")
        .click();
    // The pictures that were asked for before still come.
    let patience = Instant::now() + Duration::from_secs(120);
    while !shows(&lab, " left") {
        lab.step();
        assert!(Instant::now() < patience, "{}", lab.state().log_text());
        std::thread::sleep(Duration::from_millis(5));
    }
    let before = (lab.state().shown_time_s(), lab.state().draws());
    assert!(before.0 > 0.0 || playing_s > 0.0, "it does not play");
    lab.run_steps(20);
    assert!(shows(&lab, "Cancel"), "the film is done: it proves nothing");
    assert_eq!((lab.state().shown_time_s(), lab.state().draws()), before);
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(3);
    assert!(shows(&lab, "Stopped. No file was written") && !shows(&lab, "Frames kept"));
    let after_s = lab.state().shown_time_s();
    let patience = Instant::now() + Duration::from_secs(120);
    while lab.state().shown_time_s() == after_s {
        lab.step();
        assert!(Instant::now() < patience, "it does not play on");
    }
    assert_eq!(files_in(folder.path()).len(), 0);
}

#[test]
fn a_failed_film_keeps_the_dialog_with_the_reason() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("file"), "no folder").expect("a file");
    let Some(mut lab) = lab_of(folder.path(), SECOND) else {
        return;
    };
    open_dialog(
        &mut lab,
        "PNG frames",
        &folder.path().join("file/walk.png"),
        "8",
    );
    click(&mut lab, Role::Button, "Export film");
    assert!(
        is_open(&lab) && shows(&lab, "cannot be created"),
        "{}",
        lab.state().log_text()
    );
    assert_eq!(error_lines(&lab).len(), 1, "{}", lab.state().log_text());
    fill(&mut lab, Role::SpinButton, "End of the film", "-1");
    assert!(
        shows(&lab, "to -1 must come after from 0"),
        "a range that cannot be is told"
    );
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(!is_open(&lab), "Escape closes it");
}

/// Run by the next test in separate processes, whose `PATH` decides whether there is an ffmpeg.
#[test]
#[ignore = "run by videos_go_through_ffmpeg_or_a_sentence_says_that_it_is_missing"]
fn child_that_exports_a_video() {
    let folder = PathBuf::from(std::env::var_os("FILM_FOLDER").expect("the parent's folder"));
    let mut lab = lab_of(&folder, SECOND).expect("the parent has an adapter");
    open_dialog(&mut lab, "MP4", &folder.join("film.mp4"), "8");
    if std::env::var_os("PATH").is_some_and(|path| path.is_empty()) {
        assert!(shows(&lab, "MP4 needs ffmpeg, which is not installed"));
        lab.get_by_role_and_label(Role::Button, "Export film")
            .click();
        lab.run_steps(3);
        assert!(is_open(&lab) && !folder.join("film.mp4").exists());
        lab.get_by_label("Animated PNG").click();
        lab.run_steps(3);
        assert!(!shows(&lab, "needs ffmpeg"));
    } else {
        click(&mut lab, Role::Button, "Export film");
        assert!(!is_open(&lab), "{}", lab.state().log_text());
    }
}

#[test]
#[cfg(unix)]
fn videos_go_through_ffmpeg_or_a_sentence_says_that_it_is_missing() {
    use std::os::unix::fs::PermissionsExt as _;
    if crate::common::gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("ffmpeg");
    std::fs::write(
        &program,
        "#!/bin/sh\nfor last; do :; done\n/bin/cat > \"${last#file:}\"\n",
    )
    .expect("a file");
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).expect("a program");
    for path in [Path::new(""), folder.path()] {
        let child = std::process::Command::new(std::env::current_exe().expect("this test"))
            .args(["--exact", "films::child_that_exports_a_video", "--ignored"])
            .env("FILM_FOLDER", folder.path())
            .env("PATH", path)
            .output()
            .expect("the child starts");
        let said = String::from_utf8_lossy(&child.stdout).into_owned()
            + &String::from_utf8_lossy(&child.stderr);
        assert!(child.status.success(), "{said}");
    }
    let film = std::fs::metadata(folder.path().join("film.mp4")).expect("the film");
    assert_eq!(film.len(), 8 * 64 * 48 * 4, "ffmpeg got eight frames");
}
