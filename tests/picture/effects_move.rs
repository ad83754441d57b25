//! Promise: effects that move vertices are exact within the bound they state, on every option, and
//! change nothing at all when they move nothing. Needs an adapter for all but what the oracle says
//! of itself.

use std::sync::Arc;

use glam::{DMat3, DVec2, DVec3};
use rasterlab::{
    effects::{
        Effect, Stack,
        hooks::{ErrorBound, Vertex},
    },
    frame::Geometry,
    math::hash_unit,
    measure::Budget,
    oracle,
    plan::Tuning,
    scene::{
        Scene,
        camera::{Camera, Projection},
        draw::draws,
        view::View,
    },
};

use crate::common::*;

const MOVING: [&str; 3] = ["explode", "inflate", "wobble"];

fn set(stack: &mut Stack, effect: &str, field: &str, values: &[f64]) {
    let enabled = stack
        .get_mut(effect)
        .unwrap_or_else(|| panic!("{effect} is on"));
    let field = enabled
        .effect
        .field(field)
        .unwrap_or_else(|| panic!("{effect} has {field}"));
    field
        .set(&mut enabled.words, values)
        .unwrap_or_else(|error| panic!("{effect}: {error}"));
}

/// An effect with lengths that suit a scene of this size, and everything it can do switched on.
fn suited(effect: &str, scene: &Scene) -> Stack {
    let size = scene.bounds().radius();
    let step = size.min(20.0);
    let mut stack = stack(&[effect]);
    match effect {
        "explode" => {
            set(&mut stack, effect, "amount_m", &[0.15 * step]);
            set(&mut stack, effect, "scatter", &[0.5]);
            set(&mut stack, effect, "spin_turns", &[0.3]);
            set(&mut stack, effect, "shrink", &[0.25]);
        }
        "inflate" => set(&mut stack, effect, "amount_m", &[0.05 * step]),
        _ => {
            set(&mut stack, effect, "direction", &[0.3, 1.0, 0.2]);
            set(&mut stack, effect, "sway", &[1.0, 0.2, 0.4]);
            set(&mut stack, effect, "amplitude_m", &[0.05 * step]);
            set(&mut stack, effect, "wavelength_m", &[0.7 * size]);
            set(&mut stack, effect, "phase_turns", &[0.3]);
        }
    }
    stack
}

/// The same with every length and turn at 0: an effect that moves nothing.
fn resting(effect: &str, scene: &Scene) -> Stack {
    let mut stack = suited(effect, scene);
    for field in ["amount_m", "spin_turns", "shrink", "amplitude_m"] {
        if stack
            .get(effect)
            .is_some_and(|enabled| enabled.effect.field(field).is_some())
        {
            set(&mut stack, effect, field, &[0.0]);
        }
    }
    stack
}

fn lit(mut stack: Stack) -> Stack {
    stack.enable(Effect::find("lambert").expect("there is light"));
    stack
}

fn all_moving_effects_together_are_exact_far_from_the_origin_inside_and_in_parallel_rays(
    reach: Reach,
) {
    let Some(mut renderer) = loan() else { return };
    let mut far = Scene::clone(&scene("knot?tess=6"));
    let offset = DVec3::new(1e4, -2e4, 1e4);
    far.instances[0].world_from_object =
        glam::DMat4::from_translation(offset) * glam::DMat4::from_scale(DVec3::new(-1.0, 1.5, 0.5));
    let near = Camera {
        eye: offset + DVec3::new(1.0, 1.0, 4.0),
        target: offset,
        ..Camera::default()
    };
    let flat = Camera {
        projection: Projection::Orthographic { height_m: 3.0 },
        ..Camera::default()
    };
    let inside = Camera {
        eye: DVec3::new(0.2, -0.1, 0.3),
        target: DVec3::X,
        near_m: 0.05,
        ..Camera::default()
    };
    let cases = [
        ("mirrored far away", Arc::new(far), near),
        ("orthographic", scene("teapot?tess=5"), flat),
        ("inside the mesh", scene("sphere?triangles=3000"), inside),
    ];
    for (what, scene, camera) in cases {
        let view = camera_view(&scene, &camera, [200, 150]);
        let mut stack = lit(stack(&MOVING));
        set(&mut stack, "explode", "amount_m", &[0.1]);
        for (pattern, name) in reach.of(
            2,
            ["uniform", "sweep", "radial", "random"].iter().enumerate(),
        ) {
            set(&mut stack, "explode", "pattern", &[pattern as f64]);
            for option in reach.options(&renderer) {
                renderer.exact(
                    &scene,
                    &view,
                    &stack,
                    &pinned(option),
                    &format!("{what}, {name}, {}", option.name()),
                );
            }
        }
    }
}

