//! Promise: the GPU is within each stated tolerance of the oracle, and a kernel with any of the
//! classic mistakes is not. Needs an adapter.

use std::sync::Arc;

use glam::{DMat4, DVec3};
use pollster::FutureExt as _;
use rasterlab::{
    accuracy::Visibility,
    gpu::{
        Renderer,
        naive::{Naive, Viewport},
    },
    measure::{ErrorReport as Errors, Verdict, error_map::PixelError},
    plan::Tuning,
    scene::{
        Scene,
        camera::{Camera, Projection},
        view::View,
    },
};

use crate::common::*;

/// Scenes with the camera given: what each is for, the scene, and the view.
fn viewpoints() -> Vec<(String, Arc<Scene>, View)> {
    const SIZE: [u32; 2] = [200, 150];
    let mut cases: Vec<(String, Arc<Scene>, View)> = Vec::new();
    let mut add = |what: &str, scene: &Arc<Scene>, camera: &Camera| {
        cases.push((what.into(), scene.clone(), camera_view(scene, camera, SIZE)))
    };
    let double_sided = |query: &str| {
        let mut scene = Scene::clone(&scene(query));
        scene
            .materials
            .iter_mut()
            .for_each(|material| material.double_sided = true);
        Arc::new(scene)
    };

    let shell = double_sided("sphere?triangles=3000");
    add(
        "inside the mesh",
        &shell,
        &Camera {
            eye: DVec3::new(0.2, -0.1, 0.3),
            target: DVec3::X,
            ..Camera::default()
        },
    );
    let close = Camera {
        eye: DVec3::new(0.0, 0.0, 0.97),
        target: DVec3::new(0.3, 0.2, 0.9),
        near_m: 1e-4,
        ..Camera::default()
    };
    add("in the mesh's skin", &shell, &close);

    let (teapot, knot) = (scene("teapot?tess=5"), scene("knot?tess=6"));
    let flat = Camera {
        projection: Projection::Orthographic { height_m: 2.4 },
        ..Camera::default()
    };
    add("orthographic", &teapot, &flat);
    add(
        "orthographic from above",
        &knot,
        &Camera {
            eye: DVec3::Y * 5.0,
            up: DVec3::NEG_Z,
            ..flat
        },
    );
    add(
        "orthographic, eye inside",
        &knot,
        &Camera {
            eye: DVec3::Z * 0.1,
            ..flat
        },
    );
    let wide = Camera {
        projection: Projection::Perspective { fov_y_deg: 150.0 },
        ..Camera::default()
    };
    add(
        "fisheye",
        &teapot,
        &Camera {
            eye: DVec3::new(0.3, 0.6, 1.2),
            ..wide
        },
    );
    add(
        "telescope",
        &knot,
        &Camera {
            eye: DVec3::Z * 400.0,
            projection: Projection::Perspective { fov_y_deg: 0.3 },
            ..wide
        },
    );
    add(
        "looking away",
        &knot,
        &Camera {
            eye: DVec3::Z * 4.0,
            target: DVec3::Z * 8.0,
            ..Camera::default()
        },
    );

    for query in ["grid?cell=3&width=200&height=150", "near", "stack", "fan"] {
        let scene = scene(query);
        for camera in &scene.cameras {
            add(
                &format!("{query}, its camera {:?}", camera.name),
                &scene,
                &camera.pose,
            );
        }
    }

    // Far from the origin: as a placement, which the matrices take care of, and in the vertices
    // themselves.
    let offset = DVec3::new(1e4, -2e4, 1e4);
    let far = Camera {
        eye: offset + DVec3::new(1.0, 1.0, 4.0),
        target: offset,
        ..Camera::default()
    };
    let mut placed = Scene::clone(&knot);
    placed.instances[0].world_from_object = DMat4::from_translation(offset);
    add("placed far away", &Arc::new(placed.clone()), &far);
    placed.instances[0].world_from_object *= DMat4::from_scale(DVec3::new(-1.0, 1.5, 0.5));
    add("mirrored far away", &Arc::new(placed), &far);
    add("modelled far away", &Arc::new(moved(&knot, offset)), &far);
    let tall = Camera {
        projection: Projection::Orthographic { height_m: 3.0 },
        ..far
    };
    add(
        "modelled far away, orthographic",
        &Arc::new(moved(&knot, offset)),
        &tall,
    );
    cases
}

