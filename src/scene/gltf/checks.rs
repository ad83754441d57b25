//! What is checked and measured about every vertex and triangle of a primitive, on all threads.

use glam::DVec3;

use super::error::LoadError;
use crate::{
    scene::{
        accessor::Accessor,
        bounds::Bounds,
        model::{Primitive, Scene},
        texture::{MAX_REPEATS, Texture, texcoord},
    },
    work::{checkpoint, map_parts},
};

/// The first of `count` elements of which `is_wrong` is true.
fn first(count: u32, is_wrong: impl Fn(u32) -> bool + Sync) -> Option<u32> {
    map_parts(count, |mut part| part.find(|&element| is_wrong(element))).into_iter().flatten().next()
}

/// Checks that all values of a copied attribute are finite.
pub fn check_finite(scene: &Scene, accessor: &Accessor) -> Result<(), LoadError> {
    let bytes = &scene.vertex_bytes;
    let is_finite = |vertex| match accessor.components {
        3 => accessor.vector(bytes, vertex).into_iter().all(f64::is_finite),
        components => (0..components).all(|component| accessor.value(bytes, vertex, component).is_finite()),
    };
    match first(accessor.count, |vertex| !is_finite(vertex)) {
        Some(vertex) => Err(LoadError::new(format!("vertex {vertex} has a value that is not finite"))),
        None => Ok(()),
    }
}

/// Checks that all corners refer to vertices that exist.
pub fn check_indices(scene: &Scene, primitive: &Primitive) -> Result<(), LoadError> {
    let Some(indices) = &primitive.indices else { return Ok(()) };
    let count = primitive.vertex_count();
    match first(indices.count, |corner| indices.integer(&scene.index_bytes, corner, 0) >= i64::from(count)) {
        Some(corner) => {
            let index = indices.integer(&scene.index_bytes, corner, 0);
            Err(LoadError::new(format!("corner {corner} refers to vertex {index}, but there are only {count}")))
        }
        None => Ok(()),
    }
}

/// Checks that no texture coordinates repeat an image more often than a lookup can tell.
pub fn check_repeats(scene: &Scene, accessor: &Accessor, texture: &Texture) -> Result<(), LoadError> {
    let coordinates = |vertex| texture.image_coordinates(texcoord(accessor, &scene.vertex_bytes, vertex));
    match first(accessor.count, |vertex| coordinates(vertex).abs().max_element() > MAX_REPEATS) {
        Some(vertex) => {
            let at = coordinates(vertex);
            let reason = format!("vertex {vertex} has the image coordinates {} {}; allowed: magnitudes up to {MAX_REPEATS}", at.x, at.y);
            Err(LoadError::new(reason))
        }
        None => Ok(()),
    }
}

/// Computes the bounds and the longest edge. Positions must be finite.
pub fn measure(scene: &Scene, primitive: &mut Primitive) -> Result<(), LoadError> {
    check_finite(scene, &primitive.positions)?;
    let at = |vertex: u32| DVec3::from(primitive.position(scene, vertex).map(f64::from));
    let boxes = map_parts(primitive.vertex_count(), |part| {
        let mut bounds = Bounds::EMPTY;
        part.for_each(|vertex| bounds.include(at(vertex)));
        bounds
    });
    let longest = map_parts(primitive.triangle_count(), |part| {
        let edge = |t| {
            let [a, b, c] = primitive.corners(scene, t).map(at);
            a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a))
        };
        part.map(edge).fold(0.0, f64::max)
    });
    let mut bounds = Bounds::EMPTY;
    boxes.iter().for_each(|part| {
        bounds.include(part.min);
        bounds.include(part.max);
    });
    (primitive.bounds, primitive.longest_edge) = (bounds, longest.into_iter().fold(0.0, f64::max).sqrt());
    Ok(())
}

/// Computes missing normals, not yet [normalized](normal): the sum of the normals of the adjoining triangles, weighted by area.
///
/// glTF asks for flat normals. Without indices the result is flat. Shared vertices would have to be split first, so theirs
/// are smooth instead and the bytes of the file stay as they are.
pub fn smooth_normals(scene: &Scene, primitive: &Primitive) -> Vec<DVec3> {
    let at = |vertex: u32| DVec3::from(primitive.position(scene, vertex).map(f64::from));
    let mut sums = vec![DVec3::ZERO; primitive.vertex_count() as usize];
    let checkpoint = checkpoint();
    // One after another: the order of a sum is seen in its last bits.
    for t in 0..primitive.triangle_count() {
        if t.is_multiple_of(1 << 16) {
            checkpoint.pass();
        }
        let corners = primitive.corners(scene, t);
        let [a, b, c] = corners.map(at);
        let twice_area = (b - a).cross(c - a);
        corners.into_iter().for_each(|corner| sums[corner as usize] += twice_area);
    }
    sums
}

/// The normal from a sum of normals.
pub fn normal(sum: DVec3) -> [f32; 3] {
    sum.normalize_or(DVec3::Y).as_vec3().into()
}
