//! Promise: what culling leaves out is never seen: triangle ids and keys are those of a picture
//! that leaves nothing out, from everywhere, on every option, picture after picture. Needs an
//! adapter.

use std::sync::{Arc, Mutex, OnceLock};

use glam::{DMat4, DVec3};
use pollster::FutureExt as _;
use rasterlab::{
    accuracy::{Culling, PinnedOptions, PositionFormat, Visibility},
    frame::{CullingStats, Frame},
    gpu::{Capture, Renderer},
    measure::compare,
    plan::Tuning,
    scene::{
        Scene,
        camera::{Camera, Projection},
        view::View,
    },
};
use rasterlab_fuzz::stress::culling::walk;

use crate::common::*;

mod changes;

const SIZE: [u32; 2] = [128, 96];

/// The next picture, and what was left out of it.
fn drawn(renderer: &mut Renderer, view: &View, pins: PinnedOptions) -> (Capture, CullingStats) {
    let capture = renderer
        .capture_next(view, &stack(&["lambert"]), &request(pins))
        .block_on()
        .unwrap_or_else(|error| panic!("{}: {error}", pins.words()));
    (capture, renderer.culled().unwrap_or_default())
}

/// Scenes of every kind: closed and open, one and many, clipped, mirrored, double-sided, deformed.
fn scenes() -> Vec<(String, Arc<Scene>)> {
    let queries = [
        "field?count=64&triangles=600",
        "near",
        "cube-wall",
        "teapot?tess=6",
        "tentacle?tess=3&instances=12",
        "sizes",
        "slivers",
    ];
    let mut scenes: Vec<(String, Arc<Scene>)> = queries
        .iter()
        .map(|query| ((*query).to_owned(), scene(query)))
        .collect();
    let mut mirrored = (*scene("field?count=27&triangles=400")).clone();
    for (i, instance) in mirrored.instances.iter_mut().enumerate() {
        instance.world_from_object *= DMat4::from_scale(DVec3::new(
            if i % 2 == 0 { -1.0 } else { 1.0 },
            1.0,
            [1.0, 0.1, 2.0][i % 3],
        ));
    }
    mirrored.materials[1].double_sided = true;
    scenes.push(("mirrored".into(), Arc::new(mirrored)));
    scenes.push(("grown".into(), grown()));
    scenes
}

/// As a CPU adapter likes it, and as a graphics card.
fn both_tunings(renderer: &Renderer) -> [Tuning; 2] {
    let card = Tuning {
        exchanges_maximum: false,
        ..GRAPHICS_CARD
    };
    [renderer.gpu().caps.tuning(), card]
}

/// Follows a walk with two-pass culling, what each picture leaves for the next included; the first
/// difference, and what was left out in all.
fn followed(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    views: &[View],
    pins: PinnedOptions,
) -> Result<CullingStats, String> {
    renderer.set_scene(scene).block_on().expect("it fits");
    let mut total = CullingStats::default();
    for (step, view) in views.iter().enumerate() {
        let (culled, stats) = drawn(renderer, view, pins);
        let whole = whole(renderer, scene, view, pins);
        let triangle_ids = compare::triangle_ids(&culled.frame.triangle_id, &whole.triangle_id);
        let keys = compare::triangle_ids(&culled.frame.depth_key, &whole.depth_key);
        if triangle_ids.different + keys.different > 0 {
            let (what, pixel) = (pins.words(), triangle_ids.mismatches.first());
            return Err(format!(
                "step {step} on {what}: {} triangle ids and {} keys differ, {pixel:?}",
                triangle_ids.different, keys.different
            ));
        }
        for (sum, count) in [
            (&mut total.drawn, stats.drawn),
            (&mut total.outside, stats.outside),
            (&mut total.backfacing, stats.backfacing),
            (&mut total.hidden, stats.hidden),
        ] {
            *sum += count;
        }
    }
    Ok(total)
}

/// The same picture with nothing left out, by a renderer that shares nothing with the one under
/// test.
fn whole(renderer: &Renderer, scene: &Arc<Scene>, view: &View, pins: PinnedOptions) -> Frame {
    static WHOLE: OnceLock<Mutex<Renderer>> = OnceLock::new();
    let whole = WHOLE.get_or_init(|| Mutex::new(Renderer::new(renderer.gpu().clone())));
    let mut whole = whole
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    whole
        .captured(
            scene,
            view,
            &stack(&["lambert"]),
            &request(pins.with(Culling::None)),
        )
        .frame
}

