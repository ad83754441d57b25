//! Promise: a pass that is kept reads what it wrote in the previous frame, on the adapter as in the
//! oracle; a picture is the same whenever it is drawn, and what a kept pass writes is judged.

use std::sync::Arc;

use rasterlab::{
    accuracy::RenderScale,
    effect_files::read,
    effects::{Conflict, Effect, Stack},
    measure::compare::pictures,
    oracle,
    preset::{Clock, Preset, SceneSource},
};

use super::common::{Draws as _, exactness, loan, scene};

const SIZE: [u32; 2] = [96, 72];

/// Adds up pictures in a buffer of half the size, which is shown beside the picture.
const TRAIL: &str = "struct Trail { @range(0.0, 1.0, 0.75) lasting: f32 }
@pass(half) @kept(4, 0.1)
fn add(at: ImageAt, p: Trail) -> vec4f {
    let middle = image_middle(at);
    let left = image_kept(at.x, at.y) + image_kept_at(0.5 * middle.x + 0.3, 0.5 * middle.y);
    return image_color_at(middle.x, middle.y) + 0.5 * p.lasting * left;
}
fn show(at: ImageAt, p: Trail) -> vec4f {
    return vec4f(0.3 * image_last(at.x / 2, at.y / 2).rgb, image_color(at.x, at.y).a);
}";

fn trail() -> Arc<Effect> {
    read("trail.wgsl", "trail", TRAIL).unwrap_or_else(|error| panic!("{error}"))
}

/// A turning knot with these effects.
fn spinning(effects: &[Arc<Effect>]) -> Preset {
    let mut stack = Stack::default();
    for effect in effects {
        stack.enable(effect);
    }
    let mut preset = Preset {
        scene: SceneSource::Builtin("knot?tess=6".into()),
        spin_deg_per_s: 90.0,
        clock: Clock {
            time_s: 0.7,
            ..Clock::default()
        },
        stack,
        ..Preset::default()
    };
    preset.output.size = SIZE;
    preset
}

#[test]
fn a_kept_pass_reads_the_frame_before_and_its_picture_does_not_depend_on_what_was_drawn_earlier() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("knot?tess=6");
    let lambert = Effect::find("lambert").expect("it is built in").clone();
    let preset = spinning(&[lambert, trail()]);
    let moments = preset.moments(&scene, SIZE);
    assert_eq!(moments.len(), 5, "@kept(4, 0.1)");
    let reference = oracle::render_sequence(&scene, &moments).expect("it is drawn");
    let (view, stack) = moments.last().expect("five of them");
    let first = oracle::render(&scene, view, stack).expect("it is drawn");
    let changed = pictures(&first.color, &reference.color, 1).pixels_over_tolerance;
    assert!(changed > 200, "{changed} pixels show earlier frames");

    let (capture, verdict) = renderer.judged_preset(&scene, &preset, &Default::default());
    exactness(&verdict.report).unwrap_or_else(|why| panic!("{why}"));
    let far = pictures(&capture.frame.color, &reference.color, 1);
    assert!(far.pixels_over_tolerance <= 4, "{far:?}");
    let (again, _) = renderer.judged_preset(&scene, &preset, &Default::default());
    assert!(again.frame == capture.frame, "the same to the bit");

    let kept = capture.frame.kept.as_ref().expect("a pass is kept");
    assert_eq!(kept.after.len(), 48 * 36);
    assert!(kept.before != kept.after && kept.before.iter().any(|pixel| pixel[0] > 0.0));
    for change in [0, 1] {
        let mut wrong = capture.clone();
        let kept = wrong.frame.kept.as_mut().expect("a pass is kept");
        [&mut kept.before, &mut kept.after][change][48 * 18 + 24][1] += 0.1;
        let verdict = oracle::judge(&scene, view, stack, &wrong.picture()).expect("it is judged");
        assert!(verdict.report.max_color_delta > 2, "{:?}", verdict.report);
    }
}

#[test]
fn a_kept_pass_is_exact_where_more_pixels_are_drawn_than_shown() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("knot?tess=6");
    let mut preset = spinning(&[trail()]);
    preset.accuracy.pins = preset.accuracy.pins.with(RenderScale::Double);
    let accuracy = preset.accuracy;
    let (capture, verdict) = renderer.judged_preset(&scene, &preset, &accuracy);
    exactness(&verdict.report).unwrap_or_else(|why| panic!("{why}"));
    let kept = capture.frame.kept.as_ref().expect("a pass is kept");
    assert_eq!(kept.after.len(), 96 * 72, "half of twice the size");
}

#[test]
fn a_stack_remembers_earlier_frames_for_one_effect() {
    let smear = Effect::find("smear").expect("it is built in").clone();
    let other = read("other.wgsl", "other", TRAIL).expect("it is read");
    for second in [smear, other] {
        let stack = spinning(&[trail(), second.clone()]).stack;
        let refused = stack.check().expect_err("one of them has to go");
        assert!(
            matches!(refused, Conflict::EarlierFrames { .. }),
            "{refused}"
        );
        assert!(!trail().has_instances(), "nor twice");
    }
}
