//! What scenes cover after their vertices are snapped: once, in layers, without folds, computed in
//! i64.

use glam::{DMat4, DVec3};
use rasterlab::{
    math::{UNITS_PER_PIXEL, rounded_columns},
    scene::{Scene, camera::Projection, view::View},
};

use super::{position, scene, triangles};

/// What a camera of the scene sees.
fn view(scene: &Scene, camera: usize, width: u32, height: u32) -> View {
    let pose = &scene.cameras[camera].pose;
    View::new(
        pose,
        width,
        height,
        &scene.bounds(),
        DMat4::IDENTITY,
        [0.0; 4],
    )
}

/// Corners of every triangle in 1/256 px, y down, through the scene's first camera in f32 as the
/// vertex stage computes them.
fn snapped(scene: &Scene, width: u32, height: u32) -> Vec<[[i64; 2]; 3]> {
    let view = view(scene, 0, width, height);
    assert_eq!(scene.instances.len(), 1);
    let primitive = &scene.primitives[0];
    let m = rounded_columns(&view.clip_from_world);
    let vertices: Vec<[i64; 2]> = (0..primitive.vertex_count())
        .map(|v| {
            let p = primitive.position(scene, v);
            let clip =
                |row: usize| ((m[0][row] * p[0] + m[1][row] * p[1]) + m[2][row] * p[2]) + m[3][row];
            let units = |value: f32, pixels: u32| {
                (value / clip(3) * (128 * pixels) as f32).round_ties_even() as i64
            };
            [
                128 * i64::from(width) + units(clip(0), width),
                128 * i64::from(height) - units(clip(1), height),
            ]
        })
        .collect();
    triangles(scene, primitive)
        .map(|corners| corners.map(|c| vertices[c as usize]))
        .collect()
}

/// Twice the oriented area in units squared; positive for a front face (y points down in the
/// picture).
fn doubled_area([a, b, c]: [[i64; 2]; 3]) -> i64 {
    (b[1] - a[1]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[1] - a[1])
}

/// How often each sample of the picture is covered under the top-left rule, computed in i64.
fn hits(triangles: &[[[i64; 2]; 3]], width: i64, height: i64) -> Vec<u32> {
    let mut hits = vec![0; (width * height) as usize];
    for &triangle in triangles {
        if doubled_area(triangle) == 0 {
            continue;
        }
        let [a, b, c] = if doubled_area(triangle) > 0 {
            [triangle[0], triangle[2], triangle[1]]
        } else {
            triangle
        };
        let range = |axis: usize, size: i64| {
            let (low, high) = (
                a[axis].min(b[axis]).min(c[axis]),
                a[axis].max(b[axis]).max(c[axis]),
            );
            ((low + 127) >> 8).max(0)..=((high - 128) >> 8).min(size - 1)
        };
        for y in range(1, height) {
            for x in range(0, width) {
                let sample = [256 * x + 128, 256 * y + 128];
                let inside = [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| {
                    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
                    let owns_ties = dy < 0 || (dy == 0 && dx > 0);
                    dx * (sample[1] - from[1]) - dy * (sample[0] - from[0]) - i64::from(!owns_ties)
                        >= 0
                });
                hits[(y * width + x) as usize] += u32::from(inside);
            }
        }
    }
    hits
}

/// The grid does not fold after the snap, checked in integers.
#[test]
fn grid_is_fold_free_after_the_snap() {
    for (query, width, height) in [
        ("grid?cell=0.1&width=100&height=60", 100, 60),
        ("grid?cell=0.4&width=200&height=100&seed=7", 200, 100),
        ("grid", 256, 256),
        ("grid?cell=1&lattice=16", 256, 256),
        ("grid?cell=4&lattice=2", 256, 256),
        ("grid?cell=16&lattice=16&width=333&height=77", 333, 77),
        (
            "grid?cell=64&width=2000&height=1000&seed=4294967295",
            2000,
            1000,
        ),
    ] {
        let scene = scene(query);
        for triangle in snapped(&scene, width, height) {
            assert!(doubled_area(triangle) >= 0, "{query}: {triangle:?} folds");
        }
    }
}

