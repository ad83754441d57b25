//! Promise: effects whose formulas were published compute what the publications say: values here
//! were computed apart from the texts. Needs no adapter.

use glam::{DMat4, DVec2, DVec3, DVec4};
use rasterlab::{
    effects::{
        Effect, EnabledEffect, Surface,
        glass::Glass,
        hooks::{Image, ImageAt, Lens, PassInput, Picture, Pixel, Signs},
    },
    scene::{Bounds, camera::Camera, view::View},
};

/// An effect with these values; a choice is the number of its word.
fn enabled(name: &str, values: &[(&str, &[f64])]) -> EnabledEffect {
    let mut enabled = EnabledEffect::new(Effect::named(name));
    for (field, components) in values {
        enabled.set(field, components);
    }
    enabled
}

fn shaded(effect: &EnabledEffect, surface: Surface) -> Surface {
    let shade = effect.effect.hooks.surface.as_ref();
    let mut all = [surface];
    shade.expect("it is on the hook")(&mut all, &effect.words);
    all[0]
}

fn finished(effect: &EnabledEffect, picture: &Picture<'_>, color: DVec4, at: [u32; 2]) -> DVec4 {
    let [x, y] = at;
    let mut all = [Pixel {
        color,
        x,
        y,
        step_offset: 0.0,
    }];
    let hook = effect.effect.hooks.image.as_ref();
    (hook.expect("it is on the hook").finish)(&mut all, picture, &effect.words);
    all[0].color
}

/// A picture of one color.
const PLAIN: Picture<'static> = Picture {
    width: 8,
    height: 8,
    triangle_ids: &[0; 64],
    keys: &[1; 64],
    draws: &[0],
    previous: None,
    background: &[[0; 4]; 8],
};

/// What the only pass of an effect makes of the pixel in the middle of three by three.
fn passed(effect: &EnabledEffect, colors: [DVec3; 9]) -> DVec3 {
    passed_at(effect, 0, &colors, &[DVec3::ZERO; 9], [1, 1])
}

/// What pass `index` of an effect makes of a pixel of a square picture with these `colors`, after a
/// pass that has written `last`.
fn passed_at(
    effect: &EnabledEffect,
    index: usize,
    colors: &[DVec3],
    last: &[DVec3],
    [x, y]: [i64; 2],
) -> DVec3 {
    let side = colors.len().isqrt() as u32;
    let [image, last] = [colors, last].map(|colors| Image {
        size: [side; 2],
        colors: colors.iter().map(|color| color.extend(1.0)).collect(),
    });
    let picture = Picture {
        width: side,
        height: side,
        triangle_ids: &vec![0; colors.len()],
        keys: &vec![1; colors.len()],
        background: &vec![[0; 4]; side as usize],
        ..PLAIN
    };
    let bounds = Bounds {
        min: DVec3::NEG_ONE,
        max: DVec3::ONE,
    };
    let view = View::new(
        &Camera::default(),
        side,
        side,
        &bounds,
        DMat4::IDENTITY,
        [0.0; 4],
    );
    let input = PassInput {
        picture: &picture,
        lens: Lens::of(&view),
        source: &image,
        last: &last,
        kept: None,
        signs: Signs::None,
        panorama: None,
    };
    let at = ImageAt {
        x,
        y,
        size: [side; 2],
        scale: 1,
        step_offset: 0.0,
        input: &input,
    };
    let hook = effect.effect.hooks.passes.as_ref();
    (hook.expect("it has passes").run)(index, &[at], &effect.words)[0].truncate()
}

fn near(what: &str, given: impl Into<DVec3>, expected: [f64; 3], within: f64) {
    let (given, expected) = (given.into(), DVec3::from(expected));
    let apart = (given - expected).abs().max_element();
    assert!(apart <= within, "{what}: {given}, and {expected} is right");
}

/// Reinhard and others 2002; Khronos, PBR Neutral 2024; Hill's fit of ACES; Sobotka's AgX with
/// Wrensch's polynomial. Published matrices have 4 to 6 digits.
#[test]
fn tone_curves_are_those_of_their_authors() {
    let (dim, strong) = ([0.18; 3], [1.0, 0.5, 0.1]);
    for (curve, light, expected, within) in [
        (1.0, [1.0, 0.25, 3.0], [0.5, 0.2, 0.75], 1e-12),
        (2.0, [0.05, 0.2, 0.5], [0.015625, 0.165625, 0.465625], 1e-9),
        (2.0, [2.0, 1.0, 0.5], [0.96, 0.5340905, 0.3211358], 1e-6),
        (3.0, dim, [0.1055912, 0.1055912, 0.1055902], 1e-6),
        (3.0, strong, [0.6388707, 0.383867, 0.0822001], 1e-6),
        (4.0, dim, [0.214549, 0.214502, 0.214499], 1e-5),
        (4.0, strong, [0.614157, 0.41901, 0.208579], 1e-5),
    ] {
        let effect = enabled("tonemap", &[("curve", &[curve])]);
        let seen = shaded(&effect, Surface::example(light.into(), 0));
        near(
            &format!("curve {curve}"),
            seen.color.truncate(),
            expected,
            within,
        );
    }
}

