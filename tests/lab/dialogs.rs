//! Promise: files are found and saved without a service of the desktop: paths are completed, recent
//! files are listed, and a save that fails keeps its dialog with the path and the reason.

use std::time::Duration;

use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};

use crate::{files::tiny_glb, harness::*};

fn path_of(lab: &Lab) -> String {
    lab.get_by_role_and_label(Role::TextInput, "Path")
        .accesskit_node()
        .value()
        .unwrap_or_default()
}

#[test]
fn tab_completes_a_path_and_enter_goes_into_folders_and_opens_files() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let models = folder.path().join("models");
    std::fs::create_dir(&models).expect("a folder");
    std::fs::write(models.join("triangle.glb"), tiny_glb()).expect("a file");
    std::fs::write(models.join("notes.txt"), "").expect("a file");
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    press(&mut lab, Modifiers::COMMAND, Key::O);
    type_text(&mut lab, &format!("{}/mod", folder.path().display()));
    wait_for(&mut lab, "the folder is listed", |lab| {
        lab.query_by_label("models/").is_some()
    });
    press(&mut lab, Modifiers::NONE, Key::Tab);
    assert_eq!(path_of(&lab), format!("{}/", models.display()));
    wait_for(&mut lab, "the folder is listed", |lab| {
        lab.query_by_label("triangle.glb").is_some()
    });
    assert!(
        lab.query_by_label("notes.txt").is_none(),
        "a file that cannot be opened is listed"
    );
    type_text(&mut lab, "tr");
    press(&mut lab, Modifiers::NONE, Key::Tab);
    assert_eq!(
        path_of(&lab),
        models.join("triangle.glb").display().to_string()
    );
    press(&mut lab, Modifiers::NONE, Key::Enter);
    settle(&mut lab);
    assert_eq!(lab.state().preset_file().title(), "Daylight on triangle");
    assert!(
        lab.query_by_role_and_label(Role::TextInput, "Path")
            .is_none()
    );

    // The file is recent now. The arrow keys choose it.
    press(&mut lab, Modifiers::NONE, Key::CloseBracket);
    press(&mut lab, Modifiers::COMMAND, Key::O);
    wait_for(&mut lab, "the recent file is listed", |lab| {
        lab.query_by_label("triangle.glb").is_some()
    });
    press(&mut lab, Modifiers::NONE, Key::ArrowDown);
    press(&mut lab, Modifiers::NONE, Key::Enter);
    settle(&mut lab);
    let title = lab.state().preset_file().title();
    assert!(
        title.ends_with(" on triangle") && title != "Daylight on triangle",
        "{title}"
    );
}

#[test]
fn a_save_that_fails_keeps_the_dialog_its_path_and_the_reason() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "in the way").expect("a file");
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    press(&mut lab, Modifiers::COMMAND, Key::A);
    let path = file.join("mine.toml");
    type_text(&mut lab, &path.display().to_string());
    press(&mut lab, Modifiers::NONE, Key::Enter);
    assert_eq!(path_of(&lab), path.display().to_string());
    assert!(
        lab.query_by_label_contains("the folder cannot be created")
            .is_some(),
        "{}",
        lab.state().log_text()
    );
    // Another name, and it is saved.
    press(&mut lab, Modifiers::COMMAND, Key::A);
    let path = folder.path().join("mine.toml");
    type_text(&mut lab, &path.display().to_string());
    press(&mut lab, Modifiers::NONE, Key::Enter);
    assert!(
        path.exists()
            && lab
                .query_by_role_and_label(Role::TextInput, "Path")
                .is_none()
    );
}

#[test]
fn an_export_that_fails_keeps_its_size() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "in the way").expect("a file");
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    press(&mut lab, Modifiers::COMMAND, Key::E);
    press(&mut lab, Modifiers::COMMAND, Key::A);
    type_text(&mut lab, &file.join("mine.png").display().to_string());
    // What is below the list moves when the folder is listed.
    for _ in 0..20 {
        lab.step();
        std::thread::sleep(Duration::from_millis(10));
    }
    let width = |lab: &Lab| {
        lab.get_by_label("Width of the picture")
            .accesskit_node()
            .value()
            .unwrap_or_default()
    };
    lab.get_by_label("Width of the picture").click();
    lab.run_steps(3);
    press(&mut lab, Modifiers::COMMAND, Key::A);
    type_text(&mut lab, "123");
    assert_eq!(
        path_of(&lab),
        file.join("mine.png").display().to_string(),
        "the number was typed into the path"
    );
    press(&mut lab, Modifiers::NONE, Key::Enter);
    let typed = width(&lab);
    assert!(typed.contains("123"), "{typed}");
    lab.get_by_role_and_label(Role::Button, "Save").click();
    wait_for(&mut lab, "the export fails", |lab| {
        !error_lines(lab).is_empty()
    });
    lab.run_steps(3);
    assert_eq!(
        (path_of(&lab), width(&lab)),
        (file.join("mine.png").display().to_string(), typed)
    );
}

