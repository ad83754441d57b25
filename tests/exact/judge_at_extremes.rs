//! Promise: the judge finds no fault with exact pictures where its bounds are hardest to state:
//! clipped triangles of enormous scenes, boxes and discs whose rims move, and depth keys that are
//! rounded. Needs an adapter.

use rasterlab::{
    accuracy::{DepthFormat, PinnedOptions, PositionFormat, Visibility},
    effect_files::read,
    effects::{Effect, Stack},
    gpu::{Capture, Renderer},
    measure::Budget,
    plan::AccuracyRequest,
    preset_file::{self, Folders},
};

use crate::common::*;

/// Draws a preset with every visibility option and judges it.
fn exact_preset(renderer: &mut Renderer, text: &str) {
    let preset = preset_file::parse(&format!("schema = 2\n{text}"), "case")
        .unwrap_or_else(|error| panic!("{error}"))
        .preset;
    let scene = preset_file::load_scene(&preset, None).unwrap_or_else(|error| panic!("{error}"));
    for option in options(renderer) {
        let accuracy = AccuracyRequest {
            pins: preset.accuracy.pins.with(option),
            ..preset.accuracy
        };
        let (_, verdict) = judged_preset(renderer, &scene, &preset, &accuracy);
        if let Err(faults) = exactness(&verdict.report) {
            panic!(
                "{} with {}: {faults}\n{:?}",
                text.replace('\n', "; "),
                option.name(),
                verdict.report
            );
        }
    }
}

#[test]
fn edges_that_reach_far_behind_the_eye_move_by_their_corners_errors() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    // Walls of 200 km, cut a few meters from the eye.
    for tier in ["", "accuracy.tier = \"strict\"\n"] {
        let camera = "[camera]\neye = [1.0, 1.0, 1.0]";
        exact_preset(
            &mut renderer,
            &format!(
                "scene.builtin = \"near\"\noutput.size = [320, 240]\n{tier}{camera}\n[effects.lambert]"
            ),
        );
    }
    exact_preset(
        &mut renderer,
        "scene.builtin = \"near?reach=100000\"\noutput.size = [60, 144]\n[camera]",
    );
    exact_preset(
        &mut renderer,
        "scene.builtin = \"near\"\noutput.size = [160, 120]\naccuracy.coverage = \"fixed12\"",
    );
}

#[test]
fn colors_follow_places_and_depths_as_far_as_floats_have_them() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    // Coordinates of 10⁷ m have roundings of half a meter, in which fog changes by a factor of 7.
    let camera = "eye = [7374058.418809221, 1329874.6336635372, 5580748.5448456155]\northographic_height_m = 214860.24534349842";
    exact_preset(
        &mut renderer,
        &format!(
            "scene.builtin = \"near?reach=126680.02275335086\"\noutput.size = [3, 21]\n[camera]\n{camera}\n[effects.fog]\nfalloff = 3.8830113"
        ),
    );
    // Depths of 2 cm, mixed of corners 500 km before and behind the eye, have either sign.
    let camera = "eye = [-0.3753949679065174, 0.17225348024402232, 0.14648751406236715]
target = [0.4934496261266421, 0.1380689030792961, -0.35075775310289736]
fov_y_deg = 170.0";
    let depth = "[effects.depth]\nfit = false\nscale = 13840.0";
    exact_preset(
        &mut renderer,
        &format!(
            "scene.builtin = \"near?reach=1000000\"\noutput.size = [84, 3]\n[camera]\n{camera}\n{depth}"
        ),
    );
    // The depth window's front is one box of a clipped triangle; others of the same triangle lie
    // behind the window.
    for size in ["[1, 1]", "[64, 48]"] {
        exact_preset(
            &mut renderer,
            &format!(
                "scene.builtin = \"near\"\noutput.size = {size}\n[effects.boxes]\n[effects.xray]\nlayers = \"window\""
            ),
        );
    }
}

#[test]
fn overlapping_boxes_of_one_clipped_triangle_have_the_nearest_depth() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let camera = "[camera]\ntarget = [0.155594989, -0.760247648, -0.299653268]\nup = [-0.634883838, 0.745447538, -0.370145453]";
    for accuracy in [
        "",
        "accuracy.depth = \"integer\"\n",
        "accuracy.tier = \"strict\"\n",
    ] {
        exact_preset(
            &mut renderer,
            &format!(
                "scene.builtin = \"near\"\noutput.size = [64, 48]\n{accuracy}{camera}\n[effects.boxes]"
            ),
        );
    }
}

#[test]
fn rims_of_boxes_and_discs_move_with_their_corners() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    for (scene, shape) in [("globe?tess=12", "boxes"), ("teapot?tess=4", "points")] {
        exact_preset(
            &mut renderer,
            &format!(
                "scene.builtin = \"{scene}\"\noutput.size = [200, 150]\n[effects.explode]\n[effects.{shape}]"
            ),
        );
    }
}

