//! Promise: one slider chooses the accuracy from draft to strict, beside what each tier was
//! measured to cost on the open picture and judged to err by; below it stand the axes that the
//! picture can use, each with the reason for its option.

use std::time::{Duration, Instant};

use egui::{Role, vec2};
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
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    assert_eq!(tier(&lab), Tier::Precise);
    slider(&lab, "accuracy.tier").scroll_to_me();
    lab.run_steps(3);
    assert!(
        lab.query_all_by_label_contains("no wrong pixel expected")
            .count()
            > 0,
        "what the precise tier may err by"
    );
    assert!(lab.query_by_label_contains("– wrong pixels (V)").is_some());
    click(&mut lab, Role::Button, "Verify");
    assert!(
        lab.query_all_by_label_contains(", no wrong pixel").count() > 0,
        "the precise tier was judged"
    );
    let same = "the same options here as ";
    assert!(
        lab.query_all_by_label_contains(same).count() > 0,
        "tiers that draw the same picture say so"
    );
    click(&mut lab, Role::Button, "Tier strict");
    assert_eq!((tier(&lab), lab.state().undo_steps()), (Tier::Strict, 1));
    click(&mut lab, Role::Button, "Tier draft");
    assert_eq!((tier(&lab), lab.state().undo_steps()), (Tier::Draft, 2));
    assert!(
        lab.query_all_by_label_contains("Up to 2 % of the pixels")
            .count()
            > 0
    );
    undo(&mut lab);
    assert_eq!(tier(&lab), Tier::Strict);
    let rail = slider(&lab, "accuracy.tier").rect();
    drag(
        &mut lab,
        rail.right_center() - vec2(6.0, 0.0),
        rail.left_center() + vec2(6.0, 0.0),
    );
    assert_eq!(tier(&lab), Tier::Draft, "the slider is dragged");
}

/// Steps until every tier is measured, as far as this adapter has timestamps.
fn measure_tiers(lab: &mut Lab) {
    let patience = Instant::now() + Duration::from_secs(300);
    while !Tier::ALL
        .iter()
        .all(|tier| lab.state().tier_ms(*tier).is_some_and(|ms| ms > 0.0))
    {
        lab.step();
        assert!(
            Instant::now() < patience,
            "the tiers are not measured\n{}",
            lab.state().log_text()
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    lab.run_steps(2);
}

#[test]
fn tiers_are_measured_at_rest_and_their_times_dropped_when_the_picture_changes() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    if !lab.state().gpu().caps.timestamps {
        return eprintln!("this adapter has no timestamps, so tiers are not measured");
    }
    let unknown = |lab: &Lab| lab.query_all_by_label_contains("no time yet").count();
    lab.run_steps(60);
    let other = |lab: &Lab| lab.state().tier_ms(Tier::Strict);
    assert_eq!(other(&lab), None, "nobody has looked at the slider");
    slider(&lab, "accuracy.tier").scroll_to_me();
    let own = "reference and strict have kernels of their own";
    wait_until(&mut lab, own, |lab| unknown(lab) >= 2);
    measure_tiers(&mut lab);
    wait_until(&mut lab, "every tier says its time", |lab| {
        unknown(lab) == 0
    });
    let before = Tier::ALL.map(|tier| lab.state().tier_ms(tier));
    click(&mut lab, Role::Button, "Tier strict");
    assert_eq!(
        Tier::ALL.map(|tier| lab.state().tier_ms(tier)),
        before,
        "the slider changes no picture of a tier"
    );

    lab.state_mut().preset_mut().output.background[0] += 0.25;
    wait_until(&mut lab, "the times of another picture go", |lab| {
        [Tier::Draft, Tier::Reference]
            .iter()
            .all(|tier| lab.state().tier_ms(*tier).is_none())
    });
    settle(&mut lab);
    measure_tiers(&mut lab);
}

#[test]
fn axes_are_folded_and_only_those_that_decide_are_shown_with_their_reasons() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
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
    assert!(
        lab.query_by_label_contains("fixed8: triangles have exact edges between corners")
            .is_some(),
        "the option and why"
    );
    assert!(
        !has(&lab, "accuracy.dot_culling") && !has(&lab, "accuracy.skinning"),
        "there are neither dots nor joints"
    );
    assert!(
        lab.query_by_label_contains("more axes decide about nothing")
            .is_some()
    );
    // A pinned axis can always be unpinned.
    lab.state_mut().preset_mut().accuracy.pins = PinnedOptions::of(DotCulling::Brute);
    settle(&mut lab);
    assert!(has(&lab, "accuracy.dot_culling") && lab.query_by_label_contains("1 pinned").is_some());
}
