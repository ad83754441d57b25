//! Promise: the extreme cases keep their expectation, each on every rung and with work shared out in several ways: exact
//! against the oracle unless a test says otherwise. Needs an adapter.

mod common;

use std::sync::Arc;

use common::*;
use glam::{DMat4, DVec3, DVec4};
use rasterlab::{
    effects::Stack,
    frame::{NO_OWNER, vertex_flags},
    gpu::{Capture, RenderError, Renderer, uniforms::Capacities},
    ladder::Visibility,
    math::GUARD_BAND,
    measure::compare,
    plan::Tuning,
    scene::{
        Scene,
        camera::{Camera, Projection, View},
    },
};

/// Draws on every rung with work shared out as on a graphics card, and on the last rung as the adapter likes it and with
/// a workgroup for all but the tiniest triangles. Each is exact, and all are the same; the last is handed over.
fn everywhere_with(renderer: &mut Renderer, scene: &Arc<Scene>, view: &View, stack: &Stack, what: &str) -> Capture {
    let usual = renderer.gpu().caps.tuning();
    let [crowded, _, card, _] = tunings();
    let rungs = rungs(renderer);
    let last = quick_rung(renderer);
    let ways = rungs.iter().map(|&rung| (rung, card)).chain([(last, crowded), (last, usual)]);
    let mut first: Option<Capture> = None;
    for (rung, tuning) in ways {
        renderer.set_tuning(tuning);
        let what = format!("{what}, {} {tuning:?}", rung.name());
        let (capture, _) = exact(renderer, scene, view, stack, &pinned(rung), &what);
        let first = first.get_or_insert_with(|| capture.clone());
        assert_eq!(compare::owners(&capture.frame.owner, &first.frame.owner).different, 0, "{what}: owners");
        assert_eq!(compare::owners(&capture.frame.key, &first.frame.key).different, 0, "{what}: keys");
        assert_eq!(capture.layers, first.layers, "{what}: layers");
    }
    renderer.set_tuning(usual);
    first.expect("at least one way")
}

fn everywhere(renderer: &mut Renderer, scene: &Arc<Scene>, view: &View, what: &str) -> Capture {
    everywhere_with(renderer, scene, view, &Stack::default(), what)
}

fn layers(capture: &Capture) -> &[u32] {
    capture.layers.as_deref().expect("layers are counted")
}

/// Every sample of the picture is covered exactly once.
fn assert_once(capture: &Capture, what: &str) {
    let wrong = layers(capture).iter().enumerate().find(|(_, hits)| **hits != 1);
    assert_eq!(wrong, None, "{what}: (pixel, hits)");
}

/// A perspective in which (x w, y w, -w) lands on (x, y) in normalized device coordinates.
fn square_perspective(width: u32, height: u32, near: f64) -> View {
    View {
        clip_from_world: DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::new(0.0, 0.0, 0.0, -1.0), DVec4::new(0.0, 0.0, near, 0.0)),
        eye: DVec3::ZERO,
        ndc_axes: [DVec3::X, DVec3::Y],
        linear_depth_m: None,
        scene_range_m: [near, near + 10.0],
        ..pixel_view(width, height)
    }
}

/// Four corners of a square, turned.
fn turned(center: [f64; 2], half: f64, angle: f64) -> [[f64; 2]; 4] {
    [0.0, 1.0, 2.0, 3.0].map(|quarter| {
        let (sin, cos) = libm::sincos(angle + quarter * std::f64::consts::FRAC_PI_2);
        [center[0] + half * cos, center[1] + half * sin]
    })
}

/// A quad through four corners in normalized device coordinates with a w for each, wound one way or the other.
fn quad(corners: [[f64; 2]; 4], w: [f64; 4], reversed: bool) -> Vec<[f32; 3]> {
    let place = |i: usize| [corners[i][0] * w[i], corners[i][1] * w[i], -w[i]].map(|v| v as f32);
    let order: [usize; 6] = if reversed { [0, 2, 1, 2, 0, 3] } else { [0, 1, 2, 2, 3, 0] };
    order.map(place).to_vec()
}

// ---------------------------------------------------------------- coverage

#[test]
fn case_1_rotated_quads_cover_each_sample_once_and_miss_none() {
    let Some(mut renderer) = renderer() else { return };
    let view = square_perspective(128, 128, 1.0 / 128.0);
    let mut dice = Dice(7);
    for (reversed, projective) in [(false, false), (true, false), (false, true), (true, true)] {
        let mut w = || if projective { dice.real(0.1, 4.0) } else { 1.0 };
        let quads = (0..16).flat_map(|i| {
            let center = [-0.75 + 0.5 * f64::from(i % 4), -0.75 + 0.5 * f64::from(i / 4)];
            let corners = turned(center, 0.15, f64::from(i) * std::f64::consts::FRAC_PI_2 / 16.0);
            quad(corners, [w(), w(), w(), w()], reversed)
        });
        let what = format!("reversed {reversed}, w of each corner {projective}");
        let capture = everywhere(&mut renderer, &hand_made(&[sheet(quads.collect())]), &view, &what);
        assert!(layers(&capture).iter().all(|&hits| hits <= 1), "{what}: doubles");
        // A square of diagonal 0.3 fills 184 of 128 x 128 pixels.
        let covered = capture.frame.covered();
        assert!((16 * 174..16 * 194).contains(&covered), "{what}: {covered} pixels");
    }
}

