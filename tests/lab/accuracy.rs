//! Promise: one slider chooses the accuracy from draft to strict, beside what that is expected to cost and what was measured; below it stand
//! the axes that the picture can use, each with the reason for its option.

use eframe::egui::{Role, vec2};
use egui_kittest::kittest::Queryable as _;
use rasterlab::{
    accuracy::{DotCulling, PinnedOptions},
    preset::Tier,
};

use crate::harness::*;

fn tier(lab: &Lab) -> Tier {
    lab.state().preset_file().preset.accuracy.tier
}

#[test]
fn the_slider_chooses_a_tier_beside_its_cost_and_error() {
    let Some(mut lab) = lab("facet-sweep") else { return };
    assert_eq!(tier(&lab), Tier::Precise);
    slider(&lab, "accuracy.tier").scroll_to_me();
    lab.run_steps(3);
    assert!(lab.query_by_label_contains("0 wrong ppm, color Δ 0").is_some(), "what is expected of the precise tier");
    assert!(lab.query_by_label_contains("error not measured (V)").is_some());
    click(&mut lab, Role::Button, "Verify");
    assert_eq!(lab.query_all_by_label_contains("ms, 0 wrong ppm, color Δ").count(), 1, "what was expected");
    assert_eq!(lab.query_all_by_label_contains("wrong ppm: 0 snapped, ").count(), 1, "what was measured");
    click(&mut lab, Role::Button, "Tier strict");
    assert_eq!((tier(&lab), lab.state().undo_steps()), (Tier::Strict, 1));
    click(&mut lab, Role::Button, "Tier draft");
    assert_eq!((tier(&lab), lab.state().undo_steps()), (Tier::Draft, 2));
    assert!(lab.query_all_by_label_contains("Up to 2 % of the pixels").count() > 0);
    undo(&mut lab);
    assert_eq!(tier(&lab), Tier::Strict);
    let rail = slider(&lab, "accuracy.tier").rect();
    drag(&mut lab, rail.right_center() - vec2(6.0, 0.0), rail.left_center() + vec2(6.0, 0.0));
    assert_eq!(tier(&lab), Tier::Draft, "the slider is dragged");
}

#[test]
fn axes_are_folded_and_only_those_that_decide_are_shown_with_their_reasons() {
    let Some(mut lab) = lab("facet-sweep") else { return };
    let has = |lab: &Lab, axis: &str| lab.query_by_role_and_label(Role::ComboBox, axis).is_some();
    assert!(!has(&lab, "accuracy.coverage"), "the axes are folded");
    let open = |lab: &mut Lab| {
        lab.get_by_label_contains("Axes (").scroll_to_me();
        lab.run_steps(3);
        lab.get_by_label_contains("Axes (").click();
        lab.run_steps(8);
        settle(lab);
    };
    open(&mut lab);
    assert!(has(&lab, "accuracy.coverage") && has(&lab, "accuracy.depth"));
    assert!(lab.query_by_label_contains("fixed8: exact edges between corners").is_some(), "the option and why");
    assert!(!has(&lab, "accuracy.dot_culling") && !has(&lab, "accuracy.skinning"), "there are neither dots nor joints");
    assert!(lab.query_by_label_contains("more axes decide about nothing").is_some());
    // A pinned axis can always be unpinned.
    lab.state_mut().preset_mut().accuracy.pins = PinnedOptions::of(DotCulling::Brute);
    settle(&mut lab);
    assert!(has(&lab, "accuracy.dot_culling") && lab.query_by_label_contains("1 pinned").is_some());
}
