//! Promise: the light that arrives is what the oracle's own shadow map says, where geometry says,
//! on every option; mistakes in it are found; and a preset without it has nothing of it. Most of it
//! needs an adapter.

use std::sync::Arc;

use glam::{DMat4, DVec3};
use rasterlab::{
    accuracy::{PinnedOptions, ShadowMapSize, ShadowTaps, Visibility},
    effects::{Effect, Stack, read, shadow::Shadow},
    gpu::{Capture, Renderer},
    measure::Budget,
    oracle,
    plan::AccuracyRequest,
    preset::Preset,
    scene::{
        Scene,
        camera::{Camera, Projection},
        shadow_resolution::ShadowResolution,
        view::View,
    },
    shader::{Fetch, KernelKey, library::Library, link},
};

use crate::common::*;

mod rules;

/// A stack with the light and with fields of its effects set.
fn lit(effects: &[&str], values: &[(&str, &str, f64)]) -> Stack {
    let mut stack = stack(effects);
    for (effect, field, value) in values {
        let enabled = stack.get_mut(effect).expect("an effect of the stack");
        let field = enabled.effect.field(field).expect("a field");
        field
            .set(
                &mut enabled.words,
                &vec![*value; field.value_type.components()],
            )
            .expect("within its range");
    }
    stack
}

/// Nothing but the light: what it does not reach is black.
fn light_alone(values: &[(&str, &str, f64)]) -> Stack {
    lit(
        &["shadow"],
        &[
            &[
                ("shadow", "light", 1.0),
                ("shadow", "sky", 0.0),
                ("shadow", "ground", 0.0),
            ],
            values,
        ]
        .concat(),
    )
}

fn on(view: &View, map: ShadowMapSize, taps: ShadowTaps) -> View {
    view.with_shadow(ShadowResolution::of(map, taps))
}

/// A horizontal square, seen from both sides.
fn plate(half: f32, height: f32) -> SimpleMesh {
    let corner = |x: f32, z: f32| [half * x, height, half * z];
    let [a, b, c, d] = [
        corner(-1.0, 1.0),
        corner(1.0, 1.0),
        corner(1.0, -1.0),
        corner(-1.0, -1.0),
    ];
    SimpleMesh {
        normals: vec![[0.0, 1.0, 0.0]; 6],
        ..triangle_soup(vec![a, b, c, a, c, d])
    }
}

/// A smooth unit sphere.
fn ball() -> Arc<Scene> {
    const ROWS: u32 = 48;
    let at = |i: u32, j: u32| {
        let (s, c) = (std::f64::consts::PI * f64::from(j) / f64::from(ROWS)).sin_cos();
        let (sin, cos) = (std::f64::consts::PI * f64::from(i) / f64::from(ROWS)).sin_cos();
        DVec3::new(s * sin, c, s * cos).as_vec3().to_array()
    };
    let cell = |i: u32, j: u32| {
        [
            at(i, j),
            at(i, j + 1),
            at(i + 1, j + 1),
            at(i, j),
            at(i + 1, j + 1),
            at(i + 1, j),
        ]
    };
    let positions: Vec<[f32; 3]> = (0..ROWS)
        .flat_map(|j| (0..2 * ROWS).flat_map(move |i| cell(i, j)))
        .collect();
    scene_of_meshes(&[SimpleMesh {
        normals: positions.clone(),
        double_sided: false,
        ..triangle_soup(positions)
    }])
}

fn slanted(scene: &Scene, size: [u32; 2]) -> View {
    camera_view(
        scene,
        &Camera {
            eye: DVec3::new(1.5, 4.0, 5.0),
            ..Camera::default()
        },
        size,
    )
}

fn boxed(query: &str) -> Arc<Scene> {
    Arc::new(
        rasterlab::scene::builtin::build(query)
            .expect("a builtin")
            .in_room(1.6),
    )
}

// -------- geometry

