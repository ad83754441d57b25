//! Promise: points of effects and the direction of the light are dragged in the picture, and follow
//! the pointer.

use egui::{Event, Key, Modifiers, Pos2, Role, vec2};
use egui_kittest::kittest::Queryable as _;
use glam::DVec3;

use crate::harness::*;

const RADIAL: &str = "schema = 2\n[scene]\nbuiltin = \"sphere?triangles=2000\"\n[effects.facet]\npattern = \"radial\"\n\
    center = [0.3, 0.2, 0.4]\n[effects.lambert]\n[camera]\neye = [0.0, 0.0, 4.0]\n";

fn handle(lab: &Lab, name: &str) -> Pos2 {
    lab.get_by_role_and_label(Role::Slider, name)
        .rect()
        .center()
}

fn point(lab: &Lab, effect: &str, field: &str) -> DVec3 {
    DVec3::from_slice(&value(lab, effect, field))
}

#[test]
fn a_handle_moves_the_center_of_a_pattern_across_the_view_as_one_undo_step() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = lab_of(folder.path(), RADIAL) else {
        return;
    };
    let from = handle(&lab, "Handle facet.center");
    let (to, before) = (from + vec2(70.0, -45.0), point(&lab, "facet", "center"));
    let camera = lab.state().preset_file().preset.camera;
    drag(&mut lab, from, to);
    let after = point(&lab, "facet", "center");
    let moved = after - before;
    assert!(
        moved.x > 0.05 && moved.y > 0.03 && moved.z.abs() < 1e-6,
        "{moved}"
    );
    assert!(
        handle(&lab, "Handle facet.center").distance(to) < 2.0,
        "{:?}",
        handle(&lab, "Handle facet.center")
    );
    assert_eq!(
        (
            lab.state().undo_steps(),
            lab.state().preset_file().preset.camera
        ),
        (1, camera),
        "the camera stays"
    );
    undo(&mut lab);
    assert_eq!(point(&lab, "facet", "center"), before);
}

#[test]
fn with_shift_a_handle_lies_on_the_model() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = lab_of(folder.path(), RADIAL) else {
        return;
    };
    let (from, middle) = (
        handle(&lab, "Handle facet.center"),
        lab.get_by_label("Picture").rect().center(),
    );
    lab.event(Event::ModifiersChanged(Modifiers::SHIFT));
    drag(&mut lab, from, middle + vec2(30.0, 20.0));
    lab.event(Event::ModifiersChanged(Modifiers::NONE));
    lab.step();
    let radius = point(&lab, "facet", "center").length();
    assert!(
        (0.96..1.07).contains(&radius),
        "the surface of this bumpy sphere lies at 0.96 to 1.07, not at {radius}"
    );
}

#[test]
fn points_of_particles_have_handles_and_hidden_points_have_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "schema = 2\n[scene]\nbuiltin = \"knot?tess=4\"\n[effects.facet]\n[effects.particles]\ncount = 500\nattractor = [0.4, 0.1, 0.2]\n";
    let Some(mut lab) = lab_of(folder.path(), text) else {
        return;
    };
    assert!(
        lab.query_by_label("Handle facet.center").is_none(),
        "a pattern that is not radial has no center"
    );
    let from = handle(&lab, "Handle particles.attractor");
    drag(&mut lab, from, from + vec2(-40.0, 30.0));
    assert!(handle(&lab, "Handle particles.attractor").distance(from + vec2(-40.0, 30.0)) < 2.0);
    assert_eq!(point(&lab, "particles", "center"), DVec3::ZERO);
}

#[test]
fn the_ball_turns_the_sun_of_lambert() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "schema = 2\n[scene]\nbuiltin = \"knot?tess=4\"\n[effects.lambert]\nsun_direction = [0.0, 3.0, 4.0]\n[effects.toon]\n";
    let Some(mut lab) = lab_of(folder.path(), text) else {
        return;
    };
    let ball = lab
        .get_by_role_and_label(Role::Slider, "Light direction")
        .rect()
        .center();
    drag(&mut lab, ball, ball + vec2(12.0, 0.0));
    let turned = point(&lab, "lambert", "sun_direction");
    assert!(
        (turned.length() - 1.0).abs() < 1e-4 && turned.distance(DVec3::new(0.0, 0.6, 0.8)) > 0.1,
        "{turned}"
    );
    assert_eq!(lab.state().undo_steps(), 1);
    undo(&mut lab);
    assert_eq!(
        point(&lab, "lambert", "sun_direction"),
        DVec3::new(0.0, 3.0, 4.0)
    );
}

#[test]
fn a_key_hides_the_handles_and_the_ball_and_shows_them_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = lab_of(folder.path(), RADIAL) else {
        return;
    };
    let is_shown = |lab: &Lab| {
        ["Handle facet.center", "Light direction"].map(|name| lab.query_by_label(name).is_some())
    };
    assert_eq!(is_shown(&lab), [true; 2]);
    press(&mut lab, Modifiers::NONE, Key::H);
    assert_eq!(is_shown(&lab), [false; 2]);
    press(&mut lab, Modifiers::NONE, Key::H);
    assert_eq!(is_shown(&lab), [true; 2]);
}

#[test]
fn the_ball_makes_room_for_the_numbers_of_a_comparison() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut lab) = lab_of(folder.path(), RADIAL) else {
        return;
    };
    // The last press closes the comparison.
    for is_compared in [true, true, true, false] {
        press(&mut lab, Modifiers::SHIFT, Key::Backslash);
        assert_eq!(lab.query_by_label("Compare: wipe").is_some(), is_compared);
        assert_eq!(lab.query_by_label("Light direction").is_none(), is_compared);
    }
}
