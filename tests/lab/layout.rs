//! Promise: nothing overlaps or is cut off in a small window, in both themes; values stay in their
//! boxes; a click on a slider counts however short it is; a number that cannot be taken is said;
//! Escape closes what is open, the innermost first.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Role, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use rasterlab::preset_file::Folders;

use crate::harness::*;

/// Names and places of what can be clicked and lies in `area` in part.
fn controls(lab: &Lab, area: Rect) -> Vec<(String, Rect)> {
    let roles = [Role::Button, Role::CheckBox, Role::Slider, Role::ComboBox];
    let nodes = roles
        .into_iter()
        .flat_map(|role| lab.query_all_by_role(role));
    nodes
        .map(|node| {
            (
                node.accesskit_node().label().unwrap_or_default(),
                node.rect(),
            )
        })
        .filter(|(name, rect)| !name.is_empty() && rect.intersects(area) && rect.width() > 0.0)
        .collect()
}

#[test]
fn in_a_small_window_no_control_is_cut_off_or_covered() {
    let size = [900.0, 600.0];
    let Some(mut lab) = created(Some("facet-knot"), Folders::default(), None, size) else {
        return;
    };
    settle(&mut lab);
    let window = Rect::from_min_size(Pos2::ZERO, size.into());
    let picture = lab.get_by_label("Picture").rect();
    assert!(
        picture.width() > size[0] / 3.0 && picture.height() > 200.0,
        "{picture}"
    );
    let top = Rect::from_min_max(Pos2::ZERO, lower_right(window, picture));
    let over_picture = Rect::from_min_max(picture.min, picture.right_top() + vec2(0.0, 46.0));
    for (what, area) in [("top bar", top), ("picture", over_picture)] {
        // Presets are scrolled below the top bar, where they are hidden.
        let is_over = |name: &str| !name.starts_with("Picture") && !name.starts_with("Preset ");
        let controls: Vec<_> = controls(&lab, area.shrink(1.0))
            .into_iter()
            .filter(|(name, _)| is_over(name))
            .collect();
        assert!(controls.len() >= 4, "{what}: {controls:?}");
        for (at, (name, rect)) in controls.iter().enumerate() {
            let bounds = if what == "picture" { picture } else { window };
            assert!(
                bounds.expand(0.5).contains_rect(*rect),
                "{what}: {name} at {rect} is cut off"
            );
            for (other, other_rect) in &controls[..at] {
                assert!(
                    !rect.shrink(1.0).intersects(other_rect.shrink(1.0)),
                    "{what}: {name} at {rect} covers {other} at {other_rect}"
                );
            }
        }
    }
    assert!(lab.query_by_label_contains("Compare:").is_some());
}

#[test]
fn the_guide_stays_inside_the_window() {
    let size = [900.0, 700.0];
    let Some(mut lab) = created(Some("facet-knot"), Folders::default(), None, size) else {
        return;
    };
    settle(&mut lab);
    click(&mut lab, Role::Button, "Help");
    click(&mut lab, Role::Button, "Guide");
    lab.run_steps(4);
    let window = Rect::from_min_size(Pos2::ZERO, size.into());
    for text in ["Ten minutes lead", "the picture costs (milliseconds)"] {
        let place = lab.get_by_label_contains(text).rect().x_range();
        assert!(
            window.x_range().contains(place.min) && window.x_range().contains(place.max),
            "{text}"
        );
    }
}

