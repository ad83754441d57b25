//! Promise: the window says how far f32 leads an effect astray, and where; and
//! which effect and parameter made NaN.

use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};

use crate::{
    harness::*,
    live::{INK, write},
};

const PRESET: &str =
    "schema = 2\n[scene]\nbuiltin = \"teapot\"\n[effects.lambert]\n[effects.ink]\n";

/// The number of the last line of errors in the inspector, which is that of the ink.
fn error(lab: &Lab) -> Option<String> {
    let mut nodes = lab.query_all_by_role(Role::Button).filter_map(|node| {
        node.accesskit_node()
            .label()
            .filter(|label| label.starts_with("f32 error: "))
    });
    nodes
        .next_back()
        .map(|label| label.trim_start_matches("f32 error: ").to_owned())
}

fn has(lab: &Lab, text: &str) -> bool {
    lab.query_all_by_label_contains(text).next().is_some()
}

#[test]
fn the_largest_f32_error_of_an_effect_is_shown_and_its_place_is_marked() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("effects/ink.wgsl");
    // Neighboring f32 numbers near a million are 1/16 apart, so the difference is off by up to
    // 1/32.
    write(
        &file,
        &INK.replace(
            "vec4f(p.amount, 0.0,",
            "vec4f((1000000.0 + p.amount * s.screen.x) - 1000000.0, 0.0,",
        ),
    );
    let Some(mut lab) = lab_of(folder.path(), PRESET) else {
        return;
    };
    wait_for(&mut lab, "the error is measured", |lab| {
        error(lab).is_some()
    });
    let said = error(&lab).expect("it is measured");
    let number: f64 = said
        .strip_suffix(" of 255")
        .and_then(|number| number.parse().ok())
        .unwrap_or_else(|| panic!("{said}"));
    assert!((2.0..64.0).contains(&number), "{said}");
    click(&mut lab, Role::Button, &format!("f32 error: {said}"));
    assert!(
        lab.query_by_label(&format!("ink: {said}")).is_some(),
        "the place is not marked"
    );
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(
        lab.query_by_label(&format!("ink: {said}")).is_none(),
        "Escape does not remove the mark"
    );

    // An edit of the effect is measured anew.
    write(&file, INK);
    wait_for(&mut lab, "the edit is measured", |lab| {
        has(lab, "f32 error: none")
    });
    assert_eq!(error_lines(&lab), [""; 0]);
}

#[test]
fn the_legend_names_the_effect_and_the_parameter_that_made_nan() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let ink = INK
        .replace(
            "@range(0.0, 1.0, 1.0) amount",
            "@range(0.0, 4.0, 0.5) amount",
        )
        .replace("p.amount, 0.0,", "sqrt(1.0 - p.amount), 0.0,");
    write(&folder.path().join("effects/ink.wgsl"), &ink);
    let Some(mut lab) = lab_of(folder.path(), &format!("{PRESET}amount = 2.0\n")) else {
        return;
    };
    press(&mut lab, Modifiers::NONE, Key::O);
    wait_for(&mut lab, "the legend names the effect", |lab| {
        has(lab, "ink made NaN, amount = 2.0")
    });
    let view = lab.get_by_label("Picture").rect();
    lab.hover_at(view.center());
    let line = |delta: u32| format!("Δ {delta}, ink made NaN, amount = 2.0");
    wait_for(&mut lab, "the line of the pixel names the effect", |lab| {
        (0..256).any(|delta| has(lab, &line(delta)))
    });

    // With its default the effect makes colors.
    lab.get_by_label("Reset ink.amount").click();
    lab.run_steps(3);
    settle(&mut lab);
    wait_for(&mut lab, "the legend is clean", |lab| !has(lab, "ink made"));
    assert_eq!(error_lines(&lab), [""; 0]);
}
