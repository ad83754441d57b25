//! Promise: what a picture needs is compiled beside the window. The tick of an effect shows at
//! once, the last picture stays, words name what is compiled, a newer request takes its place, and
//! the window does not wait.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use egui::{Pos2, Role, Shape};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use rasterlab::app::Devices;

use crate::harness::*;

/// The lower part of the picture, where nothing is written over it.
fn drawn(lab: &mut Lab) -> image::RgbaImage {
    let whole = middle(lab);
    image::imageops::crop_imm(&whole, 0, 64, whole.width(), whole.height() - 64).to_image()
}

/// Adds an effect, or clicks the box of one that is in the stack, and shows the window once.
pub fn tick(lab: &mut Lab, effect: &str) {
    if lab
        .query_by_role_and_label(Role::CheckBox, effect)
        .is_none()
    {
        return begin_adding(lab, effect);
    }
    lab.get_by_role_and_label(Role::CheckBox, effect)
        .scroll_to_me();
    lab.run_steps(3);
    lab.get_by_role_and_label(Role::CheckBox, effect).click();
    lab.step();
}

fn is_ticked(lab: &Lab, effect: &str) -> bool {
    let node = lab.get_by_role_and_label(Role::CheckBox, effect);
    format!("{:?}", node.accesskit_node().toggled()) == "Some(True)"
}

/// Shows the window until the thread of the picture says that it compiles.
pub fn until_compiling(lab: &mut Lab) -> String {
    let patience = Instant::now() + Duration::from_secs(60);
    loop {
        lab.step();
        let text = lab.state().compiling();
        // The words come with the next frame, or later where the machine has other work.
        if let Some(text) = text.filter(|text| lab.query_by_label(text).is_some()) {
            return text;
        }
        assert!(
            Instant::now() < patience,
            "nothing is compiled\n{}",
            lab.state().log_text()
        );
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Where the dot of the spinner left of this label is.
fn spinner(lab: &Lab, label: &str) -> Option<Pos2> {
    let words = lab.get_by_label(label).rect();
    lab.output()
        .shapes
        .iter()
        .find_map(|clipped| match &clipped.shape {
            Shape::Circle(circle) if (circle.center.y - words.center().y).abs() < 12.0 => {
                let left = words.left() - circle.center.x;
                ((0.0..40.0).contains(&left) && circle.radius < 4.0).then_some(circle.center)
            }
            _ => None,
        })
}

#[test]
fn the_window_goes_on_while_the_kernels_of_an_effect_are_compiled() {
    draw_pictures();
    let Some(mut lab) = lab_on_new_devices("lambert") else {
        return;
    };
    let (before, draws) = (drawn(&mut lab), lab.state().draws());
    // Compiling takes as long as the test wants; a window that waits for it would never come back.
    lab.state_mut().hold_compiling(true);
    let begun = Instant::now();
    tick(&mut lab, "hatch");
    lab.step();
    assert!(is_ticked(&lab, "hatch"), "the tick waits for the kernels");
    assert_eq!(until_compiling(&mut lab), "Compiling hatch…");
    assert!(
        begun.elapsed() < Duration::from_secs(15),
        "a few frames took {:?}",
        begun.elapsed()
    );
    assert!(
        lab.query_by_label("Compiling hatch…").is_some(),
        "the window does not say it"
    );
    let mut dots = Vec::new();
    for _ in 0..8 {
        lab.step();
        dots.extend(spinner(&lab, "Compiling hatch…").filter(|dot| !dots.contains(dot)));
    }
    assert!(dots.len() >= 2, "nothing turns beside the words: {dots:?}");
    assert!(!lab.state().is_idle());
    assert_eq!(drawn(&mut lab), before, "the last picture went away");
    lab.run_steps(40);
    assert_eq!(lab.state().draws(), draws, "something was drawn");
    // What else is asked for meanwhile is taken.
    tick(&mut lab, "posterize");
    lab.step();
    assert!(is_ticked(&lab, "posterize"));
    lab.run_steps(4); // The step is closed when nothing has changed for a while.
    assert_eq!(lab.state().undo_steps(), 2);
    assert_eq!(drawn(&mut lab), before);

    lab.state_mut().hold_compiling(false);
    settle(&mut lab);
    assert_eq!(lab.state().compiling(), None);
    assert!(lab.query_by_label_contains("Compiling").is_none());
    assert_ne!(drawn(&mut lab), before, "the effects are not to be seen");
    assert_eq!(error_lines(&lab), [""; 0]);
}

#[test]
fn an_effect_that_is_taken_back_while_it_is_compiled_is_never_drawn() {
    draw_pictures();
    let Some(mut lab) = lab_on_new_devices("lambert") else {
        return;
    };
    let before = drawn(&mut lab);
    lab.state_mut().hold_compiling(true);
    tick(&mut lab, "toon");
    assert_eq!(until_compiling(&mut lab), "Compiling toon…");
    tick(&mut lab, "toon");
    lab.run_steps(2);
    assert!(
        lab.query_by_label_contains("Compiling toon").is_none(),
        "it is not wanted any more"
    );
    lab.state_mut().hold_compiling(false);
    let patience = Instant::now() + Duration::from_secs(60);
    while !lab.state().is_idle() {
        assert_eq!(
            drawn(&mut lab),
            before,
            "an effect that was taken back is shown"
        );
        assert!(
            Instant::now() < patience,
            "the window does not come to rest"
        );
    }
    settle(&mut lab);
    assert_eq!(drawn(&mut lab), before);
    assert_eq!(error_lines(&lab), [""; 0]);
}

#[test]
fn a_picture_that_is_refused_is_reported_in_words_and_replaced_by_the_next() {
    draw_pictures();
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let before = drawn(&mut lab);
    let camera = lab.state().preset_file().preset.camera;
    lab.state_mut().preset_mut().camera = Some(rasterlab::scene::camera::Camera {
        eye: glam::DVec3::splat(1e13),
        ..Default::default()
    });
    lab.run_steps(2);
    settle(&mut lab);
    assert!(lab.query_by_label_contains("last good picture").is_some());
    assert_eq!(error_lines(&lab).len(), 1, "{}", lab.state().log_text());
    assert_eq!(drawn(&mut lab), before);
    lab.state_mut().preset_mut().camera = camera;
    lab.run_steps(2);
    settle(&mut lab);
    assert!(lab.query_by_label_contains("last good picture").is_none());
    assert_eq!(drawn(&mut lab), before);
}

#[test]
fn a_cpu_adapter_compiles_and_draws_on_another_device_than_the_one_that_shows_the_window() {
    let Some(window) = crate::common::gpu() else {
        return;
    };
    let Devices {
        window, picture, ..
    } = Devices::of(window);
    assert_eq!(
        Arc::ptr_eq(&window, &picture),
        !window.summary.software,
        "{}",
        window.summary.name
    );
    assert_eq!(picture.summary.name, window.summary.name);
}