#[test]
fn in_a_small_window_no_word_of_the_top_bar_covers_another_when_there_is_most_to_say() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("all.toml");
    let text = "schema = 2\nname = \"A name of some length\"\n[scene]\nbuiltin = \"teapot\"\n[effects.facet]\n[accuracy]\ncoverage = \"fixed4\"\ndepth = \"log16\"\n";
    std::fs::write(&path, text).expect("a file");
    let size = [900.0, 600.0];
    let Some(mut lab) = created(
        Some(&path.to_string_lossy()),
        Folders::default(),
        None,
        size,
    ) else {
        return;
    };
    settle(&mut lab);
    lab.state_mut().preset_mut().spin_deg_per_s = 20.0;
    click(&mut lab, Role::Button, "Verify");
    let window = Rect::from_min_size(Pos2::ZERO, size.into());
    let top = Rect::from_min_max(
        Pos2::ZERO,
        lower_right(window, lab.get_by_label("Picture").rect()),
    );
    let mut shown = controls(&lab, top.shrink(1.0));
    let labels = lab.query_all_by_role(Role::Label);
    let text = |node: &egui_kittest::Node<'_>| {
        node.accesskit_node()
            .label()
            .or_else(|| node.accesskit_node().value())
            .unwrap_or_default()
    };
    shown.extend(
        labels
            .map(|node| (text(&node), node.rect()))
            .filter(|(_, rect)| top.contains(rect.center())),
    );
    shown.retain(|(name, _)| !name.starts_with("Picture") && !name.starts_with("Preset "));
    assert!(
        shown.iter().any(|(name, _)| name.contains(" by rounding")),
        "{shown:?}"
    );
    for (at, (name, rect)) in shown.iter().enumerate() {
        assert!(
            window.expand(0.5).contains_rect(*rect),
            "{name} at {rect} is cut off"
        );
        for (other, other_rect) in &shown[..at] {
            assert!(
                !rect.shrink(1.0).intersects(other_rect.shrink(1.0)),
                "{name} at {rect} covers {other} at {other_rect}"
            );
        }
    }
    let title = shown
        .iter()
        .find(|(name, _)| name.starts_with("A name"))
        .expect("the name of the preset");
    assert!(title.1.width() >= 24.0, "{title:?}"); // It is cut where there is no room.
}

/// At every width of the picture, its notes lie beside the buttons or below them, and never over
/// each other.
#[test]
fn notes_on_the_picture_cover_no_button_and_no_other_note() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("notes.toml");
    let text = "schema = 2\n[scene]\nbuiltin = \"teapot?tess=4\"\n[effects.draw_order]\n[effects.race]\n[effects.facet]\n";
    std::fs::write(&path, text).expect("a file");
    for size in [[900.0, 600.0], [1280.0, 800.0], [1600.0, 1000.0]] {
        let Some(mut lab) = created(
            Some(&path.to_string_lossy()),
            Folders::default(),
            None,
            size,
        ) else {
            return;
        };
        settle(&mut lab);
        click(&mut lab, Role::Button, "Mute facet");
        wait_for_toasts(&mut lab);
        lab.run_steps(2);
        let picture = lab.get_by_label("Picture").rect();
        let notes = ["muted: facet", "drew ", "not reproducible"].map(|text| {
            let found = lab
                .query_all_by_label_contains(text)
                .map(|node| node.rect());
            found
                .into_iter()
                .find(|rect| picture.contains(rect.center()))
                .unwrap_or_else(|| {
                    panic!("no note {text:?} at {size:?}\n{}", lab.state().log_text())
                })
        });
        let over_picture = Rect::from_min_max(picture.min, picture.right_top() + vec2(0.0, 46.0));
        let buttons: Vec<_> = controls(&lab, over_picture)
            .into_iter()
            .filter(|(name, _)| !name.starts_with("Picture"))
            .collect();
        assert!(buttons.len() >= 4, "{buttons:?}");
        for (at, note) in notes.iter().enumerate() {
            assert!(
                picture.contains_rect(*note),
                "{note} leaves the picture {picture} at {size:?}"
            );
            let covered = buttons
                .iter()
                .find(|(_, rect)| rect.intersects(note.expand(4.0)));
            assert!(covered.is_none(), "{note} covers {covered:?} at {size:?}");
            assert!(
                notes[..at].iter().all(|other| !other.intersects(*note)),
                "{notes:?} at {size:?}"
            );
        }
    }
}