fn an_effect_that_moves_nothing_changes_nothing(reach: Reach) {
    for query in ["cube-wall", "near"] {
        let scene = scene(query);
        let view = view(&scene, [160, 120]);
        let none = oracle::render(&scene, &view, &lit(Stack::default())).expect("a builtin fits");
        for effect in MOVING {
            let resting = oracle::render(&scene, &view, &lit(resting(effect, &scene)))
                .expect("a builtin fits");
            assert_eq!(
                (&resting.triangle_id, &resting.depth_key, &resting.color),
                (&none.triangle_id, &none.depth_key, &none.color),
                "{query} {effect}"
            );
        }
    }
    let Some(mut renderer) = loan() else { return };
    let usual = renderer.gpu().caps.tuning();
    for query in ["cube-wall", "near"] {
        let scene = scene(query);
        let view = view(&scene, [160, 120]);
        // With nothing left out, so that no shorter way round a sum rounds otherwise.
        renderer.set_tuning(Tuning {
            specialized: false,
            ..usual
        });
        let none = renderer.captured(&scene, &view, &lit(Stack::default()), &split32());
        for effect in reach.of(1, MOVING) {
            let resting =
                renderer.captured(&scene, &view, &lit(resting(effect, &scene)), &split32());
            assert_eq!(resting.frame, none.frame, "{query} {effect}");
        }
    }
}

/// A few corners of a pebble, so close that a unit is a fraction of a micrometer.
fn telescope() -> (Arc<Scene>, View) {
    let scene = scene("sphere?triangles=3000");
    let camera = Camera {
        eye: DVec3::new(0.9, 0.8, 3.0),
        target: DVec3::new(0.2, 0.2, 0.9),
        projection: Projection::Perspective { fov_y_deg: 0.4 },
        ..Camera::default()
    };
    let view = camera_view(&scene, &camera, [512, 512]);
    (scene, view)
}

/// Shares of its stated bound that an adapter uses, seen through a telescope.
fn stated_bounds_hold_under_a_telescope_and_are_not_idle(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let (scene, view) = telescope();
    let draws = draws(&scene, &view).expect("a builtin fits");
    for effect in reach.of(1, MOVING) {
        let stack = suited(effect, &scene);
        let (capture, _) = renderer.exact(&scene, &view, &stack, &split32(), effect);
        let reference = oracle::project(&oracle::Shot::new(&scene, &draws, &view, &stack))
            .expect("nobody cancels it");
        let bounds = oracle::snap_bounds(&oracle::Shot::new(&scene, &draws, &view, &stack));
        let (mut largest, mut median) = (0.0f64, Vec::new());
        for ((found, own), bound) in capture
            .geometry
            .vertices
            .iter()
            .zip(&reference.vertices)
            .zip(bounds)
        {
            let (0, 0, Some([x, y])) = (found.flags, own.flags, bound) else {
                continue;
            };
            let share = (f64::from(found.x.abs_diff(own.x)) / (1.0 + x))
                .max(f64::from(found.y.abs_diff(own.y)) / (1.0 + y));
            largest = largest.max(share);
            median.push(x);
        }
        median.sort_by(f64::total_cmp);
        let middle = median[median.len() / 2];
        eprintln!(
            "{effect}: {} corners, median bound {middle:.1} units, largest share used {largest:.3}",
            median.len()
        );
        assert!(
            middle > 4.0,
            "{effect}: the telescope shows nothing, {middle} units"
        );
        assert!(
            (0.01..=1.0).contains(&largest),
            "{effect}: {largest} of the bound"
        );
    }
}

