//! Promise: the numbers in the header are those of the picture that is shown: measured at rest,
//! never a first sample, never of another preset or size; and the same count of wrong pixels stands
//! in the header and in the legend.

use std::time::Duration;

use egui::{self, Key, Modifiers, Role, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};

use crate::{
    first_use::{tick, until_compiling},
    harness::*,
};

/// The texts of the window that contain `part`. What a label says is its value.
fn texts(lab: &Lab, part: &str) -> Vec<String> {
    let text = |node: egui_kittest::Node<'_>| {
        node.accesskit_node()
            .label()
            .or_else(|| node.accesskit_node().value())
    };
    lab.query_all_by_label_contains(part)
        .filter_map(text)
        .collect()
}

fn has_timer(lab: &Lab) -> bool {
    lab.state().gpu().caps.timestamps
}

#[test]
fn the_cost_is_a_median_at_rest_and_then_nothing_is_drawn() {
    draw_pictures();
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    if !has_timer(&lab) {
        assert!(!texts(&lab, "no GPU timer").is_empty());
        return;
    }
    assert!(!texts(&lab, " ms GPU").is_empty() && texts(&lab, "– ms").is_empty());
    // Five frames, or three that take long.
    let is_enough = |ms: &[f64]| ms.len() >= 5 || ms.len() >= 3 && ms.iter().sum::<f64>() >= 1500.0;
    let (draws, measured) = (lab.state().draws(), lab.state().measured_ms());
    assert!(
        is_enough(&measured) && draws > measured.len() as u64,
        "{draws} frames, of which these were measured, ms: {measured:?}"
    );
    lab.run_steps(30);
    assert_eq!(lab.state().draws(), draws, "an idle window draws");
    assert_eq!(
        lab.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay,
        Duration::MAX,
        "{:?}",
        lab.ctx.repaint_causes()
    );

    lab.key_press(Key::Num7);
    lab.run_steps(2);
    // Where these two steps take long, the next picture has been measured within them.
    let is_measured = lab.state().measured_ms().len() > measured.len();
    let times = texts(&lab, " ms GPU");
    assert!(
        is_measured || !texts(&lab, "– ms").is_empty() && times.is_empty(),
        "the time of another picture is shown: {times:?}"
    );
    settle(&mut lab);
    assert!(!texts(&lab, " ms GPU").is_empty());
    let next = lab.state().measured_ms().split_off(measured.len());
    assert!(
        is_enough(&next) && lab.state().draws() > draws + next.len() as u64,
        "the next picture, ms: {next:?}"
    );
}

/// The next picture is held back, so that nothing but the change itself can take the old time away.
#[test]
fn the_time_of_the_picture_before_is_gone_before_the_next_is_drawn() {
    draw_pictures();
    let Some(mut lab) = lab_on_new_devices("lambert") else {
        return;
    };
    if !has_timer(&lab) {
        return;
    }
    assert!(!texts(&lab, " ms GPU").is_empty());
    lab.state_mut().hold_compiling(true);
    tick(&mut lab, "hatch");
    until_compiling(&mut lab);
    lab.run_steps(3);
    assert!(
        texts(&lab, " ms GPU").is_empty(),
        "an old time stands beside a changed preset: {:?}",
        texts(&lab, " ms GPU")
    );
    assert!(!texts(&lab, "– ms").is_empty());
    lab.state_mut().hold_compiling(false);
    settle(&mut lab);
    assert!(!texts(&lab, " ms GPU").is_empty());
}

/// A picture in motion is timed by the median of its newest frames; those of another preset with
/// the same kernels do not count.
#[test]
fn frames_of_the_preset_before_do_not_count_for_the_next() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (id, amount) in [("aa1", 0.25), ("aa2", 0.75)] {
        let text = format!(
            "schema = 2\n[scene]\nbuiltin = \"teapot?tess=4\"\n[effects.facet]\namount = {amount}\n"
        );
        std::fs::write(folder.path().join(format!("{id}.toml")), text).expect("a file");
    }
    let Some(mut lab) = lab_in("aa1", Some(folder.path())) else {
        return;
    };
    if !has_timer(&lab) {
        return;
    }
    let view = lab.get_by_label("Picture").rect();
    for by in [60.0, -60.0] {
        drag(&mut lab, view.center(), view.center() + vec2(by, 20.0));
    }
    for _ in 0..4 {
        press(&mut lab, Modifiers::NONE, Key::Num7);
        press(&mut lab, Modifiers::NONE, Key::Num1);
    }
    lab.key_press(Key::CloseBracket);
    let before = lab.state().draws();
    while lab.state().draws() < before + 2 {
        lab.step();
        assert!(
            texts(&lab, "≈").is_empty(),
            "{:?} is of the preset before",
            texts(&lab, "≈")
        );
    }
    settle(&mut lab);
    assert_eq!(lab.state().preset_file().id, "aa2");
}

