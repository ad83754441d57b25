//! Promise: effects that decide about samples decide exactly: dissolve fills what it says, stipple
//! and wireframe draw what their integers say, a draw order stops after N samples, boxes and points
//! cover their boxes and discs; on every option the same, and a mistake shows. Needs an adapter,
//! but for what the oracle alone can tell.

use std::{collections::BTreeMap, sync::Arc};

use rasterlab::{
    effects::{Effect, Stack, dissolve::Mode, draw_order::Unit},
    frame::Geometry,
    oracle::{self, SampleTests, Shot},
    scene::{Scene, draw::draws, view::View},
};

use crate::common::*;

/// A stack of one effect with some of its fields set.
fn only(name: &str, fields: &[(&str, f64)]) -> Stack {
    let mut stack = Stack::default();
    set(&mut stack, name, fields);
    stack
}

fn set(stack: &mut Stack, name: &str, fields: &[(&str, f64)]) {
    let effect = Effect::find(name).unwrap_or_else(|| panic!("no effect {name}"));
    let words = &mut stack.enable(effect).words;
    for (field, value) in fields {
        let field = effect
            .field(field)
            .unwrap_or_else(|| panic!("no field {name}.{field}"));
        let lanes = vec![*value; field.value_type.components()];
        field
            .set(words, &lanes)
            .unwrap_or_else(|error| panic!("{name}: {error}"));
    }
}

/// What is drawn of a picture: for every sample of every triangle whether the rules draw it, by
/// triangle.
struct Drawn {
    geometry: Geometry,
    triangles: Vec<oracle::OrientedTriangle>,
}

impl Drawn {
    fn of(scene: &Scene, view: &View, stack: &Stack) -> Self {
        let draws = draws(scene, view).expect("a scene that fits");
        let shot = Shot::new(scene, &draws, view, stack);
        let mut geometry = oracle::project(&Shot {
            stack: &Stack::default(),
            ..shot
        })
        .expect("nobody cancels it");
        geometry.sample_setups = oracle::sample_setups(&shot, &geometry);
        let (triangles, _) = oracle::triangles(&shot, &geometry).expect("nobody cancels it");
        Self {
            geometry,
            triangles,
        }
    }

    /// Layers of every pixel.
    fn layers(&self, view: &View, stack: &Stack) -> Vec<u32> {
        let tests = oracle::limited(
            SampleTests::of_effects(stack, &self.geometry),
            stack,
            &self.triangles,
            view,
        )
        .expect("nobody cancels it");
        oracle::cover_with(&tests, &self.triangles, view)
            .expect("nobody cancels it")
            .layers()
    }

    /// Samples of each triangle, clipped ones one by one.
    fn samples(&self, view: &View, stack: &Stack) -> BTreeMap<usize, u64> {
        let tests = oracle::limited(
            SampleTests::of_effects(stack, &self.geometry),
            stack,
            &self.triangles,
            view,
        )
        .expect("nobody cancels it");
        let one = |t: &oracle::OrientedTriangle| {
            let layers = oracle::cover_with(&tests, std::slice::from_ref(t), view)
                .expect("nobody cancels it")
                .layers();
            (t.entry, layers.iter().map(|&count| u64::from(count)).sum())
        };
        self.triangles.iter().map(one).collect()
    }
}

fn sum(layers: &[u32]) -> u64 {
    layers.iter().map(|&count| u64::from(count)).sum()
}

const MODES: [Mode; 5] = [
    Mode::Edge,
    Mode::Corner,
    Mode::Centroid,
    Mode::Scanline,
    Mode::Hash,
];

fn dissolved(mode: Mode, fill: f64) -> Stack {
    only(
        "dissolve",
        &[("mode", f64::from(mode as u32)), ("fill", fill)],
    )
}

