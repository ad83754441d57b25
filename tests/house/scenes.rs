//! Promise: built-in scenes are closed, fold-free, finite and of the size asked for; a mistyped
//! query gets a helpful message.

use std::collections::{HashMap, HashSet};

use glam::{DMat4, DVec3};
use rasterlab::{
    math::{UNITS_PER_PIXEL, rounded_columns},
    scene::{
        Primitive, Scene,
        builtin::{self, BUILTINS},
        camera::Projection,
        view::View,
    },
};

const MIB: usize = 1 << 20;

fn scene(query: &str) -> Scene {
    builtin::build(query).unwrap_or_else(|error| panic!("{query}: {error}"))
}

fn triangles<'a>(
    scene: &'a Scene,
    primitive: &'a Primitive,
) -> impl Iterator<Item = [u32; 3]> + 'a {
    (0..primitive.triangle_count()).map(|t| primitive.corners(scene, t))
}

fn position(scene: &Scene, primitive: &Primitive, vertex: u32) -> DVec3 {
    primitive.position(scene, vertex).map(f64::from).into()
}

fn normal(scene: &Scene, primitive: &Primitive, vertex: u32) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|component| {
        primitive
            .normals
            .value(&scene.vertex_bytes, vertex, component)
    }))
}

/// Directed edges that have no partner in the opposite direction; panics when two triangles run the
/// same way along one.
fn open_edges(scene: &Scene, primitive: &Primitive) -> Vec<(u32, u32)> {
    let mut edges = HashSet::new();
    for [a, b, c] in triangles(scene, primitive) {
        for edge in [(a, b), (b, c), (c, a)] {
            assert!(
                edges.insert(edge),
                "two triangles run along {edge:?} in the same direction"
            );
        }
    }
    edges
        .iter()
        .copied()
        .filter(|&(a, b)| !edges.contains(&(b, a)))
        .collect()
}

