//! Promise: built-in scenes are closed, fold-free, finite and of the size asked for; a mistyped
//! query gets a helpful message.

mod snapped;

use std::collections::HashSet;

use glam::DVec3;
use rasterlab::scene::{
    Primitive, Scene,
    builtin::{self, BUILTINS},
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
                // Points need none.
                let is_unit =
                    (n.length() - 1.0).abs() < 1e-6 || primitive.is_points() && n.length() == 0.0;
                assert!(
                    p.is_finite() && is_unit,
                    "{}: vertex {vertex} at {p}, normal {n}",
                    builtin.name
                );
                assert!(p.cmpge(primitive.bounds.min).all() && p.cmple(primitive.bounds.max).all());
            }
            for [a, b, c] in triangles(&scene, primitive) {
                if primitive.is_points() {
                    continue;
                }
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
            let volume = |corners: [u32; 3]| {
                let [a, b, c] = corners.map(|v| position(&scene, primitive, v));
                a.dot(b.cross(c)) / 6.0
            };
            let volume: f64 = triangles(&scene, primitive).map(volume).sum();
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
    let part = |index: usize| &scene.primitives[scene.instances[index].primitive];
    let names: Vec<&str> = (0..scene.instances.len())
        .map(|index| part(index).name.as_str())
        .collect();
    assert_eq!(names[..2], ["sea", "hill"]);
    assert_eq!(names[32..], ["tower", "trees", "boats", "windows"]);
    assert!(names[2..32].iter().all(|name| *name == "house"));
    let middle = |index: usize| part(index).bounds.center();
    let outwards = |index: usize| libm::hypot(middle(index).x, middle(index).z);
    let mean = |range: std::ops::Range<usize>, of: &dyn Fn(usize) -> f64| {
        range.clone().map(of).sum::<f64>() / range.len() as f64
    };
    assert!(mean(2..12, &outwards) > 1.5 * mean(22..32, &outwards));
    assert!(mean(2..12, &|i| middle(i).y) < 0.6 * mean(22..32, &|i| middle(i).y));
    let emission = |name: &str| {
        let mut primitives = scene.primitives.iter();
        let primitive = primitives
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
        let primitive = &scene.primitives[0];
        assert_eq!(
            scene.triangle_count(),
            48 * tess * tess - 8 * tess + 16 * tess * half
        );
        assert_eq!(
            open_edges(&scene, primitive).len() as u64,
            8 * tess + 8 * half
        );
        let mut places = HashSet::new();
        for vertex in 0..primitive.vertex_count() {
            let place = primitive.position(&scene, vertex).map(f32::to_bits);
            assert!(places.insert(place), "vertex {vertex} stands twice");
        }
    }
}

#[test]
fn normals_point_out_of_the_front_faces() {
    // The lip of the spout turns over within a few rows.
    let round = [
        ("teapot?tess=8", 0.1),
        ("teapot?tess=64", 0.85),
        ("sphere?triangles=30000", 0.9),
        ("knot?tess=12", 0.9),
    ];
    let flat = ["cube-wall", "near", "grid", "fan", "sizes"].map(|query| (query, 0.99));
    for (query, least) in round.into_iter().chain(flat) {
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
    let materials = scene
        .instances
        .iter()
        .map(|i| scene.primitives[i.primitive].material);
    assert_eq!(materials.collect::<HashSet<_>>().len(), 6);
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
    let cases = r#"
teapto ⇒ there is no built-in scene "teapto"; did you mean "teapot"? (known: teapot, sphere, knot, cube-wall, field, tentacle, walker, town, still-life, finishes, golf, chamber, globe, panels, panes, sunglasses, notch, crossing, hair, leaves, survey, nebula, near, grid, fan, sizes, slivers, stack)
teapot?tes=4 ⇒ teapot has no parameter "tes"; did you mean "tess"? (known: tess)
knot?color=4 ⇒ knot has no parameter "color" (known: tess)
teapot?tess=0 ⇒ teapot: tess=0 must be a whole number from 1 to 256
teapot?tess=1e9 ⇒ teapot: tess=1e9 must be a whole number from 1 to 256
teapot?tess=2.5 ⇒ teapot: tess=2.5 must be a whole number from 1 to 256
teapot?tess=nan ⇒ teapot: tess=nan must be a whole number from 1 to 256
grid?cell=inf ⇒ grid: cell=inf must be a number from 0.1 to 64
grid?cell= ⇒ grid: cell= must be a number from 0.1 to 64
grid?cell ⇒ grid: "cell" must have the form parameter=value
grid?cell=1&cell=2 ⇒ grid: cell is given twice; remove one
grid?cell=0.1 ⇒ grid: cell=0.1 on 256x256 px makes 13148192 triangles; allowed: at most 10000000. Increase cell
grid?lattice=2 ⇒ grid: lattice=2 is too coarse for cell=1, cells would fold; lattice must be above 2.1
fan?n=1000&radius=0.1 ⇒ fan: n=1000 triangles would fold after the snap at radius=0.1; allowed: at most 53
"#;
    for case in cases.trim().lines() {
        let (query, sentence) = case.split_once(" ⇒ ").expect("an arrow");
        let error = builtin::build(query).map(|_| ()).expect_err(query);
        assert_eq!(error.to_string(), sentence);
    }
}