/// The scene with an offset in the positions of its vertices.
fn moved(scene: &Scene, offset: DVec3) -> Scene {
    let mut scene = scene.clone();
    let positions = scene.primitives[0].positions;
    for vertex in 0..positions.count {
        let p = scene.primitives[0].position(&scene, vertex);
        for (lane, (p, offset)) in p.into_iter().zip(offset.to_array()).enumerate() {
            let at = (positions.offset + vertex * positions.stride) as usize + 4 * lane;
            scene.vertex_bytes[at..at + 4]
                .copy_from_slice(&((f64::from(p) + offset) as f32).to_le_bytes());
        }
    }
    let bounds = &mut scene.primitives[0].bounds;
    (bounds.min, bounds.max) = (bounds.min + offset - 0.01, bounds.max + offset + 0.01);
    scene.primitives[0].longest_edge += 0.01;
    scene
}

fn every_viewpoint_is_within_tolerance(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let (options, stack) = (
        reach.options(&renderer),
        stack(&["facet", "depth", "lambert"]),
    );
    for (turn, (what, scene, view)) in viewpoints().into_iter().enumerate() {
        let option = options[turn % options.len()];
        let (capture, verdict) = renderer.exact(
            &scene,
            &view,
            &stack,
            &pinned(option),
            &format!("{what}, {}", option.name()),
        );
        match what.as_str() {
            "inside the mesh" | "in the mesh's skin" => {
                assert_eq!(capture.frame.covered(), view.pixels(), "{what}")
            }
            "looking away" => assert_eq!(capture.frame.covered(), 0, "{what}"),
            _ => assert!(
                capture.frame.covered() > 500,
                "{what}: {} pixels",
                capture.frame.covered()
            ),
        }
        if what == "placed far away" {
            assert!(
                verdict.report.max_snap_delta <= 1,
                "{what}: camera and placement meet in f64"
            );
        }
    }
}

// -------- dense grids

#[test]
fn the_beginners_kernel_leaves_thousands_of_holes_in_dense_grids() {
    let Some(mut renderer) = loan() else { return };
    for (query, naive_holes) in [
        ("grid?cell=1", 5_000..40_000),
        ("grid?cell=0.4", 65_000..65_537),
    ] {
        let scene = scene(query);
        for camera in scene.cameras.iter().map(|camera| camera.pose) {
            let view = camera_view(&scene, &camera, [256, 256]);
            renderer.captured(&scene, &view, &stack(&[]), &unpinned());
            let key = renderer.key().expect("something was drawn").clone();
            let gpu = renderer.gpu().clone();
            let naive = Naive::new(&gpu, &scene, &view, &key, Viewport::Folded)
                .block_on()
                .and_then(|naive| naive.picture(&gpu).block_on());
            let picture = naive.unwrap_or_else(|error| panic!("{query}: {error}"));
            let holes = picture.iter().filter(|pixel| pixel[3] == 0).count();
            eprintln!("{query}: the naive kernel leaves {holes} holes in 65,536 samples");
            assert!(
                naive_holes.contains(&holes),
                "{query}: {holes} holes of the naive kernel"
            );
        }
    }
}

// -------- mutants of the kernels