#[test]
fn every_tone_curve_keeps_black_never_falls_and_ends_at_white() {
    for curve in 0..5 {
        let effect = enabled("tonemap", &[("curve", &[f64::from(curve)])]);
        let shown = |light: f64| {
            let seen = shaded(&effect, Surface::example(DVec3::splat(light), 0));
            seen.color.y
        };
        let mut last = shown(0.0);
        assert!(last < 1e-4, "{curve}: black is {last}");
        for step in -120..200 {
            let now = shown(2f64.powf(f64::from(step) / 10.0));
            assert!(now >= last, "curve {curve} falls to {now}");
            last = now;
        }
        assert!(last > 0.98, "{curve}: white is {last}");
    }
    for curve in [2.0, 4.0] {
        let effect = enabled("tonemap", &[("curve", &[curve]), ("exposure", &[6.0])]);
        let red = shaded(&effect, Surface::example(DVec3::new(4.0, 0.1, 0.1), 0));
        let least = red.color.truncate().min_element();
        assert!(least > 0.5, "curve {curve}: a strong red stays red");
    }
}

/// Bayer 1973: the order in which cells of 4 by 4 turn white, as every textbook prints it.
#[test]
fn cells_fill_in_the_order_of_bayer() {
    const ORDER: [[u32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
    let dither = enabled("dither", &[("matrix", &[1.0]), ("levels", &[2.0])]);
    for (y, row) in ORDER.iter().enumerate() {
        for (x, &rank) in row.iter().enumerate() {
            let at = [x as u32, y as u32 + 4];
            let is_white = |gray: f64| finished(&dither, &PLAIN, DVec4::splat(gray), at).x == 1.0;
            // With a gray of n 16ths, n cells of 16 are white: those of the n greatest ranks.
            let whites = (0..=16)
                .filter(|&n| is_white(f64::from(n) / 16.0 + 0.01))
                .count();
            assert_eq!(whites as u32, rank + 1, "{x}, {y}");
        }
    }
}

/// Beer and Lambert: exp(-density path). Lambert: the cosine.
#[test]
fn light_fades_in_fog_and_falls_off_with_the_cosine() {
    let fog = enabled(
        "fog",
        &[
            ("color", &[1.0, 0.5, 0.0, 1.0]),
            ("density", &[0.35]),
            ("start_m", &[3.0]),
        ],
    );
    let far = Surface {
        depth_m: 7.0,
        ..Surface::example(DVec3::ZERO, 0)
    };
    let fraction = 0.753_403_036;
    near(
        "fog",
        shaded(&fog, far).color.truncate(),
        [fraction, 0.5 * fraction, 0.0],
        1e-7,
    );
    let none: &[f64] = &[0.0, 0.0, 0.0, 1.0];
    let lambert = enabled(
        "lambert",
        &[
            ("sun", &[1.0, 0.5, 0.25, 1.0]),
            ("sky", none),
            ("ground", none),
            ("sun_direction", &[0.0, 0.866_025_403_784, 0.5]),
            ("headlight", &[0.0]),
        ],
    );
    let lit = shaded(&lambert, Surface::example(DVec3::ONE, 0));
    near("60 degrees", lit.color.truncate(), [0.5, 0.25, 0.125], 1e-6);
}

/// IEC 61966-2-1, through the color of a line, and Rec. 709, through a duotone of 256 levels.
#[test]
fn gamma_and_luminance_are_those_of_the_standards() {
    for (linear, encoded) in [
        (0.002, 0.02584),
        (0.0214, 0.157_613_84),
        (0.5, 0.735_356_98),
    ] {
        let outline = enabled("outline", &[("color", &[linear, linear, linear, 1.0])]);
        let picture = Picture {
            triangle_ids: &std::array::from_fn::<u32, 64, _>(
                |i| if i % 8 < 4 { u32::MAX } else { 0 },
            ),
            ..PLAIN
        };
        let line = finished(&outline, &picture, DVec4::ONE, [3, 3]);
        near("line", line.truncate(), [encoded; 3], 1e-6);
    }
    let dither = enabled(
        "dither",
        &[
            ("palette", &[1.0]),
            ("ink", &[0.0, 0.0, 0.0, 1.0]),
            ("paper", &[1.0; 4]),
        ],
    );
    let gray = finished(&dither, &PLAIN, DVec4::new(0.8, 0.3, 0.1, 1.0), [0, 0]);
    near("luminance", gray.truncate(), [0.391_86; 3], 1.0 / 255.0);
}

/// Yliluoma: the ink at the least distance, channels and luma weighted by 0.299, 0.587 and 0.114.
#[test]
fn the_nearest_ink_is_nearest_by_luma() {
    let palette = enabled("palette", &[("inks", &[1.0]), ("dither", &[0.0])]);
    let [black, cyan, magenta] = [[0.0; 3], [0.090_841_7, 1.0, 1.0], [1.0, 0.090_841_7, 1.0]];
    for (encoded, ink) in [
        ([0.9, 0.4, 0.8], magenta),
        ([0.3, 0.9, 0.8], cyan),
        ([0.2, 0.2, 0.3], black),
        // Luma alone would take white.
        ([0.7, 0.85, 0.95], cyan),
    ] {
        let linear = encoded.map(|v: f64| ((v + 0.055) / 1.055).powf(2.4));
        near("ink", passed(&palette, [linear.into(); 9]), ink, 1e-6);
    }
}

/// Kyprianidis, Kang and Döllner 2009, with the polynomial weights of Kyprianidis and others 2010:
/// sector by sector from angles, the ellipse from the eigenvalues of the structure tensor.
#[test]
fn a_stroke_of_paint_is_an_anisotropic_kuwahara_filter() {
    const SIDE: usize = 7;
    let colors: [DVec3; SIDE * SIDE] = std::array::from_fn(|i| {
        let (x, y) = (i % SIDE, i / SIDE);
        let tone = |k: usize| ((7 * x + 13 * y + 5 * k + x * y) % 11) as f64 / 10.0;
        let tones = DVec3::new(tone(0), 0.2 + 0.6 * tone(1), 0.5 * tone(2));
        tones * tones
    });
    for ([radius, stretch, hardness, saturation], tensor, at, expected) in [
        (
            [2.5, 0.0, 1000.0, 1.0],
            DVec3::ZERO,
            [3, 3],
            [0.265_925_32, 0.242_530_64, 0.059_317_62],
        ),
        (
            [2.0, 1.5, 50.0, 1.0],
            DVec3::new(0.02, 0.03, 0.5),
            [3, 3],
            [0.076_133_32, 0.390_433_34, 0.019_560_50],
        ),
        (
            [1.8, 1.2, 300.0, 1.2],
            DVec3::new(0.4, -0.2, 0.1),
            [2, 4],
            [0.175_278_42, 0.384_586_11, 0.012_321_91],
        ),
    ] {
        let paint = enabled(
            "paint",
            &[
                ("radius_px", &[radius]),
                ("stretch", &[stretch]),
                ("hardness", &[hardness]),
                ("saturation", &[saturation]),
            ],
        );
        let stroke = passed_at(&paint, 3, &colors, &[tensor; SIDE * SIDE], at);
        near("stroke", stroke, expected, 1e-6);
    }
}

/// Schlick 1994, of glass whose face-on reflectance is 0.04: what a black pane mirrors of white.
#[test]
fn glass_mirrors_as_schlick_says() {
    for (degrees, mirrored) in [(0.0, 0.04), (60.0, 0.07), (75.0, 0.254_729_9), (90.0, 1.0)] {
        let angle = f64::to_radians(degrees);
        let slanted = Surface {
            normal: DVec3::new(libm::sin(angle), 0.0, libm::cos(angle)),
            ..Surface::example(DVec3::ZERO, 0)
        };
        let pane = Glass {
            mirrored: [1.0; 4],
            frost: 0.0,
            ..Glass::default()
        };
        let light = pane.layer(&slanted).added;
        near("glass", light, [mirrored; 3], 1e-6);
    }
}

/// A binomial mean of 3 by 3 in square roots, and no value beyond those around it.
#[test]
fn a_sharpened_step_does_not_overshoot() {
    let sharpen = enabled("sharpen", &[("amount", &[1.0]), ("halo", &[0.0])]);
    let step = |left: f64, middle: f64, right: f64| {
        let row = [left, middle, right].map(DVec3::splat);
        passed(
            &sharpen,
            [
                row[0], row[1], row[2], row[0], row[1], row[2], row[0], row[1], row[2],
            ],
        )
    };
    near("flat", step(0.25, 0.25, 0.25), [0.25; 3], 1e-9);
    near("edge", step(0.04, 0.04, 0.64), [0.04; 3], 1e-9);
    // Roots 0.2, 0.6, 0.8: the mean is 0.55, so the middle moves to 0.65.
    near("slope", step(0.04, 0.36, 0.64), [0.4225; 3], 1e-9);
}

/// Is a line drawn at any pixel of a row that shows two objects of four pixels each?
fn has_line(outline: &EnabledEffect, keys: &[u32; 8]) -> bool {
    let picture = Picture {
        width: 8,
        height: 1,
        triangle_ids: &[0, 0, 0, 0, 1, 1, 1, 1],
        keys,
        draws: &[0, 1],
        previous: None,
        background: &[[0; 4]],
    };
    (0..8).any(|x| finished(outline, &picture, DVec4::ONE, [x, 0]) != DVec4::ONE)
}

#[test]
fn objects_meet_where_their_depths_agree() {
    let near = 0.5f32.to_bits();
    let step = 1 << 16; // A fraction of 2^-7 of the distance.
    let meeting = std::array::from_fn(|x| near + step * (x as u32).abs_diff(4));
    let apart = std::array::from_fn(|x| near - if x < 4 { 0 } else { 1 << 20 });
    for (objects, intersections, threshold, lines) in [
        (0.0, 0.0, 0.05, [false, false]),
        (0.0, 1.0, 0.05, [true, false]),
        (1.0, 0.0, 0.05, [true, true]),
        (0.0, 1.0, 0.001, [false, false]),
        (0.0, 1.0, 0.5, [true, true]),
    ] {
        let outline = enabled(
            "outline",
            &[
                ("objects", &[objects]),
                ("intersections", &[intersections]),
                ("depth", &[0.0]),
                ("depth_threshold", &[threshold]),
                ("width_px", &[1.0]),
            ],
        );
        let found = [meeting, apart].map(|keys| has_line(&outline, &keys));
        assert_eq!(found, lines, "{objects} {intersections} {threshold}");
    }
}

#[test]
fn a_thick_line_goes_round_corners_without_a_gap() {
    const SIDE: u32 = 64;
    let middle = f64::from(SIDE / 2);
    for (width_px, half_angle_deg) in [6, 8, 12, 16]
        .into_iter()
        .flat_map(|width| [15.0, 30.0, 45.0, 75.0].map(|angle| (width, angle)))
    {
        let half_angle = f64::to_radians(half_angle_deg);
        // A wedge that points to the left, its tip in the middle of the picture.
        let is_inside = |i: u32| {
            let at = DVec2::new((i % SIDE).into(), (i / SIDE).into()) - middle;
            at.x >= 0.0 && at.y.abs() <= at.x * half_angle.tan()
        };
        let inside: Vec<bool> = (0..SIDE * SIDE).map(is_inside).collect();
        let ids: Vec<u32> = inside
            .iter()
            .map(|&is_inside| if is_inside { 0 } else { u32::MAX })
            .collect();
        let picture = Picture {
            width: SIDE,
            height: SIDE,
            triangle_ids: &ids,
            keys: &vec![0.5f32.to_bits(); ids.len()],
            draws: &[0],
            previous: None,
            background: &[[0; 4]; SIDE as usize],
        };
        let outline = enabled("outline", &[("width_px", &[f64::from(width_px)])]);
        // A neighbor is looked for at every step, so a tip begins where it is as wide as one.
        let step = (width_px + 7) / 8;
        let tip_px = 1.0 + f64::from(step) / half_angle.sin();
        for i in 0..SIDE * SIDE {
            let (x, y) = (i % SIDE, i / SIDE);
            let is_line = finished(&outline, &picture, DVec4::ONE, [x, y]) != DVec4::ONE;
            let at = DVec2::new(x.into(), y.into()) - middle;
            let is_near = at.length() + tip_px <= f64::from(width_px);
            assert!(
                is_line || inside[i as usize] || !is_near,
                "{width_px} px, {half_angle_deg}°: a gap at {x}, {y}"
            );
            // Nothing of the wedge is nearer than its tip.
            let is_ahead = at.y.abs() * half_angle.tan() <= -at.x;
            let is_beyond = is_ahead && at.length() > f64::from(width_px);
            assert!(!is_line || !is_beyond, "{width_px} px: a spike at {x}, {y}");
        }
    }
}