/// Corners of every triangle in 1/256 px, y down, through the scene's first camera in f32 as the
/// vertex stage computes them.
fn snapped(scene: &Scene, width: u32, height: u32) -> Vec<[[i64; 2]; 3]> {
    let view = View::new(
        &scene.cameras[0].pose,
        width,
        height,
        &scene.bounds(),
        DMat4::IDENTITY,
        [0.0; 4],
    );
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

#[test]
fn every_builtin_is_finite_and_indexes_its_own_vertices() {
    for builtin in BUILTINS {
        let scene = scene(builtin.name);
        assert_eq!(scene.name, builtin.name);
        assert!(
            !scene.instances.is_empty()
                && scene.vertex_bytes.len().is_multiple_of(4)
                && scene.index_bytes.len().is_multiple_of(4)
        );
        for primitive in &scene.primitives {
            assert!(primitive.material < scene.materials.len());
            for vertex in 0..primitive.vertex_count() {
                let (p, n) = (
                    position(&scene, primitive, vertex),
                    normal(&scene, primitive, vertex),
                );
                assert!(
                    p.is_finite() && (n.length() - 1.0).abs() < 1e-6,
                    "{}: vertex {vertex} at {p}, normal {n}",
                    builtin.name
                );
                assert!(p.cmpge(primitive.bounds.min).all() && p.cmple(primitive.bounds.max).all());
            }
            for [a, b, c] in triangles(&scene, primitive) {
                assert!(a.max(b).max(c) < primitive.vertex_count() && a != b && b != c && c != a);
                let [a, b, c] = [a, b, c].map(|v| position(&scene, primitive, v));
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                assert!(
                    longest > 0.0 && longest <= primitive.longest_edge * (1.0 + 1e-12),
                    "{}: {longest}",
                    builtin.name
                );
            }
        }
    }
}

#[test]
fn every_builtin_builds_at_both_ends_of_each_range() {
    // The tallest grids and the narrowest fans are refused with their own messages, tested below.
    for builtin in BUILTINS
        .iter()
        .filter(|b| b.name != "grid" && b.name != "fan")
    {
        for param in builtin.params.iter().filter(|p| *p.range.end() <= 1e6) {
            for value in [param.range.start(), param.range.end()] {
                let scene = scene(&format!("{}?{}={value}", builtin.name, param.name));
                let largest = scene.vertex_bytes.len().max(scene.index_bytes.len());
                assert!(
                    scene.triangle_count() > 0 && largest <= 128 * MIB,
                    "{} {}={value}: {largest} bytes",
                    builtin.name,
                    param.name
                );
            }
        }
    }
}

#[test]
fn sphere_knot_and_walker_are_closed() {
    for query in [
        "sphere?triangles=100",
        "sphere?triangles=12346",
        "sphere",
        "knot?tess=2",
        "knot",
        "walker",
    ] {
        let scene = scene(query);
        assert_eq!(open_edges(&scene, &scene.primitives[0]), [], "{query}");
    }
}

/// Twelve surfaces from seven outlines and a tube; none has a hole, and their normals look
/// outwards.
#[test]
fn everything_in_the_still_life_is_closed_and_solid() {
    for tess in [1, 3, 8] {
        let scene = scene(&format!("still-life?tess={tess}"));
        assert_eq!((scene.primitives.len(), scene.instances.len()), (8, 12));
        for primitive in &scene.primitives {
            assert_eq!(
                open_edges(&scene, primitive),
                [],
                "tess {tess}: {}",
                primitive.name
            );
            let volume: f64 = triangles(&scene, primitive)
                .map(|corners| corners.map(|v| position(&scene, primitive, v)))
                .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
                .sum();
            assert!(
                volume > 1e-3,
                "tess {tess}: {} holds {volume} m³",
                primitive.name
            );
        }
    }
}

/// The order of the draws is the order of building: a picture that stops early shows a town that is
/// not finished.
#[test]
fn the_town_is_built_from_the_shore_up_and_lit_last() {
    let scene = scene("town?houses=30&lights=0.5");
    let names: Vec<&str> = scene
        .instances
        .iter()
        .map(|instance| scene.primitives[instance.primitive].name.as_str())
        .collect();
    assert_eq!(
        (&names[..2], &names[32..]),
        (
            &["sea", "hill"][..],
            &["tower", "trees", "boats", "windows"][..]
        )
    );
    assert!(names[2..32].iter().all(|name| *name == "house"));
    let middle = |index: usize| {
        scene.primitives[scene.instances[index].primitive]
            .bounds
            .center()
    };
    let outwards = |index: usize| libm::hypot(middle(index).x, middle(index).z);
    let mean = |range: std::ops::Range<usize>, of: &dyn Fn(usize) -> f64| {
        range.clone().map(of).sum::<f64>() / range.len() as f64
    };
    assert!(mean(2..12, &outwards) > 1.5 * mean(22..32, &outwards));
    assert!(mean(2..12, &|i| middle(i).y) < 0.6 * mean(22..32, &|i| middle(i).y));
    let emission = |name: &str| {
        let primitive = scene
            .primitives
            .iter()
            .find(|primitive| primitive.name == name)
            .expect("a part of the town");
        scene.materials[primitive.material].emission
    };
    assert_eq!((emission("windows")[0], emission("house")), (0.5, [0.0; 3]));
}

#[test]
fn sphere_has_as_many_triangles_as_asked() {
    for triangles in [100, 101, 128, 500, 4_444, 99_999, 160_000, 1_000_000] {
        assert_eq!(
            scene(&format!("sphere?triangles={triangles}")).triangle_count(),
            triangles / 2 * 2
        );
    }
}

#[test]
fn sphere_of_ten_million_triangles_fits_a_portable_binding() {
    let scene = scene("sphere?triangles=10000000");
    assert_eq!(scene.triangle_count(), 10_000_000);
    assert!(scene.vertex_bytes.len() <= 128 * MIB && scene.index_bytes.len() <= 128 * MIB);
}

#[test]
fn sphere_has_no_slivers() {
    let scene = scene("sphere?triangles=50000");
    for corners in triangles(&scene, &scene.primitives[0]) {
        let [a, b, c] = corners.map(|v| position(&scene, &scene.primitives[0], v));
        let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
        let aspect = longest * longest / (b - a).cross(c - a).length();
        assert!(
            aspect < 4.0,
            "a triangle is {aspect} times longer than high"
        );
    }
}

/// Open edges occur only at the rims: pot, lid, and both ends of handle and spout.
#[test]
fn teapot_patches_share_their_vertices() {
    for tess in [1, 2, 16] {
        let (scene, half) = (scene(&format!("teapot?tess={tess}")), tess.max(2));
        assert_eq!(
            scene.triangle_count(),
            48 * tess * tess - 8 * tess + 16 * tess * half
        );
        assert_eq!(
            open_edges(&scene, &scene.primitives[0]).len() as u64,
            8 * tess + 8 * half
        );
        let mut places = HashMap::new();
        for vertex in 0..scene.primitives[0].vertex_count() {
            let place = scene.primitives[0]
                .position(&scene, vertex)
                .map(f32::to_bits);
            assert_eq!(
                places.insert(place, vertex),
                None,
                "vertex {vertex} stands twice"
            );
        }
    }
}

#[test]
fn normals_point_out_of_the_front_faces() {
    // The lip of the spout turns over within a few rows.
    let cases = [
        ("teapot?tess=8", 0.1),
        ("teapot?tess=64", 0.85),
        ("sphere?triangles=30000", 0.9),
        ("knot?tess=12", 0.9),
    ];
    for (query, least) in cases.into_iter().chain([
        ("cube-wall", 0.99),
        ("near", 0.99),
        ("grid", 0.99),
        ("fan", 0.99),
        ("sizes", 0.99),
    ]) {
        let scene = scene(query);
        for primitive in &scene.primitives {
            for corners in triangles(&scene, primitive) {
                let [a, b, c] = corners.map(|v| position(&scene, primitive, v));
                let face = (b - a).cross(c - a).normalize();
                for corner in corners {
                    let cosine = face.dot(normal(&scene, primitive, corner));
                    assert!(
                        cosine > least,
                        "{query}: normal and face differ by {cosine:.3} at {a} {b} {c}"
                    );
                }
            }
        }
    }
}

#[test]
fn teapot_poles_look_straight_up_and_down() {
    let scene = scene("teapot");
    let primitive = &scene.primitives[0];
    for (height, up) in [
        (primitive.bounds.max.y, DVec3::Y),
        (primitive.bounds.min.y, DVec3::NEG_Y),
    ] {
        let pole = (0..primitive.vertex_count()).find(|&v| {
            let p = position(&scene, primitive, v);
            p.y == height && p.z == 0.0 && normal(&scene, primitive, v) == up
        });
        assert!(pole.is_some(), "no pole at height {height}");
    }
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
            "{query}: {wrong} samples are not covered exactly once"
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
        let view = View::new(
            &scene.cameras[camera].pose,
            320,
            240,
            &scene.bounds(),
            DMat4::IDENTITY,
            [0.0; 4],
        );
        view.clip_from_world
            .project_point3(DVec3::new(100.0, -70.0, 0.0))
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
fn sizes_hold_nine_powers_of_ten() {
    let scene = scene("sizes");
    let primitive = &scene.primitives[0];
    let decade = |[a, b, _]: [u32; 3]| {
        position(&scene, primitive, a)
            .distance(position(&scene, primitive, b))
            .log10()
            .round() as i32
    };
    let decades: HashSet<i32> = triangles(&scene, primitive).map(decade).collect();
    assert_eq!(decades, (-3..=5).collect());
}

#[test]
fn slivers_are_as_thin_as_a_unit() {
    let scene = scene("slivers?n=8&length=3906.25");
    let [a, b, c] = scene.primitives[0]
        .corners(&scene, 0)
        .map(|v| position(&scene, &scene.primitives[0], v));
    let ratio = a.distance(b) / b.distance(c);
    assert!((ratio / 1e6 - 1.0).abs() < 0.02, "{ratio}");
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
    let view = View::new(
        &scene.cameras[0].pose,
        320,
        240,
        &scene.bounds(),
        DMat4::IDENTITY,
        [0.0; 4],
    );
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

#[test]
fn the_cube_wall_places_one_cube_many_times() {
    let scene = scene("cube-wall?columns=20&rows=9");
    assert_eq!(
        (scene.instances.len(), scene.triangle_count()),
        (180, 12 * 180)
    );
    assert_eq!(
        scene.vertex_bytes.len(),
        24 * 24,
        "the primitives share the bytes of one cube"
    );
    assert_eq!(
        scene
            .instances
            .iter()
            .map(|i| scene.primitives[i.primitive].material)
            .collect::<HashSet<_>>()
            .len(),
        6
    );
}

#[test]
fn the_same_query_gives_the_same_bits() {
    for builtin in BUILTINS {
        assert!(
            scene(builtin.name) == scene(builtin.name),
            "{}",
            builtin.name
        );
    }
    assert!(scene("grid?seed=1") != scene("grid?seed=2"));
}

#[test]
fn mistyped_queries_get_a_helpful_error() {
    for (query, sentence) in [
        (
            "teapto",
            "there is no built-in scene \"teapto\"; did you mean \"teapot\"? \
             (known: teapot, sphere, knot, cube-wall, field, tentacle, walker, town, still-life, finishes, golf, chamber, globe, panels, panes, sunglasses, notch, crossing, hair, leaves, near, grid, fan, sizes, slivers, stack)",
        ),
        (
            "teapot?tes=4",
            "teapot has no parameter \"tes\"; did you mean \"tess\"? (known: tess)",
        ),
        (
            "knot?color=4",
            "knot has no parameter \"color\" (known: tess)",
        ),
        (
            "teapot?tess=0",
            "teapot: tess=0 must be a whole number from 1 to 256",
        ),
        (
            "teapot?tess=1e9",
            "teapot: tess=1e9 must be a whole number from 1 to 256",
        ),
        (
            "teapot?tess=2.5",
            "teapot: tess=2.5 must be a whole number from 1 to 256",
        ),
        (
            "teapot?tess=nan",
            "teapot: tess=nan must be a whole number from 1 to 256",
        ),
        (
            "grid?cell=inf",
            "grid: cell=inf must be a number from 0.1 to 64",
        ),
        ("grid?cell=", "grid: cell= must be a number from 0.1 to 64"),
        (
            "grid?cell",
            "grid: \"cell\" must have the form parameter=value",
        ),
        (
            "grid?cell=1&cell=2",
            "grid: cell is given twice; remove one",
        ),
        (
            "grid?cell=0.1",
            "grid: cell=0.1 on 256x256 px makes 13148192 triangles; allowed: at most 10000000. Increase cell",
        ),
        (
            "grid?lattice=2",
            "grid: lattice=2 is too coarse for cell=1, cells would fold; lattice must be above 2.1",
        ),
        (
            "fan?n=1000&radius=0.1",
            "fan: n=1000 triangles would fold after the snap at radius=0.1; allowed: at most 53",
        ),
    ] {
        assert_eq!(
            builtin::build(query)
                .err()
                .map(|e| e.to_string())
                .as_deref(),
            Some(sentence),
            "{query}"
        );
    }
}