/// A kernel with one mistake, and a picture that must give it away.
struct Mutant {
    what: &'static str,
    from: &'static str,
    to: &'static str,
    scene: Arc<Scene>,
    view: View,
    option: Visibility,
    /// Which number of the report shows it.
    shown_by: (&'static str, fn(&Errors) -> u64),
}

const HOLES: (&str, fn(&Errors) -> u64) = ("holes", |e| e.holes);
const DOUBLES: (&str, fn(&Errors) -> u64) = ("double hits", |e| e.double_hits);
const TRIANGLE_IDS: (&str, fn(&Errors) -> u64) = ("wrong triangle ids", |e| e.wrong_triangles);
const COLORS: (&str, fn(&Errors) -> u64) = ("colors", |e| u64::from(e.max_color_delta > 1));
const KEYS: (&str, fn(&Errors) -> u64) = ("depth keys", |e| e.key_outside_bound);
const SNAPS: (&str, fn(&Errors) -> u64) = ("snapped vertices", |e| e.snap_outside_bound);
const CLIPS: (&str, fn(&Errors) -> u64) = ("clipped triangles", |e| e.clips_wrong);

fn mutants() -> Vec<Mutant> {
    let builtin = |query: &str, size: [u32; 2]| {
        let scene = scene(query);
        let view = view(&scene, size);
        (scene, view)
    };
    // Samples on edges and on vertices.
    let ties = || builtin("grid?cell=4&lattice=2&width=64&height=64", [64, 64]);
    let sizes = || builtin("sizes", [256, 256]);
    let hall = || builtin("near", [160, 120]);
    // A ground from 1 m to 41 m, dark at one end.
    let receding = || {
        let (near, far) = (-1.0f32, -41.0);
        let [a, b, c, d] = [
            [-3.0, -0.6, near],
            [3.0, -0.6, near],
            [3.0, -0.6, far],
            [-3.0, -0.6, far],
        ];
        let (dark, light) = ([0.0, 0.0, 0.0, 1.0], [1.0, 1.0, 1.0, 1.0]);
        let part = SimpleMesh {
            positions: vec![a, b, c, a, c, d],
            normals: vec![[0.0, 1.0, 0.0]; 6],
            colors: vec![dark, dark, light, dark, light, light],
            ..SimpleMesh::default()
        };
        let scene = scene_of_meshes(&[part]);
        let camera = Camera {
            eye: DVec3::ZERO,
            target: DVec3::NEG_Z,
            projection: Projection::Perspective { fov_y_deg: 90.0 },
            ..Camera::default()
        };
        let view = camera_view(&scene, &camera, [128, 96]);
        (scene, view)
    };
    // Its upper edge spans the guard band, so edge functions in the picture pass 2^39.
    let vast = || {
        (
            scene_of_meshes(&[triangle_soup_in_units(&[(
                [[-8_388_607, 10], [8_388_607, 10], [0, 8_388_607]],
                0.5,
            )])]),
            pixel_view(256, 256),
        )
    };
    let mutant = |what, from, to, (scene, view): (Arc<Scene>, View), shown_by| Mutant {
        what,
        from,
        to,
        scene,
        view,
        option: Visibility::Split32,
        shown_by,
    };
    // Edges that pass samples at a doubled area of 1.
    let close = || {
        let mut rng = Rng(1);
        let triangles: Vec<_> = (0..400)
            .map(|i| {
                (
                    near_miss_triangle(&mut rng, 128 * 256, [64, 64]),
                    0.1 + 0.002 * i as f32,
                )
            })
            .collect();
        (
            scene_of_meshes(&[triangle_soup_in_units(&triangles)]),
            pixel_view(64, 64),
        )
    };
    vec![
        mutant(
            "bias 0 everywhere",
            "return select(1, 0, d.y < 0 || (d.y == 0 && d.x > 0));",
            "return 0;",
            ties(),
            DOUBLES,
        ),
        mutant(
            "float edges",
            "coverage.row = dx * from_y - dy * from_x - bias;",
            "coverage.row = vec3i(vec3f(dx) * vec3f(from_y)) - vec3i(vec3f(dy) * vec3f(from_x)) - bias;",
            close(),
            TRIANGLE_IDS,
        ),
        mutant(
            "sample at the pixel corner of large triangles",
            "* 16);\n    let edge",
            "* 16) - 128;\n    let edge",
            sizes(),
            TRIANGLE_IDS,
        ),
        mutant(
            "affine weights",
            "let terms = select(e * inv_w, e, IS_AFFINE);",
            "let terms = e;",
            receding(),
            COLORS,
        ),
        mutant(
            "the larger id wins ties",
            "atomicMax(&triangle_ids[pixel], ~id);",
            "loop {
                let held = atomicLoad(&triangle_ids[pixel]);
                if held != 0u && held <= ~id { break; }
                if atomicCompareExchangeWeak(&triangle_ids[pixel], held, ~id).exchanged { break; }
            }",
            builtin("stack?layers=5", [128, 128]),
            TRIANGLE_IDS,
        ),
        mutant(
            "half of a tile is skipped",
            "for (var half = 0u;",
            "for (var half = 1u;",
            sizes(),
            HOLES,
        ),
        mutant(
            "saturation at 2^31",
            "const BLOCK_SATURATED = 1073741824;",
            "const BLOCK_SATURATED = 2147483647;",
            vast(),
            HOLES,
        ),
        mutant(
            "one pixel to the right",
            "return vec2i(center) +",
            "return vec2i(256, 0) + vec2i(center) +",
            ties(),
            SNAPS,
        ),
        mutant(
            "depth of another corner",
            "weights.z * plane.depth.z;",
            "weights.z * plane.depth.y;",
            builtin("sphere?triangles=200", [128, 128]),
            KEYS,
        ),
        mutant(
            "a piece of what was clipped is turned over",
            "emit_triangle(t, records[0], records[i], records[i + 1u],",
            "emit_triangle(t, records[0], records[select(i, i + 1u, i == 2u)], records[select(i + 1u, i, i == 2u)],",
            hall(),
            CLIPS,
        ),
        mutant(
            "a triangle hides itself in the blocks that it covers",
            "return range.y < farthest;",
            "return is_whole;",
            sizes(),
            TRIANGLE_IDS,
        ),
        mutant(
            "a medium triangle stops a block early",
            "var x = first.x; x <= pixels.z; x += 8",
            "var x = first.x; x + 8 <= pixels.z; x += 8",
            builtin("sphere?triangles=200", [128, 128]),
            HOLES,
        ),
        mutant(
            "a tile of a large triangle is given up too soon",
            "fixed_edge(a, b, innermost)) < fixed_bias(d)",
            "fixed_edge(a, b, innermost)) < 1 + fixed_bias(d)",
            sizes(),
            HOLES,
        ),
        mutant(
            "a tile is forgotten",
            "let tiles = pixels.zw / 64 - first + 1;",
            "let tiles = max(pixels.zw / 64 - first, vec2i(1));",
            sizes(),
            HOLES,
        ),
    ]
}

