//! Promise: the effects on surface and image keep their own small promises. Needs an adapter for
//! the pictures alone.

use std::sync::Arc;

use glam::{DVec2, DVec3, DVec4};
use pollster::FutureExt as _;
use rasterlab::{
    effects::{
        Effect, Stack, Surface,
        hooks::{Picture, Pixel},
    },
    frame::{Frame, NO_TRIANGLE},
    measure::compare::pictures,
    oracle,
    preset::{Clock, Preset, SceneSource},
    scene::{Scene, view::View},
};

use crate::common::*;

mod smear;

const SIZE: [u32; 2] = [96, 72];

/// A stack from effects and parameters: `("fog", "density", 0.5)`, or `("fog", "", 0.0)` for its
/// defaults.
fn with(settings: &[(&str, &str, f64)]) -> Stack {
    let mut stack = Stack::default();
    for &(name, field, value) in settings {
        let enabled =
            stack.enable(Effect::find(name).unwrap_or_else(|| panic!("no effect {name}")));
        if !field.is_empty() {
            let field = enabled
                .effect
                .field(field)
                .unwrap_or_else(|| panic!("{name} has no {field}"));
            let lanes = vec![value; field.value_type.components()];
            field
                .set(&mut enabled.words, &lanes)
                .unwrap_or_else(|error| panic!("{name}: {error}"));
        }
    }
    stack
}

fn drawn(scene: &Scene, view: &View, stack: &Stack) -> Frame {
    oracle::render(scene, view, stack).expect("a builtin is drawn")
}

// -------- every effect against the oracle

fn fog_thins_out_by_the_height_on_the_ray_of_a_pixel_and_not_by_that_of_snapped_corners(
    reach: Reach,
) {
    let Some(mut renderer) = loan() else { return };
    // Pixels of 3.6 m, and fog that ends in a tenth of one: half a unit of snapping is several
    // steps of 255 in row 35.
    let fog = [
        ("density", 0.8),
        ("start_m", 0.0),
        ("falloff", 16.0),
        ("level_m", 1.5),
        ("color", 0.0),
    ];
    let stack = with(
        &[
            &[("lambert", "", 0.0)],
            &fog.map(|(field, value)| ("fog", field, value))[..],
        ]
        .concat(),
    );
    let scene = scene("sizes");
    for option in reach.options(&renderer) {
        renderer.exact(
            &scene,
            &view(&scene, SIZE),
            &stack,
            &pinned(option),
            option.name(),
        );
    }
}

fn what_is_off_leaves_no_trace_to_the_bit(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("knot?tess=10");
    let view = view(&scene, SIZE);
    let bare = renderer
        .captured(&scene, &view, &stack(&["lambert"]), &split32())
        .frame
        .color;
    let off: [&[(&str, &str, f64)]; 6] = [
        &[("fog", "density", 0.0)],
        &[("posterize", "amount", 0.0)],
        &[("posterize", "levels", 256.0)],
        &[
            ("outline", "silhouette", 0.0),
            ("outline", "objects", 0.0),
            ("outline", "depth", 0.0),
        ],
        &[("outline", "color", 0.0)],
        &[("smear", "fade", 1.0)],
    ];
    for settings in reach.of(2, off) {
        let stack = with(&[&[("lambert", "", 0.0)], settings].concat());
        let color = renderer
            .captured(&scene, &view, &stack, &split32())
            .frame
            .color;
        assert!(
            color == bare,
            "{settings:?} changes {:?}",
            pictures(&color, &bare, 0)
        );
        assert!(
            drawn(&scene, &view, &stack).color
                == drawn(&scene, &view, &with(&[("lambert", "", 0.0)])).color,
            "{settings:?}"
        );
    }
}

// -------- effects on a surface

/// A surface that looks at the eye from two meters.
fn surface(color: DVec3) -> Surface {
    Surface::example(color, 0)
}

fn shaded(stack: &Stack, surface: Surface) -> DVec3 {
    let none = rasterlab::effects::hooks::Lighting::default();
    stack.shade(surface, 0, &none).color.truncate()
}

