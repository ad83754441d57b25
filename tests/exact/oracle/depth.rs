//! Depth: keys of vertices are exact, the nearest triangle wins, and the depth band lies only where
//! surfaces cross.

use super::*;

#[test]
fn depth_at_a_vertex_is_the_vertex_depth_and_never_leaves_the_corners() {
    let mut rng = Rng(23);
    let mut depth = || libm::ldexpf(rng.between(1, 1 << 24) as f32, -24 - rng.between(0, 20));
    let depths: Vec<[f32; 3]> = (0..500).map(|_| [depth(), depth(), depth()]).collect();
    for z in depths {
        // The top left corner lies on a sample and covers it; the other samples lie between the
        // corners.
        let corners = [
            at(128, 128, z[0]),
            at(128 + 2048, 128, z[1]),
            at(128 + 256, 128 + 2048, z[2]),
        ];
        let coverage = cover(
            &[OrientedTriangle::clockwise(0, corners)],
            &pixel_view(9, 9),
        )
        .expect("nobody cancels it");
        assert_eq!(coverage.samples[0].depth_key, z[0].to_bits());
        let (low, high) = (z[0].min(z[1]).min(z[2]), z[0].max(z[1]).max(z[2]));
        let keys = coverage
            .samples
            .iter()
            .filter(|sample| sample.layers == 1)
            .map(|sample| sample.depth_key);
        assert!(
            keys.clone().count() > 20
                && keys
                    .into_iter()
                    .all(|key| (low.to_bits()..=high.to_bits()).contains(&key))
        );
    }
}

#[test]
fn nearest_layer_wins_and_equal_layers_go_to_the_smaller_id() {
    let square = [[0, 0], [0, 9000], [9000, 0]];
    let stack = |ids: &[u32], depth: &dyn Fn(u32) -> f32| -> Vec<OrientedTriangle> {
        ids.iter()
            .map(|&id| triangle(id, square, depth(id)).unwrap())
            .collect()
    };
    let one_key_apart = |id: u32| f32::from_bits(0.5f32.to_bits() + id);
    for ids in [[0, 1, 2, 3], [3, 2, 1, 0], [2, 0, 3, 1]] {
        let nearest = cover(&stack(&ids, &one_key_apart), &pixel_view(4, 4))
            .expect("nobody cancels it")
            .samples[0];
        assert_eq!(
            (nearest.triangle_id, nearest.depth_key, nearest.layers),
            (3, one_key_apart(3).to_bits(), 4)
        );
        let equal = bounded(&stack(&ids, &|_| 0.5), &pixel_view(4, 4)).samples[0];
        assert_eq!(
            (equal.nearest.triangle_id, equal.is_band()),
            (0, false),
            "flat triangles have exact keys, so nothing is ambiguous"
        );
    }
}

#[test]
fn depth_of_zero_still_has_a_key() {
    let far = cover(
        &[triangle(4, [[0, 0], [0, 900], [900, 0]], 0.0).unwrap()],
        &pixel_view(1, 1),
    )
    .expect("nobody cancels it")
    .samples[0];
    assert_eq!((far.triangle_id, far.depth_key), (4, 1));
}

#[test]
fn crossing_surfaces_are_ambiguous_only_where_they_cross() {
    let slope = |id, left, right| {
        OrientedTriangle::clockwise(
            id,
            [
                at(0, -9000, left),
                at(65 * 256, 0, right),
                at(0, 30_000, left),
            ],
        )
    };
    let coverage = bounded(
        &[slope(0, 0.25, 0.75), slope(1, 0.75, 0.25)],
        &pixel_view(65, 16),
    );
    let band: Vec<usize> = (0..coverage.samples.len())
        .filter(|&i| coverage.samples[i].is_band())
        .map(|i| i % 65)
        .collect();
    assert!(
        !band.is_empty() && band.iter().all(|&x| x == 32),
        "{band:?}"
    );
}