#[test]
fn the_first_save_of_a_built_in_preset_asks_for_a_name_and_writes_nothing_before() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let files = || std::fs::read_dir(folder.path()).expect("a folder").count();
    let Some(mut lab) = lab_in("lambert", Some(folder.path())) else {
        return;
    };
    for (modifiers, name) in [
        (Modifiers::COMMAND, "mine"),
        (Modifiers::COMMAND | Modifiers::SHIFT, "other"),
    ] {
        let before = files();
        press(&mut lab, modifiers, Key::S);
        assert_eq!(files(), before, "it is saved before a name is given");
        let proposed = if name == "mine" {
            "my-lambert.toml"
        } else {
            "mine.toml"
        };
        assert_eq!(
            path_of(&lab),
            folder.path().join(proposed).display().to_string()
        );
        press(&mut lab, Modifiers::NONE, Key::Escape);
        assert_eq!(files(), before, "Escape saves");
        press(&mut lab, modifiers, Key::S);
        type_text(&mut lab, name);
        press(&mut lab, Modifiers::NONE, Key::Enter);
        assert!(
            folder.path().join(format!("{name}.toml")).exists()
                && lab.state().preset_file().id == name,
            "{}",
            lab.state().log_text()
        );
    }
    // It has a name now, so that it is saved there.
    press(&mut lab, Modifiers::COMMAND, Key::S);
    assert!(
        lab.query_by_role_and_label(Role::TextInput, "Path")
            .is_none()
    );
}

#[test]
fn typing_replaces_the_proposed_name_and_keeps_folder_and_extension() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_in("lambert", Some(folder.path())) else {
        return;
    };
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    type_text(&mut lab, "evening");
    assert_eq!(
        path_of(&lab),
        folder.path().join("evening.toml").display().to_string()
    );
    press(&mut lab, Modifiers::COMMAND, Key::A);
    type_text(&mut lab, &folder.path().display().to_string());
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(!folder.path().join("evening.toml").exists());
}

#[test]
fn a_whole_path_in_place_of_the_proposed_name_replaces_the_folder_too() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let presets = folder.path().join("presets");
    let Some(mut lab) = lab_in("lambert", Some(&presets)) else {
        return;
    };
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    let path = folder.path().join("mine.toml");
    // Letter by letter, as it is typed.
    for letter in path.display().to_string().chars() {
        type_text(&mut lab, &letter.to_string());
    }
    assert!(
        path_of(&lab).starts_with(&path.display().to_string()),
        "{}",
        path_of(&lab)
    );
    press(&mut lab, Modifiers::NONE, Key::Enter);
    assert!(
        path.exists() && !presets.exists(),
        "{}",
        lab.state().log_text()
    );

    // Pasted at once.
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    let other = folder.path().join("other");
    type_text(&mut lab, &other.display().to_string());
    assert_eq!(path_of(&lab), format!("{}.toml", other.display()));
    press(&mut lab, Modifiers::NONE, Key::Enter);
    assert!(
        other.with_extension("toml").exists(),
        "{}",
        lab.state().log_text()
    );
}

/// Run by the next test in a separate process, which has no desktop.
#[test]
#[ignore = "run by without_a_desktop_the_dialog_says_so_and_works"]
fn child_without_a_desktop() {
    let mut lab = lab("lambert").expect("the parent has an adapter");
    press(&mut lab, Modifiers::COMMAND, Key::O);
    if let Some(browse) = lab.query_by_role_and_label(Role::Button, "Browse…") {
        browse.click();
    }
    wait_for(&mut lab, "the dialog says that there is no other", |lab| {
        lab.query_by_label_contains("The system's file dialog is not available")
            .is_some()
    });
    assert!(
        lab.query_by_role_and_label(Role::Button, "Browse…")
            .is_none()
    );
    press(&mut lab, Modifiers::NONE, Key::Escape);
}

#[cfg(target_os = "linux")]
#[test]
fn without_a_desktop_the_dialog_says_so_and_works() {
    if crate::common::gpu().is_none() {
        return;
    }
    let home = tempfile::tempdir().expect("a temporary folder");
    // With an address of a bus that is not there, the library is asked; without one it need not be.
    for bus in ["unix:path=/nowhere/bus", ""] {
        let child = std::process::Command::new(std::env::current_exe().expect("this test"))
            .args(["--exact", "dialogs::child_without_a_desktop", "--ignored"])
            .env("XDG_CONFIG_HOME", home.path())
            .env("XDG_RUNTIME_DIR", home.path())
            .env("DBUS_SESSION_BUS_ADDRESS", bus)
            .env("PATH", "/nowhere")
            .output()
            .expect("the child starts");
        let said = String::from_utf8_lossy(&child.stdout).into_owned()
            + &String::from_utf8_lossy(&child.stderr);
        assert!(child.status.success(), "{said}");
    }
}
