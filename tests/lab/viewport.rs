//! Promise: the window shows the picture of the oracle, draws only when something changes, and
//! follows the pointer.

use std::time::Duration;

use egui::{self, Key, Modifiers, Pos2, Role, vec2};
use egui_kittest::kittest::Queryable as _;
use rasterlab::{
    oracle,
    preset::SceneSource,
    preset_file::{self, Folders},
};

use crate::harness::*;

#[test]
fn orbiting_is_one_undo_step_and_gives_the_preset_a_camera() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let before = lab.state().preset_file().preset.camera;
    let view = lab.get_by_label("Picture").rect();
    drag(&mut lab, view.center(), view.center() + vec2(120.0, 40.0));
    let after = lab.state().preset_file().preset.camera;
    assert!(after.is_some() && after != before);
    assert_eq!(lab.state().undo_steps(), 1);
    undo(&mut lab);
    assert_eq!(lab.state().preset_file().preset.camera, before);
}

#[test]
fn a_wheel_burst_is_one_undo_step() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let view = lab.get_by_label("Picture").rect();
    lab.hover_at(view.center());
    lab.step();
    for _ in 0..4 {
        lab.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: vec2(0.0, 30.0),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        });
        lab.step();
    }
    lab.run_steps(4);
    settle(&mut lab);
    assert_eq!(lab.state().undo_steps(), 1);
    assert!(lab.state().preset_file().preset.camera.is_some());
}

#[test]
fn undo_of_a_preset_brings_its_name_back() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let (id, preset) = (
        lab.state().preset_file().id.clone(),
        lab.state().preset_file().preset.clone(),
    );
    lab.get_by_label("Preset Cut knot").scroll_to_me();
    lab.run_steps(20);
    click(&mut lab, Role::Button, "Preset Cut knot");
    assert_eq!(lab.state().preset_file().id, "facet-knot");
    assert_eq!(lab.state().undo_steps(), 1);
    undo(&mut lab);
    assert_eq!(
        (
            &lab.state().preset_file().id,
            &lab.state().preset_file().preset
        ),
        (&id, &preset)
    );
    assert!(!lab.state().preset_file().is_modified());
}

#[test]
fn brackets_walk_through_the_gallery() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let mut presets = preset_file::gallery(&Folders::default());
    let title = |entry: &preset_file::GalleryEntry| {
        entry
            .preset_file
            .as_ref()
            .map_or(String::new(), |found| found.title().to_lowercase())
    };
    presets.sort_by_key(|entry| (title(entry), entry.id.clone()));
    let ids: Vec<String> = presets.into_iter().map(|entry| entry.id).collect();
    let here = ids
        .iter()
        .position(|id| id == "lambert")
        .expect("a preset of the gallery");
    press(&mut lab, Modifiers::NONE, Key::CloseBracket);
    assert_eq!(lab.state().preset_file().id, ids[here + 1]);
    press(&mut lab, Modifiers::NONE, Key::OpenBracket);
    press(&mut lab, Modifiers::NONE, Key::OpenBracket);
    assert_eq!(lab.state().preset_file().id, ids[here - 1]);
}

#[test]
fn an_idle_window_neither_draws_nor_asks_to_be_shown_again() {
    draw_pictures();
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let draws = lab.state().draws();
    // The pointer may move over the picture and the panels: nothing changes by it.
    for to in [
        Pos2::new(640.0, 400.0),
        Pos2::new(660.0, 420.0),
        Pos2::new(1100.0, 300.0),
        Pos2::new(100.0, 300.0),
    ] {
        lab.hover_at(to);
        lab.step();
    }
    lab.remove_cursor();
    // A job of the start may end meanwhile.
    wait_until(&mut lab, "a window that asks for nothing", |lab| {
        lab.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay == Duration::MAX
    });
    assert_eq!(lab.state().draws(), draws);
}

#[test]
fn a_scene_that_cannot_be_loaded_keeps_the_last_picture_and_is_reported_once() {
    draw_pictures();
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let draws = lab.state().draws();
    lab.state_mut().preset_mut().scene = SceneSource::Builtin("no-such-scene".into());
    lab.run_steps(3);
    settle(&mut lab);
    lab.run_steps(10);
    assert!(lab.state().has_picture());
    assert_eq!(lab.state().draws(), draws);
    let log = lab.state().log_text();
    let reports: Vec<_> = log
        .lines()
        .filter(|line| line.contains("no-such-scene"))
        .collect();
    assert!(matches!(reports[..], [one] if !one.contains('×')), "{log}");
    undo(&mut lab);
    assert_eq!(
        lab.state().preset_file().preset.scene,
        preset_file::open("lambert", &Folders::default())
            .unwrap()
            .preset
            .scene
    );
}

#[test]
fn a_picture_that_cannot_be_drawn_keeps_the_last_one_and_is_reported_once() {
    draw_pictures();
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let before = picture(&mut lab);
    lab.state_mut().preset_mut().camera = Some(rasterlab::scene::camera::Camera {
        eye: glam::DVec3::splat(1e13),
        ..Default::default()
    });
    lab.run_steps(2);
    settle(&mut lab);
    lab.run_steps(10);
    let log = lab.state().log_text();
    assert_eq!(
        log.lines().filter(|line| line.starts_with("error")).count(),
        1,
        "{log}"
    );
    assert!(log.lines().all(|line| !line.contains('×')), "{log}");
    let after = picture(&mut lab);
    let below = |image: &image::RgbaImage| {
        image::imageops::crop_imm(image, 0, 48, image.width(), image.height() - 150).to_image()
    };
    assert!(
        below(&before) == below(&after),
        "the last good picture went away"
    );
}

#[test]
fn the_window_shows_the_picture_of_the_oracle() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    let shown = picture(&mut lab);
    let preset = lab.state().preset_file().preset.clone();
    let scene = preset_file::load_scene(&preset, None).expect("a built-in scene");
    let view = lab
        .state()
        .view([shown.width(), shown.height()])
        .expect("a scene on stage");
    let factor = lab.state().drawn_scale().expect("a picture").factor();
    let expected = oracle::render_scaled(&scene, &[(view, preset.evaluated_stack())], factor)
        .expect("a picture");
    let pairs = shown
        .enumerate_pixels()
        .zip(&expected.color)
        .filter(|((x, y, _), _)| is_clear(&shown, *x, *y));
    let wrong = pairs
        .filter(|((.., a), b)| a.0.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1))
        .count();
    // A vertex may snap one unit apart; that moves a few edge pixels and no more.
    assert!(
        wrong <= 24,
        "{wrong} of {} pixels differ by more than 1",
        expected.color.len()
    );
    assert!(expected.covered() > 20_000);
}