// -------- what the effects promise of themselves

fn vertex(rng: &mut Rng) -> Vertex {
    let mut point = |reach: f64| {
        DVec3::new(
            rng.real(-reach, reach),
            rng.real(-reach, reach),
            rng.real(-reach, reach),
        )
    };
    let (position, normal, flat_normal, arm) = (
        point(2.0),
        point(1.0).normalize(),
        point(1.0).normalize(),
        point(0.1),
    );
    Vertex {
        position,
        offset: DVec3::ZERO,
        normal,
        flat_normal,
        center: position - arm,
        arm,
        center_screen: DVec2::new(0.4, 0.6),
        triangle: rng.next_u32() >> 8,
        cell_px: 0,
    }
}

#[test]
fn a_wobbling_normal_is_the_numerical_derivative_of_the_position() {
    let mut rng = Rng(3);
    for case in 0..200 {
        let mut stack = stack(&["wobble"]);
        set(
            &mut stack,
            "wobble",
            "direction",
            &[
                rng.real(-1.0, 1.0),
                rng.real(-1.0, 1.0),
                rng.real(-1.0, 1.0),
            ],
        );
        set(
            &mut stack,
            "wobble",
            "sway",
            &[
                rng.real(-1.0, 1.0),
                rng.real(-1.0, 1.0),
                rng.real(-1.0, 1.0),
            ],
        );
        set(&mut stack, "wobble", "amplitude_m", &[rng.real(0.0, 0.4)]);
        set(&mut stack, "wobble", "wavelength_m", &[rng.real(0.5, 3.0)]);
        let here = vertex(&mut rng);
        let place = |p: DVec3| {
            let moved = stack.moved(
                Vertex {
                    position: p,
                    ..here
                },
                0,
            );
            moved.position + moved.offset
        };
        let step = 1e-5;
        let along = |axis: DVec3| {
            (place(here.position + axis * step) - place(here.position - axis * step)) / (2.0 * step)
        };
        let jacobian = DMat3::from_cols(along(DVec3::X), along(DVec3::Y), along(DVec3::Z));
        let [x, y, z] = [jacobian.x_axis, jacobian.y_axis, jacobian.z_axis];
        let expected =
            (DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * here.normal).normalize();
        let found = stack.moved(here, 0).normal;
        assert!(
            found.distance(expected) < 1e-6,
            "case {case}: {found} for {expected}"
        );
    }
}