#[test]
fn a_new_size_makes_a_verdict_stale_and_another_preset_drops_it() {
    draw_pictures();
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let size = lab.get_by_label("Picture").rect().size();
    click(&mut lab, Role::Button, "Verify");
    assert_eq!(
        lab.get_by_label("Picture").rect().size(),
        size,
        "a verdict changes the size of the picture"
    );
    assert!(texts(&lab, "– wrong pixels").is_empty() && !texts(&lab, "no wrong pixel").is_empty());
    lab.set_size(vec2(1216.0, 800.0));
    lab.run_steps(2);
    assert!(
        !texts(&lab, " · stale").is_empty(),
        "a verdict on another size counts: {:?}",
        texts(&lab, "no wrong pixel")
    );
    assert!(texts(&lab, " ms GPU").is_empty());
    settle(&mut lab);
    click(&mut lab, Role::Button, "Verify");
    // A panel that opens and closes leaves the picture as it was judged.
    press(&mut lab, Modifiers::NONE, Key::L);
    assert!(!texts(&lab, " · stale").is_empty(), "the log takes room");
    press(&mut lab, Modifiers::NONE, Key::L);
    assert!(texts(&lab, "– wrong pixels").is_empty() && texts(&lab, " · stale").is_empty());
    press(&mut lab, Modifiers::NONE, Key::CloseBracket);
    assert!(
        !texts(&lab, "– wrong pixels").is_empty(),
        "a verdict on another preset is shown: {:?}",
        texts(&lab, "no wrong pixel")
    );
    // A verdict that comes after the change is dropped as well.
    lab.get_by_role_and_label(Role::Button, "Verify").click();
    lab.run_steps(2);
    press(&mut lab, Modifiers::NONE, Key::OpenBracket);
    assert!(
        !texts(&lab, "– wrong pixels").is_empty(),
        "a late verdict on another preset is shown: {:?}",
        texts(&lab, "no wrong pixel")
    );
}

#[test]
fn header_and_legend_count_the_same_wrong_pixels() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = "schema = 2\n[scene]\nbuiltin = \"teapot\"\n[effects.facet]\n[accuracy]\ncoverage = \"fixed4\"\n";
    let Some(mut lab) = lab_of(folder.path(), text) else {
        return;
    };
    press(&mut lab, Modifiers::NONE, Key::O);
    let header = texts(&lab, "no wrong pixel, ");
    let header = header
        .first()
        .unwrap_or_else(|| panic!("no header: {:?}", texts(&lab, "no wrong")));
    let count = header
        .trim_start_matches("no wrong pixel, ")
        .split(" differ by rounding")
        .next()
        .expect("a count");
    assert_ne!(count, "0", "a grid of 1/16 px moves edges");
    let legend = format!("by rounding: {count} px");
    assert!(
        lab.query_by_label(&legend).is_some(),
        "{header} beside {:?}",
        texts(&lab, "by rounding:")
    );
    assert!(texts(&lab, "no errors").is_empty());
    // What the two counts mean is said on hover.
    let words = "By rounding: pixels that show another triangle than the exact picture of the true positions";
    assert!(texts(&lab, words).is_empty());
    lab.get_all_by_label_contains("no wrong pixel, ")
        .next()
        .expect("the header")
        .hover();
    lab.run_steps(12);
    assert!(
        !texts(&lab, words).is_empty(),
        "the counts are not explained"
    );
}

#[test]
fn the_timing_panel_lists_passes_rest_and_latency() {
    draw_pictures();
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    if !has_timer(&lab) {
        return;
    }
    let draws = lab.state().draws();
    // The inspector lists passes, too.
    let rows = ["median", "p5 – p95", "rest", "frame"];
    let counts = |lab: &Lab| rows.map(|title| lab.query_all_by_label(title).count());
    let before = counts(&lab);
    press(&mut lab, Modifiers::NONE, Key::G);
    assert!(!texts(&lab, "Times of ").is_empty());
    for ((title, before), after) in rows.iter().zip(before).zip(counts(&lab)) {
        assert!(after > before, "{title} is missing");
    }
    // The panel makes the picture smaller, which is another picture.
    assert!(lab.state().draws() > draws);
    let view = lab.get_by_label("Picture").rect();
    drag(&mut lab, view.center(), view.center() + vec2(60.0, 20.0));
    assert!(!texts(&lab, "input to picture: ").is_empty());
    assert!(
        !texts(&lab, " ms a frame, longest ").is_empty(),
        "the panel does not tell how long the window takes"
    );
    click(&mut lab, Role::Button, "Close timing");
    assert!(texts(&lab, "Times of ").is_empty());
    press(&mut lab, Modifiers::NONE, Key::G);
    assert!(!texts(&lab, "Times of ").is_empty());
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(
        texts(&lab, "Times of ").is_empty(),
        "Escape closes the panel"
    );
}