#[test]
fn fog_takes_more_the_farther_and_the_lower_and_nothing_before_its_start() {
    let mut stack = with(&[
        ("fog", "density", 0.4),
        ("fog", "start_m", 1.0),
        ("fog", "falloff", 2.0),
        ("fog", "color", 1.0),
    ]);
    let at = |stack: &Stack, depth_m: f64, y: f64| {
        shaded(
            stack,
            Surface {
                depth_m,
                position: DVec3::Y * y,
                ..surface(DVec3::ZERO)
            },
        )
        .x
    };
    assert_eq!(at(&stack, 0.2, 0.0), 0.0);
    assert_eq!(at(&stack, 1.0, 0.0), 0.0);
    let by_depth: Vec<f64> = (0..60)
        .map(|i| at(&stack, 1.0 + 0.2 * f64::from(i), 0.3))
        .collect();
    assert!(by_depth.is_sorted_by(|a, b| a < b), "{by_depth:?}");
    let by_height: Vec<f64> = (0..60)
        .map(|i| at(&stack, 3.0, 0.1 * f64::from(i)))
        .collect();
    assert!(by_height.is_sorted_by(|a, b| a > b), "{by_height:?}");
    assert_eq!(
        at(&stack, 3.0, -1.0),
        at(&stack, 3.0, 0.0),
        "below the level it is whole"
    );
    // Beer and Lambert: ways multiply.
    stack = with(&[
        ("fog", "density", 0.4),
        ("fog", "start_m", 0.0),
        ("fog", "color", 1.0),
    ]);
    let left = |depth_m: f64| 1.0 - at(&stack, depth_m, 0.0);
    assert!((left(5.0) - left(2.0) * left(3.0)).abs() < 1e-12);
}

#[test]
fn toon_has_as_many_tones_as_steps_and_keeps_the_hue() {
    for steps in [1usize, 2, 3, 7] {
        let stack = with(&[("toon", "steps", steps as f64), ("toon", "softness", 0.05)]);
        let tones: Vec<f64> = (0..=1000)
            .map(|i| shaded(&stack, surface(DVec3::splat(f64::from(i) / 1000.0))).x)
            .map(|x| (x * 1e9).round() / 1e9)
            .collect();
        assert!(tones.is_sorted(), "{steps} steps");
        let mut flat: Vec<f64> = tones
            .windows(2)
            .filter(|pair| pair[0] == pair[1])
            .map(|pair| pair[0])
            .collect();
        flat.dedup();
        assert_eq!(flat.len(), steps, "{flat:?}");
    }
    let orange = DVec3::new(0.6, 0.3, 0.06);
    let toned = shaded(&with(&[("toon", "", 0.0)]), surface(orange));
    assert!(
        (toned / toned.x - orange / orange.x).length() < 1e-12,
        "{toned}"
    );
    // The rim lies where the surface turns away, and only there.
    let rim = |facing: f64| {
        let stack = with(&[
            ("toon", "rim", 1.0),
            ("toon", "steps", 1.0),
            ("toon", "light", 0.5),
        ]);
        shaded(
            &stack,
            Surface {
                normal: DVec3::new((1.0 - facing * facing).sqrt(), 0.0, facing),
                ..surface(orange)
            },
        )
        .z
    };
    assert!(
        rim(1.0) < 0.1 && rim(0.0) == 1.0,
        "{} {}",
        rim(1.0),
        rim(0.0)
    );
}

#[test]
fn hatch_is_darker_where_the_tone_is_and_bare_where_it_is_bright() {
    for lie in [0.0, 1.0] {
        let stack = with(&[
            ("hatch", "space", lie),
            ("hatch", "ink", 0.0),
            ("hatch", "paper", 1.0),
            ("hatch", "layers", 4.0),
        ]);
        let mean = |tone: f64| {
            let at = |i: u32| {
                let (x, y) = (f64::from(i % 64), f64::from(i / 64));
                let place = Surface {
                    pixel: DVec2::new(x, y),
                    position: DVec3::new(x, y, 0.0) * 0.01,
                    ..surface(DVec3::splat(tone * tone))
                };
                shaded(&stack, place).x.sqrt()
            };
            (0..4096).map(at).sum::<f64>() / 4096.0
        };
        let means: Vec<f64> = (0..=20).map(|i| mean(f64::from(i) / 20.0)).collect();
        assert!(means.is_sorted(), "lie {lie}: {means:?}");
        assert_eq!(means[20], 1.0);
        // Four layers, each of which leaves 45 % bare.
        // Planes of the third layer are not at right angles to those of the first, so lines on a
        // surface overlap more.
        assert!(
            (means[0] - 0.45f64.powi(4)).abs() < [0.02, 0.08][lie as usize],
            "lie {lie}: {}",
            means[0]
        );
    }
}