/// As on a graphics card, so that every kernel runs.
const GRAPHICS_CARD: Tuning = Tuning {
    max_small_samples: 64,
    max_small_side: 32,
    group_size: 256,
    listed_tiles: false,
    early_load: true,
    exchanges_maximum: false,
    queue_groups: 0,
    dot_groups: 1024,
    interleaves_triangles: false,
    clears_in_passes: false,
    hides_blocks: true,
    stored_uniforms: false,
    wide_loads: false,
    buffered_shadow_map: false,
    glass_layers: rasterlab::plan::MOST_GLASS_LAYERS,
    specialized: true,
};

/// The map of faults shows what the counts count: as many wrong triangle ids, holes and doubles
/// just where there are any, and the largest difference of color.
fn map_agrees(verdict: &Verdict) -> Result<(), String> {
    let (a, map) = (&verdict.report, &verdict.error_map);
    let triangle_ids = map.count(PixelError::WrongTriangle) == a.wrong_triangles
        && map.count(PixelError::WrongDepthOrder) == a.wrong_nearest;
    let coverage = (map.count(PixelError::Hole) > 0) == (a.holes > 0)
        && (map.count(PixelError::DoubleHit) > 0) == (a.double_hits > 0);
    let ties = map.count(PixelError::DepthBand) == a.depth_band_pixels;
    let colors = map.color_delta.iter().max().copied().unwrap_or(0) >= a.max_color_delta;
    let marks = PixelError::ALL.map(|fault| map.count(fault));
    if triangle_ids && coverage && ties && colors {
        Ok(())
    } else {
        Err(format!("the map has {marks:?} and the counts say {a:?}"))
    }
}

fn kernels_with_a_mistake_are_caught(reach: Reach) {
    let Some(mut healthy) = loan() else { return };
    healthy.set_tuning(GRAPHICS_CARD);
    let mut failures = Vec::new();
    for mutant in reach.of(4, mutants()) {
        let Mutant {
            what,
            scene,
            view,
            option,
            shown_by: (figure, shown_by),
            ..
        } = &mutant;
        healthy.exact(
            scene,
            view,
            &stack(&[]),
            &pinned(*option),
            &format!("without the mistake: {what}"),
        );

        let library = mutated(mutant.from, mutant.to);
        let mut wrong = Renderer::with_library(healthy.gpu().clone(), library.shaders());
        wrong.set_tuning(GRAPHICS_CARD);
        let (_, verdict) = wrong.judged(scene, view, &stack(&[]), &pinned(*option));
        eprintln!(
            "{what}: {}",
            exactness(&verdict.report).err().unwrap_or_default()
        );
        if exactness(&verdict.report).is_ok() || shown_by(&verdict.report) == 0 {
            failures.push(format!(
                "{what} does not show in {figure}: {:?}",
                verdict.report
            ));
        }
        if let Err(sentence) = map_agrees(&verdict) {
            failures.push(format!("{what}: {sentence}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

few_and_all!(
    every_viewpoint_is_within_tolerance,
    kernels_with_a_mistake_are_caught,
);
