//! Promise: meshlets divide a mesh without losing a triangle, their bounds hold what is in them,
//! and they are full and round.

use std::sync::Arc;

use glam::DVec3;
use rasterlab::scene::{
    Scene, builtin,
    meshlets::{MESHLET_TRIANGLES, Meshlets},
};
use rasterlab_fuzz::stress::scenes::Rng;

/// Divides the first mesh of a built-in scene.
fn divided(query: &str) -> (Arc<Scene>, Meshlets) {
    let scene = Arc::new(builtin::build(query).unwrap_or_else(|error| panic!("{query}: {error}")));
    let meshlets = Meshlets::of(&scene, &scene.primitives[0]);
    (scene, meshlets)
}

fn wide(place: [f32; 3]) -> DVec3 {
    place.map(f64::from).into()
}

#[test]
fn every_triangle_is_in_one_meshlet_and_within_its_bounds() {
    let shuffled = {
        let mut scene = builtin::build("knot?tess=8").expect("a builtin");
        let mut order: Vec<[u8; 12]> = scene.index_bytes.as_chunks::<12>().0.to_vec();
        Rng(4).shuffle(&mut order);
        scene.index_bytes = order.concat();
        let scene = Arc::new(scene);
        let meshlets = Meshlets::of(&scene, &scene.primitives[0]);
        (scene, meshlets)
    };
    let queries = [
        "sphere?triangles=5000",
        "teapot?tess=3",
        "cube-wall",
        "near",
        "sizes",
        "grid?cell=8",
        "tentacle",
        "slivers",
    ];
    for (scene, meshlets) in queries.map(divided).into_iter().chain([shuffled]) {
        let (name, primitive) = (&scene.name, &scene.primitives[0]);
        let mut seen = vec![0; primitive.triangle_count() as usize];
        for meshlet in &meshlets.list {
            let part = |list: &[u32], first: u32, count: u32| {
                list[first as usize..][..count as usize].to_vec()
            };
            let vertices = part(
                &meshlets.vertices,
                meshlet.first_vertex,
                meshlet.vertex_count,
            );
            assert!(
                (1..=MESHLET_TRIANGLES as u32).contains(&meshlet.triangle_count),
                "{name}: {meshlet:?}"
            );
            let axis = wide(meshlet.axis).normalize_or_zero();
            for triangle in part(
                &meshlets.triangles,
                meshlet.first_triangle,
                meshlet.triangle_count,
            ) {
                seen[triangle as usize] += 1;
                let corners = primitive.corners(&scene, triangle);
                assert!(
                    corners.iter().all(|corner| vertices.contains(corner)),
                    "{name}: triangle {triangle}"
                );
                let [a, b, c] = corners.map(|corner| wide(primitive.position(&scene, corner)));
                for place in [a, b, c] {
                    let out = (place - wide(meshlet.center)).abs() - wide(meshlet.half);
                    assert!(
                        out.max_element() <= 0.0,
                        "{name}: a corner of triangle {triangle} lies outside by {out}"
                    );
                }
                let doubled = (b - a).cross(c - a);
                if meshlet.altitude > 0.0 && doubled.length() > 0.0 {
                    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                    assert!(
                        doubled.normalize().dot(axis) >= f64::from(meshlet.cos),
                        "{name}: triangle {triangle} leans out"
                    );
                    assert!(
                        doubled.length() / longest >= f64::from(meshlet.altitude),
                        "{name}: triangle {triangle} is lower"
                    );
                }
            }
            assert!(
                f64::from(meshlet.cos).hypot(meshlet.sin.into()) >= 1.0 - 1e-6,
                "{name}: {meshlet:?}"
            );
        }
        assert!(seen.iter().all(|&count| count == 1), "{name}: {seen:?}");
    }
}

#[test]
fn meshlets_of_a_closed_mesh_are_nearly_full_and_round() {
    let (_, meshlets) = divided("sphere?triangles=20000");
    let full = 20_000 / MESHLET_TRIANGLES;
    assert!(
        meshlets.list.len() < full + full / 4,
        "{} meshlets",
        meshlets.list.len()
    );
    let mean = meshlets
        .list
        .iter()
        .map(|meshlet| wide(meshlet.half).length())
        .sum::<f64>()
        / meshlets.list.len() as f64;
    // A disc of 64 of 20,000 triangles of a sphere of radius 1.1 has a radius of 0.12.
    assert!(mean < 0.25, "half a box's diagonal is {mean} m");
    let facing = meshlets
        .list
        .iter()
        .filter(|meshlet| meshlet.altitude > 0.0 && meshlet.cos > 0.5)
        .count();
    assert!(
        10 * facing > 9 * meshlets.list.len(),
        "{facing} of {} tell where they face",
        meshlets.list.len()
    );
}