/// Pictures in which triangles are many pixels, about one, cut by the near plane, or thin.
fn pictures() -> Vec<(Arc<Scene>, View)> {
    [
        "sphere?triangles=200",
        "grid?cell=0.4&width=48&height=48",
        "near",
        "slivers",
    ]
    .map(|query| {
        let scene = scene(query);
        let view = view(&scene, [80, 64]);
        (scene, view)
    })
    .into()
}

#[test]
fn dissolve_draws_nothing_at_0_everything_at_1_and_more_with_every_step() {
    for (scene, view) in pictures() {
        let plain = Drawn::of(&scene, &view, &Stack::default()).layers(&view, &Stack::default());
        for mode in MODES {
            let layers = |fill: f64| {
                let stack = dissolved(mode, fill);
                Drawn::of(&scene, &view, &stack).layers(&view, &stack)
            };
            assert_eq!(sum(&layers(0.0)), 0, "{mode:?} of {}", scene.name);
            assert_eq!(layers(1.0), plain, "{mode:?} of {}", scene.name);
            let mut last = vec![0; plain.len()];
            for fill in [0.01, 0.1, 0.25, 0.5, 0.75, 0.9, 0.999] {
                let next = layers(fill);
                // Each triangle's samples grow, so those of a pixel do.
                assert!(
                    last.iter().zip(&next).all(|(a, b)| a <= b),
                    "{mode:?} {fill} of {}",
                    scene.name
                );
                last = next;
            }
        }
    }
}

#[test]
fn p_per_cent_of_a_triangle_are_p_per_cent_of_its_area() {
    // Triangles of thousands of samples in several poses.
    let poses = [
        [[10, 7], [230, 60], [90, 220]],
        [[3, 200], [250, 190], [128, 9]],
        [[250, 250], [20, 240], [240, 11]],
    ];
    for corners in poses {
        let corners: [[i32; 2]; 3] = corners.map(|corner: [i32; 2]| corner.map(|at| at * 256 + 61));
        let (scene, view) = (
            scene_of_meshes(&[triangle_soup_in_units(&[(corners, 0.5)])]),
            pixel_view(256, 256),
        );
        let plain = Drawn::of(&scene, &view, &Stack::default());
        let covered = sum(&plain.layers(&view, &Stack::default())) as f64;
        for mode in MODES {
            for fill in [0.1, 0.25, 0.5, 0.8] {
                let stack = dissolved(mode, fill);
                let filled = sum(&Drawn::of(&scene, &view, &stack).layers(&view, &stack)) as f64;
                // A sweep errs by part of a row of samples along its edge; a hash by chance, 5
                // sigma.
                let error_bound = match mode {
                    Mode::Scanline => 0.5,
                    Mode::Hash => 5.0 * (covered * fill * (1.0 - fill)).sqrt(),
                    Mode::Edge | Mode::Corner | Mode::Centroid => 300.0,
                };
                assert!(
                    (filled - fill * covered).abs() <= error_bound,
                    "{mode:?} {fill}: {filled} of {covered}"
                );
            }
        }
    }
}

#[test]
fn scanlines_fill_every_triangle_to_the_nearest_sample() {
    for (scene, view) in pictures() {
        let plain = Drawn::of(&scene, &view, &Stack::default()).samples(&view, &Stack::default());
        for fill in [0.1, 0.37, 0.5, 0.93] {
            let stack = dissolved(Mode::Scanline, fill);
            for (entry, filled) in Drawn::of(&scene, &view, &stack).samples(&view, &stack) {
                let covered = plain[&entry];
                if covered >= 2 {
                    let share = (f64::from(fill as f32) * f64::from(1 << 24)).round_ties_even()
                        / f64::from(1 << 24);
                    assert!(
                        (filled as f64 - share * covered as f64).abs() <= 0.5,
                        "{fill} of {covered}: {filled}"
                    );
                }
            }
        }
    }
}

