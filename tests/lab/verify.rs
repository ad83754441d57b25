//! Promise: errors are measured, shown as overlays with a legend, and the extreme cases run beside
//! the window.

use std::time::{Duration, Instant};

use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use rasterlab::preset_file::Folders;

use crate::harness::*;

#[test]
fn verify_measures_the_picture_and_a_change_makes_the_result_stale() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    assert!(lab.query_by_label("– wrong pixels").is_some());
    click(&mut lab, Role::Button, "Verify");
    let accuracy = lab
        .state()
        .accuracy()
        .cloned()
        .expect("a verdict on the picture as it is shown");
    assert_eq!(
        (
            accuracy.wrong_triangles,
            accuracy.holes,
            accuracy.double_hits
        ),
        (0, 0, 0)
    );
    assert!(
        accuracy.pixels > 100_000 && accuracy.max_color_delta <= 2,
        "{accuracy:?}"
    );
    assert!(lab.query_all_by_label_contains("no wrong pixel").count() > 0);
    click(&mut lab, Role::Button, "Top view, then bottom");
    assert!(lab.state().accuracy().is_none());
    assert!(lab.query_all_by_label_contains("stale").count() > 0);
}

#[test]
fn verifying_can_be_canceled_and_leaves_the_picture_unjudged() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    lab.get_by_role_and_label(Role::Button, "Verify").click();
    lab.run_steps(2);
    assert!(
        lab.query_by_role_and_label(Role::Button, "Verify")
            .is_none()
            && lab.query_by_label_contains(" left").is_some()
    );
    lab.get_by_role_and_label(Role::Button, "Cancel verifying")
        .click();
    lab.run_steps(2);
    settle(&mut lab);
    assert!(
        lab.state().accuracy().is_none() && error_lines(&lab).is_empty(),
        "{}",
        lab.state().log_text()
    );
    click(&mut lab, Role::Button, "Verify");
    assert!(
        lab.state().accuracy().is_some(),
        "it can be judged afterwards"
    );
}

/// What the bar of work under way says, and how full it is, percent.
fn bar(lab: &Lab) -> Option<(String, f64)> {
    let bar = lab.query_all_by_role(Role::ProgressIndicator).next()?;
    let node = bar.accesskit_node();
    Some((
        node.label().unwrap_or_default(),
        node.numeric_value().unwrap_or(f64::NAN),
    ))
}