// -------- effects on the image

/// A picture without any triangle id.
fn empty(side: u32, triangle_ids: &[u32]) -> Picture<'_> {
    Picture {
        width: side,
        height: side,
        triangle_ids,
        keys: triangle_ids,
        draws: &[0],
        previous: None,
        background: &[[0; 4]; 64],
    }
}

fn finished(stack: &Stack, color: DVec4, x: u32, y: u32) -> DVec4 {
    let triangle_ids = [NO_TRIANGLE; 64 * 64];
    stack
        .finish(
            Pixel {
                color,
                x,
                y,
                step_offset: 0.0,
            },
            &empty(64, &triangle_ids),
        )
        .color
}

#[test]
fn posterize_takes_the_nearest_level_and_is_idempotent() {
    for (by, levels) in [(0.0, 2), (0.0, 5), (0.0, 256), (1.0, 2), (1.0, 7)] {
        let stack = with(&[
            ("posterize", "by", by),
            ("posterize", "levels", f64::from(levels)),
        ]);
        for i in 0..=500 {
            let v = f64::from(i) / 500.0;
            let color = DVec4::new(v, 1.0 - v, 0.3 * v, 0.5);
            let once = finished(&stack, color, 3, 4);
            assert!(
                (finished(&stack, once, 3, 4) - once).length() < 1e-12,
                "{levels} levels of {color}"
            );
            assert_eq!(once.w, 0.5);
            let off = if by == 0.0 {
                (once - color).abs().max_element()
            } else {
                (once.max_element() - color.truncate().max_element()).abs()
            };
            assert!(
                off <= 0.5 / f64::from(levels - 1) + 1e-12,
                "{levels} levels of {color}: {once}"
            );
        }
    }
}

#[test]
fn dither_has_the_mean_of_its_value_on_every_matrix() {
    for (matrix, side) in [(0.0, 8u32), (1.0, 4), (2.0, 2)] {
        for levels in [2u32, 3, 16, 256] {
            let stack = with(&[
                ("dither", "matrix", matrix),
                ("dither", "levels", f64::from(levels)),
            ]);
            for i in 0..=100 {
                let value = f64::from(i) / 100.0;
                let cells = (0..side * side)
                    .map(|i| finished(&stack, DVec4::splat(value), i % side, i / side).x);
                let mean = cells.sum::<f64>() / f64::from(side * side);
                let last = f64::from(levels - 1);
                assert!(
                    (mean - value).abs() <= 0.5 / (f64::from(side * side) * last) + 1e-12,
                    "{side}, {levels} levels: {value} {mean}"
                );
            }
        }
    }
}

#[test]
fn a_matrix_holds_every_threshold_once_and_a_checkerboard_first() {
    for (matrix, side) in [(0.0, 8u32), (1.0, 4), (2.0, 2)] {
        let stack = with(&[("dither", "matrix", matrix), ("dither", "levels", 2.0)]);
        let white = |share: f64| -> Vec<(u32, u32)> {
            let cells = (0..side * side).map(|i| (i % side, i / side));
            cells
                .filter(|&(x, y)| finished(&stack, DVec4::splat(share), x, y).x == 1.0)
                .collect()
        };
        let count = side * side;
        assert!(
            (0..=count).all(|n| white(f64::from(n) / f64::from(count)).len() == n as usize),
            "{side}"
        );
        let half = white(0.5);
        assert!(
            half.iter()
                .all(|(x, y)| (x + y) % 2 == (half[0].0 + half[0].1) % 2),
            "{side}: {half:?}"
        );
    }
}

/// A scene seen in a mirror: every column from the right.
fn mirrored(values: &[u32], width: usize) -> Vec<u32> {
    values
        .chunks(width)
        .flat_map(|row| row.iter().rev().copied())
        .collect()
}

