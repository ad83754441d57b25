//! Promise: in the trade combinations of options are measured, shown as points, and pinned by a
//! click.

use std::time::{Duration, Instant};

use egui::{self, Key, Modifiers, Pos2, Rect, Role, Shape};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use rasterlab::{accuracy::DepthFormat, preset_file::Folders};

use crate::harness::*;

fn pinned_depth(lab: &Lab) -> Option<DepthFormat> {
    lab.state().preset_file().preset.accuracy.pins.option()
}

#[test]
fn a_measured_combination_is_a_point_and_a_click_on_it_switches_the_preset_in_one_step() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    press(&mut lab, Modifiers::NONE, Key::M);
    assert!(
        lab.query_by_label_contains("Nothing is measured yet")
            .is_some()
    );
    // The options of depth cost about the same, so that a slow adapter is done in time.
    for axis in ["coverage", "depth"] {
        lab.get_by_role_and_label(Role::CheckBox, &format!("Measure {axis}"))
            .click();
        lab.run_steps(2);
    }
    assert!(
        lab.query_by_label(&format!("{} combinations", DepthFormat::ALL.len()))
            .is_some()
    );
    assert!(
        lab.query_by_label_contains("takes about ").is_some(),
        "how long it takes is said before it starts"
    );
    click(&mut lab, Role::Button, "Measure");
    assert_eq!(
        lab.state().trade_points(),
        DepthFormat::ALL.len(),
        "{}",
        lab.state().log_text()
    );
    assert!(lab.state().log_text().contains(&format!(
        "Trade: combinations measured: {}",
        DepthFormat::ALL.len()
    )));
    assert_eq!(
        (pinned_depth(&lab), lab.state().undo_steps()),
        (None, 0),
        "measuring changes no preset"
    );
    // Options that cost the same lie over each other: the click goes to a point with nothing over
    // its center.
    let place = |format: DepthFormat| {
        lab.get_by_role_and_label(Role::Button, &format!("Point depth={}", format.name()))
            .rect()
    };
    let is_clear = |format: &DepthFormat| {
        DepthFormat::ALL
            .iter()
            .all(|other| other == format || !place(*other).contains(place(*format).center()))
    };
    let clear = DepthFormat::ALL
        .iter()
        .copied()
        .find(is_clear)
        .expect("a point that can be clicked");
    click(
        &mut lab,
        Role::Button,
        &format!("Point depth={}", clear.name()),
    );
    assert_eq!(
        (pinned_depth(&lab), lab.state().undo_steps()),
        (Some(clear), 1)
    );
    undo(&mut lab);
    assert_eq!((pinned_depth(&lab), lab.state().undo_steps()), (None, 0));
    // The table does what the plot does.
    click(&mut lab, Role::Button, "Use depth=ndc16");
    assert_eq!(
        (pinned_depth(&lab), lab.state().undo_steps()),
        (Some(DepthFormat::Ndc16), 1)
    );
    // Under another metric the points stay the same.
    click(&mut lab, Role::Button, "holes and doubles");
    assert!(lab.query_by_label("Point depth=log16").is_some());
    let copied = copied_table(&mut lab);
    assert!(
        copied.starts_with("depth,ms p5,ms p50,ms p95,samples,by rounding px,")
            && copied.lines().count() == 1 + DepthFormat::ALL.len(),
        "{copied}"
    );
    spread_is_shown(&lab, &copied);
    // Another camera makes another picture, so the points are stale.
    assert!(lab.query_by_label_contains("stale: ").is_none());
    click(&mut lab, Role::Button, "Top view, then bottom");
    assert!(lab.query_by_label_contains("stale: ").is_some());
}

/// The table as comma-separated values, from the clipboard.
fn copied_table(lab: &mut Lab) -> String {
    lab.get_by_role_and_label(Role::Button, "Copy as CSV")
        .click();
    lab.step();
    let copied = lab
        .output()
        .platform_output
        .commands
        .iter()
        .find_map(|command| match command {
            egui::OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        });
    copied.expect("a table on the clipboard")
}