const ROUNDED: [DepthFormat; 3] = [
    DepthFormat::Standard,
    DepthFormat::Log24,
    DepthFormat::Log16,
];

#[test]
fn dots_and_outlines_read_the_depth_that_a_rounded_key_stands_for() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    for depth in ROUNDED {
        for effect in ["dots", "outline"] {
            let accuracy = format!("accuracy.depth = \"{}\"", depth.name());
            exact_preset(
                &mut renderer,
                &format!(
                    "scene.builtin = \"sphere?triangles=200\"\noutput.size = [120, 90]\n{accuracy}\n[effects.{effect}]"
                ),
            );
        }
    }
}

#[test]
fn ambient_light_is_as_exact_far_from_the_eye_as_near() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    // A million meters have roundings of 6 cm, of which the effect's radius has eight.
    let eye = "eye = [-1306.9121089497348, 931523.4472208153, -553999.5865975871]";
    for projection in ["orthographic_height_m = 2.0", "fov_y_deg = 1.0"] {
        exact_preset(
            &mut renderer,
            &format!("output.size = [96, 72]\n[camera]\n{eye}\n{projection}\n[effects.ambient]"),
        );
    }
}

/// NaN in one pixel and infinity in another, at run time.
const NOT_FINITE: &str = "struct Bad { @range(0, 4, 0) more: u32 }
fn bad(at: ImageAt, p: Bad) -> vec4f {
    if at.x == 48 && at.y == 36 { return vec4f(bitcast<f32>(0x7fc00000u + p.more)); }
    if at.x == 20 && at.y == 9 { return vec4f(bitcast<f32>(0x7f800000u + p.more)); }
    return image_color(at.x, at.y);
}";

#[test]
fn one_pixel_that_is_not_finite_stays_one_pixel() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let effect = read("bad.wgsl", "bad", NOT_FINITE).unwrap_or_else(|error| panic!("{error}"));
    let scene = scene("sphere?triangles=500");
    let view = view(&scene, [96, 72]);
    let (mut bad, plain) = (Stack::default(), stack(&["bloom"]));
    bad.enable(&effect);
    bad.enable(Effect::find("bloom").expect("a built-in effect"));
    let accuracy = AccuracyRequest::default();
    let (capture, verdict) = judged(&mut renderer, &scene, &view, &bad, &accuracy);
    assert_eq!(exactness(&verdict.report), Ok(()), "{:?}", verdict.report);
    let (clean, _) = judged(&mut renderer, &scene, &view, &plain, &accuracy);
    let apart = capture.frame.color.iter().zip(&clean.frame.color);
    let far = |(a, b): &(&[u8; 4], &[u8; 4])| (0..4).any(|c| a[c].abs_diff(b[c]) > 4);
    assert_eq!(
        apart.filter(far).count(),
        2,
        "pixels that differ by more than 4 of 255"
    );
    // A compiler that assumes numbers may give any there, and nowhere else.
    for (column, is_right) in [("48", true), ("47", false)] {
        let text = NOT_FINITE
            .replace("bitcast<f32>(0x7fc00000u + p.more)", "0.5")
            .replace("bitcast<f32>(0x7f800000u + p.more)", "1.0")
            .replace("48", column);
        let effect = read("bad.wgsl", "bad", &text).unwrap_or_else(|error| panic!("{error}"));
        let mut assumed = Stack::default();
        assumed.enable(&effect);
        assumed.enable(Effect::find("bloom").expect("a built-in effect"));
        let (capture, _) = judged(&mut renderer, &scene, &view, &assumed, &accuracy);
        let verdict =
            rasterlab::oracle::judge(&scene, &view, &bad, &capture.picture()).expect("a verdict");
        let exact = exactness(&verdict.report);
        assert_eq!(exact.is_ok(), is_right, "{column}: {:?}", verdict.report);
    }
}

#[test]
fn centers_of_clipped_triangles_beside_the_eye_err_by_their_quotients() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    // The eye is inside of a fan, whose triangles have their centers on either side of it.
    let camera = "eye = [-0.004514218984405529, -0.008789869808921784, -0.008500272292612217]
target = [0.6228166157677087, -0.6715926773288968, -0.32151463812062137]
near_m = 0.001";
    let wobble = "amplitude_m = 685.3344604463061\ndirection = [0.0, -2.0237188507299584e-06, 3.9013881956549175e-05]\nphase_turns = 0.0\nsway = [0.6996552251912239, 0.0, 1000.0]";
    exact_preset(
        &mut renderer,
        &format!(
            "scene.builtin = \"fan?n=8&seed=0\"\noutput.size = [1, 150]\n[camera]\n{camera}\n[effects.dissolve]\nmode = \"corner\"\npattern = \"sweep\"\nwidth = 30.23224372781227\n[effects.wobble]\n{wobble}"
        ),
    );
}

