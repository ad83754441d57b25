//! Promise: what the user has set up is there again at the next start: theme, size, keys, panels,
//! recent files, and the open preset with its unsaved edits; the user's own configuration is never
//! touched by tests.

use std::path::Path;

use egui::{Event, Key, Modifiers, Pos2, Rect, Role, Theme, ViewportId, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use rasterlab::preset_file::Folders;

use crate::{files::tiny_glb, harness::*};

/// A window with `config` as its folder of settings.
fn lab_at(config: &Path, open: Option<&str>) -> Option<Lab> {
    let mut lab = created(open, Folders::default(), Some(config.to_owned()), SIZE)?;
    settle(&mut lab);
    Some(lab)
}

fn settings_text(config: &Path) -> String {
    std::fs::read_to_string(config.join("settings.toml")).unwrap_or_default()
}

fn press_event(key: Key, modifiers: Modifiers) -> Event {
    Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    }
}

#[test]
fn theme_size_keys_and_panels_are_there_at_the_next_start() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_at(folder.path(), Some("facet-knot")) else {
        return;
    };
    assert_eq!(lab.ctx.theme(), Theme::Dark);
    press(&mut lab, Modifiers::NONE, Key::L); // The log.
    press(&mut lab, Modifiers::COMMAND, Key::Plus);
    press(&mut lab, Modifiers::COMMAND, Key::Comma);
    click(&mut lab, Role::Button, "Light");
    assert_eq!(lab.ctx.theme(), Theme::Light);
    click(&mut lab, Role::Button, "Keys of Randomize effects");
    lab.input_mut()
        .events
        .push(press_event(Key::J, Modifiers::NONE));
    lab.run_steps(4);
    drop(lab);
    let text = settings_text(folder.path());
    for line in [
        "theme = \"light\"",
        "scale = 1.1",
        "log = true",
        "randomize = [\"J\"]",
    ] {
        assert!(text.contains(line), "{line}\n{text}");
    }

    let Some(mut lab) = lab_at(folder.path(), Some("facet-knot")) else {
        return;
    };
    assert_eq!(
        (lab.ctx.theme(), lab.ctx.zoom_factor()),
        (Theme::Light, 1.1)
    );
    assert!(
        lab.query_by_label("Clear the log").is_some(),
        "the log is open"
    );
    press(&mut lab, Modifiers::NONE, Key::R);
    assert!(
        !lab.state().log_text().contains("Randomized"),
        "R was bound to nothing"
    );
    press(&mut lab, Modifiers::NONE, Key::J);
    assert!(lab.state().log_text().contains("Randomized"));
}

/// Where the side panels end, points.
fn borders(lab: &Lab) -> [f32; 2] {
    let picture = lab.get_by_label("Picture").rect();
    [picture.left(), picture.right()]
}

#[test]
fn widths_of_the_panels_and_the_size_of_the_window_are_there_at_the_next_start() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_at(folder.path(), Some("facet-knot")) else {
        return;
    };
    let before = borders(&lab);
    for (border, grip, by) in [(0, -2.0, 70.0), (1, 2.0, -60.0)] {
        let from = Pos2::new(borders(&lab)[border] + grip, 400.0);
        drag(&mut lab, from, from + vec2(by, 0.0));
    }
    let dragged = borders(&lab);
    assert!(
        dragged[0] > before[0] + 40.0 && dragged[1] < before[1] - 30.0,
        "{before:?} became {dragged:?}"
    );
    let window = lab
        .input_mut()
        .viewports
        .entry(ViewportId::ROOT)
        .or_default();
    window.inner_rect = Some(Rect::from_min_size(
        Pos2::new(10.0, 20.0),
        vec2(1111.0, 777.0),
    ));
    lab.run_steps(2);
    drop(lab);
    let text = settings_text(folder.path());
    assert!(text.contains("1111") && text.contains("777"), "{text}");
    let Some(lab) = lab_at(folder.path(), Some("facet-knot")) else {
        return;
    };
    let again = borders(&lab);
    assert!(
        again.iter().zip(dragged).all(|(a, b)| (a - b).abs() < 2.0),
        "{dragged:?} became {again:?}"
    );
}