/// Looks for the spread of every row of `csv` in the table and as a bar of the plot, whose time is
/// logarithmic.
fn spread_is_shown(lab: &Lab, csv: &str) {
    let rows: Vec<(String, [f64; 3])> = csv
        .lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            (
                format!("Use depth={}", cells[0]),
                [2, 1, 3].map(|at| cells[at].parse().expect("milliseconds")),
            )
        })
        .collect();
    let mut numbers: Vec<(Rect, f64)> = Vec::new();
    for node in lab.query_all_by_role(Role::Label) {
        let text = node
            .accesskit_node()
            .value()
            .or_else(|| node.accesskit_node().label());
        if let Some(number) = text.and_then(|text| text.parse().ok()) {
            numbers.push((node.rect(), number));
        }
    }
    for (name, [median, p5, p95]) in &rows {
        let button = lab.get_by_role_and_label(Role::Button, name).rect();
        let is_of_row = |rect: &Rect| {
            rect.left() > button.right() && (rect.center().y - button.center().y).abs() < 4.0
        };
        let mut row: Vec<&(Rect, f64)> =
            numbers.iter().filter(|(rect, _)| is_of_row(rect)).collect();
        row.sort_by(|a, b| a.0.left().total_cmp(&b.0.left()));
        let shown: Vec<f64> = row.iter().take(3).map(|(_, number)| *number).collect();
        let is_near = |(shown, ms): (&f64, &f64)| (shown - ms).abs() <= 0.006 * ms.abs();
        assert!(
            shown.len() == 3 && shown.iter().zip([median, p5, p95]).all(is_near),
            "{name}: {shown:?} for {median}, {p5}, {p95} ms"
        );
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
    let mut spreads: Vec<f64> = rows
        .iter()
        .map(|(_, [_, p5, p95])| (p95 / p5).log10())
        .collect();
    bars.sort_by(f64::total_cmp);
    spreads.sort_by(f64::total_cmp);
    assert_eq!(bars.len(), spreads.len(), "{bars:?} for {spreads:?}");
    let decade = bars.iter().sum::<f64>() / spreads.iter().sum::<f64>();
    assert!(
        bars.iter()
            .zip(&spreads)
            .all(|(bar, spread)| (bar - spread * decade).abs() < 1.0),
        "{bars:?} for {spreads:?}"
    );
}

#[test]
fn a_measurement_is_canceled_and_leaves_nothing_behind() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    press(&mut lab, Modifiers::NONE, Key::M);
    lab.get_by_role_and_label(Role::CheckBox, "Measure depth")
        .click();
    lab.run_steps(2);
    lab.get_by_role_and_label(Role::Button, "Measure").click();
    lab.run_steps(2);
    assert!(
        !lab.state().is_idle()
            && lab
                .query_by_role_and_label(Role::Button, "Measure")
                .is_none()
    );
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(2);
    settle(&mut lab);
    assert_eq!(
        (lab.state().trade_points(), error_lines(&lab).len()),
        (0, 0)
    );
    assert!(
        lab.query_by_role_and_label(Role::Button, "Measure")
            .is_some()
    );
}

/// Opens the panel and begins to measure the options of depth.
fn measure_depth(lab: &mut Lab) {
    press(lab, Modifiers::NONE, Key::M);
    for axis in ["coverage", "depth"] {
        lab.get_by_role_and_label(Role::CheckBox, &format!("Measure {axis}"))
            .click();
        lab.run_steps(2);
    }
    lab.get_by_role_and_label(Role::Button, "Measure").click();
    lab.run_steps(2);
}

/// The text in the bar of a measurement under way, as `12 %  about 5 s left`.
fn progress(lab: &Lab) -> Option<String> {
    let bars = lab
        .query_all_by_role(Role::ProgressIndicator)
        .filter_map(|bar| bar.accesskit_node().label());
    bars.into_iter().find(|text| text.contains(" %  "))
}

/// The combination that is being measured; none before the first.
fn measured_now(lab: &Lab) -> Option<&'static str> {
    DepthFormat::ALL
        .iter()
        .map(|format| format.name())
        .find(|name| lab.query_by_label(&format!("depth={name}")).is_some())
}

