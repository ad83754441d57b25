//! Promise: wrong and doubtful pixels are gone through one by one, each ringed, enlarged and told
//! why it shows what it shows.

use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};

use crate::harness::*;

fn label_of(lab: &Lab, text: &str) -> Option<String> {
    lab.query_all_by_label_contains(text)
        .next()
        .and_then(|node| node.value().or_else(|| node.accesskit_node().label()))
}

/// The pixel that the probe tells of.
fn probed(lab: &Lab) -> Option<String> {
    label_of(lab, "Pixels round ")
}

#[test]
fn next_and_previous_go_through_the_pixels_of_the_overlays() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    // On a coarse grid many pixels show another triangle than the exact picture.
    let preset = "schema = 2\n[scene]\nbuiltin = \"knot?tess=4\"\n[effects.facet]\n[accuracy]\ncoverage = \"fixed4\"\n[output]\nsize = [640, 480]\n";
    let Some(mut lab) = lab_of(folder.path(), preset) else {
        return;
    };
    press(&mut lab, Modifiers::NONE, Key::O);
    let mut told = Vec::new();
    for (key, place) in [
        ((Modifiers::NONE, Key::N), "1 of "),
        ((Modifiers::NONE, Key::N), "2 of "),
        ((Modifiers::SHIFT, Key::N), "1 of "),
    ] {
        let before = probed(&lab);
        press(&mut lab, key.0, key.1);
        wait_for(&mut lab, "the probe answers", |lab| {
            probed(lab).is_some() && probed(lab) != before
        });
        let is_marked = |text: &String| text.starts_with(place) && text.contains("triangle");
        let marked = lab
            .query_all_by_label_contains(place)
            .filter_map(|node| node.value().or_else(|| node.accesskit_node().label()))
            .find(is_marked);
        assert!(marked.is_some(), "{place}");
        told.push(probed(&lab));
    }
    assert!(told[0] == told[2] && told[0] != told[1], "{told:?}");
    let pixels = label_of(&lab, "Pixels round ").expect("the loupe");
    click(&mut lab, Role::Button, "Larger pixels");
    assert!(lab.query_by_label("64 \u{d7}").is_some());
    // The middle of the loupe is the pixel that is told of, beside it lies another.
    let loupe = lab.get_by_role_and_label(Role::Image, &pixels).rect();
    let beside = loupe.center() + egui::vec2(64.0, 0.0);
    lab.drag_at(beside);
    lab.step();
    lab.drop_at(beside);
    wait_for(&mut lab, "the pixel beside is told of", |lab| {
        probed(lab) != told[0]
    });
    // Shift+N goes on from there, and Escape ends it.
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert_eq!(probed(&lab), None);
    click(&mut lab, Role::Button, "Next pixel");
    wait_for(&mut lab, "the first is told of again", |lab| {
        probed(lab) == told[0]
    });
}