#[test]
fn a_key_of_another_action_is_refused_in_words_and_reset_brings_the_own_keys_back() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    press(&mut lab, Modifiers::COMMAND, Key::Comma);
    click(&mut lab, Role::Button, "Keys of Randomize effects");
    // It is bound, not carried out.
    lab.input_mut()
        .events
        .push(press_event(Key::V, Modifiers::NONE));
    lab.run_steps(4);
    assert!(
        lab.state()
            .log_text()
            .contains("V belongs to \"Verify against the oracle\""),
        "{}",
        lab.state().log_text()
    );
    click(&mut lab, Role::Button, "Keys of Randomize effects");
    lab.input_mut()
        .events
        .push(press_event(Key::J, Modifiers::NONE));
    lab.run_steps(4);
    click(&mut lab, Role::Button, "Reset keys of Randomize effects");
    press(&mut lab, Modifiers::NONE, Key::Escape);
    press(&mut lab, Modifiers::NONE, Key::J);
    assert!(!lab.state().log_text().contains("Randomized"));
    press(&mut lab, Modifiers::NONE, Key::R);
    assert!(lab.state().log_text().contains("Randomized"));
    assert!(
        !lab.state().log_text().contains("verified"),
        "{}",
        lab.state().log_text()
    );
}

#[test]
fn recent_files_open_again_and_missing_ones_are_greyed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let [model, preset] = ["tri.glb", "moving.toml"].map(|name| folder.path().join(name));
    std::fs::write(&model, tiny_glb()).expect("a file");
    std::fs::write(&preset, MOVING).expect("a file");
    let config = folder.path().join("config");
    let Some(mut lab) = lab_at(&config, Some("lambert")) else {
        return;
    };
    crate::files::drop_files(&mut lab, &[&preset]);
    crate::files::drop_files(&mut lab, &[&model]);
    drop(lab);
    std::fs::remove_file(&model).expect("it is there");

    let Some(mut lab) = lab_at(&config, Some("lambert")) else {
        return;
    };
    lab.get_by_role_and_label(Role::Button, "File").click();
    lab.run_steps(4);
    lab.get_by_label_contains("Open recent").click();
    lab.run_steps(4);
    let recent = |lab: &Lab, name: &str| {
        lab.get_by_role_and_label(Role::Button, name)
            .accesskit_node()
            .is_disabled()
    };
    let patience = std::time::Instant::now() + std::time::Duration::from_secs(120);
    while !recent(&lab, "Recent tri.glb") {
        assert!(
            std::time::Instant::now() < patience,
            "a missing file is not greyed"
        );
        lab.step();
    }
    assert!(!recent(&lab, "Recent moving.toml"));
    lab.get_by_role_and_label(Role::Button, "Recent moving.toml")
        .click();
    lab.run_steps(3);
    settle(&mut lab);
    assert_eq!(lab.state().preset_file().id, "moving");
}

/// Edits that are kept for the next start, as *Keep for the next start* keeps them.
fn edit(lab: &mut Lab) -> Vec<f64> {
    let rail = slider(lab, "facet.amount").rect();
    drag(lab, rail.right_center() - vec2(8.0, 0.0), rail.center());
    value(lab, "facet", "amount")
}

