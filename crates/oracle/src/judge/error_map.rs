//! The error map: what is wrong at each pixel.

use rayon::prelude::*;

use super::{
    super::{bounds::coverage::BoundedCoverage, shot::Shot},
    freedom::Freedom,
    samples::Hits,
};
use crate::{
    frame::{AdapterPicture, Geometry},
    measure::error_map::{ErrorMap, PixelError, is_nonfinite, is_unsound},
    scene::Accessor,
};

/// What is wrong at each pixel of a picture, whose colors are compared with `colors`.
pub fn error_map(
    shot: &Shot,
    coverage: &BoundedCoverage,
    picture: &AdapterPicture,
    colors: &[[u8; 4]],
    freedom: Freedom,
) -> ErrorMap {
    let frame = picture.frame;
    let unsound = unsound_triangles(shot, picture.geometry, &frame.triangle_id);
    ErrorMap::new(&frame.color, colors, |pixel| {
        let (sample, triangle_id) = (&coverage.samples[pixel], frame.triangle_id[pixel]);
        let Hits { drawn, expected } = Hits::at(picture, pixel, sample);
        let is_wrong = freedom.is_wrong(sample, triangle_id);
        let errors = [
            (PixelError::WrongTriangle, is_wrong),
            (
                PixelError::WrongDepthOrder,
                is_wrong && sample.claimed.is_some(),
            ),
            (
                PixelError::Hole,
                !freedom.is_scheduled() && drawn < expected,
            ),
            (PixelError::DoubleHit, drawn > expected),
            (PixelError::DepthBand, sample.is_band()),
            (
                PixelError::Unsound,
                is_unsound(frame.depth_key[pixel]) || unsound.binary_search(&triangle_id).is_ok(),
            ),
        ];
        errors
            .into_iter()
            .filter(|(_, is_there)| *is_there)
            .map(|(error, _)| error)
            .collect()
    })
}

/// Triangles with a corner whose depth, 1/w, normal or color is NaN, infinite or negative by its
/// bits; sorted. Corners that are clipped or rejected are never read; normals may be negative.
fn unsound_triangles(shot: &Shot, geometry: &Geometry, triangle_ids: &[u32]) -> Vec<u32> {
    let scene = shot.scene;
    let is_unsound_triangle = |&id: &u32| {
        let Some(draw) = shot.draw_of(id) else {
            return false;
        };
        let primitive = &scene.primitives[draw.primitive];
        let vertices = primitive.corners(scene, id - draw.first_triangle);
        let any = |accessor: &Accessor, test: fn(u32) -> bool| {
            let bits = |vertex: u32, component: u32| {
                (accessor.value(&scene.vertex_bytes, vertex, component) as f32).to_bits()
            };
            vertices.iter().any(|&vertex| {
                (0..accessor.components).any(|component| test(bits(vertex, component)))
            })
        };
        let mut records = shot
            .corner_records(draw, geometry, id)
            .into_iter()
            .filter(|record| record.flags == 0);
        records
            .any(|record| is_unsound(record.depth.to_bits()) || is_unsound(record.inv_w.to_bits()))
            || any(&primitive.normals, is_nonfinite)
            || primitive
                .colors
                .as_ref()
                .is_some_and(|colors| any(colors, is_unsound))
    };
    let mut ids = triangle_ids.to_vec();
    ids.par_sort_unstable();
    ids.dedup();
    ids.into_par_iter().filter(is_unsound_triangle).collect()
}
