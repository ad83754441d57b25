//! Promise: the trail of the effect smear is exact, fades to its end and begins anew where another
//! picture begins.

use super::*;

fn a_trail_is_exact_and_bit_equal_on_repeats_and_with_every_option(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("knot?tess=6");
    let preset = spinning(0.2);
    let bare = drawn(
        &scene,
        &preset.view(&scene, SIZE),
        &with(&[("lambert", "", 0.0)]),
    );
    let reference =
        oracle::render_sequence(&scene, &preset.moments(&scene, SIZE)).expect("it is drawn");
    let trail = (0..reference.color.len())
        .filter(|&i| reference.triangle_id[i] == NO_TRIANGLE && reference.color[i] != bare.color[i])
        .count();
    assert!(trail > 200, "{trail} pixels of trail");
    for option in reach.options(&renderer) {
        let (capture, verdict) = renderer.judged_preset(&scene, &preset, &pinned(option));
        exactness(&verdict.report).unwrap_or_else(|why| panic!("{}: {why}", option.name()));
        let far = pictures(&capture.frame.color, &reference.color, 1);
        assert!(
            far.pixels_over_tolerance <= 2,
            "the oracle replays the same: {far:?}"
        );
        let (again, _) = renderer.judged_preset(&scene, &preset, &pinned(option));
        assert!(
            again.frame == capture.frame && again.previous == capture.previous,
            "{}",
            option.name()
        );
    }
}

#[test]
fn a_trail_fades_in_whole_steps_to_its_end_and_none_is_left_at_once_at_full_fade() {
    let scene = scene("knot?tess=6");
    let view = view(&scene, SIZE);
    let away = View {
        clip_from_world: view.clip_from_world * glam::DMat4::from_translation(DVec3::Y * 1e3),
        ..view.clone()
    };
    let after = |fade: f64, pictures: usize| {
        let stack = with(&[("smear", "fade", fade)]);
        let mut moments = vec![(view.clone(), stack.clone())];
        moments.extend(vec![(away.clone(), stack); pictures]);
        oracle::render_sequence(&scene, &moments)
            .expect("it is drawn")
            .color
    };
    let (first, nothing) = (after(0.1, 0), after(1.0, 1));
    assert!(
        nothing.iter().all(|pixel| *pixel == nothing[0]),
        "full fade leaves the background"
    );
    assert_eq!(after(0.0, 3), first, "no fade keeps everything");
    let gap = |a: &[[u8; 4]]| -> u64 {
        a.iter()
            .zip(&nothing)
            .map(|(a, b)| u64::from(a[0].abs_diff(b[0])))
            .sum()
    };
    let gaps: Vec<u64> = (0..40).map(|n| gap(&after(0.1, n))).collect();
    assert!(
        gaps.is_sorted_by(|a, b| a > b || *a == 0 && *b == 0),
        "{gaps:?}"
    );
    assert_eq!(gaps[39], 0, "it ends");
}

#[test]
fn another_size_or_scene_begins_without_a_trail_and_drawing_again_adds_none() {
    let Some(mut renderer) = loan() else { return };
    let (knot, pot) = (scene("knot?tess=6"), scene("teapot?tess=3"));
    let smear = with(&[("lambert", "", 0.0), ("smear", "fade", 0.1)]);
    let exact = split32();
    let turned = |scene: &Arc<Scene>, deg: f64| {
        let clock = Clock {
            time_s: deg,
            ..Clock::default()
        };
        Preset {
            spin_deg_per_s: 1.0,
            clock,
            ..Preset::default()
        }
        .view(scene, SIZE)
    };
    let mut next = |scene: &Arc<Scene>, view: &View| {
        renderer.set_scene(scene).block_on().expect("it fits");
        renderer
            .capture_next(view, &smear, &exact)
            .block_on()
            .expect("it is drawn")
            .frame
            .color
    };
    let alone = next(&pot, &turned(&pot, 0.0));
    let first = next(&knot, &turned(&knot, 0.0));
    let second = next(&knot, &turned(&knot, 40.0));
    assert!(
        next(&knot, &turned(&knot, 40.0)) == second,
        "the same moment again"
    );
    let small = View {
        width: 60,
        height: 45,
        ..turned(&knot, 0.0)
    };
    next(&knot, &small);
    assert!(
        next(&knot, &turned(&knot, 0.0)) == first,
        "another size in between"
    );
    assert!(next(&knot, &turned(&knot, 40.0)) == second);
    assert!(next(&pot, &turned(&pot, 0.0)) == alone, "another scene");
}

few_and_all!(a_trail_is_exact_and_bit_equal_on_repeats_and_with_every_option,);