/// AccuracyOptions that two passes can hide behind.
fn hiding(renderer: &Renderer) -> Vec<PinnedOptions> {
    options(renderer)
        .into_iter()
        .map(|option| PinnedOptions::of(option).with(Culling::TwoPass))
        .collect()
}

fn two_passes_lose_nothing_on_any_walk(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let mut rng = Rng(11);
    for (what, scene) in scenes().into_iter().filter(|(what, _)| {
        ["field?count=64&triangles=600", "near", "mirrored", "grown"].contains(&&**what)
    }) {
        for (i, pins) in reach.of(1, hiding(&renderer)).into_iter().enumerate() {
            let tuning = both_tunings(&renderer)[i % 2];
            renderer.set_tuning(tuning);
            let views = walk(&scene, &mut rng, 8, SIZE);
            let total = followed(&mut renderer, &scene, &views, pins)
                .unwrap_or_else(|why| panic!("{what}: {why}"));
            assert!(
                !what.starts_with("field") || total.hidden > 0,
                "{what}: nothing is hidden: {total:?}"
            );
        }
    }
}

fn another_scene_another_size_and_a_pause_leave_nothing_stale(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let mut rng = Rng(5);
    let scenes = [
        scene("field?count=64&triangles=400"),
        scene("cube-wall"),
        scene("field?count=27&triangles=200&seed=3"),
    ];
    for turn in 0..9 {
        let scene = &scenes[turn % 3];
        let size = [[160, 120], [65, 63], [1, 1], [200, 8]][turn % 4];
        let views = walk(scene, &mut rng, 2, size);
        for pins in reach.of(1, hiding(&renderer)) {
            followed(&mut renderer, scene, &views, pins)
                .unwrap_or_else(|why| panic!("turn {turn}: {why}"));
            drawn(&mut renderer, &views[0], pins.with(Culling::Frustum));
            followed(&mut renderer, scene, &views, pins)
                .unwrap_or_else(|why| panic!("turn {turn}, after a pause: {why}"));
        }
    }
}

/// A sheet of triangles that all face away, so far edge-on that they are about a unit of the grid
/// high: the snap turns some of them over, and those show.
fn dust() -> (Arc<Scene>, Vec<View>) {
    const SIDES: [u32; 2] = [400, 200];
    let place = |x: u32, z: u32| [x as f32 * 0.01 - 2.0, 0.0, z as f32 * 0.01 - 1.0];
    let at = |x: u32, z: u32| z * (SIDES[0] + 1) + x;
    let quad = |i: u32| {
        let (x, z) = (i % SIDES[0], i / SIDES[0]);
        [
            at(x, z),
            at(x + 1, z),
            at(x, z + 1),
            at(x, z + 1),
            at(x + 1, z),
            at(x + 1, z + 1),
        ]
    };
    let scene = scene_of_meshes(&[SimpleMesh {
        positions: (0..=SIDES[1])
            .flat_map(|z| (0..=SIDES[0]).map(move |x| place(x, z)))
            .collect(),
        indices: (0..SIDES[0] * SIDES[1]).flat_map(quad).collect(),
        double_sided: false,
        ..SimpleMesh::default()
    }]);
    let bounds = scene.bounds();
    let view = |i: u32| {
        let eye = DVec3::new(0.1 * f64::from(i), 0.12 + 0.02 * f64::from(i), 8.0);
        let projection = Projection::Perspective { fov_y_deg: 60.0 };
        let camera = Camera {
            eye,
            target: DVec3::ZERO,
            up: DVec3::new(0.3, 1.0, 0.0),
            projection,
            near_m: 0.01,
        };
        View::new(
            &camera,
            SIZE[0],
            SIZE[1],
            &bounds,
            DMat4::IDENTITY,
            [0.0; 4],
        )
    };
    (scene.clone(), (0..6).map(view).collect())
}

/// Spheres that reach into each other.
fn grown() -> Arc<Scene> {
    let mut scene = (*scene("field?count=64&triangles=600")).clone();
    scene
        .instances
        .iter_mut()
        .for_each(|instance| instance.world_from_object *= DMat4::from_scale(DVec3::splat(1.9)));
    Arc::new(scene)
}

#[test]
fn backs_that_the_snap_turns_over_are_not_left_out() {
    let Some(mut renderer) = loan() else { return };
    let (scene, views) = dust();
    let shown: usize = views
        .iter()
        .map(|view| {
            whole(
                &renderer,
                &scene,
                view,
                PinnedOptions::of(Visibility::Split32),
            )
            .covered()
        })
        .sum();
    assert!(shown > 0, "the snap turns nothing over");
    for pins in [Culling::Frustum, Culling::TwoPass]
        .map(|option| PinnedOptions::of(option).with(Visibility::Split32))
    {
        followed(&mut renderer, &scene, &views, pins).unwrap_or_else(|why| panic!("{why}"));
    }
}

