//! Promise: in the trade combinations of options are measured, shown as points, and pinned by a click.

use std::time::{Duration, Instant};

use eframe::egui::{self, Key, Modifiers, Pos2, Rect, Role, Shape};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
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
    assert!(lab.query_by_label_contains("takes about ").is_some(), "how long it takes is said before it starts");
    click(&mut lab, Role::Button, "Measure");
    assert_eq!(lab.state().trade_points(), DepthFormat::ALL.len(), "{}", lab.state().log_text());
    assert!(lab.state().log_text().contains(&format!("Trade: combinations measured: {}", DepthFormat::ALL.len())));
    assert_eq!((pinned_depth(&lab), lab.state().undo_steps()), (None, 0), "measuring changes no preset");
    // Options that cost the same lie over each other: the click goes to a point with nothing over its center.
    let place = |format: DepthFormat| lab.get_by_role_and_label(Role::Button, &format!("Point depth={}", format.name())).rect();
    let is_clear =
        |format: &DepthFormat| DepthFormat::ALL.iter().all(|other| other == format || !place(*other).contains(place(*format).center()));
    let clear = DepthFormat::ALL.iter().copied().find(is_clear).expect("a point that can be clicked");
    click(&mut lab, Role::Button, &format!("Point depth={}", clear.name()));
    assert_eq!((pinned_depth(&lab), lab.state().undo_steps()), (Some(clear), 1));
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
        copied.starts_with("depth,ms p5,ms p50,ms p95,samples,wrong pixels ppm,") && copied.lines().count() == 1 + DepthFormat::ALL.len(),
        "{copied}"
    );
    spread_is_shown(&lab, &copied);
    // Another camera makes another picture, so the points are stale.
    assert!(lab.query_by_label_contains("stale: ").is_none());
    click(&mut lab, Role::Button, "Top view");
    assert!(lab.query_by_label_contains("stale: ").is_some());
}

/// Looks for the spread of every row of `csv` in the table and as a bar of the plot, whose time is logarithmic.
fn spread_is_shown(lab: &Lab, csv: &str) {
    let rows: Vec<(String, [f64; 3])> = csv
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            (format!("Use depth={}", cells[0]), [2, 1, 3].map(|at| cells[at].parse().expect("milliseconds")))
        })
        .collect();
    let mut numbers: Vec<(Rect, f64)> = Vec::new();
    for node in lab.query_all_by_role(Role::Label) {
        let text = node.accesskit_node().value().or_else(|| node.accesskit_node().label());
        if let Some(number) = text.and_then(|text| text.parse().ok()) {
            numbers.push((node.rect(), number));
        }
    }
    for (name, [median, p5, p95]) in &rows {
        let button = lab.get_by_role_and_label(Role::Button, name).rect();
        let is_of_row = |rect: &Rect| rect.left() > button.right() && (rect.center().y - button.center().y).abs() < 4.0;
        let mut row: Vec<&(Rect, f64)> = numbers.iter().filter(|(rect, _)| is_of_row(rect)).collect();
        row.sort_by(|a, b| a.0.left().total_cmp(&b.0.left()));
        let shown: Vec<f64> = row.iter().take(3).map(|(_, number)| *number).collect();
        let is_near = |(shown, ms): (&f64, &f64)| (shown - ms).abs() <= 0.006 * ms.abs();
        assert!(shown.len() == 3 && shown.iter().zip([median, p5, p95]).all(is_near), "{name}: {shown:?} for {median}, {p5}, {p95} ms");
    }
    // The lines of two ends at one height are the bars.
    let mut bars: Vec<f64> = Vec::new();
    for clipped in &lab.output().shapes {
        if let Shape::Path(path) = &clipped.shape
            && let [a, b] = path.points[..]
            && (path.stroke.width - 1.5).abs() < 0.01
            && (a.y - b.y).abs() < 0.01
            && a.x < b.x
        {
            bars.push(f64::from(b.x - a.x));
        }
    }
    let mut spreads: Vec<f64> = rows.iter().map(|(_, [_, p5, p95])| (p95 / p5).log10()).collect();
    bars.sort_by(f64::total_cmp);
    spreads.sort_by(f64::total_cmp);
    assert_eq!(bars.len(), spreads.len(), "{bars:?} for {spreads:?}");
    let decade = bars.iter().sum::<f64>() / spreads.iter().sum::<f64>();
    assert!(bars.iter().zip(&spreads).all(|(bar, spread)| (bar - spread * decade).abs() < 1.0), "{bars:?} for {spreads:?}");
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

/// Opens the panel and begins to measure the options of depth.
fn measure_depth(lab: &mut Lab) {
    press(lab, Modifiers::NONE, Key::M);
    for axis in ["coverage", "depth"] {
        lab.get_by_role_and_label(Role::CheckBox, &format!("Measure {axis}")).click();
        lab.run_steps(2);
    }
    lab.get_by_role_and_label(Role::Button, "Measure").click();
    lab.run_steps(2);
}

/// Shows frames until something is there.
fn until(lab: &mut Lab, what: &str, mut is_there: impl FnMut(&mut Lab) -> bool) {
    let patience = Instant::now() + Duration::from_secs(120);
    while !is_there(lab) {
        assert!(Instant::now() < patience, "{what} never comes\n{}", lab.state().log_text());
        lab.step();
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn what_was_timed_before_a_measurement_was_canceled_is_kept() {
    let Some(mut lab) = lab("facet-sweep") else { return };
    measure_depth(&mut lab);
    // The first is measured when the third begins.
    until(&mut lab, "the third combination", |lab| lab.query_by_label(&format!("depth={}", DepthFormat::ALL[2].name())).is_some());
    assert!(lab.query_by_label_contains(" left").is_some() || lab.query_by_label_contains("Waiting").is_some());
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(2);
    settle(&mut lab);
    let points = lab.state().trade_points();
    assert!((2..=DepthFormat::ALL.len()).contains(&points), "{points} points are kept");
    assert!(error_lines(&lab).is_empty());
    assert!(lab.query_by_label(&format!("Point depth={}", DepthFormat::ALL[0].name())).is_some());
}

#[test]
fn a_measurement_waits_while_the_person_works_in_the_window() {
    let Some(mut lab) = lab("facet-sweep") else { return };
    measure_depth(&mut lab);
    let mut x = 400.0;
    until(&mut lab, "the pause", |lab| {
        x += 1.0;
        lab.hover_at(Pos2::new(x, 300.0));
        lab.query_by_label_contains("Waiting while you work").is_some()
    });
    // Nobody touches the window any more.
    until(&mut lab, "the end of the pause", |lab| lab.query_by_label_contains("Waiting while you work").is_none());
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(2);
    settle(&mut lab);
}

#[test]
fn a_picture_that_plays_is_paused_when_a_measurement_begins() {
    let Some(mut lab) = lab("facet-motion") else { return };
    lab.key_press(Key::Space);
    lab.run_steps(6);
    let playing_s = lab.state().shown_time_s();
    measure_depth_of_playing(&mut lab);
    let paused_s = lab.state().shown_time_s();
    lab.run_steps(6);
    assert!(paused_s >= playing_s && lab.state().shown_time_s() == paused_s, "{playing_s} {paused_s}");
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(2);
    settle(&mut lab);
}

/// Opens the panel and begins to measure while the picture plays, so that the window never rests before.
fn measure_depth_of_playing(lab: &mut Lab) {
    lab.key_press(Key::M);
    lab.run_steps(4);
    lab.get_by_role_and_label(Role::Button, "Measure").click();
    lab.run_steps(4);
}