#[test]
fn exploding_and_turning_keeps_every_triangle_and_its_area() {
    let scene = scene("sphere?triangles=300");
    let view = view(&scene, [200, 150]);
    let mut stack = stack(&["explode"]);
    set(&mut stack, "explode", "amount_m", &[0.4]);
    set(&mut stack, "explode", "spin_turns", &[0.37]);
    set(&mut stack, "explode", "scatter", &[0.6]);
    let draws = draws(&scene, &view).expect("a builtin fits");
    let geometry = oracle::project(&oracle::Shot::new(&scene, &draws, &view, &stack))
        .expect("nobody cancels it");
    assert_eq!(geometry.vertices.len() as u64, 3 * scene.triangle_count());
    assert!(geometry.has_unshared_vertices);

    let primitive = &scene.primitives[0];
    for t in 0..primitive.triangle_count() {
        let places = primitive
            .corners(&scene, t)
            .map(|v| DVec3::from(primitive.position(&scene, v).map(f64::from)));
        let center = places.iter().sum::<DVec3>() / 3.0;
        let normal = (places[1] - places[0]).cross(places[2] - places[0]);
        let moved = places.map(|position| {
            let corner = Vertex {
                position,
                offset: DVec3::ZERO,
                normal: normal.normalize(),
                flat_normal: normal.normalize(),
                center,
                arm: position - center,
                center_screen: DVec2::splat(0.5),
                triangle: t,
                cell_px: 0,
            };
            position + stack.moved(corner, 0).offset
        });
        let turned = (moved[1] - moved[0]).cross(moved[2] - moved[0]);
        // The text's sine is a polynomial, some 4e-9 off.
        assert!(
            turned.distance(normal) < 1e-7 * normal.length().max(1e-3),
            "triangle {t}: its plane or its area changed"
        );
        let flight = moved.iter().sum::<DVec3>() / 3.0 - center;
        let expected = 0.4 * (1.0 - f64::from(0.6f32) * hash_unit(t ^ 0x85eb_ca6b));
        assert!(
            (flight.length() - expected).abs() < 1e-6 && flight.dot(normal) > 0.0,
            "triangle {t} flew {flight}"
        );
    }
}

fn corners_snap_to_cells_and_the_adapter_agrees_on_each(reach: Reach) {
    const CELL_PX: i32 = 6;
    let size = [200, 150];
    let mut stack = lit(stack(&["wobble", "psx"]));
    set(&mut stack, "psx", "cell_px", &[f64::from(CELL_PX)]);
    let on_grid = |geometry: &Geometry| {
        let seen = geometry.vertices.iter().filter(|corner| corner.flags == 0);
        let [x, y] = size.map(|side| 128 * side as i32);
        let is_on = |at: i32| at.rem_euclid(256 * CELL_PX) == 0;
        let count = seen.clone().count();
        assert!(count > 50, "{count} corners are seen");
        seen.filter(|corner| is_on(corner.x - x) && is_on(corner.y - y))
            .count()
            == count
    };
    let inside = Camera {
        eye: DVec3::new(0.2, -0.1, 0.3),
        target: DVec3::X,
        near_m: 0.05,
        ..Camera::default()
    };
    let flat = Camera {
        projection: Projection::Orthographic { height_m: 3.0 },
        ..Camera::default()
    };
    let mut renderer = loan();
    for (what, query, camera) in [
        ("in front", "knot?tess=6", Camera::default()),
        ("inside the mesh", "sphere?triangles=3000", inside),
        ("orthographic", "teapot?tess=5", flat),
    ] {
        let scene = scene(query);
        let view = camera_view(&scene, &camera, size);
        let draws = draws(&scene, &view).expect("a builtin fits");
        let own = oracle::project(&oracle::Shot::new(&scene, &draws, &view, &stack));
        assert!(on_grid(&own.expect("nobody cancels it")), "{what}");
        let Some(renderer) = &mut renderer else {
            continue;
        };
        for option in reach.options(renderer) {
            let (what, pins) = (format!("{what}, {}", option.name()), pinned(option));
            let (capture, verdict) = renderer.judged(&scene, &view, &stack, &pins);
            let judgement = verdict.report.within(&Budget::default());
            assert_eq!(judgement, Ok(()), "{what}: {:?}", verdict.report);
            assert!(on_grid(&capture.geometry), "{what}");
            let ill = verdict.report.ill_conditioned;
            assert!(
                ill * 50 <= verdict.report.vertices,
                "{what}: {ill} corners are not judged"
            );
        }
    }
}

