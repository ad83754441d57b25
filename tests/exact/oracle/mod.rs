//! Promise: the oracle covers every sample exactly once, shades it as the ray through it says, and
//! its judge catches every mistake that it is shown. A file for each part; hand-made scenes, views
//! and triangles for all of them are here.

mod canceling;
mod coverage;
mod depth;
mod judge;
mod projection;
mod shading;

use glam::{DMat4, DVec3, DVec4};
use rasterlab::{
    effects::{Effect, Stack},
    frame::{
        AdapterPicture, ClippedTriangle, Counters, Frame, Geometry, NO_TRIANGLE, SnappedVertex,
        vertex_flags,
    },
    math::GUARD_BAND,
    measure::{Budget, ErrorReport},
    oracle::{
        self, OrientedTriangle, ResolveInput, SampleTests, Shot, cover, cover_claims, judge, owns,
        render, shade,
    },
    scene::{
        Scene,
        camera::{Camera, MIN_NEAR_M, Projection},
        draw::draws,
        view::View,
    },
};
use rasterlab_fuzz::stress::scenes::{
    Rng, SimpleMesh, for_seeds, pixel_view, scene_of_meshes, square_perspective, triangle_soup,
};

fn scene(meshes: &[SimpleMesh]) -> Scene {
    Scene::clone(&scene_of_meshes(meshes))
}

/// A closed sphere of `2 * rows * rows` quads, smooth and colored by direction.
fn sphere(rows: u32) -> SimpleMesh {
    let columns = 2 * rows;
    let mut mesh = SimpleMesh {
        double_sided: false,
        ..Default::default()
    };
    for row in 0..=rows {
        for column in 0..=columns {
            let (v, u) = (
                f64::from(row) / f64::from(rows),
                f64::from(column % columns) / f64::from(columns),
            );
            let ((sin_v, cos_v), (sin_u, cos_u)) = (
                libm::sincos(v * std::f64::consts::PI),
                libm::sincos(u * std::f64::consts::TAU),
            );
            let normal = [sin_v * sin_u, cos_v, sin_v * cos_u].map(|n| n as f32);
            mesh.positions.push(normal);
            mesh.normals.push(normal);
            mesh.colors.push([
                0.5 + 0.5 * normal[0],
                0.5 + 0.5 * normal[1],
                0.5 + 0.5 * normal[2],
                1.0,
            ]);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let b = a + columns + 1;
            mesh.indices.extend([a, b, b + 1, a, b + 1, a + 1]);
        }
    }
    mesh
}

/// A ground of one square, `half` meters to each side at height `y`.
fn ground(half: f32, y: f32) -> SimpleMesh {
    let [a, b, c, d] = [
        [-half, y, -half],
        [-half, y, half],
        [half, y, half],
        [half, y, -half],
    ];
    SimpleMesh {
        positions: vec![a, b, c, a, c, d],
        normals: vec![[0.0, 1.0, 0.0]; 6],
        double_sided: true,
        ..Default::default()
    }
}

/// A sphere over a ground that reaches behind the eye, seen in perspective.
fn still_life(size: [u32; 2]) -> (Scene, View) {
    let scene = scene(&[sphere(12), ground(50.0, -1.0)]);
    let camera = Camera {
        eye: DVec3::new(1.0, 1.5, 4.0),
        ..Default::default()
    };
    let view = View::new(
        &camera,
        size[0],
        size[1],
        &scene.bounds(),
        DMat4::IDENTITY,
        [0.01, 0.02, 0.03, 1.0],
    );
    (scene, view)
}

fn all_effects() -> Stack {
    let mut stack = Stack::default();
    for name in ["facet", "depth", "lambert"] {
        stack
            .enable(Effect::find(name).expect("a listed effect"))
            .words = Effect::find(name).unwrap().defaults.clone();
    }
    stack
}

/// A stack of one effect, with parameter words by index.
fn only(name: &str, words: &[(usize, f32)]) -> Stack {
    let mut stack = Stack::default();
    let enabled = stack.enable(Effect::find(name).expect("a listed effect"));
    words
        .iter()
        .for_each(|&(at, value)| enabled.words[at] = value.to_bits());
    stack
}

/// The geometry of a scene without effects.
fn projected(scene: &Scene, view: &View) -> Geometry {
    oracle::project(&Shot::new(
        scene,
        &draws(scene, view).unwrap(),
        view,
        &Stack::default(),
    ))
    .expect("nobody cancels it")
}

/// The triangles that are drawn of such a geometry.
fn assembled(scene: &Scene, view: &View, geometry: &Geometry) -> (Vec<OrientedTriangle>, Counters) {
    oracle::triangles(
        &Shot::new(scene, &draws(scene, view).unwrap(), view, &Stack::default()),
        geometry,
    )
    .expect("nobody cancels it")
}

/// What covers every sample, with bounds and without claims.
fn bounded(triangles: &[OrientedTriangle], view: &View) -> oracle::BoundedCoverage {
    cover_claims(
        &SampleTests::default(),
        triangles,
        view,
        &vec![NO_TRIANGLE; view.pixels()],
    )
    .expect("nobody cancels it")
}

/// What a picture is colored from.
fn seen(frame: &Frame) -> ResolveInput<'_> {
    ResolveInput {
        triangle_ids: &frame.triangle_id,
        depth_keys: &frame.depth_key,
        dots: &frame.dots,
        previous: None,
    }
}

/// A snapped vertex that is ready to be drawn.
fn at(x: i32, y: i32, depth: f32) -> SnappedVertex {
    SnappedVertex {
        x,
        y,
        depth,
        inv_w: 1.0,
        flags: 0,
    }
}

/// Doubled area of (a, b, c) in i64; positive clockwise on screen.
fn area([a, b, c]: [[i32; 2]; 3]) -> i64 {
    let [ax, ay, bx, by, cx, cy] = [a[0], a[1], b[0], b[1], c[0], c[1]].map(i64::from);
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

/// A flat triangle through three points in units of 1/256 px, turned clockwise; none without area.
fn triangle(id: u32, mut points: [[i32; 2]; 3], depth: f32) -> Option<OrientedTriangle> {
    let area = area(points);
    if area < 0 {
        points.swap(1, 2);
    }
    (area != 0).then(|| OrientedTriangle::clockwise(id, points.map(|[x, y]| at(x, y, depth))))
}

fn layers(triangles: &[OrientedTriangle], width: u32, height: u32) -> Vec<u32> {
    cover(triangles, &pixel_view(width, height))
        .expect("nobody cancels it")
        .layers()
}

/// Projects, clips, assembles and covers.
fn covered(scene: &Scene, view: &View) -> (Vec<u32>, Counters) {
    let (drawn, counters) = assembled(scene, view, &projected(scene, view));
    (
        cover(&drawn, view).expect("nobody cancels it").layers(),
        counters,
    )
}