/// Where a pixel's ray meets the plane y = 0.
fn on_floor(view: &View, x: usize, y: usize) -> DVec3 {
    let [right, up] = [
        (x as f64 + 0.5) / f64::from(view.width),
        (y as f64 + 0.5) / f64::from(view.height),
    ];
    let ray =
        view.forward + view.ndc_axes[0] * (2.0 * right - 1.0) + view.ndc_axes[1] * (1.0 - 2.0 * up);
    view.eye - ray * (view.eye.y / ray.y)
}

fn a_plate_throws_its_shadow_where_geometry_says_to_a_texel(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    const HALF: f64 = 0.6;
    let scene = scene_of_meshes(&[plate(2.0, 0.0), plate(HALF as f32, 1.0)]);
    for (azimuth, elevation) in reach.of(2, [(0.0, 90.0), (25.0, 60.0), (-130.0, 40.0)]) {
        let stack = light_alone(&[
            ("shadow", "azimuth_deg", azimuth),
            ("shadow", "elevation_deg", elevation),
        ]);
        let toward = read::<Shadow>(&stack.0[0].words).toward();
        for map in [ShadowMapSize::Side256, ShadowMapSize::Side512] {
            let view = on(&slanted(&scene, [200, 150]), map, ShadowTaps::One);
            let light = stack.light_view(&scene, &view).expect("there is a light");
            let texel_m =
                2.0 / (light.clip_from_world.row(0).truncate().length() * f64::from(light.width));
            let (capture, _) = renderer.exact(
                &scene,
                &view,
                &stack,
                &unpinned(),
                &format!("{azimuth} {elevation} {map:?}"),
            );
            let mut counts = [0, 0];
            for (i, color) in capture
                .frame
                .color
                .iter()
                .enumerate()
                .filter(|(i, _)| capture.frame.triangle_id[*i] < 2)
            {
                let above = on_floor(&view, i % view.width as usize, i / view.width as usize)
                    + toward / toward.y;
                let inside = HALF - above.x.abs().max(above.z.abs());
                if inside.abs() * toward.y <= texel_m {
                    continue;
                }
                let is_dark = color[0] == 0;
                assert_eq!(
                    is_dark,
                    inside > 0.0,
                    "{azimuth} {elevation} {map:?}: pixel {i}, {inside} m inside, a texel has {texel_m} m"
                );
                counts[usize::from(is_dark)] += 1;
            }
            assert!(counts.iter().all(|&count| count > 200), "{counts:?}");
        }
    }
}

#[test]
fn what_nothing_covers_is_lit_and_what_is_covered_is_dark() {
    let Some(mut renderer) = loan() else { return };
    let above = [("shadow", "elevation_deg", 90.0)];
    let (alone, covered) = (
        scene_of_meshes(&[plate(1.0, 0.0)]),
        scene_of_meshes(&[plate(1.0, 0.0), plate(1.5, 1.5)]),
    );
    let low = |scene: &Scene| {
        camera_view(
            scene,
            &Camera {
                eye: DVec3::new(0.5, 0.8, 6.0),
                ..Camera::default()
            },
            [160, 120],
        )
    };
    for map in [ShadowMapSize::Side256, ShadowMapSize::Side1024] {
        for taps in [ShadowTaps::One, ShadowTaps::Nine, ShadowTaps::TwentyFive] {
            for (scene, byte) in [(&alone, 255), (&covered, 0)] {
                let (view, what) = (
                    on(&low(scene), map, taps),
                    format!("{map:?} {taps:?} {byte}"),
                );
                let (capture, _) =
                    renderer.exact(scene, &view, &light_alone(&above), &unpinned(), &what);
                let floor = capture
                    .frame
                    .triangle_id
                    .iter()
                    .zip(&capture.frame.color)
                    .filter(|(triangle_id, _)| **triangle_id < 2);
                let wrong = floor.clone().filter(|(_, color)| color[0] != byte).count();
                assert!(floor.count() > 300 && wrong == 0, "{what}: {wrong} pixels");
            }
        }
    }
}

