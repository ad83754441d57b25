//! Promise: on the timeline values are animated by keyframes, keyframes are moved, eased and
//! removed, and time plays, loops and is scrubbed.

use std::time::Duration;

use egui::{self, Key, Modifiers, Role, vec2};
use egui_kittest::kittest::Queryable as _;
use rasterlab::{oracle, preset_file};

use crate::harness::*;

#[test]
fn a_keyed_value_follows_the_clock_and_a_change_at_a_time_is_a_key() {
    draw_pictures();
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let first = value(&lab, "lambert", "headlight");
    click(&mut lab, Role::Button, "Animate lambert.headlight");
    assert_eq!(key_times(&lab, "lambert", "headlight"), [0.0]);
    let draws = lab.state().draws();
    scrub(&mut lab, 0.2, 0.5);
    let later_s = lab.state().shown_time_s();
    assert!((later_s - 2.0).abs() < 0.05, "{later_s}");
    assert_eq!(
        lab.state().draws(),
        draws,
        "one key alone moves nothing, and nothing is drawn"
    );
    let rail = slider(&lab, "lambert.headlight").rect();
    drag(
        &mut lab,
        rail.left_center() + vec2(14.0, 0.0),
        rail.right_center() - vec2(10.0, 0.0),
    );
    assert_eq!(key_times(&lab, "lambert", "headlight"), [0.0, later_s]);
    let last = shown(&lab, "lambert", "headlight");
    assert!(last[0] > first[0] + 0.2, "{first:?} {last:?}");
    assert_eq!(
        value(&lab, "lambert", "headlight"),
        first,
        "the value without keys stays"
    );
    assert_eq!(
        lab.state().undo_steps(),
        2,
        "scrubbing is none, and a drag that makes a key is one"
    );
    let draws = lab.state().draws();
    scrub(&mut lab, 0.5, 0.3);
    let between = shown(&lab, "lambert", "headlight");
    assert!(
        first[0] < between[0] && between[0] < last[0],
        "{first:?} {between:?} {last:?}"
    );
    assert!(lab.state().draws() > draws);
    let field = lab
        .get_by_label("lambert.headlight value")
        .value()
        .expect("a number");
    assert!(
        (field.parse::<f64>().expect("a number") - between[0]).abs() < 1e-3,
        "the slider shows {field} and not {between:?}"
    );
    undo(&mut lab);
    assert_eq!(key_times(&lab, "lambert", "headlight"), [0.0]);
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(key_times(&lab, "lambert", "headlight"), [0.0, later_s]);
}

#[test]
fn removing_the_last_key_leaves_its_value() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    scrub(&mut lab, 0.1, 0.25);
    click(&mut lab, Role::Button, "Animate lambert.headlight");
    let rail = slider(&lab, "lambert.headlight").rect();
    drag(
        &mut lab,
        rail.left_center() + vec2(14.0, 0.0),
        rail.center(),
    );
    let keyed = shown(&lab, "lambert", "headlight");
    click(&mut lab, Role::Button, "Remove key of lambert.headlight");
    assert!(key_times(&lab, "lambert", "headlight").is_empty());
    assert_eq!(value(&lab, "lambert", "headlight"), keyed);
    assert!(lab.query_by_label("Animate lambert.headlight").is_some());
}

#[test]
fn a_reset_of_an_animated_value_takes_its_keys() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let default = value(&lab, "lambert", "headlight");
    click(&mut lab, Role::Button, "Animate lambert.headlight");
    click(&mut lab, Role::Button, "Reset lambert.headlight");
    assert!(lab.state().preset_file().preset.animation.is_empty());
    assert_eq!(value(&lab, "lambert", "headlight"), default);
    undo(&mut lab);
    assert_eq!(key_times(&lab, "lambert", "headlight"), [0.0]);
}