#[test]
fn case_1_a_quad_larger_than_the_view_covers_everything_once() {
    let Some(mut renderer) = renderer() else { return };
    let view = square_perspective(96, 64, 1.0 / 128.0);
    for turn in 0..15 {
        let angle = f64::from(turn) * std::f64::consts::FRAC_PI_2 / 15.0;
        // Beyond every corner, then far past the guard band.
        for half in [2.5, 40.0, 1e5, 1e8] {
            let part = sheet(quad(turned([0.1, -0.2], half, angle), [1.0, 0.7, 2.0, 1.3], turn % 2 == 0));
            let what = format!("turn {turn}, half {half}");
            let (capture, mut verdict) = judged(&mut renderer, &hand_made(&[part]), &view, &stack(&[]), &pinned(Visibility::Split32));
            if half > 1e6 {
                // Cuts of f32 coordinates of 10^8 lie whole pixels apart: exact given the clipped pieces, and without a crack.
                assert!(capture.frame.counters.clipped == 2 && !capture.geometry.pieces.is_empty());
                verdict.accuracy.unexplained = 0;
            }
            assert_eq!(exactness(&verdict.accuracy), Ok(()), "{what}: {:?}", verdict.accuracy);
            assert_once(&capture, &what);
        }
    }
}

#[test]
fn case_2_a_fan_about_a_sample_hits_it_once() {
    let Some(mut renderer) = renderer() else { return };
    for n in [3, 5, 8, 13, 40] {
        for seed in 0..3 {
            let fan = scene(&format!("fan?n={n}&radius=0.3&seed={seed}"));
            let capture = everywhere(&mut renderer, &fan, &view(&fan, [64, 64]), &format!("{n} triangles, seed {seed}"));
            assert_eq!(layers(&capture).iter().sum::<u32>(), 0, "a picture of other size shows the fan elsewhere");
            let capture = everywhere(&mut renderer, &fan, &view(&fan, [256, 256]), &format!("{n} triangles, seed {seed}"));
            assert_eq!(layers(&capture).iter().sum::<u32>(), 1, "{n} triangles, seed {seed}");
        }
    }
}

#[test]
fn case_3_the_rectangle_of_the_d3d11_rules_owns_fifteen_and_ten_pixels() {
    let Some(mut renderer) = renderer() else { return };
    let [a, b, c, d] = [[0, 0], [5 * 256, 0], [5 * 256, 5 * 256], [0, 5 * 256]];
    let scene = hand_made(&[units(&[([a, b, c], 0.5), ([a, c, d], 0.5)])]);
    let capture = everywhere(&mut renderer, &scene, &pixel_view(8, 8), "rectangle");
    let count = |owner| capture.frame.owner.iter().filter(|&&o| o == owner).count();
    assert_eq!((count(0), count(1), count(NO_OWNER)), (15, 10, 39));
    assert!(layers(&capture).iter().all(|&hits| hits <= 1));
}

#[test]
fn case_4_a_translation_by_whole_pixels_moves_the_owners_and_nothing_else() {
    let Some(mut renderer) = renderer() else { return };
    let mut dice = Dice(11);
    let soup: Vec<_> = (0..60).map(|i| (near_miss(&mut dice, [600, 8192, 40_000][i % 3], [32, 32]), 0.1 + 0.01 * i as f32)).collect();
    let view = pixel_view(128, 128);
    let mut drawn = |by: [i32; 2]| {
        let moved: Vec<_> = soup.iter().map(|(corners, z)| (corners.map(|[x, y]| [x + 256 * by[0], y + 256 * by[1]]), *z)).collect();
        everywhere(&mut renderer, &hand_made(&[units(&moved)]), &view, &format!("moved by {by:?}"))
    };
    let still = drawn([0, 0]);
    for by in [[1, 0], [0, 1], [31, 17], [64, 96]] {
        let moved = drawn(by);
        for (x, y) in (0..128 - by[0]).flat_map(|x| (0..128 - by[1]).map(move |y| (x, y))) {
            let (from, to) = ((y * 128 + x) as usize, ((y + by[1]) * 128 + x + by[0]) as usize);
            assert_eq!(still.frame.owner[from], moved.frame.owner[to], "{by:?}: owner of {x}, {y}");
            assert_eq!(layers(&still)[from], layers(&moved)[to], "{by:?}: layers at {x}, {y}");
        }
    }
}

#[test]
fn case_5_triangles_of_every_size_cover_their_half_plane() {
    let Some(mut renderer) = renderer() else { return };
    for exponent in -3..=9 {
        let size = libm::pow(10.0, f64::from(exponent)) as f32;
        let (x, y) = (32.3f32, 31.7f32);
        let scene = hand_made(&[sheet(vec![[x, y - size, 0.5], [x + size, y, 0.5], [x, y + size, 0.5]])]);
        let capture = everywhere(&mut renderer, &scene, &pixel_view(64, 64), &format!("10^{exponent} px"));
        for (pixel, &hits) in layers(&capture).iter().enumerate() {
            let (px, py) = ((pixel % 64) as f32 + 0.5, (pixel / 64) as f32 + 0.5);
            let slack = (size - (py - y).abs() - (px - x)).min(px - x);
            if slack.abs() > 1.0 / 128.0 {
                assert_eq!(hits, u32::from(slack > 0.0), "10^{exponent} px, pixel {pixel}");
            }
        }
    }
}

#[test]
fn case_6_dense_grids_have_no_hole_and_no_double() {
    let Some(mut renderer) = renderer() else { return };
    for query in ["grid?cell=0.1&width=48&height=48", "grid?cell=0.4&width=96&height=96", "grid?cell=1&lattice=16&width=96&height=96"] {
        let grid = scene(query);
        let size = if query.contains("48") { [48, 48] } else { [96, 96] };
        assert_once(&everywhere(&mut renderer, &grid, &view(&grid, size), query), query);
    }
}

#[test]
fn case_7_slivers_share_their_edges() {
    let Some(mut renderer) = renderer() else { return };
    let mut dice = Dice(17);
    let guard = GUARD_BAND;
    for height in 1..=8 {
        // Needles of a million to one, back to back: above them, below them and they themselves cover each sample once.
        let (left, right) = (dice.between(2000, 14_000), dice.between(2000, 14_000));
        let [a, b] = [[-guard, left], [guard, right]];
        let [c, d] = [[-guard, left + height], [guard, right + height]];
        let [e, f, g, h] = [[-guard, -guard], [guard, -guard], [-guard, guard], [guard, guard]];
        let faces = [[e, f, a], [f, b, a], [a, b, c], [b, d, c], [c, d, g], [d, h, g]];
        let scene = hand_made(&[units(&faces.map(|face| (face, 0.5)))]);
        let capture = everywhere(&mut renderer, &scene, &pixel_view(64, 64), &format!("height {height}"));
        assert_once(&capture, &format!("height {height}"));
    }
    let needles = scene("slivers?n=200&length=30000");
    everywhere(&mut renderer, &needles, &view(&needles, [256, 256]), "needles");
}