/// Pixels that the light meets at more than a grazing angle, and that shadows change all the same.
fn acne(unshaded: &Capture, shaded: &Capture) -> usize {
    let pairs = unshaded.frame.color.iter().zip(&shaded.frame.color);
    // A quarter of the light, gamma-encoded.
    pairs
        .filter(|(bare, lit)| bare[0] >= 137 && bare[0].abs_diff(lit[0]) > 1)
        .count()
}

fn a_ball_casts_no_shadow_on_its_lit_side(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = ball();
    let view = slanted(&scene, [160, 120]);
    for (azimuth, elevation) in reach.of(1, [(-70.0, 10.0), (40.0, 48.0), (0.0, 90.0)]) {
        let towards = [
            ("shadow", "azimuth_deg", azimuth),
            ("shadow", "elevation_deg", elevation),
        ];
        let bare = light_alone(&[&towards[..], &[("shadow", "strength", 0.0)]].concat());
        for &map in ShadowMapSize::ALL {
            for taps in reach.of(1, ShadowTaps::ALL.iter().rev().copied()) {
                let view = on(&view, map, taps);
                let [unshaded, shaded] = [&bare, &light_alone(&towards)]
                    .map(|stack| renderer.captured(&scene, &view, stack, &unpinned()));
                assert_eq!(
                    acne(&unshaded, &shaded),
                    0,
                    "{azimuth} {elevation} {map:?} {taps:?}"
                );
            }
        }
    }
    // The test can fail: surfaces behind their own depths are speckled.
    let drowned = light_alone(&[("shadow", "bias", -1.0)]);
    let [unshaded, shaded] = [light_alone(&[("shadow", "strength", 0.0)]), drowned]
        .map(|stack| renderer.captured(&scene, &view, &stack, &unpinned()));
    assert!(acne(&unshaded, &shaded) > 1000);
}

#[test]
fn a_light_that_looks_as_the_eye_does_sees_all_that_the_eye_sees() {
    let Some(mut renderer) = loan() else { return };
    let scene = ball();
    let towards = [
        ("shadow", "azimuth_deg", 30.0),
        ("shadow", "elevation_deg", 35.0),
    ];
    let toward = read::<Shadow>(&light_alone(&towards).0[0].words).toward();
    let camera = Camera {
        eye: toward * 4.0,
        projection: Projection::Orthographic { height_m: 2.4 },
        ..Camera::default()
    };
    let view = camera_view(&scene, &camera, [160, 120]);
    let [unshaded, shaded] = [
        light_alone(&[&towards[..], &[("shadow", "strength", 0.0)]].concat()),
        light_alone(&towards),
    ]
    .map(|stack| renderer.captured(&scene, &view, &stack, &unpinned()));
    assert_eq!(acne(&unshaded, &shaded), 0);
}

// -------- the oracle's twin

/// Scenes and stacks that take every path of a shadow: queues, clipped triangles, effects that move
/// or discard, layers, skins.
fn cases() -> Vec<(Arc<Scene>, Stack)> {
    let sweep = [
        ("explode", "pattern", 1.0),
        ("explode", "width", 1.0),
        ("explode", "front", 0.5),
    ];
    let front = [
        ("dissolve", "pattern", 1.0),
        ("dissolve", "width", 1.0),
        ("dissolve", "front", 0.5),
    ];
    vec![
        (boxed("knot?tess=8"), lit(&["shadow"], &[])),
        (
            boxed("cube-wall?columns=5&rows=4"),
            lit(
                &["shadow"],
                &[("shadow", "shading", 1.0), ("shadow", "strength", 0.7)],
            ),
        ),
        (
            boxed("teapot?tess=5"),
            lit(
                &["lambert", "shadow", "toon"],
                &[("shadow", "shading", 1.0)],
            ),
        ),
        (boxed("tentacle?tess=3"), lit(&["shadow"], &[])),
        (
            boxed("sphere?triangles=2000"),
            lit(&["wobble", "shadow"], &[]),
        ),
        (boxed("teapot?tess=4"), lit(&["explode", "shadow"], &sweep)),
        (boxed("teapot?tess=5"), lit(&["dissolve", "shadow"], &front)),
        (boxed("knot?tess=6"), lit(&["stipple", "shadow"], &[])),
        (boxed("leaves"), lit(&["shadow"], &[])),
        (boxed("knot?tess=6"), lit(&["shadow", "xray"], &[])),
        (
            boxed("knot?tess=6"),
            lit(&["shadow", "dither"], &[("dither", "levels", 5.0)]),
        ),
        (scene("near"), lit(&["shadow"], &[])),
        (scene("stack"), lit(&["shadow"], &[])),
        (scene("sizes"), lit(&["shadow"], &[])),
        (Arc::new(Scene::default()), lit(&["shadow"], &[])),
    ]
}