#[test]
fn dragging_a_mark_moves_its_key_in_one_undo_step() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), MOVING) else {
        return;
    };
    let mark = lab
        .get_by_role_and_label(Role::Button, "Key facet.amount 1.000 s")
        .rect()
        .center();
    drag(&mut lab, mark, mark + vec2(120.0, 2.0));
    let times = key_times(&lab, "facet", "amount");
    assert!(
        times.len() == 3 && times[1] > 1.3 && times[1] < 3.0,
        "{times:?}"
    );
    assert!(
        ((times[1] * 30.0).round() / 30.0 - times[1]).abs() < 1e-9,
        "{times:?} are not on the grid of frames"
    );
    assert_eq!(lab.state().undo_steps(), 1);
    undo(&mut lab);
    assert_eq!(
        (key_times(&lab, "facet", "amount"), lab.state().undo_steps()),
        (vec![0.0, 1.0, 3.0], 0)
    );
    // It never passes its neighbors, however far it is dragged.
    drag(&mut lab, mark, mark + vec2(900.0, 0.0));
    let times = key_times(&lab, "facet", "amount");
    assert!(times[1] > 2.9 && times[1] < 3.0, "{times:?}");
}

#[test]
fn a_selected_key_is_eased_and_removed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), MOVING) else {
        return;
    };
    click(&mut lab, Role::Button, "Key facet.amount 1.000 s");
    assert_eq!(lab.state().shown_time_s(), 1.0, "a click goes there");
    click(&mut lab, Role::ComboBox, "Key easing");
    click(&mut lab, Role::Button, "linear");
    let easing = |lab: &Lab| {
        lab.state()
            .preset_file()
            .preset
            .animation
            .get("facet", "amount")
            .expect("a track")
            .keys()[1]
            .easing
    };
    assert_eq!(easing(&lab), rasterlab::preset::animation::Easing::Linear);
    press(&mut lab, Modifiers::NONE, Key::Delete);
    assert_eq!(key_times(&lab, "facet", "amount"), [0.0, 3.0]);
    assert_eq!(lab.state().undo_steps(), 2);
    undo(&mut lab);
    undo(&mut lab);
    assert_eq!(easing(&lab), rasterlab::preset::animation::Easing::Smooth);
}

#[test]
fn without_a_name_the_window_starts_on_the_first_preset_playing_on_a_card_and_with_one_at_rest() {
    draw_pictures();
    let Some(mut lab) = opened(None, None) else {
        return;
    };
    assert_eq!(lab.state().preset_file().id, rasterlab::app::FIRST_PRESET);
    let start_s = lab.state().shown_time_s();
    let is_software = lab.state().gpu().summary.software;
    if is_software {
        // Its own moment, whole: what moves would be drawn at half its size.
        settle(&mut lab);
        lab.run_steps(10);
        let picture = lab.get_by_label("Picture").rect().size();
        assert_eq!(
            lab.state().ordered_size(),
            Some([picture.x as u32, picture.y as u32])
        );
        assert_eq!(
            [start_s, lab.state().shown_time_s()],
            [lab.state().preset_file().preset.clock.time_s; 2]
        );
    }
    if !is_software {
        wait_until(&mut lab, "it plays", |lab| {
            lab.state().draws() >= 3 && lab.state().shown_time_s() != start_s
        });
    }
    assert_eq!(
        (
            lab.state().undo_steps(),
            lab.state().preset_file().is_modified()
        ),
        (0, false)
    );

    let Some(mut lab) = self::lab(rasterlab::app::FIRST_PRESET) else {
        return;
    };
    let [time_s, draws] = [lab.state().shown_time_s(), lab.state().draws() as f64];
    lab.run_steps(5);
    assert_eq!(
        [lab.state().shown_time_s(), lab.state().draws() as f64],
        [time_s, draws]
    );
}

#[test]
fn play_runs_loops_and_pauses() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    // No whole number of steps of the window's clock is as long as the range.
    let range_s = [0.25, 1.15];
    let text = format!("{MOVING}[clock]\ntime_s = 0.5\nrange_s = {range_s:?}\n");
    let Some(mut lab) = lab_of(folder.path(), &text) else {
        return;
    };
    let preset = lab.state().preset_file().preset.clone();
    let draws = lab.state().draws();
    lab.key_press(Key::Space);
    let (mut last_s, mut runs, mut loops) = (lab.state().shown_time_s(), false, false);
    wait_until(&mut lab, "it plays, loops and is drawn", |lab| {
        let time_s = lab.state().shown_time_s();
        assert!((range_s[0]..range_s[1]).contains(&time_s), "{time_s}");
        (runs, loops) = (runs || time_s > last_s, loops || time_s < last_s);
        last_s = time_s;
        runs && loops && lab.state().draws() > draws + 5
    });
    press(&mut lab, Modifiers::NONE, Key::Space);
    let (paused_s, draws) = (lab.state().shown_time_s(), lab.state().draws());
    lab.run_steps(10);
    assert_eq!(
        (lab.state().shown_time_s(), lab.state().draws()),
        (paused_s, draws)
    );
    assert_eq!(
        lab.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay,
        Duration::MAX,
        "{:?}",
        lab.ctx.repaint_causes()
    );
    assert_eq!(
        (&lab.state().preset_file().preset, lab.state().undo_steps()),
        (&preset, 0),
        "playing changes no preset"
    );
}