#[test]
fn colors_that_are_all_a_little_wrong_are_wrong() {
    let Some(renderer) = renderer() else { return };
    let scene = scene("knot?tess=6");
    let view = view(&scene, [96, 72]);
    let (stack, accuracy) = (stack(&["lambert"]), AccuracyRequest::default());
    let report =
        |renderer: &mut Renderer| judged(renderer, &scene, &view, &stack, &accuracy).1.report;
    assert_eq!(
        exactness(&report(&mut Renderer::new(renderer.gpu().clone()))),
        Ok(())
    );
    // Less than a third of a step of 255.
    let shaders = mutated(
        "let up = 0.5 + 0.5 * s.normal.y;\n    let light",
        "let up = 0.503 + 0.5 * s.normal.y;\n    let light",
    );
    let mistaken = report(&mut Renderer::with_library(
        renderer.gpu().clone(),
        shaders.shaders(),
    ));
    assert_eq!(mistaken.max_color_delta, 1, "{mistaken:?}");
    let fault = mistaken
        .within(&Budget::default())
        .expect_err("it is caught");
    assert!(
        fault.contains("pixels have a color that is one step of 255 away (at most "),
        "{fault}"
    );
}

#[test]
fn a_color_in_the_middle_between_two_bytes_may_be_either() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    // With three levels, red and green of normals along z are 0.5, which is 127.5 of 255.
    let (scene, mut stack) = (scene("grid?cell=16"), stack(&["normals"]));
    let posterize = Effect::find("posterize").expect("a built-in effect");
    posterize
        .field("levels")
        .expect("a parameter")
        .set(&mut stack.enable(posterize).words, &[3.0])
        .expect("a number of levels");
    let view = view(&scene, [64, 48]);
    let mut capture = captured(
        &mut renderer,
        &scene,
        &view,
        &stack,
        &AccuracyRequest::default(),
    );
    let judged = |capture: &Capture| exactness(&verdict(&scene, &view, &stack, capture).report);
    assert_eq!(judged(&capture), Ok(()));
    let replace = |capture: &mut Capture, from: u8, to: u8| {
        let bytes = capture
            .frame
            .color
            .iter_mut()
            .flatten()
            .filter(|byte| **byte == from);
        bytes.map(|byte| *byte = to).count()
    };
    assert!(replace(&mut capture, 128, 127) > 1000, "a picture of ties");
    assert_eq!(judged(&capture), Ok(()));
    assert!(replace(&mut capture, 127, 126) > 1000);
    judged(&capture).expect_err("126 is wrong");
}

#[test]
fn dots_before_the_background_may_be_either_byte_at_a_tie() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    // The background's blue is 63 of 255 and the dots' is 255: a dot of 162 of 256 makes it 184.5.
    let mut preset = preset_file::open("dots-route", &Folders::default())
        .expect("a preset of the gallery")
        .preset;
    preset.output.size = [96, 72];
    let scene = preset_file::load_scene(&preset, None).expect("a built-in scene");
    let (_, verdict) = judged_preset(&mut renderer, &scene, &preset, &preset.accuracy);
    assert_eq!(exactness(&verdict.report), Ok(()));
}

#[test]
fn rounded_keys_are_judged() {
    let Some(renderer) = renderer() else { return };
    let scene = scene("knot?tess=4");
    let view = view(&scene, [96, 72]);
    let faults = |renderer: &mut Renderer, depth: DepthFormat, visibility: Visibility| {
        let accuracy = AccuracyRequest {
            pins: PinnedOptions::of(depth).with(visibility),
            ..AccuracyRequest::default()
        };
        judged(renderer, &scene, &view, &stack(&[]), &accuracy)
            .1
            .report
            .key_outside_bound
    };
    let mut right = Renderer::new(renderer.gpu().clone());
    for depth in [
        DepthFormat::Log16,
        DepthFormat::Log24,
        DepthFormat::Ndc16,
        DepthFormat::Standard,
    ] {
        for visibility in options(&renderer).into_iter().chain([Visibility::Packed32]) {
            assert_eq!(
                faults(&mut right, depth, visibility),
                0,
                "{} with {}",
                depth.name(),
                visibility.name()
            );
        }
    }
}