#[test]
fn case_8_the_class_of_a_triangle_does_not_show_at_its_borders() {
    let Some(mut renderer) = renderer() else { return };
    let mut dice = Dice(23);
    let px = 256;
    // Sides of boxes at the borders of all classes: 8 px and 32 px of one invocation, 64 px, 128 px of extent, and where i32 ends.
    for extent in [8 * px, 11 * px, 32 * px, 33 * px, 64 * px, 65 * px, 128 * px - 1, 128 * px, 128 * px + 1, 46_340, 46_341, 65_536] {
        let mut triangles = Vec::new();
        for i in 0..24 {
            let at = [dice.between(-extent / 2, 128 * px), dice.between(-extent / 2, 128 * px)];
            let [near, far] = [dice.between(0, extent + 1), dice.between(0, extent + 1)];
            let mut corners = [[0, 0], [extent, near], [far, extent]];
            if i % 2 == 1 {
                corners = corners.map(|[x, y]| [extent - x, y]);
            }
            if i % 3 == 0 {
                // A box of that width and the least height, and the reverse.
                corners = if i % 2 == 0 { [[0, 0], [extent, 128], [far, 256]] } else { [[0, 0], [128, extent], [256, near]] };
            }
            triangles.push((corners.map(|[x, y]| [x + at[0], y + at[1]]), 0.2 + 0.01 * i as f32));
        }
        everywhere(&mut renderer, &hand_made(&[units(&triangles)]), &pixel_view(128, 128), &format!("extent {extent}"));
    }
}

#[test]
fn case_9_the_guard_band_is_exact_inside_and_has_no_crack_beyond() {
    let Some(mut renderer) = renderer() else { return };
    let view = pixel_view(16, 16);
    let center = [2125, 1971];
    let (mut whole, mut cut) = (0, 0);
    // Each coordinate of four corners at the end of the guard band or one unit beyond.
    for beyond in 0..256 {
        let corner = |i: usize, [x, y]: [i32; 2]| {
            let reach = |axis: usize| GUARD_BAND + (beyond >> (2 * i + axis) & 1);
            [x * reach(0), y * reach(1)]
        };
        let [a, b, c, d] = [corner(0, [-1, -1]), corner(1, [1, -1]), corner(2, [1, 1]), corner(3, [-1, 1])];
        let faces = [[center, a, b], [center, b, c], [center, c, d], [center, d, a]];
        let scene = hand_made(&[units(&faces.map(|face| (face, 0.5)))]);
        let what = format!("corners beyond: {beyond:08b}");
        let (capture, _) = exact(&mut renderer, &scene, &view, &stack(&[]), &pinned(Visibility::Split32), &what);
        assert_once(&capture, &what);
        for (vertex, [x, y]) in capture.geometry.vertices.iter().zip(faces.as_flattened()) {
            let is_inside = x.abs().max(y.abs()) <= GUARD_BAND;
            assert_eq!(vertex.flags == 0, is_inside, "{what}: {x}, {y}");
            assert!(!is_inside || (vertex.x, vertex.y) == (*x, *y), "{what}: {vertex:?} for {x}, {y}");
        }
        let counters = capture.frame.counters;
        (whole, cut) = (whole + 4 - counters.clipped, cut + counters.clipped);
    }
    assert!(whole >= 4 * 16 && cut > 512, "{whole} whole, {cut} cut");
}

// ---------------------------------------------------------------- clipping

#[test]
fn case_10_w_at_and_around_zero() {
    let Some(mut renderer) = renderer() else { return };
    let near = 1.0f32 / 128.0;
    let step = |v: f32, by: i32| f32::from_bits(v.to_bits().wrapping_add_signed(by));
    let depths = [0.0, 1e-30, -1e-30, near, step(near, 1), step(near, -1), 1.0, -1.0, 0.5, 1e3, -1e3];
    for seed in 1..=6 {
        let mut dice = Dice(seed);
        let corner = |dice: &mut Dice| {
            let w = depths[dice.between(0, depths.len() as i32) as usize];
            let spread = if w.abs() > 1.0 { 900.0 } else { 2.0 };
            [dice.real(-spread, spread) as f32, dice.real(-spread, spread) as f32, -w]
        };
        let positions: Vec<_> = (0..180).map(|_| corner(&mut dice)).collect();
        let view = square_perspective(64, 64, near.into());
        let capture = everywhere(&mut renderer, &hand_made(&[sheet(positions)]), &view, &format!("seed {seed}"));
        assert!(capture.frame.counters.clipped > 20 && capture.frame.covered() > 2000, "{:?}", capture.frame.counters);
        for vertex in &capture.geometry.vertices {
            assert!(vertex.depth.is_finite() && vertex.inv_w.is_finite() && vertex.inv_w <= 129.0, "{vertex:?}");
        }
    }
}