#[test]
fn grid_covers_every_sample_exactly_once() {
    for (query, width, height) in [
        ("grid?cell=0.1&width=64&height=40", 64, 40),
        ("grid?cell=0.4&width=128&height=128", 128, 128),
        ("grid?width=255&height=129", 255, 129),
        ("grid?cell=3&lattice=2", 256, 256),
        ("grid?cell=1&lattice=16", 256, 256),
        ("grid?cell=40", 256, 256),
    ] {
        let hits = hits(
            &snapped(&scene(query), width, height),
            width.into(),
            height.into(),
        );
        let wrong = hits.iter().filter(|&&n| n != 1).count();
        assert_eq!(
            wrong, 0,
            "{query}: samples that are not covered exactly once"
        );
    }
}

#[test]
fn grid_cells_have_the_side_asked_for() {
    let scene = scene("grid?cell=8&width=320&height=240");
    let Projection::Orthographic { height_m } = scene.cameras[0].pose.projection else {
        panic!("the grid's camera is orthographic")
    };
    assert_eq!(height_m, 240.0);
    let triangles = snapped(&scene, 320, 240);
    let mean =
        triangles.iter().map(|&t| doubled_area(t)).sum::<i64>() as f64 / triangles.len() as f64;
    let cell = mean.sqrt() / f64::from(UNITS_PER_PIXEL);
    assert!((cell - 8.0).abs() < 0.05, "{cell}");
}

#[test]
fn grid_perspective_camera_keeps_the_scale() {
    let scene = scene("grid?cell=16&width=320&height=240");
    let [flat, perspective] = [0, 1].map(|camera| {
        let clip = view(&scene, camera, 320, 240).clip_from_world;
        clip.project_point3(DVec3::new(100.0, -70.0, 0.0))
            .truncate()
    });
    assert!(flat.distance(perspective) < 1e-12, "{flat} {perspective}");
}

#[test]
fn a_fan_draws_its_middle_sample_once() {
    for query in [
        "fan",
        "fan?n=3&radius=0.1",
        "fan?n=8&radius=0.4",
        "fan?n=1000&seed=3",
        "fan?n=16384&radius=100",
    ] {
        let triangles = snapped(&scene(query), 256, 256);
        assert!(
            triangles.iter().all(|&t| doubled_area(t) >= 0),
            "{query} folds"
        );
        let hits = hits(&triangles, 256, 256);
        assert_eq!(hits[127 * 256 + 128], 1, "{query}");
        assert!(hits.iter().all(|&n| n <= 1), "{query}");
    }
}

#[test]
fn every_layer_of_a_stack_covers_the_middle() {
    for layers in [1, 8, 257, 5_000] {
        let scene = scene(&format!("stack?layers={layers}"));
        assert_eq!(
            hits(&snapped(&scene, 256, 256), 256, 256)[128 * 256 + 128],
            layers
        );
    }
}

#[test]
fn near_crosses_the_near_plane_and_all_sides_of_the_guard_band() {
    let scene = scene("near");
    let view = view(&scene, 0, 320, 240);
    let primitive = &scene.primitives[0];
    let mut mixed_near = 0;
    let mut beyond = [0; 4];
    for corners in triangles(&scene, primitive) {
        let clip =
            corners.map(|v| view.clip_from_world * position(&scene, primitive, v).extend(1.0));
        let behind = clip.iter().filter(|c| c.z > c.w).count();
        mixed_near += u32::from(behind == 1 || behind == 2);
        // In front of the near plane: beyond 32,768 px from the middle?
        for c in clip.iter().filter(|c| c.z <= c.w) {
            let (x, y) = (c.x / c.w * 160.0, c.y / c.w * 120.0);
            [x < -32_768.0, x > 32_768.0, y < -32_768.0, y > 32_768.0]
                .iter()
                .zip(&mut beyond)
                .for_each(|(out, n)| *n += u32::from(*out));
        }
    }
    assert!(
        mixed_near > 100,
        "{mixed_near} triangles cross the near plane"
    );
    assert!(
        beyond.iter().all(|&n| n > 0),
        "vertices beyond the left, right, bottom, top: {beyond:?}"
    );
}