fn mistakes_of_culling_are_seen(reach: Reach) {
    let Some(healthy) = loan() else { return };
    let gpu = healthy.gpu().clone();
    drop(healthy);
    let split = |option: Culling| PinnedOptions::of(option).with(Visibility::Split32);
    let field = scene("field?count=64&triangles=600");
    let through = walk(&field, &mut Rng(11), 8, SIZE);
    let mut failures = Vec::new();
    let mistakes = [
        (
            "cones are too narrow",
            "let across = sqrt(",
            "let across = 0.3 * sqrt(",
            Culling::Frustum,
            &field,
            &through,
        ),
        (
            "nearest and farthest are exchanged",
            "key = min(key,",
            "key = max(select(key, 0u, key == 0xffffffffu),",
            Culling::TwoPass,
            &field,
            &through,
        ),
        (
            "the rectangle is upside down",
            "vec2f(low.x, -high.y)",
            "vec2f(low.x, low.y)",
            Culling::TwoPass,
            &field,
            &through,
        ),
        (
            "the second round draws nothing",
            "select(CULL_VISIBLE, CULL_HIDDEN, is_hidden), CULL_OTHER_PHASE",
            "select(CULL_HIDDEN, CULL_HIDDEN, is_hidden), CULL_OTHER_PHASE",
            Culling::TwoPass,
            &field,
            &through,
        ),
        (
            "a vertex of every meshlet is not projected",
            "i < meshlet.vertices;",
            "i + 1u < meshlet.vertices;",
            Culling::Frustum,
            &field,
            &through,
        ),
        (
            "the triangle id pass takes the second round alone",
            "select(count, 0u, REOPENS_QUEUES)",
            "select(count, count, REOPENS_QUEUES)",
            Culling::TwoPass,
            &field,
            &through,
        ),
    ];
    for (what, from, to, option, scene, views) in reach.of(2, mistakes) {
        let mut wrong = Mistaken::new(&gpu, from, to);
        match followed(&mut wrong, scene, views, split(option)) {
            Ok(_) => failures.push(format!("{what} does not show")),
            Err(why) => eprintln!("{what}: {why}"),
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn more_meshlets_than_one_row_of_workgroups_are_all_drawn(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    const SIDE: u32 = 257;
    // One triangle over one sample, 66,049 times: as many meshlets, and more than 65,535
    // workgroups.
    let corner = |x: f32, y: f32| [x / 4.0, y / 4.0, 0.5];
    let transforms = (0..SIDE * SIDE)
        .map(|i| DMat4::from_translation(DVec3::new((i % SIDE).into(), (i / SIDE).into(), 0.0)));
    let positions = vec![corner(1.0, 1.0), corner(1.0, 3.0), corner(3.0, 2.0)];
    let scene = scene_of_meshes(&[SimpleMesh {
        transforms: transforms.collect(),
        ..triangle_soup(positions)
    }]);
    let usual = renderer.gpu().caps.tuning();
    renderer.set_tuning(Tuning {
        group_size: 64,
        ..usual
    });
    renderer.set_scene(&scene).block_on().expect("it fits");
    let view = pixel_view(260, 260);
    for option in reach.of(1, [Culling::TwoPass, Culling::Frustum]) {
        for visibility in reach.options(&renderer) {
            let (culled, stats) = drawn(
                &mut renderer,
                &view,
                PinnedOptions::of(option).with(visibility),
            );
            assert_eq!(
                (culled.frame.covered() as u32, stats.drawn),
                (SIDE * SIDE, SIDE * SIDE),
                "{}",
                visibility.name()
            );
            let triangle_ids = culled
                .frame
                .triangle_id
                .iter()
                .filter(|triangle_id| **triangle_id != rasterlab::frame::NO_TRIANGLE);
            assert!(
                triangle_ids
                    .zip(0..)
                    .all(|(&triangle_id, id)| triangle_id == id),
                "{}: a triangle id is another's",
                visibility.name()
            );
        }
    }
}

/// Passes, buffers and the reason for culling, as a new renderer explains one picture.
fn explained(
    query: &str,
    effects: &[&str],
    pins: PinnedOptions,
) -> Option<(Vec<String>, Vec<String>, String)> {
    let mut renderer = Renderer::new(gpu()?);
    let scene = scene(query);
    renderer
        .set_scene(&scene)
        .block_on()
        .expect("a builtin fits");
    renderer
        .draw_complete(&view(&scene, SIZE), &stack(effects), &request(pins))
        .block_on()
        .expect("a builtin is drawn");
    let explanation = renderer.explain();
    let passes = explanation
        .passes
        .into_iter()
        .map(|pass| pass.name)
        .collect();
    let buffers = explanation
        .buffers
        .into_iter()
        .map(|buffer| buffer.name)
        .collect();
    let why = explanation
        .reasons
        .into_iter()
        .find(|note| note.name == "culling")
        .map(|note| note.why)
        .unwrap_or_default();
    Some((passes, buffers, why))
}

#[test]
fn what_lies_outside_the_picture_is_not_deformed() {
    let scene = scene("tentacle?tess=1&instances=60");
    let bounds = scene.bounds();
    let middle = bounds.center();
    let camera = Camera {
        eye: middle,
        target: middle + DVec3::new(1.0, 0.1, 0.3),
        near_m: 0.02,
        ..Camera::default()
    };
    let view = View::new(
        &camera,
        SIZE[0],
        SIZE[1],
        &bounds,
        DMat4::IDENTITY,
        [0.0; 4],
    );
    let drawn = [Culling::None, Culling::Frustum].map(|option| {
        let mut renderer = Renderer::new(gpu()?);
        renderer.set_scene(&scene).block_on().expect("it fits");
        renderer
            .draw_complete(&view, &stack(&["lambert"]), &pin(option))
            .block_on()
            .expect("it is drawn");
        let buffers = renderer.explain().buffers;
        let capture = renderer.captured(&scene, &view, &stack(&["lambert"]), &pin(option));
        Some((
            capture.frame,
            buffers
                .into_iter()
                .find(|buffer| buffer.name == "joints")
                .map_or(0, |buffer| buffer.bytes),
        ))
    });
    let [Some((whole, all)), Some((culled, some))] = drawn else {
        return;
    };
    assert_same(&culled, &whole, "from the middle");
    assert!(
        0 < some && 2 * some < all && whole.covered() > 0,
        "{some} of {all} bytes of joints"
    );
}

#[test]
fn what_lies_far_from_its_origin_is_culled_about_the_eye() {
    let Some(mut renderer) = loan() else { return };
    const FAR: DVec3 = DVec3::new(3e5, -2e5, 1e5);
    let mut scene = (*scene("sphere?triangles=3000")).clone();
    // The mesh itself lies there, in whole sixteenths.
    let count = 3 * scene.primitives[0].vertex_count() as usize;
    let at = scene.primitives[0].positions.offset as usize;
    for (lane, bytes) in scene.vertex_bytes[at..at + 4 * count]
        .as_chunks_mut::<4>()
        .0
        .iter_mut()
        .enumerate()
    {
        *bytes = (f32::from_le_bytes(*bytes) * 8.0 + FAR[lane % 3] as f32).to_le_bytes();
    }
    let bounds = &mut scene.primitives[0].bounds;
    (bounds.min, bounds.max) = (bounds.min * 8.0 + FAR - 1.0, bounds.max * 8.0 + FAR + 1.0);
    scene.primitives[0].longest_edge *= 9.0;
    let scene = Arc::new(scene);
    let views = (0..3).map(|i| {
        let eye = FAR + DVec3::new(2.0 + f64::from(i), 0.5, 11.0 - f64::from(i));
        let camera = Camera {
            eye,
            target: FAR + DVec3::new(2.0, 1.0, 0.0),
            near_m: 0.1,
            ..Camera::default()
        };
        View::new(
            &camera,
            SIZE[0],
            SIZE[1],
            &scene.bounds(),
            DMat4::IDENTITY,
            [0.0; 4],
        )
    });
    let views: Vec<View> = views.collect();
    for places in [PositionFormat::Stored, PositionFormat::Relative] {
        let pins = PinnedOptions::of(places)
            .with(Culling::TwoPass)
            .with(Visibility::Split32);
        let total = followed(&mut renderer, &scene, &views, pins)
            .unwrap_or_else(|why| panic!("{}: {why}", places.name()));
        assert!(
            total.outside + total.backfacing > 0 || places == PositionFormat::Stored,
            "{}: {total:?}",
            places.name()
        );
    }
}

few_and_all!(
    mistakes_of_culling_are_seen,
    another_scene_another_size_and_a_pause_leave_nothing_stale,
    two_passes_lose_nothing_on_any_walk,
    more_meshlets_than_one_row_of_workgroups_are_all_drawn,
);