/// A thousand steps of the near plane through a closed shell and the ground under it.
#[test]
fn case_11_a_camera_passes_through_a_surface() {
    let Some(mut renderer) = renderer() else { return };
    let mut shell = Scene::clone(&scene("sphere?triangles=300"));
    shell.materials[0].double_sided = true;
    let ground = hand_made(&[sheet(vec![[-50.0, -0.5, -50.0], [-50.0, -0.5, 50.0], [50.0, -0.5, 50.0]])]);
    let shell = Arc::new(shell);
    let rung = quick_rung(&renderer);
    let (mut cut, mut worst) = (0, 0);
    for step in 0..1000 {
        let way = f64::from(step) / 1000.0;
        let scene = if step % 4 == 0 { &ground } else { &shell };
        let eye = DVec3::new(0.3 - 0.4 * way, 0.9 - 1.6 * way, 1.7 - 1.4 * way);
        let camera = Camera { eye, target: DVec3::new(0.1, -0.2, -1.0), near_m: 0.1, ..Camera::default() };
        let view = seen(scene, &camera, [48, 32]);
        let (capture, verdict) = exact(&mut renderer, scene, &view, &stack(&["depth"]), &pinned(rung), &format!("step {step}"));
        cut += u32::from(capture.frame.counters.clipped > 0);
        worst = worst.max(verdict.accuracy.explained_by_snap);
    }
    assert!(cut > 300, "{cut} pictures were clipped");
    // Clipped outlines may move by less than a pixel: at most a row along the longest cut.
    assert!(worst <= 48, "{worst} pixels differ from the oracle's own picture");
}

// ---------------------------------------------------------------- attributes

#[test]
fn case_12_positions_that_are_no_numbers_are_rejected_by_their_bits_and_counted() {
    let Some(mut renderer) = renderer() else { return };
    let view = pixel_view(64, 64);
    let good = [[4.0, 4.0, 0.25], [60.0, 8.0, 0.5], [8.0, 60.0, 0.75f32]];
    let huge = (1u64 << 40) as f32;
    let bad = [f32::NAN, -f32::NAN, f32::from_bits(0x7f80_0001), f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -f32::MAX, huge, -huge];
    let (mut positions, mut nonfinite, mut range) = (good.to_vec(), 0, 0);
    for value in bad {
        for place in 0..9 {
            let mut corners = good.map(|p| [p[0], p[1], 0.9]);
            corners[place / 3][place % 3] = value;
            positions.extend(corners);
            if value.is_finite() { range += 1 } else { nonfinite += 1 }
        }
    }
    positions.extend(good.map(|[x, y, z]| [64.0 - x, y, z]));
    let last = positions.len() as u32 / 3 - 1;
    let scene = hand_made(&[sheet(positions)]);
    let capture = everywhere(&mut renderer, &scene, &view, "bad positions");
    let counters = capture.frame.counters;
    assert_eq!((counters.rejected_nonfinite, counters.rejected_range, counters.degenerate), (nonfinite, range, 0));
    assert!(capture.frame.owner.iter().all(|&owner| [0, last, NO_OWNER].contains(&owner)));
    let alone = hand_made(&[sheet(scene_positions(&scene, [0, last]))]);
    let truth = everywhere(&mut renderer, &alone, &view, "good positions alone");
    assert_eq!(capture.frame.key, truth.frame.key, "a rejected triangle leaves no trace");

    // The largest that pass the gate are clipped; what is subnormal is 0.
    let below = f32::from_bits(huge.to_bits() - 1);
    let vast = hand_made(&[sheet(vec![[-below, -below, 0.5], [below, -below, 0.5], [0.0, below, 0.5]])]);
    let capture = everywhere(&mut renderer, &vast, &view, "just below 2^40");
    assert_eq!(capture.frame.covered(), 64 * 64);
    let with = |zero: f32| hand_made(&[sheet(vec![[zero, zero, 0.5], [50.0, zero, zero], [zero, 50.0, 0.25]])]);
    let [zero, subnormal] = [0.0, f32::from_bits(0x007f_ffff)].map(|z| everywhere(&mut renderer, &with(z), &view, "subnormal"));
    assert_eq!(zero.frame, subnormal.frame);
    assert_eq!(zero.geometry, subnormal.geometry);
}

fn scene_positions(scene: &Scene, triangles: [u32; 2]) -> Vec<[f32; 3]> {
    let corners = triangles.map(|t| scene.primitives[0].corners(scene, t));
    corners.as_flattened().iter().map(|&vertex| scene.primitives[0].position(scene, vertex)).collect()
}

#[test]
fn case_12_normals_and_colours_that_are_no_numbers_become_finite_ones() {
    let Some(mut renderer) = renderer() else { return };
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, -f32::MAX, 1e-40, -1e-40, 0.0, 1e20, -3.0];
    let (mut positions, mut normals, mut colors) = (vec![], vec![], vec![]);
    for (i, value) in bad.into_iter().enumerate() {
        for lane in 0..4 {
            let (x, y) = (6.0 * i as f32 + 1.0, 10.0 * lane as f32 + 1.0);
            for (corner, [dx, dy]) in [[0.0, 0.0], [5.0, 0.0], [0.0, 9.0]].into_iter().enumerate() {
                let (mut normal, mut color) = ([0.3, 0.2, 0.9], [0.9, 0.5, 0.2, 1.0f32]);
                if corner == lane % 3 {
                    color[lane] = value;
                    if lane < 3 { normal[lane] = value } else { normal = [value; 3] }
                }
                positions.push([x + dx, y + dy, 0.5]);
                normals.push(normal);
                colors.push(color);
            }
        }
    }
    let both = |normals: &[[f32; 3]], colors: &[[f32; 4]]| {
        hand_made(&[Part { positions: positions.clone(), normals: normals.to_vec(), colors: colors.to_vec(), ..Part::default() }])
    };
    for (what, scene) in [("normals", both(&normals, &[])), ("colours", both(&[], &colors)), ("both", both(&normals, &colors))] {
        for effects in [&["lambert"][..], &["normals"], &["facet", "lambert"]] {
            let capture = everywhere_with(&mut renderer, &scene, &pixel_view(64, 64), &stack(effects), &format!("{what}, {effects:?}"));
            assert!(capture.frame.covered() > 700);
        }
    }
}

// ---------------------------------------------------------------- depth

