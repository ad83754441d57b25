//! Promise: the comparison shows a reference or a kept preset beside the live one, as a wipe, side
//! by side, or as their difference.

use egui::{Key, Modifiers, Role, vec2};
use egui_kittest::kittest::Queryable as _;

use crate::harness::*;

#[test]
fn the_wipe_shows_the_reference_on_its_left_and_is_dragged() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    let alone = middle(&mut lab);
    let (draws, preset) = (
        lab.state().draws(),
        lab.state().preset_file().preset.clone(),
    );
    assert!(lab.query_by_label("Wipe divider").is_none());
    press(&mut lab, Modifiers::SHIFT, Key::Backslash);
    assert_eq!(lab.state().wipe_split(), Some(0.5));
    // The reference of an exact picture is that picture.
    let wiped = middle(&mut lab);
    let differing = |a: &image::RgbaImage, b: &image::RgbaImage| {
        a.pixels().zip(b.pixels()).filter(|(a, b)| a != b).count()
    };
    let divider = 28 * alone.height() as usize;
    assert!(
        differing(&alone, &wiped) <= divider,
        "{} pixels differ",
        differing(&alone, &wiped)
    );
    assert_eq!(
        lab.query_all_by_label("– wrong pixels").count(),
        3,
        "in the bar and under both sides"
    );
    // A kept preset stays as it was while the live one changes.
    click(&mut lab, Role::Button, "Keep B");
    click(&mut lab, Role::Button, "Mute facet");
    let muted = middle(&mut lab);
    let (width, height) = alone.dimensions();
    let part = |image: &image::RgbaImage, from: u32, to: u32| {
        image::imageops::crop_imm(image, from, 0, to - from, height).to_image()
    };
    assert!(
        differing(
            &part(&muted, 0, width / 2 - 20),
            &part(&alone, 0, width / 2 - 20)
        ) == 0,
        "A changed"
    );
    assert!(
        differing(
            &part(&muted, width / 2 + 20, width),
            &part(&alone, width / 2 + 20, width)
        ) > 1000,
        "B did not"
    );
    let knob = lab
        .get_by_role_and_label(Role::Slider, "Wipe divider")
        .rect()
        .center();
    drag(&mut lab, knob, knob - vec2(0.25 * width as f32, 0.0));
    let split = lab.state().wipe_split().expect("a wipe");
    assert!((split - 0.25).abs() < 0.02, "{split}");
    let further = middle(&mut lab);
    assert!(
        differing(
            &part(&further, width / 4 + 20, width / 2 - 20),
            &part(&muted, width / 4 + 20, width / 2 - 20)
        ) > 100
    );
    assert_eq!(
        lab.state().preset_file().preset,
        preset,
        "comparing changes no preset"
    );
    assert!(lab.state().draws() > draws);
    click(&mut lab, Role::Button, "Close the comparison");
    assert_eq!(lab.state().wipe_split(), None);
    assert!(lab.query_by_label("Wipe divider").is_none());
}

#[test]
fn a_key_flips_between_a_and_b_and_both_sides_are_measured() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    press(&mut lab, Modifiers::SHIFT, Key::Backslash);
    click(&mut lab, Role::Button, "Keep B");
    click(&mut lab, Role::Button, "Mute facet");
    let wiped = middle(&mut lab);
    press(&mut lab, Modifiers::NONE, Key::Backslash);
    let a = middle(&mut lab);
    press(&mut lab, Modifiers::NONE, Key::Backslash);
    let b = middle(&mut lab);
    assert!(a != b && a != wiped && b != wiped);
    press(&mut lab, Modifiers::NONE, Key::Backslash);
    assert!(middle(&mut lab) == a);
    press(&mut lab, Modifiers::SHIFT, Key::Backslash);
    press(&mut lab, Modifiers::NONE, Key::V);
    assert_eq!(lab.query_all_by_label("– wrong pixels").count(), 0);
    assert!(
        lab.query_all_by_label_contains("no wrong pixel").count() >= 3,
        "in the bar and under both sides"
    );
}