#[test]
fn triangles_of_a_sample_or_none_dissolve_without_bias() {
    let scene = scene("grid?cell=0.7&width=160&height=120");
    let view = view(&scene, [160, 120]);
    let covered =
        sum(&Drawn::of(&scene, &view, &Stack::default()).layers(&view, &Stack::default())) as f64;
    for mode in MODES {
        for fill in [0.05, 0.3, 0.5, 0.9] {
            let stack = dissolved(mode, fill);
            let filled = sum(&Drawn::of(&scene, &view, &stack).layers(&view, &stack)) as f64;
            let sigma = (covered * fill * (1.0 - fill)).sqrt();
            assert!(
                (filled - fill * covered).abs() <= 4.0 * sigma,
                "{mode:?} {fill}: {filled} of {covered}, sigma {sigma:.1}"
            );
        }
    }
}

#[test]
fn stipple_draws_its_fraction_of_every_matrix() {
    let [a, b, c, d] = [[0, 0], [64 * 256, 0], [64 * 256, 64 * 256], [0, 64 * 256]];
    let (scene, view) = (
        scene_of_meshes(&[triangle_soup_in_units(&[
            ([a, b, c], 0.5),
            ([a, c, d], 0.5),
        ])]),
        pixel_view(64, 64),
    );
    for (matrix, levels) in [(0.0, 4.0), (1.0, 16.0), (2.0, 64.0)] {
        for cell in [1.0, 2.0, 4.0] {
            for level in 0..=8 {
                let opacity = f64::from(level) / 8.0;
                let stack = only(
                    "stipple",
                    &[("matrix", matrix), ("cell_px", cell), ("opacity", opacity)],
                );
                let drawn = sum(&Drawn::of(&scene, &view, &stack).layers(&view, &stack)) as f64;
                assert_eq!(
                    drawn,
                    4096.0 * (opacity * levels).round_ties_even() / levels,
                    "{matrix} {cell} {opacity}"
                );
            }
        }
    }
}

#[test]
fn wires_are_as_wide_as_they_say_whatever_the_edge() {
    let mut rng = Rng(11);
    for _ in 0..30 {
        let mut corner = || [rng.between(-4000, 20_000), rng.between(-4000, 20_000)];
        let corners = [corner(), corner(), corner()];
        let (scene, view) = (
            scene_of_meshes(&[triangle_soup_in_units(&[(corners, 0.5)])]),
            pixel_view(64, 64),
        );
        for width in [1.0, 2.5, 9.0] {
            let stack = only("wireframe", &[("width_px", width), ("hidden", 0.0)]);
            let plain =
                Drawn::of(&scene, &view, &Stack::default()).layers(&view, &Stack::default());
            let wires = Drawn::of(&scene, &view, &stack).layers(&view, &stack);
            for (pixel, (&covered, &wired)) in plain.iter().zip(&wires).enumerate() {
                let p = [pixel % 64, pixel / 64].map(|k| (256 * k + 128) as f64);
                let distance = (0..3)
                    .map(|k| {
                        let [[ax, ay], [bx, by]] =
                            [corners[k], corners[(k + 1) % 3]].map(|c| c.map(f64::from));
                        ((bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax)).abs()
                            / (bx - ax).hypot(by - ay)
                            / 256.0
                    })
                    .fold(f64::INFINITY, f64::min);
                if (distance - width / 2.0).abs() > 0.01 {
                    assert_eq!(
                        wired,
                        if distance < width / 2.0 { covered } else { 0 },
                        "{corners:?} at {p:?}, {distance} px"
                    );
                }
            }
        }
    }
}