#[test]
fn case_13_depths_over_nine_decades_are_told_apart() {
    let Some(mut renderer) = renderer() else { return };
    for near in [1e-3, 1e-5] {
        let view = square_perspective(64, 64, near);
        let mut positions = Vec::new();
        // The farther, the larger on screen; pairs a thousandth apart, the farther one first.
        for decade in 0..11 {
            for nearer in [1.001, 1.0] {
                let w = near * 1.5 * libm::pow(10.0, f64::from(decade)) * nearer;
                positions.extend(quad(turned([0.0, 0.0], 0.1 + 0.1 * f64::from(decade), 0.3 * f64::from(decade)), [w; 4], false));
            }
        }
        let capture = everywhere_with(&mut renderer, &hand_made(&[sheet(positions)]), &view, &stack(&["depth"]), &format!("near {near}"));
        let seen: std::collections::BTreeSet<u32> = capture.frame.owner.iter().copied().filter(|&o| o != NO_OWNER).collect();
        assert!(seen.iter().all(|owner| owner % 4 >= 2), "near {near}: the nearer of each pair wins, not {seen:?}");
        assert!(seen.len() >= 20, "near {near}: {} triangles show", seen.len());
    }
}

#[test]
fn case_14_scales_and_offsets_keep_their_bounds() {
    let Some(mut renderer) = renderer() else { return };
    let knot = scene("knot?tess=4");
    for (offset, scale) in [(0.0, 1e-6), (0.0, 1e-3), (0.0, 1e6), (1e4, 1.0), (1e6, 1.0), (1e8, 1.0), (1e8, 1e6)] {
        let mut placed = Scene::clone(&knot);
        let at = DVec3::new(offset, -offset, 0.5 * offset);
        placed.instances[0].world_from_object = DMat4::from_translation(at) * DMat4::from_scale(DVec3::splat(scale));
        let camera = Camera { eye: at + DVec3::new(1.0, 1.0, 4.0) * scale, target: at, near_m: scale.max(1e-6), ..Camera::default() };
        let view = seen(&placed, &camera, [96, 72]);
        let what = format!("offset {offset:e}, scale {scale:e}");
        let capture = everywhere_with(&mut renderer, &Arc::new(placed), &view, &stack(&["depth", "lambert"]), &what);
        assert!(capture.frame.covered() > 1500, "{what}");
    }
}

#[test]
fn case_15_layers_one_key_apart_and_equal_layers() {
    let Some(mut renderer) = renderer() else { return };
    let view = pixel_view(64, 64);
    let mut dice = Dice(5);
    // Full-screen layers in no order, one float after another: small triangles, and one that is large.
    for (what, corners) in [("small", [[0, 0], [24 * 256, 0], [0, 24 * 256]]), ("large", [[-60_000, -90_000], [90_000, 0], [0, 90_000]])] {
        let mut steps: Vec<u32> = (0..40).chain(10..20).collect();
        for i in (1..steps.len()).rev() {
            steps.swap(i, dice.between(0, i as i32 + 1) as usize);
        }
        let layers: Vec<_> = steps.iter().map(|step| (corners, f32::from_bits(0.5f32.to_bits() + step))).collect();
        let capture = everywhere(&mut renderer, &hand_made(&[units(&layers)]), &view, what);
        let nearest = steps.iter().position(|&step| step == 39).expect("the nearest layer") as u32;
        let mut owners: Vec<u32> = capture.frame.owner.iter().copied().filter(|&o| o != NO_OWNER).collect();
        owners.dedup();
        assert_eq!(owners, [nearest], "{what}");
        let top = 0.5f32.to_bits() + 39;
        assert!(capture.frame.key.iter().all(|&key| key == 0 || key == top), "{what}: keys");

        // The nearest twice more: equal keys go to the smaller id.
        let again: Vec<_> = layers.iter().chain([&layers[nearest as usize]; 2]).copied().collect();
        let equal = everywhere(&mut renderer, &hand_made(&[units(&again)]), &view, what);
        assert_eq!(equal.frame.owner, capture.frame.owner, "{what}: equal layers");
    }
}

#[test]
fn case_28_w_ratios_within_one_triangle() {
    let Some(mut renderer) = renderer() else { return };
    for ratio in [2.0, 10.0, 1e3, 1e6f64] {
        let (w, mid) = (1.0f64, ratio.sqrt());
        let corners = [([-0.95, -0.9], w), ([0.95, -0.7], ratio), ([0.1, 0.95], mid)];
        let positions = corners.map(|([x, y], w)| [x * w, y * w, -w].map(|v| v as f32)).to_vec();
        let colors = vec![[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.5], [0.0, 0.0, 1.0, 0.0]];
        let normals = vec![[1.0, 0.0, 0.1], [0.0, 1.0, 0.1], [-1.0, 0.2, 0.5]];
        let scene = hand_made(&[Part { positions, normals, colors, ..Part::default() }]);
        for effects in [&[][..], &["normals"], &["depth"]] {
            let view = square_perspective(160, 160, 1.0 / 1024.0);
            let capture = everywhere_with(&mut renderer, &scene, &view, &stack(effects), &format!("ratio {ratio}, {effects:?}"));
            assert!(capture.frame.covered() > 5000);
        }
    }
}

// ---------------------------------------------------------------- nothing, and too much