#[test]
fn every_size_of_map_and_filter_is_what_the_oracle_draws() {
    let Some(mut renderer) = loan() else { return };
    let scene = boxed("knot?tess=6");
    let quick = quick_option(&renderer);
    let mut tuning = renderer.gpu().caps.tuning();
    for (turn, &map) in ShadowMapSize::ALL.iter().enumerate() {
        let taps = ShadowTaps::ALL[turn % 3];
        let view = on(&view(&scene, [96, 72]), map, taps);
        let (capture, _) = renderer.exact(
            &scene,
            &view,
            &lit(&["shadow"], &[]),
            &pinned(quick),
            &format!("{map:?} {taps:?}"),
        );
        let keys = &capture
            .geometry
            .shadow_map
            .expect("there is a map")
            .depth_keys;
        assert_eq!(keys.len(), (map.side() * map.side()) as usize);
        // The map is read from the buffer in which it was drawn, or from a texture, its copy.
        if std::mem::replace(&mut tuning.buffered_shadow_map, false) {
            renderer.set_tuning(tuning);
            let copied = renderer.captured(&scene, &view, &lit(&["shadow"], &[]), &pinned(quick));
            assert_eq!(
                renderer.key().map(|key| key.work.buffered_shadow_map),
                Some(false)
            );
            assert_eq!(
                copied.frame.color, capture.frame.color,
                "{map:?} {taps:?} from a texture"
            );
            tuning.buffered_shadow_map = true;
            renderer.set_tuning(tuning);
        } else {
            eprintln!("this adapter binds too few storage buffers for a shadow map among them");
        }
    }
}

#[test]
fn the_light_may_stand_anywhere() {
    let Some(mut renderer) = loan() else { return };
    let scene = boxed("teapot?tess=4");
    let quick = quick_option(&renderer);
    let coarse = |scene: &Scene| {
        on(
            &view(scene, [96, 72]),
            ShadowMapSize::Side256,
            ShadowTaps::TwentyFive,
        )
    };
    for (azimuth, elevation) in [
        (0.0, 90.0),
        (77.0, -90.0),
        (0.0, 0.0),
        (90.0, 0.0),
        (-180.0, 89.9999),
        (35_999.0, -35.0),
    ] {
        let stack = lit(
            &["shadow"],
            &[
                ("shadow", "azimuth_deg", azimuth),
                ("shadow", "elevation_deg", elevation),
            ],
        );
        renderer.exact(
            &scene,
            &coarse(&scene),
            &stack,
            &pinned(quick),
            &format!("{azimuth} {elevation}"),
        );
    }
    for (bias, slope) in [(-64.0, 64.0), (64.0, -64.0), (0.0, 0.0)] {
        let stack = lit(
            &["shadow"],
            &[("shadow", "bias", bias), ("shadow", "slope", slope)],
        );
        let (_, verdict) = renderer.judged(&scene, &coarse(&scene), &stack, &pinned(quick));
        let a = &verdict.report;
        assert!(
            a.max_color_delta <= 1 && a.wrong_triangles + a.key_outside_bound == 0,
            "{bias} {slope}: {a:?}"
        );
    }
}

