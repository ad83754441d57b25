//! Promise: after a file of the open preset is reloaded, a badge says whether the preset still
//! gives its golden.

use std::path::Path;

use egui_kittest::kittest::Queryable as _;
use rasterlab::{oracle, preset_file};

use crate::{
    harness::*,
    live::{INK, write},
};

const PRESET: &str = "schema = 2\nname = \"Mine\"\n[scene]\nbuiltin = \"teapot\"\n[effects.ink]\n[output]\nsize = [64, 48]\n[test]\n";

fn badge(lab: &Lab) -> Option<String> {
    lab.query_all_by_label_contains("golden: ")
        .next()
        .and_then(|node| node.value().or_else(|| Some(format!("{node:?}"))))
}

/// Stores what the oracle draws of the preset.
fn bless(folder: &Path) {
    let drawn = preset_file::load(&folder.join("mine.toml")).expect("a preset");
    let scene = preset_file::load_scene(&drawn.preset, drawn.path.as_deref()).expect("a scene");
    let frame = oracle::render_sequence(&scene, &drawn.preset.moments(&scene, [64, 48]))
        .expect("a picture");
    std::fs::create_dir_all(folder.join("snapshots")).expect("a folder");
    std::fs::write(
        folder.join("snapshots/mine.png"),
        preset_file::png_bytes(&frame.color, [64, 48]).expect("a PNG"),
    )
    .expect("a file");
}

#[test]
fn a_reload_compares_the_golden_of_the_preset() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("effects/ink.wgsl");
    write(&file, INK);
    write(&folder.path().join("mine.toml"), PRESET);
    bless(folder.path());
    let Some(mut lab) = lab_of(folder.path(), PRESET) else {
        return;
    };
    assert_eq!(badge(&lab), None, "nothing was reloaded");

    // The golden is that of the file, so changes that are not saved do not matter.
    lab.state_mut().preset_mut().spin_deg_per_s = 90.0;
    lab.state_mut().preset_mut().output.size = [80, 80];
    write(&file, &format!("{INK}// The same.\n"));
    wait_for(&mut lab, "the golden is compared", |lab| {
        badge(lab).is_some()
    });
    assert!(
        lab.query_by_label("golden: same").is_some(),
        "{:?}\n{}",
        badge(&lab),
        lab.state().log_text()
    );

    write(
        &file,
        &INK.replace("vec4f(p.amount, 0.0,", "vec4f(0.0, p.amount,"),
    );
    wait_for(&mut lab, "the golden is compared again", |lab| {
        lab.query_by_label("golden: same").is_none() && badge(lab).is_some()
    });
    let differs = |lab: &Lab| {
        lab.query_all_by_label_contains("pixels differ, largest 255 of 255")
            .next()
            .is_some()
    };
    assert!(differs(&lab), "{:?}", badge(&lab));
    let badge = lab
        .query_all_by_label_contains("golden: ")
        .next()
        .expect("the badge");
    badge.hover();
    lab.run_steps(60);
    assert!(
        lab.query_all_by_label_contains("Judge > Review of goldens")
            .next()
            .is_some(),
        "hovering does not explain the badge"
    );
}

#[test]
fn a_preset_without_a_golden_has_no_badge() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("effects/ink.wgsl");
    write(&file, INK);
    let Some(mut lab) = lab_of(folder.path(), PRESET) else {
        return;
    };
    write(
        &file,
        &INK.replace("vec4f(p.amount, 0.0,", "vec4f(0.0, p.amount,"),
    );
    wait_for(&mut lab, "the edit is seen", |lab| {
        lab.state().log_text().contains("ink was reloaded")
    });
    assert_eq!(badge(&lab), None);
}