#[test]
fn case_17_what_has_no_area_is_counted_and_not_drawn() {
    let Some(mut renderer) = renderer() else { return };
    let view = pixel_view(32, 32);
    let points = vec![[1.0, 1.0, 0.5], [30.0, 2.0, 0.5], [3.0, 30.0, 0.5], [15.5, 1.5, 0.5], [1.0, 1.0, 0.9]];
    let none = Part { positions: points.clone(), indices: vec![0, 0, 0, 0, 1, 1, 0, 1, 3, 0, 4, 1, 2, 0, 2], ..Part::default() };
    let capture = everywhere(&mut renderer, &hand_made(std::slice::from_ref(&none)), &view, "degenerate");
    assert_eq!((capture.frame.covered(), capture.frame.counters.degenerate), (0, 5));

    // Far larger than a class of its own, and still a line; a speck that the snap makes a point.
    let line = units(&[([[-8_000_000, -8_000_000], [0, 0], [8_000_000, 8_000_000]], 0.5)]);
    let speck = sheet(vec![[9.5, 9.5, 0.5], [9.5001, 9.5, 0.5], [9.5, 9.5001, 0.5]]);
    let capture = everywhere(&mut renderer, &hand_made(&[none, line, speck]), &view, "degenerate and large");
    assert_eq!((capture.frame.covered(), capture.frame.counters.degenerate), (0, 7));

    // Meshes without triangles, without vertices, alone and among others; a scene without meshes.
    let empty = Part { positions: vec![[1.0, 1.0, 0.5]; 2], ..Part::default() };
    let nothing = Part::default();
    let whole = sheet(points[..3].to_vec());
    for (parts, covered) in [
        (vec![], false),
        (vec![nothing.clone()], false),
        (vec![empty.clone()], false),
        (vec![empty.clone(), nothing.clone(), empty.clone()], false),
        (vec![empty.clone(), nothing.clone(), whole.clone(), empty.clone()], true),
        (vec![nothing, whole, empty], true),
    ] {
        let what = format!("{} meshes", parts.len());
        let capture = everywhere(&mut renderer, &hand_made(&parts), &view, &what);
        assert_eq!(capture.frame.covered() > 0, covered, "{what}");
        assert_eq!(capture.frame.counters, Default::default(), "{what}");
    }
}

/// Tiny triangles one after another over the pixels of a row, one hit each, all of them `times` over, later ones nearer.
fn dots(indexed: bool, count: u32, times: u32) -> (Arc<Scene>, View) {
    let corner = |i: u32, c: usize| {
        let (x, y) = ((i % 64) as f32, (i / 64 % 64) as f32);
        [[x + 0.25, y + 0.25, 0.0], [x + 0.75, y + 0.5, 0.0], [x + 0.25, y + 0.75, 0.0]][c]
    };
    let distinct = if indexed { 4096.min(count) } else { count };
    let part = Part {
        positions: (0..distinct).flat_map(|i| [0, 1, 2].map(|c| corner(i, c))).collect(),
        indices: if indexed { (0..count).flat_map(|i| [0, 1, 2].map(|c| 3 * (i % distinct) + c)).collect() } else { vec![] },
        placements: (0..times).map(|i| DMat4::from_translation(DVec3::Z * f64::from(i + 1) / f64::from(times + 1))).collect(),
        ..Part::default()
    };
    (hand_made(&[part]), pixel_view(64, 64))
}

/// Hits of each pixel, and its owner: the last of those with the last placement's depth has the smallest id there.
fn assert_dots(capture: &Capture, count: u32, times: u32, what: &str) {
    let rounds = |pixel: u32| (count - pixel).div_ceil(4096);
    for pixel in 0..4096.min(count) {
        assert_eq!(layers(capture)[pixel as usize], times * rounds(pixel), "{what}: hits of pixel {pixel}");
        assert_eq!(capture.frame.owner[pixel as usize], (times - 1) * count + pixel, "{what}: owner of pixel {pixel}");
    }
}

#[test]
fn case_18_more_workgroups_than_one_dimension_holds_directly() {
    let Some(mut renderer) = renderer() else { return };
    let rung = quick_rung(&renderer);
    // 64 triangles, or vertices, to a group: 65,535, 65,536 and 65,537 groups, the last one with a single lane at work.
    for groups in [65_535u32, 65_536, 65_537] {
        let triangles = 64 * (groups - 1) + 1;
        // Three placements divide none of these evenly, so the list itself is as long as it must be.
        let (scene, view) = dots(true, triangles, 1);
        let what = format!("{groups} groups of triangles");
        let capture = captured(&mut renderer, &scene, &view, &stack(&[]), &pinned(rung));
        assert_dots(&capture, triangles, 1, &what);
    }
    let (count, times) = (66_666, 21);
    assert!(3 * count * times > 64 * 65_535);
    let (scene, view) = dots(false, count, times);
    let capture = captured(&mut renderer, &scene, &view, &stack(&[]), &pinned(rung));
    assert_dots(&capture, count, times, "65,626 groups of vertices");
}

#[test]
fn case_18_more_workgroups_than_one_dimension_holds_indirectly() {
    let Some(mut renderer) = renderer() else { return };
    let rung = quick_rung(&renderer);
    let [crowded, _, card, _] = tunings();
    // Medium triangles: one group each.
    for demand in [65_535u32, 65_536, 65_537] {
        let corners = |i: u32| {
            let [x, y] = [i % 21, i / 21 % 21].map(|k| 768 * k as i32);
            [[x, y], [x + 600, y], [x, y + 600]]
        };
        let triangles: Vec<_> = (0..demand).map(|i| (corners(i), 0.25 + 1e-6 * i as f32)).collect();
        let scene = hand_made(&[units(&triangles)]);
        renderer.set_tuning(crowded);
        exact(&mut renderer, &scene, &pixel_view(64, 64), &stack(&[]), &pinned(rung), &format!("{demand} medium triangles"));
        assert!(renderer.capacities().medium >= demand);
    }
    // Large triangles and their tiles: one group each, one tile to a triangle; with room from the start, since it takes time.
    let needle = |i: i32| [[-20_000 - i % 7, i % 16_000], [40_000, i % 16_000 + 3], [40_000, i % 16_000 + 600]];
    let triangles: Vec<_> = (0..65_600).map(|i| (needle(i), 0.25 + 1e-6 * i as f32)).collect();
    let scene = hand_made(&[units(&triangles)]);
    renderer.set_tuning(card);
    renderer.set_scene(&scene).expect("it fits");
    renderer.set_capacities(Capacities { large: 65_600, tiles: 65_600, ..Capacities::default() });
    exact(&mut renderer, &scene, &pixel_view(64, 64), &stack(&[]), &pinned(rung), "65,600 large triangles");
    assert_eq!(
        renderer.capacities(),
        Capacities { clip: 1, pieces: 1, medium: 1, large: 65_600, tiles: 65_600, bins: 1 },
        "demand was as foreseen"
    );
    // Tiles of the resolve: 66,048 of 8 x 8 pixels.
    let [a, b, c, d] = [[0, 0], [2048 * 256, 0], [2048 * 256, 2064 * 256], [0, 2064 * 256]];
    renderer.set_tuning(Tuning { listed_tiles: true, ..card });
    let scene = hand_made(&[units(&[([a, b, c], 0.5), ([a, c, d], 0.5)])]);
    let view = pixel_view(2048, 2064);
    let (capture, _) = exact(&mut renderer, &scene, &view, &stack(&["triangle_id"]), &pinned(Visibility::Split32), "66,048 tiles");
    assert_eq!(capture.frame.covered(), 2048 * 2064);
}