fn a_step_of_depth_of_exactly_the_threshold_is_no_line(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("knot?tess=6");
    let view = view(&scene, SIZE);
    let frame = renderer
        .captured(&scene, &view, &Stack::default(), &unpinned())
        .frame;
    let width = SIZE[0] as usize;
    let curvature = |i: usize, step: usize| {
        let covered = [i - step, i, i + step]
            .iter()
            .all(|&i| frame.triangle_id[i] != NO_TRIANGLE);
        let [before, here, after] = [i - step, i, i + step].map(|i| i64::from(frame.depth_key[i]));
        covered.then_some(before + after - 2 * here)
    };
    for side in reach.of(1, [0.0, 1.0, 2.0]) {
        // A pixel with a step across that the effect's range contains, and with less down.
        let steps = (width + 1..frame.depth_key.len() - width - 1)
            .filter(|i| ![0, width - 1].contains(&(i % width)))
            .filter_map(|i| {
                let (across, down) = (curvature(i, 1)?, curvature(i, width)?);
                let is_of_side = if side == 0.0 {
                    across > 0
                } else {
                    side == 2.0 || across < 0
                };
                (is_of_side && across.abs() > down.abs() && (839..1 << 23).contains(&across.abs()))
                    .then_some(across.abs())
            });
        let step = steps.min().expect("the knot has a step");
        let threshold = step as f64 / f64::from(1 << 23);
        let stack = with(&[
            ("outline", "side", side),
            ("outline", "width_px", 1.0),
            ("outline", "depth_threshold", threshold),
        ]);
        renderer.exact(
            &scene,
            &view,
            &stack,
            &unpinned(),
            &format!("side {side}, a step of {step}"),
        );
    }
}

#[test]
fn outlines_of_a_mirrored_picture_are_mirrored_and_as_wide_as_asked() {
    let scene = scene("cube-wall");
    let view = view(&scene, SIZE);
    let frame = drawn(&scene, &view, &stack(&[]));
    let draws: Vec<u32> = rasterlab::scene::draw::draws(&scene, &view)
        .expect("it fits")
        .iter()
        .map(|draw| draw.first_triangle)
        .collect();
    let lines = |triangle_ids: &[u32], keys: &[u32], stack: &Stack| -> Vec<u32> {
        let [width, height] = SIZE;
        let picture = Picture {
            width,
            height,
            triangle_ids,
            keys,
            draws: &draws,
            previous: None,
            background: &[[255; 4]; 128],
        };
        let pixel = |i: u32| Pixel {
            color: DVec4::ONE,
            x: i % width,
            y: i / width,
            step_offset: 0.0,
        };
        (0..width * height)
            .map(|i| u32::from(stack.finish(pixel(i), &picture).color.x < 0.5))
            .collect()
    };
    let width = SIZE[0] as usize;
    for side in [0.0, 1.0, 2.0] {
        for width_px in [1.0, 3.0, 8.0] {
            let stack = with(&[("outline", "side", side), ("outline", "width_px", width_px)]);
            let there = lines(&frame.triangle_id, &frame.depth_key, &stack);
            let back = lines(
                &mirrored(&frame.triangle_id, width),
                &mirrored(&frame.depth_key, width),
                &stack,
            );
            assert!(
                there.contains(&1) && mirrored(&back, width) == there,
                "side {side}, {width_px} px"
            );
        }
    }
    // A line outside lies on empty pixels alone where only silhouettes are drawn, within its width
    // of a triangle id.
    let only = with(&[
        ("outline", "objects", 0.0),
        ("outline", "depth", 0.0),
        ("outline", "width_px", 2.0),
    ]);
    let drawn = lines(&frame.triangle_id, &frame.depth_key, &only);
    let owned = |x: i64, y: i64| {
        let is_inside =
            (0..i64::from(SIZE[0])).contains(&x) && (0..i64::from(SIZE[1])).contains(&y);
        is_inside && frame.triangle_id[y as usize * width + x as usize] != NO_TRIANGLE
    };
    for (i, &line) in drawn.iter().enumerate() {
        let (x, y) = ((i % width) as i64, (i / width) as i64);
        let near = (-2..=2i64)
            .any(|dy| (-2..=2i64).any(|dx| dx * dx + dy * dy <= 4 && owned(x + dx, y + dy)));
        assert_eq!(line == 1, !owned(x, y) && near, "({x}, {y})");
    }
}

