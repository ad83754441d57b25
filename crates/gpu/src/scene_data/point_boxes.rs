//! Boxes of blocks of points, by which a workgroup tells whether one can show.

use rayon::prelude::*;

use crate::{
    scene::{Primitive, Scene},
    shader::key::POINT_BLOCK,
};

/// The least and the greatest corner of a box, in object space.
pub type PointBox = [[f32; 3]; 2];

fn clouds(scene: &Scene) -> impl Iterator<Item = &Primitive> {
    (scene.instances.iter())
        .map(|instance| &scene.primitives[instance.primitive])
        .filter(|primitive| primitive.is_points())
}

/// Bytes of the boxes of a scene.
pub fn bytes_of(scene: &Scene) -> u64 {
    let blocks = clouds(scene).map(|cloud| u64::from(cloud.triangle_count().div_ceil(POINT_BLOCK)));
    size_of::<PointBox>() as u64 * blocks.sum::<u64>()
}

/// The boxes of all blocks, in the order of draws. Points that are not finite do not count.
pub fn boxes_of(scene: &Scene) -> Vec<PointBox> {
    clouds(scene)
        .flat_map(|cloud| {
            let points = cloud.triangle_count();
            let boxes = (0..points.div_ceil(POINT_BLOCK))
                .into_par_iter()
                .map(|block| {
                    let first = block * POINT_BLOCK;
                    box_of(scene, cloud, first..points.min(first + POINT_BLOCK))
                });
            boxes.collect::<Vec<_>>()
        })
        .collect()
}

fn box_of(scene: &Scene, cloud: &Primitive, points: std::ops::Range<u32>) -> PointBox {
    let last = cloud.vertex_count().saturating_sub(1);
    let mut bounds = [[f32::MAX; 3], [f32::MIN; 3]];
    for point in points {
        let [vertex, ..] = cloud.corners(scene, point);
        let position = cloud.position(scene, vertex.min(last));
        if position.iter().all(|value| value.is_finite()) {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(position[axis]);
                bounds[1][axis] = bounds[1][axis].max(position[axis]);
            }
        }
    }
    // A block of none lies at the origin.
    if bounds[0][0] > bounds[1][0] {
        [[0.0; 3]; 2]
    } else {
        bounds
    }
}