/// The lower right corner of the top bar.
fn lower_right(window: Rect, picture: Rect) -> Pos2 {
    Pos2::new(window.right(), picture.top() - 2.0)
}

fn button(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    }
}

#[test]
fn a_click_and_a_drag_within_one_frame_move_a_slider() {
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    let rail = slider(&lab, "facet.amount").rect();
    let at = |part: f32| Pos2::new(rail.left() + part * rail.width(), rail.center().y);
    let pressed_at = |lab: &mut Lab, events: Vec<Event>| {
        lab.input_mut().events.extend(events);
        lab.run_steps(6);
        settle(lab);
        value(lab, "facet", "amount")[0]
    };
    let low = pressed_at(
        &mut lab,
        vec![
            Event::PointerMoved(at(0.25)),
            button(at(0.25), true),
            button(at(0.25), false),
        ],
    );
    assert!((low - 0.25).abs() < 0.1, "the click was lost: {low}");
    let moves = [0.3, 0.5, 0.75].map(|part| Event::PointerMoved(at(part)));
    let events = [
        vec![Event::PointerMoved(at(0.25)), button(at(0.25), true)],
        moves.to_vec(),
        vec![button(at(0.75), false)],
    ]
    .concat();
    let high = pressed_at(&mut lab, events);
    assert!((high - 0.75).abs() < 0.1, "the drag was lost: {high}");

    // The camera follows a drag within one frame, too.
    let view = lab.get_by_label("Picture").rect();
    let before = lab.state().preset_file().preset.camera;
    let [from, to] = [view.center(), view.center() + vec2(90.0, 30.0)];
    let events = vec![
        Event::PointerMoved(from),
        button(from, true),
        Event::PointerMoved(to),
        button(to, false),
    ];
    lab.input_mut().events.extend(events);
    lab.run_steps(6);
    settle(&mut lab);
    assert_ne!(
        lab.state().preset_file().preset.camera,
        before,
        "the drag over the picture was lost"
    );
}

#[test]
fn long_numbers_stay_in_their_boxes_beside_each_other() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = "schema = 2\n[scene]\nbuiltin = \"teapot\"\n[effects.facet]\npattern = \"radial\"\ncenter = [-98765.43, 54321.987, -12345.678]\n\
        radius_m = 87654.32\n";
    let Some(lab) = lab_of(folder.path(), text) else {
        return;
    };
    let boxes = ["facet.center.x", "facet.center.y", "facet.center.z"]
        .map(|name| lab.get_by_label(name).rect());
    for (at, rect) in boxes.iter().enumerate() {
        assert!(
            rect.right() <= 1280.0 && boxes[..at].iter().all(|left| left.right() < rect.left()),
            "{boxes:?}"
        );
    }
    let (field, reset) = (
        lab.get_by_label("facet.radius_m value").rect(),
        lab.get_by_label("Reset facet.radius_m").rect(),
    );
    assert!(
        field.right() <= reset.left()
            && slider(&lab, "facet.radius_m").rect().right() <= field.left(),
        "{field} {reset}"
    );
}

#[test]
fn at_most_three_toasts_stand_over_the_picture_and_clear_of_the_timeline() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    wait_for_toasts(&mut lab);
    let command = Modifiers::COMMAND;
    for (modifiers, key) in [
        (command, Key::Z),
        (command | Modifiers::SHIFT, Key::Z),
        (Modifiers::NONE, Key::Delete),
    ] {
        lab.key_press_modifiers(modifiers, key);
        lab.step();
    }
    lab.event(Event::Paste("no preset".into()));
    lab.run_steps(3);
    let picture = lab.get_by_label("Picture").rect();
    let timeline = lab.get_by_role_and_label(Role::Slider, "Timeline").rect();
    let said = [
        "Nothing to undo",
        "Nothing to redo",
        "No key is selected",
        "rasterlab1:",
    ];
    let toasts: Vec<Rect> = said
        .iter()
        .flat_map(|text| lab.query_all_by_label_contains(text))
        .map(|node| node.rect())
        .collect();
    assert_eq!(toasts.len(), 3, "{toasts:?}\n{}", lab.state().log_text());
    for toast in toasts {
        assert!(
            picture.contains_rect(toast)
                && toast.bottom() < picture.center().y
                && toast.bottom() < timeline.top(),
            "{toast}"
        );
    }
}

