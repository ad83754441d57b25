//! Promise: box, axes and grid lie where the camera sees them, and a measured distance is that of
//! the points of the model under both clicks.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Role, pos2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use glam::DVec2;
use rasterlab::{preset_file, scene::pick};

use crate::harness::*;

const PRESET: &str = "schema = 2\n[scene]\nbuiltin = \"teapot\"\n[effects.lambert]\n[camera]\neye = [0.0, 2.0, 9.0]\ntarget = [0.0, 1.0, 0.0]\n";

fn label(lab: &Lab, begin: &str) -> Option<(String, Rect)> {
    let is_it = |text: &String| text.starts_with(begin);
    lab.query_all_by_label_contains(begin).find_map(|node| {
        let text = node.value().or_else(|| node.accesskit_node().label());
        let text = text.filter(is_it)?;
        Some((text, node.rect()))
    })
}

#[test]
fn guides_have_the_sizes_of_the_scene_and_distances_are_measured_on_the_model() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), PRESET) else {
        return;
    };
    let file = preset_file::load(&folder.path().join("mine.toml")).expect("a preset");
    let scene = preset_file::load_scene(&file.preset, None).expect("its scene");
    assert_eq!(label(&lab, "box "), None);
    press(&mut lab, Modifiers::NONE, Key::B);
    lab.get_by_label("Overlays").scroll_to_me();
    lab.run_steps(3);
    lab.get_by_label("Overlays").click();
    lab.run_steps(3);
    click(&mut lab, Role::CheckBox, "Guide grid");
    click(&mut lab, Role::CheckBox, "Guide axes");
    let (text, _) = label(&lab, "box ").expect("the box");
    let bounds = scene.content_bounds();
    let numbers: Vec<f64> = text
        .split(|c: char| !c.is_ascii_digit() && c != '.')
        .filter_map(|word| word.parse().ok())
        .collect();
    for (number, side) in numbers.iter().zip((bounds.max - bounds.min).to_array()) {
        assert!((number / side - 1.0).abs() < 0.01, "{text}: {side}");
    }
    assert_eq!(numbers.len(), 3, "{text}");
    assert!(label(&lab, "grid ").is_some());

    let picture = lab.get_by_role_and_label(Role::Image, "Picture").rect();
    let size = [picture.width().round(), picture.height().round()].map(|side| side as u32);
    let view = lab.state().view(size).expect("a view");
    let picked = |x: u32, y: u32| {
        let uv = DVec2::new(x.into(), y.into()) / 64.0;
        pick::pick(&scene, &view, uv)
    };
    // Places where the model is, and on all sides of them.
    let inside: Vec<[u32; 2]> = (1..64 * 64)
        .map(|i| [i % 64, i / 64])
        .filter(|&[x, y]| x > 0 && y > 0)
        .filter(|&[x, y]| {
            [[x, y], [x - 1, y], [x + 1, y], [x, y - 1], [x, y + 1]]
                .iter()
                .all(|&[x, y]| picked(x, y).is_some())
        })
        .collect();
    let ends = [inside[0], inside[inside.len() - 1]];
    let places = ends.map(|end| pos2(end[0] as f32 / 64.0, end[1] as f32 / 64.0));
    for place in places {
        let at = Pos2::ZERO + picture.min.to_vec2() + place.to_vec2() * picture.size();
        lab.hover_at(at);
        lab.step();
        let pressed = |is_down| Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed: is_down,
            modifiers: Modifiers::SHIFT,
        };
        lab.event(Event::ModifiersChanged(Modifiers::SHIFT));
        for is_down in [true, false] {
            lab.event(pressed(is_down));
            lab.run_steps(2);
        }
        lab.event(Event::ModifiersChanged(Modifiers::NONE));
        lab.step();
        settle(&mut lab);
    }
    let [a, b] = ends.map(|[x, y]| picked(x, y).expect("a point of the model"));
    let (text, _) = label(&lab, "distance ").expect("a distance");
    let told: f64 = text
        .split_whitespace()
        .nth(1)
        .and_then(|number| number.parse().ok())
        .expect("a number");
    assert!((told / a.distance(b) - 1.0).abs() < 0.02, "{text}, {a} {b}");
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert_eq!(label(&lab, "distance "), None);
}
