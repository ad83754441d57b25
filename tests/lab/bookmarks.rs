//! Promise: the inspector keeps cameras under names, goes back to them, renames and removes them,
//! each as one undo step, and keys and the palette reach them, too.

use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;
use rasterlab::preset::Preset;

use crate::harness::*;

const PLAIN: &str = "schema = 2\n[scene]\nbuiltin = \"knot?tess=4\"\n[camera]\n\
    eye = [0.0, 0.0, 6.0]\n[effects.lambert]\n";

fn preset(lab: &Lab) -> &Preset {
    &lab.state().preset_file().preset
}

fn names(lab: &Lab) -> Vec<&str> {
    let names = preset(lab).bookmarks.iter().map(|mark| mark.name.as_str());
    names.collect()
}

fn eye(lab: &Lab) -> [f64; 3] {
    preset(lab).camera.expect("it has one").eye.to_array()
}

#[test]
fn a_camera_is_kept_found_again_renamed_and_removed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), PLAIN) else {
        return;
    };
    lab.get_by_label("Camera").click();
    lab.run_steps(2);
    click(&mut lab, Role::Button, "Add bookmark");
    assert_eq!((names(&lab), lab.state().undo_steps()), (vec!["view 1"], 1));
    press(&mut lab, Modifiers::NONE, Key::Num7); // From above.
    let above = eye(&lab);
    assert!(above != [0.0, 0.0, 6.0]);
    press(&mut lab, Modifiers::SHIFT, Key::C);
    assert_eq!(names(&lab), ["view 1", "view 2"]);

    click(&mut lab, Role::Button, "Go to view 1");
    assert_eq!(eye(&lab), [0.0, 0.0, 6.0]);
    press(&mut lab, Modifiers::NONE, Key::C);
    assert_eq!(eye(&lab), above);

    let steps = lab.state().undo_steps();
    for (name, is_taken) in [("view 1", true), ("above", false)] {
        if is_taken {
            click(&mut lab, Role::Button, "Rename view 2");
        }
        let field = lab.get_by_role_and_label(Role::TextInput, "Name");
        field.focus();
        lab.run_steps(2);
        press(&mut lab, Modifiers::COMMAND, Key::A);
        lab.event(egui::Event::Text(name.into()));
        lab.run_steps(2);
        click(&mut lab, Role::Button, "Rename");
        let refused = lab.query_by_label_contains("Another bookmark is called");
        assert_eq!(refused.is_some(), is_taken, "{name}");
    }
    assert_eq!(names(&lab), ["view 1", "above"]);
    assert_eq!(lab.state().undo_steps(), steps + 1);

    click(&mut lab, Role::Button, "Remove view 1");
    assert_eq!(names(&lab), ["above"]);
    undo(&mut lab);
    assert_eq!(names(&lab), ["view 1", "above"]);

    press(&mut lab, Modifiers::COMMAND, Key::K);
    lab.event(egui::Event::Text("camera: view 1".into()));
    lab.run_steps(2);
    press(&mut lab, Modifiers::NONE, Key::Enter);
    assert_eq!(eye(&lab), [0.0, 0.0, 6.0]);
}