/// Shows frames until something is there.
fn until(lab: &mut Lab, what: &str, mut is_there: impl FnMut(&mut Lab) -> bool) {
    let patience = Instant::now() + Duration::from_secs(120);
    while !is_there(lab) {
        assert!(
            Instant::now() < patience,
            "{what} never comes\n{}",
            lab.state().log_text()
        );
        lab.step();
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn what_was_timed_before_a_measurement_was_canceled_is_kept() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    measure_depth(&mut lab);
    // The first is measured when the third begins.
    let mut said = Vec::new();
    until(&mut lab, "the third combination", |lab| {
        said.extend(progress(lab));
        lab.query_by_label(&format!("depth={}", DepthFormat::ALL[2].name()))
            .is_some()
    });
    assert!(
        said.iter()
            .any(|text| text.contains(" %  about ") && text.ends_with(" left")),
        "no time left is said: {said:?}"
    );
    let percent = |text: &String| {
        text.split(' ')
            .next()
            .and_then(|percent| percent.parse::<u32>().ok())
            .expect("a percentage")
    };
    assert!(
        said.is_sorted_by_key(percent) && percent(&said[0]) < percent(&said[said.len() - 1]),
        "no progress is shown: {said:?}"
    );
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(2);
    settle(&mut lab);
    let points = lab.state().trade_points();
    assert!(
        (2..=DepthFormat::ALL.len()).contains(&points),
        "{points} points are kept"
    );
    assert!(error_lines(&lab).is_empty());
    assert!(
        lab.query_by_label(&format!("Point depth={}", DepthFormat::ALL[0].name()))
            .is_some()
    );
}

#[test]
fn a_measurement_waits_while_the_person_works_in_the_window() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    measure_depth(&mut lab);
    let mut x = 400.0;
    until(&mut lab, "the pause", |lab| {
        x += 1.0;
        lab.hover_at(Pos2::new(x, 300.0));
        lab.query_by_label_contains("Waiting while you work")
            .is_some()
    });
    // The window gets no more input.
    until(&mut lab, "the end of the pause", |lab| {
        lab.query_by_label_contains("Waiting while you work")
            .is_none()
    });
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(2);
    settle(&mut lab);
}

#[test]
fn a_measurement_that_is_canceled_while_pictures_are_timed_ends_with_the_samples_that_it_has() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    measure_depth(&mut lab);
    let [first, last] = [
        DepthFormat::ALL[0].name(),
        DepthFormat::ALL[DepthFormat::ALL.len() - 1].name(),
    ];
    until(&mut lab, "the last combination", |lab| {
        measured_now(lab) == Some(last)
    });
    // All are set up now, and timed in turn.
    until(&mut lab, "the first sample", |lab| {
        measured_now(lab) == Some(first) || lab.state().is_idle()
    });
    let Some(cancel) = lab.query_by_role_and_label(Role::Button, "Cancel") else {
        return;
    }; // All was timed within a frame.
    cancel.click();
    lab.run_steps(2);
    settle(&mut lab);
    let table = copied_table(&mut lab);
    let samples: Vec<u32> = table
        .lines()
        .skip(1)
        .map(|line| {
            line.split(',')
                .nth(4)
                .and_then(|n| n.parse().ok())
                .expect("samples")
        })
        .collect();
    assert_eq!(samples.len(), DepthFormat::ALL.len(), "{table}");
    assert!(
        samples.iter().all(|samples| (1..30).contains(samples)),
        "all was timed after the cancel: {samples:?}"
    );
}

/// The words say that it waits; this says that it does. A measurement that went on would come to
/// its third combination in this time, on any machine.
#[test]
fn nothing_is_measured_while_the_person_works_however_long_that_takes() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    let begun = Instant::now();
    measure_depth(&mut lab);
    until(&mut lab, "the third combination", |lab| {
        measured_now(lab) == Some(DepthFormat::ALL[2].name())
    });
    let undisturbed = begun.elapsed();
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(2);
    settle(&mut lab);

    let mut lab = self::lab("facet-sweep").expect("there was one");
    measure_depth(&mut lab);
    let (begun, mut last, mut longest, mut seen, mut x) = (
        Instant::now(),
        Instant::now(),
        Duration::ZERO,
        Vec::new(),
        400.0,
    );
    while begun.elapsed() < 2 * undisturbed {
        x = if x > 600.0 { 400.0 } else { x + 1.0 };
        lab.hover_at(Pos2::new(x, 300.0));
        lab.step();
        longest = longest.max(std::mem::replace(&mut last, Instant::now()).elapsed());
        seen.extend(measured_now(&lab).filter(|now| !seen.contains(now)));
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(
        lab.query_by_label_contains("Waiting while you work")
            .is_some()
    );
    // Where the machine showed no frame for a second, no input arrived.
    assert!(
        seen.len() <= 1 || longest > Duration::from_millis(900),
        "{seen:?} were measured meanwhile, frames took at most {longest:?}"
    );
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(2);
    settle(&mut lab);
}

/// A window of this size in which the options of depth are being measured, and when that began.
fn measuring(size: [f32; 2]) -> Option<(Lab, Instant)> {
    let mut lab = created(Some("facet-sweep"), Folders::default(), None, size)?;
    settle(&mut lab);
    let begun = Instant::now();
    measure_depth(&mut lab);
    Some((lab, begun))
}

/// Cancels, and returns after how long the measurement has ended.
fn cancel(lab: &mut Lab) -> Duration {
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.step();
    let canceled = Instant::now();
    until(lab, "the end", |lab| {
        lab.query_by_role_and_label(Role::Button, "Measure")
            .is_some()
    });
    canceled.elapsed()
}