#[test]
fn packed_positions_are_judged_within_half_a_step() {
    let Some(renderer) = renderer() else { return };
    let mut right = Renderer::new(renderer.gpu().clone());
    for position_format in [PositionFormat::Packed16, PositionFormat::Packed10] {
        let accuracy = AccuracyRequest {
            pins: PinnedOptions::of(position_format),
            ..AccuracyRequest::default()
        };
        for query in ["knot?tess=4", "cube-wall?columns=4&rows=3", "sizes", "near"] {
            let scene = scene(query);
            let report = judged(
                &mut right,
                &scene,
                &view(&scene, [96, 72]),
                &stack(&[]),
                &accuracy,
            )
            .1
            .report;
            // Where positions err, many depths are in doubt.
            assert_eq!(
                report.within(&Budget::default()),
                Ok(()),
                "{query} with {}",
                position_format.name()
            );
        }
    }
    let scene = scene("knot?tess=4");
    let accuracy = AccuracyRequest {
        pins: PinnedOptions::of(PositionFormat::Packed10),
        ..AccuracyRequest::default()
    };
    let shaders = mutated("& vec3u(1023u));", "& vec3u(1022u));");
    let mut mistaken = Renderer::with_library(renderer.gpu().clone(), shaders.shaders());
    let report = judged(
        &mut mistaken,
        &scene,
        &view(&scene, [512, 512]),
        &stack(&[]),
        &accuracy,
    )
    .1
    .report;
    assert!(
        report.snap_outside_bound > 0,
        "a bit that is lost is not caught: {report:?}"
    );
}

#[test]
fn colors_seen_from_very_far_err_by_the_roundings_of_the_distance() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    // The depth of each sample is rounded to steps of 6 cm, which fog with a steep fall-off shows.
    let camera = "[camera]\neye = [353739.2985322324, 812418.4990550128, -226515.01635057153]\northographic_height_m = 2.0";
    let scene = "scene.builtin = \"tentacle?joints=1&influences=1&tess=2\"\noutput.size = [38, 29]";
    exact_preset(
        &mut renderer,
        &format!("{scene}\n{camera}\n[effects.fog]\nfalloff = 10.0"),
    );
    exact_preset(
        &mut renderer,
        &format!(
            "{scene}\n{camera}\n[effects.fog]\nfalloff = 1000.0\n[effects.hatch]\n[effects.posterize]"
        ),
    );
}

#[test]
fn a_flat_area_on_a_step_of_color_is_one_color_in_doubt() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let flat =
        "scene.builtin = \"stack\"\noutput.size = [157, 98]\n[effects.hatch]\n[effects.dither]";
    exact_preset(&mut renderer, flat);
    // A race shows layers of other tones, too, on each of which the lines of the hatch vary from
    // pixel to pixel.
    for _ in 0..3 {
        exact_preset(&mut renderer, &format!("{flat}\n[effects.race]"));
    }
}

#[test]
fn colors_of_clipped_triangles_err_by_the_normals_and_depths_of_their_corners() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    // Waves of a few centimeters across walls of 20 m: f32 does not tell where in the wave a corner
    // behind the eye lies.
    let near = "scene.builtin = \"near\"\noutput.size = [1, 5]";
    let lit = format!(
        "{near}\n[effects.wobble]\nsway = [0.90552074, 1.0, 0.90710723]\nwavelength_m = 0.056449506\n[effects.lambert]"
    );
    let direction = "direction = [0.9509494, 0.06562333, 0.29090148]";
    exact_preset(&mut renderer, &lit);
    exact_preset(
        &mut renderer,
        &format!(
            "{near}\n[effects.wobble]\n{direction}\nwavelength_m = 0.15100664\n[effects.normals]"
        ),
    );
}

#[test]
fn vertex_colors_of_clipped_triangles_err_by_the_weights_of_their_corners() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    // Triangles of a few centimeters, torn to 1,000 m along one direction.
    let wave = "[effects.wobble]\ndirection = [-1.0, -1.0, 1.0]\nsway = [0.8, 0.2, -0.3]\namplitude_m = 1000.0\nwavelength_m = 0.16";
    let camera = "[camera]\neye = [0.5, -2.9, -2.6]\ntarget = [-1.5, 1.0, 0.1]";
    let torn = format!(
        "scene.builtin = \"walker?tess=1\"\noutput.size = [64, 48]\n{camera}\n{wave}\n[effects.xray]\nbits = \"8\""
    );
    exact_preset(&mut renderer, &torn);
    exact_preset(
        &mut renderer,
        &format!("{torn}\n[effects.posterize]\nlevels = 32"),
    );
}

#[test]
fn surfaces_may_cross_where_only_depths_moved() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    // Triangles in a plane, waving by 590 m along the parallel rays of the camera, with a wave of a
    // millimeter.
    let sway = "sway = [0.0, 0.0, -1.0]\namplitude_m = 590.5813\nwavelength_m = 0.001";
    let clock = "[clock]\ntime_s = 1.0";
    exact_preset(
        &mut renderer,
        &format!(
            "scene.builtin = \"sizes?seed=1\"\noutput.size = [200, 1]\n{clock}\n[effects.wobble]\n{sway}"
        ),
    );
}