/// The largest contrast between two pixels of `area`, as the guidelines for accessible pages count
/// it.
fn contrast(window: &image::RgbaImage, area: Rect) -> f64 {
    let linear = |c: u8| {
        let c = f64::from(c) / 255.0;
        if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    };
    let [x, y, width, height] =
        [area.min.x, area.min.y, area.width(), area.height()].map(|v| v.round() as u32);
    let part = image::imageops::crop_imm(window, x, y, width, height).to_image();
    let lights: Vec<f64> = part
        .pixels()
        .map(|p| 0.2126 * linear(p.0[0]) + 0.7152 * linear(p.0[1]) + 0.0722 * linear(p.0[2]) + 0.05)
        .collect();
    lights.iter().copied().fold(0.0, f64::max)
        / lights.iter().copied().fold(f64::INFINITY, f64::min)
}

#[test]
fn icons_show_in_both_themes_and_over_pictures_of_any_color() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (theme, color) in [
        ("Dark", "1.0"),
        ("Light", "0.0"),
        ("Dark", "0.7"),
        ("Light", "0.3"),
    ] {
        let text = format!(
            "schema = 2\n[scene]\nbuiltin = \"teapot?tess=4\"\n[effects.facet]\n[output]\nbackground = [{color}, {color}, {color}, 1.0]\n"
        );
        let Some(mut lab) = lab_of(folder.path(), &text) else {
            return;
        };
        press(&mut lab, Modifiers::COMMAND, Key::Comma);
        click(&mut lab, Role::Button, theme);
        press(&mut lab, Modifiers::NONE, Key::Escape);
        wait_for_toasts(&mut lab);
        lab.remove_cursor();
        lab.run_steps(3);
        let window = lab.screenshot();
        let names = [
            "Frame the scene",
            "Next preset",
            "Mute facet",
            "More of facet",
        ];
        let icons = names.map(|name| {
            lab.query_all_by_label_contains(name)
                .next()
                .unwrap_or_else(|| panic!("no {name}"))
                .rect()
        });
        for (name, rect) in names.iter().zip(icons) {
            let contrast = contrast(&window, rect.shrink(3.0));
            assert!(
                contrast >= 3.0,
                "{name}: {contrast:.2} with the {theme} theme over {color}"
            );
        }
    }
}

#[test]
fn a_number_out_of_range_is_said_to_be_clamped_and_a_word_to_be_none() {
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    for (typed, said, expected) in [
        ("7", "facet.amount takes 0 to 1: 7 became 1", 1.0),
        ("abc", "\"abc\" is no number, so it stays 1", 1.0),
    ] {
        lab.get_by_label("facet.amount value").click();
        lab.run_steps(3);
        lab.event(Event::Text(typed.into()));
        lab.run_steps(2);
        press(&mut lab, Modifiers::NONE, Key::Enter);
        assert_eq!(value(&lab, "facet", "amount"), [expected]);
        assert!(
            lab.state().log_text().contains(said),
            "{}",
            lab.state().log_text()
        );
    }
    // A look at the number changes nothing and says nothing.
    let before = lab.state().log_text();
    lab.get_by_label("facet.amount value").click();
    lab.run_steps(3);
    press(&mut lab, Modifiers::NONE, Key::Enter);
    assert_eq!(
        (value(&lab, "facet", "amount"), lab.state().log_text()),
        (vec![1.0], before)
    );
}