/// How long the reference picture and the first combination take in a window of this size.
fn durations(size: [f32; 2]) -> Option<[Duration; 2]> {
    let (mut lab, begun) = measuring(size)?;
    until(&mut lab, "the first combination", |lab| {
        measured_now(lab).is_some()
    });
    let reference = begun.elapsed();
    until(&mut lab, "the second combination", |lab| {
        measured_now(lab) == Some(DepthFormat::ALL[1].name())
    });
    let both = begun.elapsed();
    cancel(&mut lab);
    Some([reference, both - reference])
}

/// Times are compared with those of the same work that was not canceled, on the same machine.
#[test]
fn a_canceled_measurement_does_not_wait_for_the_oracle() {
    const LARGE: [f32; 2] = [1600.0, 1000.0];
    let Some([_, set_up]) = durations([900.0, 600.0]) else {
        return;
    };
    let [reference, combination] = durations(LARGE).expect("there was an adapter");
    /// The shortest of a few waits, each after `begin` has opened a window: one wait may be the
    /// machine's, which had other work.
    fn shortest_wait(whole: Duration, begin: impl Fn() -> Lab) -> Result<(), Duration> {
        let enough = (whole / 3).max(Duration::from_millis(300));
        let mut shortest = Duration::MAX;
        for _ in 0..4 {
            shortest = shortest.min(cancel(&mut begin()));
            if shortest < enough {
                return Ok(());
            }
        }
        Err(shortest)
    }
    fn step_until(lab: &mut Lab, begun: Instant, duration: Duration) {
        while begun.elapsed() < duration {
            lab.step();
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    let at_the_reference = || {
        let (mut lab, begun) = measuring(LARGE).expect("there was an adapter");
        step_until(&mut lab, begun, reference / 8);
        lab
    };
    let wait = shortest_wait(reference, at_the_reference);
    assert_eq!(
        wait,
        Ok(()),
        "the reference picture takes {reference:?}, and goes on after it was canceled"
    );

    // Compiling takes as long in a small window, so that the rest is the oracle's.
    let judging = combination.saturating_sub(set_up);
    if judging < combination / 3 {
        return; // The device takes longer, which is not canceled.
    }
    let at_the_judge = || {
        let (mut lab, _) = measuring(LARGE).expect("there was an adapter");
        until(&mut lab, "the first combination", |lab| {
            measured_now(lab).is_some()
        });
        step_until(&mut lab, Instant::now(), combination - judging * 3 / 4);
        lab
    };
    let wait = shortest_wait(judging, at_the_judge);
    assert_eq!(
        wait,
        Ok(()),
        "the oracle judges a combination in {judging:?}, and goes on after it was canceled"
    );
}

#[test]
fn a_picture_that_plays_is_paused_when_a_measurement_begins() {
    draw_pictures();
    let Some(mut lab) = lab("facet-motion") else {
        return;
    };
    lab.key_press(Key::Space);
    lab.run_steps(6);
    let playing_s = lab.state().shown_time_s();
    measure_depth_of_playing(&mut lab);
    let paused_s = lab.state().shown_time_s();
    lab.run_steps(6);
    assert!(
        paused_s >= playing_s && lab.state().shown_time_s() == paused_s,
        "{playing_s} {paused_s}"
    );
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(2);
    settle(&mut lab);
}

/// The window gets no input, but its device is busy.
#[test]
fn a_measurement_waits_as_long_as_a_picture_plays() {
    draw_pictures();
    let Some(mut lab) = lab("facet-motion") else {
        return;
    };
    measure_depth(&mut lab);
    lab.key_press(Key::Space);
    lab.run_steps(3);
    let (begun, time_s) = (Instant::now(), lab.state().shown_time_s());
    // Longer than the measurement waits after a key. The first picture may come later than that on
    // a busy machine.
    until(&mut lab, "a picture that plays", |lab| {
        begun.elapsed() > Duration::from_millis(2500) && lab.state().shown_time_s() != time_s
    });
    assert!(
        lab.query_by_label_contains("Waiting while you work")
            .is_some(),
        "it goes on: {:?}",
        progress(&lab)
    );
    lab.key_press(Key::Space);
    lab.get_by_role_and_label(Role::Button, "Cancel").click();
    lab.run_steps(2);
    settle(&mut lab);
}

/// Opens the panel and begins to measure while the picture plays, so that the window never rests
/// before.
fn measure_depth_of_playing(lab: &mut Lab) {
    lab.key_press(Key::M);
    lab.run_steps(4);
    lab.get_by_role_and_label(Role::Button, "Measure").click();
    lab.run_steps(4);
}