#[test]
fn play_without_loop_stops_at_the_end() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(
        folder.path(),
        &format!("{MOVING}[clock]\nrange_s = [0.0, 0.5]\n"),
    ) else {
        return;
    };
    click(&mut lab, Role::CheckBox, "Loop");
    assert_eq!(
        lab.state().undo_steps(),
        1,
        "whether a preset loops belongs to it"
    );
    lab.key_press(Key::Space);
    wait_until(&mut lab, "the end", |lab| lab.state().shown_time_s() == 0.5);
    settle(&mut lab);
    lab.run_steps(5);
    assert_eq!(lab.state().shown_time_s(), 0.5);
}

#[test]
fn time_is_stepped_by_frames_and_kept_on_request() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), MOVING) else {
        return;
    };
    for (key, frame) in [
        (Key::Period, 1.0),
        (Key::Period, 2.0),
        (Key::Comma, 1.0),
        (Key::Comma, 0.0),
        (Key::Comma, -1.0),
    ] {
        press(&mut lab, Modifiers::NONE, key);
        assert!(
            (lab.state().shown_time_s() - frame / 30.0).abs() < 1e-9,
            "{} s",
            lab.state().shown_time_s()
        );
    }
    scrub(&mut lab, 0.1, 0.5);
    assert_eq!(
        (
            lab.state().preset_file().preset.clock.time_s,
            lab.state().undo_steps()
        ),
        (0.0, 0)
    );
    let time_s = lab.state().shown_time_s();
    click(&mut lab, Role::Button, "Keep");
    assert_eq!(
        (
            lab.state().preset_file().preset.clock.time_s,
            lab.state().undo_steps()
        ),
        (time_s, 1)
    );
    press(&mut lab, Modifiers::NONE, Key::Num0);
    assert_eq!(lab.state().shown_time_s(), 0.0);
}

#[test]
fn the_window_shows_the_picture_of_the_moment() {
    draw_pictures();
    let folder = tempfile::tempdir().expect("a temporary folder");
    let Some(mut lab) = lab_of(folder.path(), MOVING) else {
        return;
    };
    scrub(&mut lab, 0.1, 0.6);
    lab.remove_cursor();
    settle(&mut lab);
    let seen = picture(&mut lab);
    let mut preset = lab.state().preset_file().preset.clone();
    preset.clock.time_s = lab.state().shown_time_s();
    let scene = preset_file::load_scene(&preset, None).expect("a built-in scene");
    let view = lab
        .state()
        .view([seen.width(), seen.height()])
        .expect("a scene on stage");
    let expected = oracle::render(&scene, &view, &preset.evaluated_stack()).expect("a picture");
    let pairs = seen
        .enumerate_pixels()
        .zip(&expected.color)
        .filter(|((x, y, _), _)| is_clear(&seen, *x, *y));
    let wrong = pairs
        .filter(|((.., a), b)| a.0.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1))
        .count();
    assert!(
        wrong <= 24,
        "{wrong} of {} pixels differ by more than 1",
        expected.color.len()
    );
}

#[test]
fn a_scene_at_rest_offers_its_clips_under_the_timeline() {
    let Some(mut lab) = lab("builtin:tentacle?tess=3") else {
        return;
    };
    let scene = rasterlab::scene::builtin::build("tentacle?tess=3").expect("a builtin");
    let sway = &scene.rig.clips[scene.rig.clip("Sway").expect("it sways")];
    lab.get_by_role_and_label(Role::Button, "Play Sway").click();
    // It plays from here on and never comes to rest.
    lab.run_steps(4);
    let preset = &lab.state().preset_file().preset;
    assert_eq!(
        (preset.playback.clip.as_str(), preset.clock.range_s),
        ("Sway", [0.0, sway.duration_s])
    );
    assert!(
        lab.query_by_role_and_label(Role::Button, "Play Sway")
            .is_none(),
        "it plays"
    );
    assert!(lab.query_by_label_contains("Sway plays").is_some());
}