#[test]
fn escape_closes_the_innermost_first() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    press(&mut lab, Modifiers::NONE, Key::L);
    press(&mut lab, Modifiers::NONE, Key::M);
    press(&mut lab, Modifiers::COMMAND, Key::Comma);
    press(&mut lab, Modifiers::COMMAND, Key::O);
    let is_open = |lab: &Lab| {
        [
            lab.query_by_role_and_label(Role::TextInput, "Path")
                .is_some(),
            lab.query_by_role_and_label(Role::TextInput, "Search actions and keys")
                .is_some(),
            lab.state().is_trade_open(),
            lab.query_by_label("Clear the log").is_some(),
        ]
    };
    assert_eq!(is_open(&lab), [true; 4]);
    for closed in 1..=4 {
        press(&mut lab, Modifiers::NONE, Key::Escape);
        assert_eq!(
            is_open(&lab),
            [0, 1, 2, 3].map(|at| at >= closed),
            "after {closed} times Escape"
        );
    }
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert_eq!(lab.state().undo_steps(), 0);
}

#[test]
fn escape_closes_the_windows_for_films_sweeps_and_seeds() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    press(&mut lab, Modifiers::NONE, Key::L);
    let windows = [
        (Modifiers::SHIFT, Key::R, "The last twelve seeds"),
        (Modifiers::SHIFT, Key::S, "Draw the sheet"),
        (Modifiers::COMMAND | Modifiers::SHIFT, Key::E, "Export film"),
    ];
    for (modifiers, key, shown) in windows {
        press(&mut lab, modifiers, key);
        assert!(
            lab.query_all_by_label_contains(shown).next().is_some(),
            "{shown}"
        );
        press(&mut lab, Modifiers::NONE, Key::Escape);
        assert!(
            lab.query_all_by_label_contains(shown).next().is_none(),
            "Escape does not close {shown}"
        );
        assert!(
            lab.query_by_label("Clear the log").is_some(),
            "Escape closes the log as well"
        );
    }
}

#[test]
fn escape_closes_the_extreme_cases_and_the_comparison() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    press(&mut lab, Modifiers::NONE, Key::L);
    click(&mut lab, Role::Button, "Judge");
    click(&mut lab, Role::Button, "Run extreme cases…");
    assert!(
        lab.query_by_role_and_label(Role::TextInput, "Cases")
            .is_some()
    );
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(
        lab.query_by_role_and_label(Role::TextInput, "Cases")
            .is_none(),
        "Escape does not close the extreme cases"
    );
    press(&mut lab, Modifiers::SHIFT, Key::Backslash);
    assert!(lab.state().wipe_split().is_some());
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(
        lab.state().wipe_split().is_none(),
        "Escape does not close the comparison"
    );
    assert!(
        lab.query_by_label("Clear the log").is_some(),
        "Escape closes the log as well"
    );
}

#[test]
fn escape_ends_a_choice_in_the_picture_and_leaves_the_panels() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text =
        "schema = 2\n[scene]\nbuiltin = \"teapot?tess=4\"\n[effects.facet]\npattern = \"radial\"\n";
    let Some(mut lab) = lab_of(folder.path(), text) else {
        return;
    };
    press(&mut lab, Modifiers::NONE, Key::L);
    click(&mut lab, Role::Button, "Pick facet.center");
    let asks = |lab: &Lab| {
        lab.query_by_label_contains("click a point of the model")
            .is_some()
    };
    assert!(asks(&lab));
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(!asks(&lab), "Escape does not end the choice");
    assert!(
        lab.query_by_label("Clear the log").is_some(),
        "Escape closes the log as well"
    );
}

#[test]
fn escape_in_a_field_leaves_the_field_and_no_panel() {
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    press(&mut lab, Modifiers::NONE, Key::L);
    lab.get_by_label("facet.amount value").click();
    lab.run_steps(3);
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(lab.query_by_label("Clear the log").is_some());
    press(&mut lab, Modifiers::NONE, Key::Escape);
    assert!(lab.query_by_label("Clear the log").is_none());
}
