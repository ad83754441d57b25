//! Promise: what is typed into a text field or a search is text, from the first letter after the
//! key that opened it, and never a shortcut.

use std::time::{Duration, Instant};

use egui::{Event, Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};

use crate::harness::*;

/// The events of typing `text`, as a window system sends them.
fn typed(text: &str) -> Vec<Event> {
    let key = |name: char| Key::from_name(&name.to_uppercase().to_string());
    text.chars()
        .flat_map(|c| {
            key(c)
                .map(|key| pressed(key, Modifiers::NONE))
                .into_iter()
                .chain([Event::Text(c.to_string())])
        })
        .collect()
}

fn pressed(key: Key, modifiers: Modifiers) -> Event {
    Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    }
}

/// Sends all events in one frame.
fn send(lab: &mut Lab, events: Vec<Event>) {
    lab.input_mut().events.extend(events);
    lab.run_steps(6);
    settle(lab);
}

fn text_of(lab: &Lab, field: &str) -> String {
    lab.get_by_role_and_label(Role::TextInput, field)
        .accesskit_node()
        .value()
        .unwrap_or_default()
}

#[test]
fn words_typed_into_the_cheat_sheet_search_it_and_do_nothing_else() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    let before = lab.state().preset_file().preset.clone();
    press(&mut lab, Modifiers::NONE, Key::F1);
    // O shows overlays, V verifies, R randomizes.
    send(&mut lab, typed("over"));
    assert_eq!(text_of(&lab, "Search actions and keys"), "over");
    assert!(
        lab.query_all_by_label("Show or hide overlays").count() == 2
            && lab.query_by_label("Randomize effects").is_none()
    );
    assert_eq!(
        lab.state().preset_file().preset,
        before,
        "typing changed the preset"
    );
    assert!(
        !lab.state().log_text().contains("verified") && !lab.state().log_text().contains("seed"),
        "{}",
        lab.state().log_text()
    );

    // A click beside the field does not make typing dangerous, and F1 and Escape close the sheet.
    let view = lab.get_by_label("Picture").rect();
    lab.drop_at(view.left_bottom() + egui::vec2(30.0, -60.0));
    lab.run_steps(3);
    send(&mut lab, typed("r"));
    assert_eq!(
        (
            text_of(&lab, "Search actions and keys").as_str(),
            &lab.state().preset_file().preset
        ),
        ("overr", &before)
    );
    // With Ctrl a letter is no text: it acts, and what is typed then goes into the dialog alone.
    send(
        &mut lab,
        [vec![pressed(Key::O, Modifiers::COMMAND)], typed("rover")].concat(),
    );
    let [path, search] = ["Path", "Search actions and keys"].map(|field| text_of(&lab, field));
    assert_eq!([path.as_str(), &search], ["rover", "overr"]);
    press(&mut lab, Modifiers::NONE, Key::Escape);
    send(&mut lab, typed("s"));
    assert_eq!(text_of(&lab, "Search actions and keys"), "overrs");
    press(&mut lab, Modifiers::NONE, Key::F1);
    assert!(
        lab.query_by_role_and_label(Role::TextInput, "Search actions and keys")
            .is_none()
    );
    press(&mut lab, Modifiers::NONE, Key::F1);
    assert_eq!(
        text_of(&lab, "Search actions and keys"),
        "",
        "the search begins anew"
    );
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(
        lab.query_by_role_and_label(Role::TextInput, "Search actions and keys")
            .is_none()
    );
}

#[test]
fn letters_typed_while_a_dialog_opens_are_in_its_field() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    let before = lab.state().preset_file().preset.clone();
    // All in one frame, as a fast typist on a slow machine has it, with a key before.
    let opens = vec![pressed(Key::O, Modifiers::COMMAND)];
    send(&mut lab, [typed("j"), opens, typed("rover")].concat());
    assert_eq!(text_of(&lab, "Path"), "rover");
    assert_eq!(lab.state().preset_file().preset, before);
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(
        lab.query_by_role_and_label(Role::TextInput, "Path")
            .is_none()
    );

    // Over two frames, of which the second is the first that shows the dialog.
    lab.input_mut()
        .events
        .push(pressed(Key::O, Modifiers::COMMAND));
    lab.step();
    lab.input_mut().events.extend(typed("rov"));
    lab.step();
    lab.input_mut().events.extend(typed("er"));
    lab.run_steps(6);
    assert_eq!(text_of(&lab, "Path"), "rover");
    assert_eq!(lab.state().preset_file().preset, before);
    press(&mut lab, Modifiers::NONE, Key::Escape);

    // The character of the key that opens the cheat sheet is no search.
    send(
        &mut lab,
        [
            vec![
                pressed(Key::Questionmark, Modifiers::SHIFT),
                Event::Text("?".into()),
            ],
            typed("log"),
        ]
        .concat(),
    );
    assert_eq!(text_of(&lab, "Search actions and keys"), "log");
    assert_eq!(
        (&lab.state().preset_file().preset, error_lines(&lab)),
        (&before, vec![])
    );
}

/// The key that saves opens a dialog only for a preset without a file.
#[test]
fn letters_typed_for_a_dialog_that_does_not_open_do_not_come_into_the_next() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(
        folder.path(),
        "schema = 2\n[scene]\nbuiltin = \"teapot?tess=4\"\n[effects.facet]\n",
    ) else {
        return;
    };
    let before = lab.state().preset_file().preset.clone();
    send(
        &mut lab,
        [vec![pressed(Key::S, Modifiers::COMMAND)], typed("rover")].concat(),
    );
    assert!(
        lab.query_by_role_and_label(Role::TextInput, "Path")
            .is_none()
    );
    send(&mut lab, vec![pressed(Key::O, Modifiers::COMMAND)]);
    assert_eq!(text_of(&lab, "Path"), "");
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert_eq!(
        (&lab.state().preset_file().preset, error_lines(&lab)),
        (&before, vec![])
    );
}

/// A dialog that comes back after a failed save is shown one frame before its field has the focus.
#[test]
fn a_letter_typed_in_the_frame_in_which_a_dialog_comes_back_is_in_its_field() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "in the way").expect("a file");
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    press(&mut lab, Modifiers::COMMAND, Key::E);
    press(&mut lab, Modifiers::COMMAND, Key::A);
    let path = file.join("mine.png").display().to_string();
    lab.event(Event::Text(path.clone()));
    // The button moves when the folder is listed.
    for _ in 0..20 {
        lab.step();
        std::thread::sleep(Duration::from_millis(10));
    }
    lab.get_by_role_and_label(Role::Button, "Save").click();
    let is_gone = |lab: &Lab| {
        lab.query_by_role_and_label(Role::TextInput, "Path")
            .is_none()
    };
    if !(0..20).any(|_| {
        lab.step();
        is_gone(&lab)
    }) {
        return; // It was back before a frame without it was shown.
    }
    let patience = Instant::now() + Duration::from_secs(60);
    loop {
        lab.event(Event::Text("z".into())); // No shortcut.
        lab.step();
        if !is_gone(&lab) {
            break;
        }
        assert!(
            Instant::now() < patience,
            "the dialog does not come back\n{}",
            lab.state().log_text()
        );
    }
    lab.run_steps(4);
    let shown = text_of(&lab, "Path");
    assert_eq!(
        (shown.len(), shown.matches('z').count()),
        (path.len() + 1, path.matches('z').count() + 1),
        "{shown}"
    );
}