#[test]
fn verifying_shows_how_far_it_is_and_ends_in_the_middle_when_it_is_canceled() {
    draw_pictures();
    let Some(mut lab) = created(
        Some("facet-sweep"),
        Folders::default(),
        None,
        [1600.0, 1000.0],
    ) else {
        return;
    };
    settle(&mut lab);
    let begin = |lab: &mut Lab| {
        lab.get_by_role_and_label(Role::Button, "Verify").click();
        lab.run_steps(2);
        Instant::now()
    };
    let begun = begin(&mut lab);
    let mut said = Vec::new();
    while !lab.state().is_idle() {
        said.extend(bar(&lab));
        lab.step();
        std::thread::sleep(Duration::from_millis(5));
        assert!(
            begun.elapsed() < Duration::from_secs(120),
            "{}",
            lab.state().log_text()
        );
    }
    let whole = begun.elapsed();
    assert!(lab.state().accuracy().is_some());
    assert!(
        !said.is_empty()
            && said
                .iter()
                .all(|(text, _)| text.starts_with("about ") && text.ends_with(" left")),
        "{said:?}"
    );
    let most = said.iter().map(|(_, percent)| *percent).fold(0.0, f64::max);
    assert!(
        said[0].1 < most && most <= 100.0,
        "no progress is shown: {said:?}"
    );

    click(&mut lab, Role::Button, "Top view, then bottom");
    let begun = begin(&mut lab);
    while begun.elapsed() < whole / 2 {
        lab.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    let Some(cancel) = lab.query_by_role_and_label(Role::Button, "Cancel verifying") else {
        return;
    }; // It was much quicker.
    cancel.click();
    lab.step();
    let canceled = Instant::now();
    while lab
        .query_by_role_and_label(Role::Button, "Verify")
        .is_none()
    {
        lab.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    let took = canceled.elapsed();
    assert!(
        took < (whole / 4).max(Duration::from_millis(200)),
        "judging takes {whole:?}, and went on for {took:?}"
    );
    assert!(lab.state().accuracy().is_none());
}

#[test]
fn the_extremes_run_beside_the_window_and_can_be_stopped() {
    draw_pictures();
    let Some(mut lab) = lab("facet") else { return };
    click(&mut lab, Role::Button, "Judge");
    click(&mut lab, Role::Button, "Run extreme cases…");
    let run = |lab: &mut Lab, cases: &str, button: &str| {
        lab.get_by_label("Cases").focus();
        lab.run_steps(2);
        press(lab, Modifiers::COMMAND, Key::A);
        lab.get_by_label("Cases").type_text(cases);
        lab.run_steps(3);
        click(lab, Role::Button, button);
    };
    let until = |lab: &mut Lab, what: &str, is_there: &dyn Fn(&Lab) -> bool| {
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
    };
    let draws = lab.state().draws();
    run(&mut lab, "d3d-rectangle", "Run 1 case");
    until(&mut lab, "the end", &|lab| {
        lab.state()
            .log_text()
            .contains("Extreme cases: 1 case: 1 passed")
    });
    lab.run_steps(3);
    assert!(
        lab.query_by_label("d3d-rectangle").is_some() && lab.query_by_label("passed").is_some()
    );
    assert_eq!(
        lab.state().draws(),
        draws,
        "the picture is not drawn again for it"
    );
    lab.check_accessibility();

    run(&mut lab, "million-triangles", "Run 1 case");
    until(&mut lab, "the first picture", &|lab| {
        lab.query_by_label_contains("million-triangles: ").is_some()
    });
    click(&mut lab, Role::Button, "Stop the run");
    until(&mut lab, "the end", &|lab| {
        lab.state()
            .log_text()
            .contains("Extreme cases: 1 case: 1 stopped")
    });

    // As soon as one case is done, the time of the others is known.
    run(&mut lab, "d3d-rectangle,million-triangles", "Run 2 cases");
    until(&mut lab, "the time that is left", &|lab| {
        bar(lab).is_some_and(|(text, percent)| {
            text.starts_with("1 of 2, about ") && text.ends_with(" left") && percent == 50.0
        })
    });
    click(&mut lab, Role::Button, "Stop the run");
    until(&mut lab, "the end", &|lab| {
        lab.state()
            .log_text()
            .contains("Extreme cases: 2 cases: 1 passed, 1 stopped")
    });
}

/// Switches an overlay on in its folder of the inspector.
fn show_overlay(lab: &mut Lab, name: &str) {
    if lab
        .query_by_role_and_label(Role::CheckBox, &format!("Overlay {name}"))
        .is_none()
    {
        lab.get_by_label("Overlays").scroll_to_me();
        lab.run_steps(3);
        lab.get_by_label("Overlays").click();
        lab.run_steps(8);
    }
    click(lab, Role::CheckBox, &format!("Overlay {name}"));
}

#[test]
fn overlays_are_laid_over_the_picture_and_counted_in_a_legend() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    let (plain, draws) = (middle(&mut lab), lab.state().draws());
    show_overlay(&mut lab, "triangle edges");
    let edges = middle(&mut lab);
    assert!(edges != plain, "the edges are to be seen");
    assert!(
        lab.state().accuracy().is_some(),
        "overlays judge the picture automatically"
    );
    assert!(
        lab.query_by_label_contains("triangle edges: ").is_some(),
        "the legend counts them"
    );
    show_overlay(&mut lab, "triangle ids");
    let both = middle(&mut lab);
    assert!(both != edges);
    show_overlay(&mut lab, "triangle edges");
    let triangle_ids = middle(&mut lab);
    assert!(
        triangle_ids != both && triangle_ids != plain,
        "any subset shows"
    );
    press(&mut lab, Modifiers::NONE, Key::O);
    assert!(middle(&mut lab) == plain, "the key hides them all");
    press(&mut lab, Modifiers::NONE, Key::O);
    assert!(
        middle(&mut lab) == triangle_ids,
        "and brings back what was shown"
    );
    assert_eq!(
        (lab.state().draws(), lab.state().undo_steps()),
        (draws, 0),
        "overlays draw no frame and are no part of the preset"
    );
}

#[test]
fn the_legend_says_that_nothing_is_wrong_where_nothing_is() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    show_overlay(&mut lab, "wrong");
    show_overlay(&mut lab, "holes");
    let pixels = lab.state().accuracy().expect("a verdict").pixels;
    let sentence = format!(
        "no errors: 0 of {},{:03} pixels",
        pixels / 1000,
        pixels % 1000
    );
    assert!(
        (1000..1_000_000).contains(&pixels) && lab.query_by_label(&sentence).is_some(),
        "{sentence}"
    );
    // Another picture is judged as soon as it is at rest.
    click(&mut lab, Role::Button, "Top view, then bottom");
    assert!(lab.state().accuracy().is_some());
    assert!(lab.query_by_label_contains("no errors: 0 of ").is_some());
}