/// Share of the middle of the picture that is darker than one step of 255 in every channel.
fn black(image: &image::RgbaImage) -> f64 {
    let dark = image
        .pixels()
        .filter(|pixel| pixel.0[..3].iter().all(|channel| *channel == 0))
        .count();
    dark as f64 / f64::from(image.width() * image.height())
}

#[test]
fn numbers_that_differ_are_keyed_from_a_to_b_in_one_undo_step() {
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    press(&mut lab, Modifiers::SHIFT, Key::Backslash);
    click(&mut lab, Role::Button, "Keep B");
    let before = lab.state().undo_steps();
    click(&mut lab, Role::Button, "Key A to B");
    assert!(
        lab.state().log_text().contains("no effect in common"),
        "{}",
        lab.state().log_text()
    );
    let rail = slider(&lab, "facet.front").rect();
    drag(
        &mut lab,
        rail.center(),
        rail.right_center() - vec2(10.0, 0.0),
    );
    click(&mut lab, Role::Button, "Key A to B");
    let preset = &lab.state().preset_file().preset;
    let track = preset.animation.get("facet", "front").expect("it is keyed");
    let [first, last] = [track.keys().first(), track.keys().last()].map(Option::unwrap);
    assert_eq!([first.time_s, last.time_s], preset.clock.range_s);
    assert!(
        (first.value[0] - 0.48).abs() < 1e-6 && last.value[0] > 0.6,
        "{track:?}"
    );
    assert_eq!(lab.state().undo_steps(), before + 2);
    undo(&mut lab);
    assert!(
        lab.state()
            .preset_file()
            .preset
            .animation
            .get("facet", "front")
            .is_none()
    );
}

#[test]
fn both_sides_stand_beside_each_other_and_their_difference_shows_what_changed() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    press(&mut lab, Modifiers::SHIFT, Key::Backslash);
    click(&mut lab, Role::Button, "Keep B");
    press(&mut lab, Modifiers::SHIFT, Key::Backslash);
    assert!(
        lab.query_by_label("Wipe divider").is_none(),
        "side by side has no divider"
    );
    // Twice the same picture: one half is as the other.
    let beside = middle(&mut lab);
    let (width, height) = beside.dimensions();
    let half = |image: &image::RgbaImage, from: u32| {
        image::imageops::crop_imm(image, from, height / 3, width / 2 - 8, height / 3).to_image()
    };
    let differing = |a: &image::RgbaImage, b: &image::RgbaImage| {
        a.pixels().zip(b.pixels()).filter(|(a, b)| a != b).count()
    };
    let same = differing(&half(&beside, 0), &half(&beside, width / 2));
    assert!(
        same * 20 < (width * height / 6) as usize,
        "{same} pixels of one half differ from the other's"
    );
    click(&mut lab, Role::Button, "Mute facet");
    let changed = middle(&mut lab);
    assert!(
        differing(&half(&changed, 0), &half(&changed, width / 2)) > same + 1000,
        "B did not change"
    );
    click(&mut lab, Role::Button, "Compare: difference");
    let apart = middle(&mut lab);
    assert!(lab.query_by_label("Difference gain").is_some());
    click(&mut lab, Role::Button, "Show facet");
    let none = middle(&mut lab);
    assert!(
        black(&none) > 0.8 && black(&apart) < black(&none) - 0.05,
        "{} and {} black",
        black(&apart),
        black(&none)
    );
    assert!(lab.query_by_label("A and B not compared yet").is_some());
    press(&mut lab, Modifiers::NONE, Key::V);
    assert!(
        lab.query_by_label("max \u{394} 0, RMS 0.000, 0 other triangles")
            .is_some(),
        "{}",
        lab.state().log_text()
    );
    press(&mut lab, Modifiers::SHIFT, Key::Backslash);
    assert!(
        lab.query_by_label("Difference gain").is_none()
            && lab.query_by_label("Compare: wipe").is_none(),
        "it is closed"
    );
}