/// The light's view drawn as a picture: triangle ids to the sample, keys within their bound, and
/// the map has those keys.
fn the_map_is_the_picture_that_the_light_sees(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let cases = cases()
        .into_iter()
        .filter(|(scene, _)| scene.triangle_count() > 0);
    for (scene, stack) in reach.of(3, cases) {
        let view = on(
            &view(&scene, [64, 48]),
            ShadowMapSize::Side256,
            ShadowTaps::One,
        );
        let capture = renderer.captured(&scene, &view, &stack, &unpinned());
        let map = capture.geometry.shadow_map.expect("there is a map");
        let (light, casting) = (
            stack.light_view(&scene, &view).expect("there is a light"),
            stack.shadow_casters(),
        );
        let (seen, verdict) = renderer.judged(&scene, &light, &casting, &split32());
        // A map has depths and no triangle ids, and layers a quantum apart are all in the band.
        verdict
            .report
            .within(&Budget::default())
            .unwrap_or_else(|faults| panic!("{}: {faults}", scene.name));
        assert!(
            seen.frame.depth_key == map.depth_keys,
            "{}: the map has other depths",
            scene.name
        );
        assert_eq!(
            seen.geometry.vertices, map.geometry.vertices,
            "{}",
            scene.name
        );
        let own = oracle::shadow_map(&scene, &view, &stack)
            .expect("a scene that fits")
            .expect("there is a light");
        let differs = own
            .depth_keys
            .iter()
            .zip(&map.depth_keys)
            .filter(|(a, b)| (**a == 0) != (**b == 0))
            .count();
        assert!(
            differs * 200 <= own.depth_keys.len(),
            "{}: {differs} texels of {}",
            scene.name,
            own.depth_keys.len()
        );
    }
}

fn mistakes_in_the_light_are_found(reach: Reach) {
    let Some(usual) = loan() else { return };
    let gpu = usual.gpu().clone();
    drop(usual);
    let scene = boxed("knot?tess=6");
    let sweep = [
        ("explode", "pattern", 1.0),
        ("explode", "width", 1.0),
        ("explode", "front", 0.5),
    ];
    let (plain, parted) = (lit(&["shadow"], &[]), lit(&["explode", "shadow"], &sweep));
    for (from, to, stack) in reach.of(
        2,
        [
            (
                "texel.y * side + texel.x",
                "texel.x * side + texel.y",
                &plain,
            ),
            (
                "vec2i(first) + texel",
                "vec2i(first) + texel + vec2i(1, 0)",
                &plain,
            ),
            (
                "atomicMax(&depth_keys[pixel], key)",
                "atomicMin(&depth_keys[pixel], key)",
                &plain,
            ),
            (
                "picture_from_world * vec4f(center, 1.0)",
                "picture_from_world * vec4f(center.zyx, 1.0)",
                &parted,
            ),
        ],
    ) {
        if from == "texel.y * side + texel.x" && !gpu.caps.tuning().buffered_shadow_map {
            continue;
        }
        let mut renderer = Mistaken::new(&gpu, from, to);
        let view = on(
            &view(&scene, [120, 90]),
            ShadowMapSize::Side512,
            ShadowTaps::Nine,
        );
        let option = if options(&renderer).contains(&Visibility::Packed64) {
            Visibility::Packed64
        } else {
            Visibility::Split32
        };
        let (_, verdict) = renderer.judged(&scene, &view, stack, &pinned(option));
        assert!(
            exactness(&verdict.report).is_err(),
            "{from:?} as {to:?} passes: {:?}",
            verdict.report
        );
    }
}

few_and_all!(
    the_map_is_the_picture_that_the_light_sees,
    a_plate_throws_its_shadow_where_geometry_says_to_a_texel,
    mistakes_in_the_light_are_found,
    a_ball_casts_no_shadow_on_its_lit_side,
);