/// Each queue alone, with the demand that is known for it.
/// What a demand is called, what it comes to, the scene that makes it, and the capacity that must hold it.
type Demand = (&'static str, Capacities, Arc<Scene>, fn(&mut Capacities) -> &mut u32);

fn demands() -> Vec<Demand> {
    let ample = Capacities { clip: 4096, pieces: 4096, medium: 4096, large: 4096, tiles: 4096, bins: 65_536 };
    let n = 40;
    let many = |triangle: [[i32; 2]; 3]| {
        let moved = |i: i32| (triangle.map(|[x, y]| [x, y + 97 * i]), 0.2 + 0.01 * i as f32);
        hand_made(&[units(&(0..n).map(moved).collect::<Vec<_>>())])
    };
    let demand = n as u32;
    // One corner beyond the guard band leaves a quad of two pieces, both on screen.
    let cut = many([[9_000_000, 300], [200, 9000], [300, 200]]);
    let small = many([[300, 300], [9000, 400], [400, 9000]]);
    let large = many([[-3000, -3000], [90_000, 4000], [4000, 90_000]]);
    vec![
        ("clip", Capacities { clip: demand, ..ample }, cut.clone(), |c| &mut c.clip),
        ("pieces", Capacities { pieces: 2 * demand, ..ample }, cut, |c| &mut c.pieces),
        ("medium", Capacities { medium: demand, ..ample }, small, |c| &mut c.medium),
        ("large", Capacities { large: demand, ..ample }, large.clone(), |c| &mut c.large),
        // A picture of 128 x 128 has four tiles.
        ("tiles", Capacities { tiles: 4 * demand, ..ample }, large.clone(), |c| &mut c.tiles),
        // And 64 of the tiles that have lists.
        ("bins", Capacities { bins: 64 * demand, ..ample }, large, |c| &mut c.bins),
    ]
}

#[test]
fn case_19_queues_hold_their_demand_exactly_and_grow_beyond() {
    let Some(mut renderer) = renderer() else { return };
    let view = pixel_view(128, 128);
    renderer.set_tuning(tunings()[0]);
    for rung in rungs(&renderer) {
        let has = |queue: &str| queue != if rung == Visibility::Tiled { "tiles" } else { "bins" };
        for (queue, exactly, scene, field) in demands().into_iter().filter(|(queue, ..)| has(queue)) {
            let demand = *field(&mut exactly.clone());
            for capacity in [demand, demand - 1, demand / 10, 1] {
                let what = format!("{queue} {}: demand {demand}, capacity {capacity}", rung.name());
                let mut capacities = exactly;
                *field(&mut capacities) = capacity;
                renderer.set_scene(&scene).expect("a small scene fits");
                renderer.set_capacities(capacities);
                renderer.draw(&view, &stack(&[]), &pinned(rung)).unwrap_or_else(|error| panic!("{what}: {error}"));
                let report = renderer.finish().unwrap_or_else(|error| panic!("{what}: {error}"));
                assert_eq!(report.counters.overflow, demand - capacity, "{what}");
                assert_eq!(report.redraw, capacity < demand, "{what}");
                exact(&mut renderer, &scene, &view, &stack(&[]), &pinned(rung), &what);
                assert!(*field(&mut renderer.capacities()) >= demand, "{what}: it has grown");
            }
        }
    }
}

#[test]
fn case_20_pictures_without_pixels_dispatch_nothing() {
    let Some(mut renderer) = renderer() else { return };
    let hall = scene("near");
    for size in [[0, 0], [0, 64], [64, 0]] {
        let capture = captured(&mut renderer, &hall, &view(&hall, size), &stack(&["lambert"]), &Default::default());
        assert_eq!([capture.frame.width, capture.frame.height], size);
        assert!(capture.frame.owner.is_empty() && capture.frame.color.is_empty() && renderer.texture_view().is_none());
        let view = view(&hall, [33, 17]);
        exact(&mut renderer, &hall, &view, &stack(&["lambert"]), &Default::default(), "the next picture");
        assert!(renderer.texture_view().is_some());
    }
}

#[test]
fn case_20_odd_and_very_wide_pictures() {
    let Some(mut renderer) = renderer() else { return };
    let hall = scene("near");
    for size in [[1, 1], [1, 97], [97, 1], [9, 7], [65, 63], [129, 127]] {
        let view = view(&hall, size);
        everywhere_with(&mut renderer, &hall, &view, &stack(&["lambert"]), &format!("{size:?}"));
    }
    let most = renderer.gpu().caps.max_texture_side;
    assert!(most >= 8192, "WebGPU promises 8192, this adapter has {most}");
    let teapot = scene("teapot?tess=4");
    for side in [8192, 16_384, 16_385] {
        for size in [[side, 6], [6, side]] {
            let view = view(&teapot, size);
            if side <= most {
                exact(&mut renderer, &teapot, &view, &stack(&["lambert"]), &Default::default(), &format!("{size:?}"));
                continue;
            }
            renderer.set_scene(&teapot).expect("the teapot fits");
            let error = renderer.capture(&view, &stack(&[]), &Default::default()).expect_err("too large a picture");
            assert!(error.is_unsupported() && matches!(error, RenderError::TooWide { .. }), "{error}");
            assert!(
                error.to_string().contains(&format!("{} x {}", size[0], size[1])) && error.to_string().contains(&most.to_string()),
                "{error}"
            );
        }
    }
}

// ---------------------------------------------------------------- chance, mirrors, volume

#[test]
fn case_23_random_triangles_that_pass_samples_as_closely_as_they_can() {
    let Some(mut renderer) = renderer() else { return };
    let chosen = std::env::var("RASTERLAB_SEED").ok().map(|seed| seed.parse::<u32>().expect("RASTERLAB_SEED is a whole number"));
    let rung = quick_rung(&renderer);
    // Extent in units, triangles in a picture, pictures: a million triangles altogether.
    for (extent, count, pictures) in [
        (300, 120_000, 5),
        (1500, 60_000, 6),
        (9000, 6000, 4),
        (32_768, 900, 4),
        (70_000, 300, 4),
        (2_000_000, 200, 4),
        (8_388_607, 200, 4),
    ] {
        let seeds: Vec<u32> = chosen.map_or_else(|| (1..=pictures).collect(), |seed| vec![seed]);
        for seed in seeds {
            let mut dice = Dice(seed.wrapping_mul(0x9e37_79b1) ^ extent as u32);
            let depth = |dice: &mut Dice| dice.between(1, 1024) as f32 / 1024.0;
            let triangles: Vec<_> = (0..count).map(|_| (near_miss(&mut dice, extent, [64, 64]), depth(&mut dice))).collect();
            let scene = hand_made(&[units(&triangles)]);
            let what = format!("RASTERLAB_SEED={seed}, extent {extent}");
            let capture = if count > 2000 {
                renderer.set_tuning(tunings()[2]);
                exact(&mut renderer, &scene, &pixel_view(64, 64), &stack(&[]), &pinned(rung), &what).0
            } else {
                everywhere(&mut renderer, &scene, &pixel_view(64, 64), &what)
            };
            // Nothing moved on the way: the lattice is exact in f32.
            let is_exact =
                |(vertex, [x, y]): (&rasterlab::frame::SnappedVertex, [i32; 2])| vertex.flags == 0 && (vertex.x, vertex.y) == (x, y);
            let placed = triangles.iter().flat_map(|(corners, _)| *corners);
            assert!(capture.geometry.vertices.iter().zip(placed).all(is_exact), "{what}: vertices are not where they were put");
            // Flat triangles have their corners' depth, so no owner is left to a band.
            let truth = truth(&scene, &pixel_view(64, 64));
            assert_eq!(compare::owners(&capture.frame.owner, &truth.owners()).different, 0, "{what}: owners");
            assert_eq!(compare::owners(layers(&capture), &truth.layers()).different, 0, "{what}: layers");
        }
    }
}

#[test]
fn case_24_a_mirrored_placement_shows_the_same_faces() {
    let Some(mut renderer) = renderer() else { return };
    let camera = Camera { eye: DVec3::Z * 4.0, projection: Projection::Orthographic { height_m: 2.6 }, ..Camera::default() };
    for double_sided in [false, true] {
        let mut plain = Scene::clone(&scene("sphere?triangles=900"));
        plain.materials[0].double_sided = double_sided;
        let drawn = |renderer: &mut Renderer, scale: DVec3| {
            let mut scene = plain.clone();
            scene.instances[0].world_from_object = DMat4::from_scale(scale);
            let view = seen(&scene, &camera, [128, 96]);
            everywhere_with(renderer, &Arc::new(scene), &view, &stack(&["lambert"]), &format!("scale {scale}, double-sided {double_sided}"))
        };
        let straight = drawn(&mut renderer, DVec3::ONE);
        // Mirrored left to right the same triangles show, but for samples on edges, which have a left and a right.
        let mirrored = drawn(&mut renderer, DVec3::new(-1.0, 1.0, 1.0));
        let rows = straight.frame.owner.chunks_exact(128).flat_map(|row| row.iter().rev());
        let different = rows.zip(&mirrored.frame.owner).filter(|(a, b)| a != b).count();
        assert!(different <= 8, "{different} pixels show another triangle");
        // Mirrored front to back its other side shows, from outside again.
        let turned = drawn(&mut renderer, DVec3::new(1.0, 1.0, -1.0));
        let shared = turned.frame.owner.iter().filter(|&o| *o != NO_OWNER && straight.frame.owner.contains(o)).count();
        assert!(shared < turned.frame.covered() / 10, "{shared} pixels show the front");
        assert!(turned.frame.covered() > 3000);
    }
}

#[test]
fn case_27_a_million_triangles_and_a_thousand_full_screen_ones() {
    let Some(mut renderer) = renderer() else { return };
    let sphere = scene("sphere?triangles=1000000");
    let rung = quick_rung(&renderer);
    let sphere_view = view(&sphere, [256, 192]);
    let (capture, _) = exact(&mut renderer, &sphere, &sphere_view, &stack(&["lambert"]), &pinned(rung), "a million triangles");
    assert!(capture.frame.covered() > 7000, "{}", capture.frame.covered());

    let mut dice = Dice(3);
    let mut far = || dice.between(60_000, 8_000_000);
    let triangles: Vec<_> =
        (0..1000).map(|i| ([[-far(), -far()], [2 * far() / 2 + 40_000, -far()], [64 * 256, 8_388_607]], 1e-3 * (i % 997) as f32)).collect();
    let scene = hand_made(&[units(&triangles)]);
    renderer.set_tuning(tunings()[2]);
    for rung in rungs(&renderer) {
        let (capture, _) =
            exact(&mut renderer, &scene, &pixel_view(128, 64), &stack(&[]), &pinned(rung), "a thousand full-screen triangles");
        assert!(layers(&capture).iter().all(|&hits| hits > 900));
        assert!(capture.geometry.vertices.iter().all(|vertex| vertex.flags & vertex_flags::CLIPPED == 0));
    }
}
