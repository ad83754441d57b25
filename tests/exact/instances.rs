//! Promise: many instances of few primitives are drawn as draws with whole records are: their
//! triangle ids and depth keys are the same, and their colors are within their bounds. They fit a
//! binding in which whole records do not. Needs an adapter.

use std::sync::Arc;

use glam::{DMat4, DVec3};
use pollster::FutureExt as _;
use rasterlab::{
    accuracy::{Culling, PinnedOptions, PositionFormat},
    gpu::{RenderError, Renderer},
    plan::AccuracyRequest,
    scene::{
        Scene,
        model::{MANY_INSTANCES, MOST_SHAPES},
    },
};

use crate::common::*;

const SIZE: [u32; 2] = [96, 72];

/// Tetrahedra of two kinds, all around, under transforms that turn, mirror and shear.
fn crowd() -> Arc<Scene> {
    let transform = |i: usize| {
        let [column, row] = [i % 75, i / 75].map(|at| at as f64);
        let [mirror, shear] = [[1.0, -1.0][i % 2], [0.0, 0.7, 0.0][i % 3]];
        let sheared = DMat4::from_cols_array(&[
            mirror, 0.0, 0.0, 0.0, shear, 1.0, 0.0, 0.0, 0.0, 0.0, 1.5, 0.0, 0.1, 0.0, 0.0, 1.0,
        ]);
        let place = DVec3::new(column, (i % 7) as f64, row);
        DMat4::from_translation(place) * DMat4::from_rotation_y(i as f64) * sheared
    };
    let count = MANY_INSTANCES + 100;
    let of_kind = |kind: usize, size: f32| SimpleMesh {
        positions: [
            [0.0; 3],
            [size, 0.0, 0.0],
            [0.0, size, 0.0],
            [0.0, 0.0, size],
        ]
        .to_vec(),
        normals: [
            [-1.0, -1.0, -1.0],
            [1.0, 0.0, 0.1],
            [0.0, 1.0, 0.1],
            [0.0, 0.1, 1.0],
        ]
        .to_vec(),
        colors: (0..4).map(|i| [0.2 * i as f32, 0.9, 0.3, 1.0]).collect(),
        indices: vec![0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3],
        double_sided: kind == 0,
        transforms: (kind..count).step_by(2).map(transform).collect(),
    };
    scene_of_meshes(&[of_kind(0, 0.6), of_kind(1, 0.9)])
}

/// The same beside so many primitives that draws have whole records.
fn with_whole_records(scene: &Scene) -> Arc<Scene> {
    let mut scene = scene.clone();
    let unused = scene.primitives[0].clone();
    scene.primitives.resize(MOST_SHAPES + 1, unused);
    Arc::new(scene)
}

#[test]
fn instances_are_drawn_as_whole_records_are_where_those_do_not_fit() {
    let (Some(mut gpu), Some(mut usual)) = (own_gpu(), loan()) else {
        return;
    };
    let caps = &mut Arc::get_mut(&mut gpu).expect("it is no other's").caps;
    caps.max_storage_binding_bytes = 1 << 20;
    let mut small = Renderer::new(gpu);
    let crowd = crowd();
    let whole = with_whole_records(&crowd);
    assert!(crowd.is_instanced() && !whole.is_instanced());
    let view = view(&crowd, SIZE);
    for (effects, pins) in [
        (&["lambert"][..], PinnedOptions::of(Culling::Frustum)),
        (&["wobble", "lambert"], PinnedOptions::default()),
        (&["lambert"], PinnedOptions::of(PositionFormat::Packed16)),
    ] {
        let is_packed = pins.option() == Some(PositionFormat::Packed16);
        let (stack, request) = (
            stack(effects),
            AccuracyRequest {
                pins,
                ..AccuracyRequest::default()
            },
        );
        let what = format!("{effects:?}, {is_packed}");
        let drawn = if is_packed {
            small.captured(&crowd, &view, &stack, &request)
        } else {
            small.exact(&crowd, &view, &stack, &request, &what).0
        };
        let wanted = usual.captured(&whole, &view, &stack, &request);
        let covered = wanted.frame.covered();
        assert!(covered > 300, "{what}: {covered}");
        assert!(
            drawn.frame.triangle_id == wanted.frame.triangle_id,
            "{what}"
        );
        assert!(drawn.frame.depth_key == wanted.frame.depth_key, "{what}");
        let refused = small
            .set_scene(&whole)
            .block_on()
            .and_then(|()| small.capture(&view, &stack, &request).block_on().map(drop));
        assert!(
            matches!(
                refused,
                Err(RenderError::TooLarge {
                    buffer: "draws",
                    ..
                })
            ),
            "{what}: {refused:?}"
        );
    }
}
