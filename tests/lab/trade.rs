//! Promise: in the trade combinations of options are measured, shown as points, and pinned by a click.

use eframe::egui::{self, Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;
use rasterlab::accuracy::DepthFormat;

use crate::harness::*;

fn pinned_depth(lab: &Lab) -> Option<DepthFormat> {
    lab.state().preset_file().preset.accuracy.pins.option()
}

#[test]
fn a_measured_combination_is_a_point_and_a_click_on_it_switches_the_preset_in_one_step() {
    let Some(mut lab) = lab("facet-sweep") else { return };
    press(&mut lab, Modifiers::NONE, Key::M);
    assert!(lab.query_by_label_contains("Nothing is measured yet").is_some());
    // The options of depth cost about the same, so that a slow adapter is done in time.
    for axis in ["coverage", "depth"] {
        lab.get_by_role_and_label(Role::CheckBox, &format!("Measure {axis}")).click();
        lab.run_steps(2);
    }
    assert!(lab.query_by_label(&format!("{} combinations", DepthFormat::ALL.len())).is_some());
    click(&mut lab, Role::Button, "Measure");
    assert_eq!(lab.state().trade_points(), DepthFormat::ALL.len(), "{}", lab.state().log_text());
    assert_eq!((pinned_depth(&lab), lab.state().undo_steps()), (None, 0), "measuring changes no preset");
    click(&mut lab, Role::Button, "Point depth=log16");
    assert_eq!((pinned_depth(&lab), lab.state().undo_steps()), (Some(DepthFormat::Log16), 1));
    undo(&mut lab);
    assert_eq!((pinned_depth(&lab), lab.state().undo_steps()), (None, 0));
    // The table does what the plot does.
    click(&mut lab, Role::Button, "Use depth=ndc16");
    assert_eq!((pinned_depth(&lab), lab.state().undo_steps()), (Some(DepthFormat::Ndc16), 1));
    // Under another metric the points stay the same.
    click(&mut lab, Role::Button, "holes and doubles");
    assert!(lab.query_by_label("Point depth=log16").is_some());
    lab.get_by_role_and_label(Role::Button, "Copy as CSV").click();
    lab.step();
    let copied = lab.output().platform_output.commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let copied = copied.expect("a table on the clipboard");
    assert!(
        copied.starts_with("depth,ms p50,ms p95,samples,wrong pixels ppm,") && copied.lines().count() == 1 + DepthFormat::ALL.len(),
        "{copied}"
    );
    // Another camera makes another picture, so the points are stale.
    assert!(lab.query_by_label_contains("stale: ").is_none());
    click(&mut lab, Role::Button, "Top view");
    assert!(lab.query_by_label_contains("stale: ").is_some());
}

#[test]
fn a_measurement_is_canceled_and_leaves_nothing_behind() {
    let Some(mut lab) = lab("facet-sweep") else { return };
    press(&mut lab, Modifiers::NONE, Key::M);
    lab.get_by_role_and_label(Role::CheckBox, "Measure depth").click();
    lab.run_steps(2);
    lab.get_by_role_and_label(Role::Button, "Measure").click();
    lab.run_steps(2);
    assert!(!lab.state().is_idle() && lab.query_by_role_and_label(Role::Button, "Measure").is_none());
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(2);
    settle(&mut lab);
    assert_eq!((lab.state().trade_points(), error_lines(&lab).len()), (0, 0));
    assert!(lab.query_by_role_and_label(Role::Button, "Measure").is_some());
}