#[test]
fn a_draw_order_draws_n_samples_and_one_more_with_every_step() {
    for query in ["sphere?triangles=200", "near", "stack?layers=5"] {
        let scene = scene(query);
        let view = view(&scene, [48, 40]);
        let total =
            sum(&Drawn::of(&scene, &view, &Stack::default()).layers(&view, &Stack::default()));
        let layers = |limit: u64| {
            let stack = only(
                "draw_order",
                &[
                    ("unit", f64::from(Unit::Count as u32)),
                    ("limit", limit as f64),
                ],
            );
            Drawn::of(&scene, &view, &stack).layers(&view, &stack)
        };
        let mut last = layers(total / 3);
        for limit in total / 3 + 1..total / 3 + 40 {
            let next = layers(limit);
            assert_eq!(sum(&next), limit, "{query}");
            assert!(
                last.iter().zip(&next).all(|(a, b)| a <= b),
                "{query}: {limit} is no superset of one less"
            );
            last = next;
        }
        for limit in [0, 1, total - 1, total, total + 1, u64::from(u32::MAX)] {
            assert_eq!(sum(&layers(limit)), limit.min(total), "{query}");
        }
    }
}

fn a_scheduler_draws_as_many_samples_as_it_should_and_only_right_ones(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("cube-wall");
    let view = view(&scene, [160, 120]);
    let total = sum(&Drawn::of(&scene, &view, &Stack::default()).layers(&view, &Stack::default()));
    for option in reach.options(&renderer) {
        for limit in [0, 1, total / 2, total, total + 100] {
            let stack = only(
                "draw_order",
                &[("mode", 1.0), ("unit", 1.0), ("limit", limit as f64)],
            );
            assert!(!stack.is_repeatable());
            let (capture, _) = renderer.exact(
                &scene,
                &view,
                &stack,
                &pinned(option),
                &format!("{limit} tickets on {}", option.name()),
            );
            let drawn = capture.layers.map(|layers| sum(&layers));
            assert_eq!(drawn, Some(limit.min(total)), "{}", option.name());
        }
    }
}

fn kernels_with_a_mistake_are_caught(reach: Reach) {
    let Some(mut healthy) = loan() else { return };
    let card = tunings()[2];
    healthy.set_tuning(card);
    let mutants = [
        (
            "another hash",
            "hash(hash(s.triangle ^ p.seed) ^ pixel)",
            "hash(s.triangle ^ pixel)",
            dissolved(Mode::Hash, 0.5),
        ),
        (
            "the limit is off by one",
            "pixel < order.cut",
            "pixel <= order.cut",
            only("draw_order", &[("fraction", 0.4)]),
        ),
        (
            "the matrix is transposed",
            "let y = (at.y >> i) & 1u;",
            "let y = (at.x >> i) & 1u;",
            only("stipple", &[("opacity", 0.3)]),
        ),
        (
            "twice the width",
            "p.width_px * 128.0",
            "p.width_px * 256.0",
            only("wireframe", &[("hidden", 0.0)]),
        ),
        (
            "discs without their right end",
            "d.x * d.x + d.y * d.y <= r * r",
            "d.x * d.x + d.y * d.y <= r * r && d.x < r / 2",
            only("points", &[("size_px", 6.0)]),
        ),
        (
            "boxes at the far corner",
            "max(max(a.z, b.z), c.z)",
            "min(min(a.z, b.z), c.z)",
            only("boxes", &[]),
        ),
    ];
    let scene = scene("sphere?triangles=5000");
    let view = view(&scene, [128, 96]);
    let mut failures = Vec::new();
    for (what, from, to, stack) in reach.of(2, mutants) {
        let option = pinned(rasterlab::accuracy::Visibility::Split32);
        healthy.exact(
            &scene,
            &view,
            &stack,
            &option,
            &format!("without the mistake: {what}"),
        );
        let mut wrong = Mistaken::new(healthy.gpu(), from, to);
        wrong.set_tuning(card);
        let (_, verdict) = wrong.judged(&scene, &view, &stack, &option);
        if exactness(&verdict.report).is_ok() {
            failures.push(what);
        }
    }
    assert!(failures.is_empty(), "these do not show: {failures:?}");
}

few_and_all!(
    a_scheduler_draws_as_many_samples_as_it_should_and_only_right_ones,
    kernels_with_a_mistake_are_caught,
);
