//! Promise: presets whose picture is not their golden are queued beside the window; keys accept and
//! reject them, only the oracle's picture becomes a golden, and the queue comes back at the next
//! start.

use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;
use rasterlab::{
    golden,
    preset_file::{self, Folders, golden_paths},
};

use crate::{harness::*, live::write};

const PRESET: &str = "schema = 2\nname = \"Knot\"\n[scene]\nbuiltin = \"knot?tess=3\"\n[effects.lambert]\n[output]\nsize = [64, 48]\n[test]\n";

#[test]
fn the_queue_is_worked_through_by_keys_and_survives_a_restart() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let presets = folder.path().join("presets");
    // They come first in the gallery.
    let ids = ["0-first", "0-second"];
    for id in ids {
        write(&presets.join(format!("{id}.toml")), PRESET);
        let [png, _] = golden_paths(&presets.join("snapshots"), id);
        std::fs::create_dir_all(png.parent().expect("a folder")).expect("a folder");
        let gray = vec![[90, 90, 90, 255]; 64 * 48];
        let gray = preset_file::png_bytes(&gray, [64, 48]).expect("a PNG");
        std::fs::write(png, gray).expect("a file");
    }
    let config = folder.path().join("config");
    let window = || {
        let folders = Folders {
            presets: Some(presets.clone()),
            ..Folders::default()
        };
        let open = presets.join("0-first.toml");
        let open = open.to_string_lossy();
        let mut lab = created(Some(&open), folders, Some(config.clone()), SIZE)?;
        settle(&mut lab);
        press(&mut lab, Modifiers::SHIFT, Key::G);
        Some(lab)
    };
    let Some(mut lab) = window() else {
        return;
    };
    click(&mut lab, Role::Button, "Look for differences");
    let is_there = |lab: &Lab, text: &str| lab.query_all_by_label_contains(text).next().is_some();
    wait_for(&mut lab, "the second is queued", |lab| {
        lab.query_by_label("0-second").is_some()
    });
    if is_there(&lab, "Stop looking") {
        click(&mut lab, Role::Button, "Stop looking");
    }
    for mode in ["difference", "blink", "wipe"] {
        click(&mut lab, Role::Button, &format!("Review: {mode}"));
    }
    assert!(is_there(&lab, "of 3072 pixels differ, at most by"));

    press(&mut lab, Modifiers::NONE, Key::Y);
    wait_for(&mut lab, "the first is accepted", |lab| {
        lab.state().log_text().contains("Accepted the golden")
    });
    assert!(lab.query_by_label("0-first").is_none());
    let drawn = preset_file::load(&presets.join("0-first.toml")).expect("a preset");
    let scene = preset_file::load_scene(&drawn.preset, drawn.path.as_deref()).expect("a scene");
    let golden = golden::draw(&drawn, &scene).expect("a golden");
    let [png, sidecar] = golden_paths(&presets.join("snapshots"), "0-first");
    assert_eq!(std::fs::read(png).expect("it was written"), golden.png);
    assert!(sidecar.is_file());
    press(&mut lab, Modifiers::NONE, Key::X);
    assert!(is_there(&lab, "Rejected: the golden stays"));
    drop(lab);

    let mut lab = window().expect("it opened before");
    wait_for(&mut lab, "it is drawn again", |lab| {
        is_there(lab, "of 3072 pixels differ, at most by")
    });
    assert!(is_there(&lab, "Rejected: the golden stays"));
    assert!(lab.query_by_label("0-first").is_none());
    let kept = std::fs::read(&golden_paths(&presets.join("snapshots"), "0-second")[0]);
    assert!(kept.expect("it stays").len() < golden.png.len());
}