#[test]
fn the_open_preset_comes_back_with_its_edits_and_the_command_line_wins() {
    let config = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_at(config.path(), Some("facet-sweep")) else {
        return;
    };
    let amount = edit(&mut lab);
    drop(lab);

    let Some(mut lab) = lab_at(config.path(), None) else {
        return;
    };
    assert_eq!(lab.state().preset_file().id, "facet-sweep");
    assert_eq!(value(&lab, "facet", "amount"), amount);
    assert!(
        lab.query_by_label("unsaved").is_some(),
        "the edits are still unsaved"
    );
    // Discarded edits do not come back.
    lab.input_mut()
        .viewports
        .entry(egui::ViewportId::ROOT)
        .or_default()
        .events
        .push(egui::ViewportEvent::Close);
    lab.run_steps(4);
    click(&mut lab, Role::Button, "Discard");
    drop(lab);
    let Some(lab) = lab_at(config.path(), None) else {
        return;
    };
    assert_eq!(lab.state().preset_file().id, "facet-sweep");
    assert_ne!(value(&lab, "facet", "amount"), amount);
    drop(lab);
    let Some(lab) = lab_at(config.path(), Some("lambert")) else {
        return;
    };
    assert_eq!(lab.state().preset_file().id, "lambert");
}

#[test]
fn after_a_crash_the_window_asks() {
    let config = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_at(config.path(), Some("facet-sweep")) else {
        return;
    };
    let amount = edit(&mut lab);
    drop(lab);
    // As a crash leaves it.
    let path = config.path().join("session.toml");
    let text = std::fs::read_to_string(&path).expect("a session");
    assert!(text.contains("running = false"), "{text}");
    std::fs::write(&path, text.replace("running = false", "running = true")).expect("a file");

    let Some(mut lab) = lab_at(config.path(), None) else {
        return;
    };
    assert_ne!(lab.state().preset_file().id, "facet-sweep", "it asks first");
    press(&mut lab, Modifiers::NONE, Key::Escape);
    click(&mut lab, Role::Button, "Open it again");
    assert_eq!(
        (
            lab.state().preset_file().id.as_str(),
            value(&lab, "facet", "amount")
        ),
        ("facet-sweep", amount.clone())
    );
    assert!(lab.query_by_label("unsaved").is_some());
}

#[test]
fn broken_settings_are_one_line_of_the_log_and_the_window_opens() {
    let config = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(config.path().join("settings.toml"), "theme = = \"light\"\n").expect("a file");
    std::fs::write(config.path().join("session.toml"), "nonsense").expect("a file");
    let Some(lab) = lab_at(config.path(), Some("lambert")) else {
        return;
    };
    let log = lab.state().log_text();
    assert_eq!(
        log.lines()
            .filter(|line| line.contains("settings.toml, line 1"))
            .count(),
        1,
        "{log}"
    );
    assert_eq!(lab.ctx.theme(), Theme::Dark);
    drop(lab);
    let aside = std::fs::read_to_string(config.path().join("settings.toml.broken"));
    assert_eq!(aside.expect("it is kept"), "theme = = \"light\"\n");
    let Some(lab) = lab_at(config.path(), None) else {
        return;
    };
    assert!(lab.state().has_picture());
}

/// As in a home that is read-only; a file in the folder's place stops root too.
#[test]
fn without_a_folder_for_settings_the_window_says_so_once_and_works() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "no folder").expect("a file");
    let config = file.join("rasterlab");
    let Some(mut lab) = lab_at(&config, Some("facet-sweep")) else {
        return;
    };
    assert!(lab.state().has_picture());
    let amount = edit(&mut lab);
    press(&mut lab, Modifiers::COMMAND, Key::Comma);
    click(&mut lab, Role::Button, "Light");
    press(&mut lab, Modifiers::NONE, Key::Escape);
    for _ in 0..200 {
        lab.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert_eq!(
        (lab.ctx.theme(), value(&lab, "facet", "amount")),
        (Theme::Light, amount)
    );
    let log = lab.state().log_text();
    let said: Vec<&str> = log
        .lines()
        .filter(|line| line.contains(&*config.to_string_lossy()))
        .collect();
    // Of the settings that are read, of the session, and of the settings that are written: a
    // sentence each, once.
    assert!(
        (1..=3).contains(&said.len())
            && said
                .iter()
                .all(|line| line.starts_with("warning") && !line.contains(" ×")),
        "{said:#?}"
    );
    drop(lab);
    assert_eq!(
        std::fs::read_to_string(&file).expect("the file"),
        "no folder"
    );
}