#[test]
fn a_slope_is_no_jump_and_a_step_of_depth_is() {
    // Eight pixels of one object; keys as bits of a depth.
    let triangle_ids = [1u32; 64];
    let line = |depth: fn(u32) -> f32, jump: f64| -> Vec<u32> {
        let keys: Vec<u32> = (0..64).map(|i| depth(i % 8).to_bits()).collect();
        let picture = Picture {
            width: 8,
            height: 8,
            triangle_ids: &triangle_ids,
            keys: &keys,
            draws: &[0],
            previous: None,
            background: &[[255; 4]; 128],
        };
        let stack = with(&[
            ("outline", "width_px", 1.0),
            ("outline", "depth_threshold", jump),
        ]);
        (0..8)
            .filter(|&x| {
                stack
                    .finish(
                        Pixel {
                            color: DVec4::ONE,
                            x,
                            y: 4,
                            step_offset: 0.0,
                        },
                        &picture,
                    )
                    .color
                    .x
                    < 0.5
            })
            .collect()
    };
    assert_eq!(
        line(|x| 0.5 + 0.05 * x as f32, 0.01),
        Vec::<u32>::new(),
        "a slope of a tenth"
    );
    assert_eq!(
        line(|x| if x < 4 { 0.6 } else { 0.5 }, 0.05),
        [4],
        "on the far side"
    );
    assert_eq!(
        line(|x| if x < 4 { 0.6 } else { 0.59 }, 0.05),
        Vec::<u32>::new(),
        "a small step"
    );
}

// -------- smear

fn spinning(fade: f64) -> Preset {
    let stack = with(&[
        ("lambert", "", 0.0),
        ("smear", "fade", fade),
        ("smear", "frames", 5.0),
        ("smear", "step_s", 0.1),
    ]);
    let clock = Clock {
        time_s: 0.7,
        ..Clock::default()
    };
    let mut preset = Preset {
        scene: SceneSource::Builtin("knot?tess=6".into()),
        spin_deg_per_s: 90.0,
        clock,
        stack,
        ..Preset::default()
    };
    preset.output.size = SIZE;
    preset
}

// -------- mutants

fn effects_with_a_mistake_are_caught(reach: Reach) {
    let Some(healthy) = loan() else { return };
    let gpu = healthy.gpu().clone();
    let scene = scene("knot?tess=10");
    let view = view(&scene, SIZE);
    let coarse = |name: &'static str| {
        if matches!(name, "posterize" | "dither") {
            (name, "levels", 4.0)
        } else {
            (name, "", 0.0)
        }
    };
    let mutants = [
        ("fog", "exp(-thickness *", "exp2(-thickness *"),
        ("toon", "sqrt(brightest)", "brightest"),
        ("hatch", "0.5 * width", "0.47 * width"),
        (
            "posterize",
            "last + 0.5) / last, vec3f",
            "last + 0.49) / last, vec3f",
        ),
        ("dither", "((x ^ y) >> bit)", "(x >> bit)"),
        (
            "outline",
            "squared <= reach * reach",
            "squared < reach * reach",
        ),
        ("smear", "fraction + 65535", "fraction * 2 + 65535"),
    ];
    for (name, from, to) in reach.of(3, mutants) {
        let mut wrong = Mistaken::new(&gpu, from, to);
        let stack = with(&[("lambert", "", 0.0), coarse(name)]);
        let (_, verdict) = if name == "smear" {
            wrong.judged_preset(&scene, &spinning(0.2), &split32())
        } else {
            wrong.judged(&scene, &view, &stack, &split32())
        };
        assert!(
            verdict.report.max_color_delta > 1,
            "{name}, {to:?}: {:?}",
            verdict.report
        );
    }
}

few_and_all!(
    fog_thins_out_by_the_height_on_the_ray_of_a_pixel_and_not_by_that_of_snapped_corners,
    what_is_off_leaves_no_trace_to_the_bit,
    effects_with_a_mistake_are_caught,
    a_step_of_depth_of_exactly_the_threshold_is_no_line,
);