#[test]
fn a_bound_grows_with_what_an_effect_is_given_and_with_what_it_does() {
    let mut rng = Rng(11);
    let given = ErrorBound {
        position_m: 1e-7,
        offset_m: 0.0,
        along_m: DVec3::ZERO,
        normal: 1e-7,
        flat_normal: 1e-7,
        center_m: 1e-7,
        arm_m: 1e-8,
        center_screen: 1e-7,
    };
    let coarser = ErrorBound {
        position_m: 1e-5,
        offset_m: 1e-6,
        along_m: DVec3::ZERO,
        normal: 1e-5,
        flat_normal: 1e-5,
        center_m: 1e-5,
        arm_m: 1e-5,
        center_screen: 1e-5,
    };
    for effect in MOVING {
        let moving = suited(effect, &scene("sphere?triangles=200"));
        let still = resting(effect, &scene("sphere?triangles=200"));
        for _ in 0..100 {
            let here = vertex(&mut rng);
            assert_eq!(still.error_bound(here, given, 0), given, "{effect} at rest");
            assert_eq!(still.moved(here, 0), here, "{effect} at rest");
            let (fine, coarse) = (
                moving.error_bound(here, given, 0),
                moving.error_bound(here, coarser, 0),
            );
            assert!(
                fine.offset_m > 0.0 && fine.offset_m < 2e-5,
                "{effect}: {}",
                fine.offset_m
            );
            assert!(
                coarse.offset_m > fine.offset_m && coarse.normal >= fine.normal,
                "{effect}"
            );
        }
    }
}

// -------- mutants

fn still_life(query: &str) -> (Arc<Scene>, View) {
    let scene = scene(query);
    let view = view(&scene, [160, 120]);
    (scene, view)
}

fn kernels_that_move_wrongly_are_caught(reach: Reach) {
    let Some(mut healthy) = loan() else { return };
    let mutants = [
        (
            "a wave turns normals the wrong way",
            "wobble",
            "- direction * dot(sway, v.normal)",
            "+ direction * dot(sway, v.normal)",
        ),
        (
            "corners take their neighbor's record",
            "explode",
            "var at = 3u * id + vec3u(0u, 1u, 2u);",
            "var at = 3u * id + vec3u(0u, 1u, 3u);",
        ),
        (
            "movement is forgotten where triangles are clipped",
            "explode",
            "    return vertex_effects_clip(draw, vertex, id, floats_of_class(position_bits(draw, vertex), 0u));\n}\n\n// What the samples",
            "    return transform_clip(draw, floats_of_class(position_bits(draw, vertex), 0u));\n}\n\n// What the samples",
        ),
        (
            "the last term of the sine is halved",
            "wobble",
            "y * 39.5367061",
            "y * 20.0",
        ),
    ];
    let mut failures = Vec::new();
    for (what, effect, from, to) in reach.of(1, mutants) {
        let (scene, view) = match what {
            "the last term of the sine is halved" => telescope(),
            "movement is forgotten where triangles are clipped" => still_life("near"),
            _ => still_life("sphere?triangles=200"),
        };
        let mut stack = lit(suited(effect, &scene));
        if effect == "wobble" {
            set(&mut stack, effect, "amplitude_m", &[0.15]);
        }
        healthy.exact(
            &scene,
            &view,
            &stack,
            &split32(),
            &format!("without the mistake: {what}"),
        );
        let mut wrong = Mistaken::new(healthy.gpu(), from, to);
        let (_, verdict) = wrong.judged(&scene, &view, &stack, &split32());
        match exactness(&verdict.report) {
            Ok(()) => failures.push(what),
            Err(faults) => eprintln!("{what}: {faults}"),
        }
    }
    assert_eq!(failures, Vec::<&str>::new(), "not caught");
}

few_and_all!(
    all_moving_effects_together_are_exact_far_from_the_origin_inside_and_in_parallel_rays,
    corners_snap_to_cells_and_the_adapter_agrees_on_each,
    stated_bounds_hold_under_a_telescope_and_are_not_idle,
    an_effect_that_moves_nothing_changes_nothing,
    kernels_that_move_wrongly_are_caught,
);
