//! What is checked and measured about every vertex and triangle of a primitive, on all threads.

use glam::DVec3;
use rayon::prelude::*;

use super::{buffers::SceneWriter, error::LoadError};
use crate::{
    scene::{
        accessor::Accessor,
        bounds::{Bounds, is_near},
        model::{Primitive, Scene, Topology},
        texture::{MAX_REPEATS, Texture, texcoord},
    },
    work::{Canceled, checkpoint, map_parts},
};

/// Below this a single thread adds up normals.
const FEW_VERTICES: usize = 1 << 16;
/// More threads than this would mostly look at triangles of others.
const MOST_THREADS: usize = 8;

/// The first of `count` elements of which `is_wrong` is true.
fn first(count: u32, is_wrong: impl Fn(u32) -> bool + Sync) -> Result<Option<u32>, Canceled> {
    Ok(
        map_parts(count, |mut part| part.find(|&element| is_wrong(element)))?
            .into_iter()
            .flatten()
            .next(),
    )
}

/// Checks that all values of a copied attribute are finite.
pub fn check_finite(scene: &Scene, accessor: &Accessor) -> Result<(), LoadError> {
    let bytes = &scene.vertex_bytes;
    let is_finite = |vertex| match accessor.components {
        3 => accessor
            .vector(bytes, vertex)
            .into_iter()
            .all(f64::is_finite),
        components => {
            (0..components).all(|component| accessor.value(bytes, vertex, component).is_finite())
        }
    };
    match first(accessor.count, |vertex| !is_finite(vertex))? {
        Some(vertex) => Err(LoadError::new(format!(
            "vertex {vertex} has a value that is not finite"
        ))),
        None => Ok(()),
    }
}

/// Checks that all corners refer to vertices that exist.
pub fn check_indices(scene: &Scene, primitive: &Primitive) -> Result<(), LoadError> {
    let Some(indices) = &primitive.indices else {
        return Ok(());
    };
    let count = primitive.vertex_count();
    match first(indices.count, |corner| {
        indices.integer(&scene.index_bytes, corner, 0) >= i64::from(count)
    })? {
        Some(corner) => {
            let index = indices.integer(&scene.index_bytes, corner, 0);
            Err(LoadError::new(format!(
                "corner {corner} refers to vertex {index}, but there are only {count}"
            )))
        }
        None => Ok(()),
    }
}

/// Checks that no texture coordinates repeat an image more often than a lookup can tell.
pub fn check_repeats(
    scene: &Scene,
    accessor: &Accessor,
    texture: &Texture,
) -> Result<(), LoadError> {
    let coordinates =
        |vertex| texture.image_coordinates(texcoord(accessor, &scene.vertex_bytes, vertex));
    match first(accessor.count, |vertex| {
        coordinates(vertex).abs().max_element() > MAX_REPEATS
    })? {
        Some(vertex) => {
            let at = coordinates(vertex);
            let reason = format!(
                "vertex {vertex} has the image coordinates {} {}; allowed: magnitudes up to {MAX_REPEATS}",
                at.x, at.y
            );
            Err(LoadError::new(reason))
        }
        None => Ok(()),
    }
}

/// Leaves out the triangles, lines and points with a vertex that cannot be drawn. Returns a sentence
/// about them; none where there are none.
///
/// # Errors
/// None is left.
pub fn leave_out_far(
    writer: &mut SceneWriter,
    primitive: &mut Primitive,
) -> Result<Option<String>, LoadError> {
    let scene = &writer.scene;
    let place = |vertex: u32| primitive.position(scene, vertex);
    let is_near = |vertex: &u32| is_near(place(*vertex).map(f64::from));
    let count = primitive.vertex_count();
    let Some(vertex) = first(count, |vertex| !is_near(&vertex))? else {
        return Ok(None);
    };
    let reason = match place(vertex).iter().all(|value| value.is_finite()) {
        true => format!("vertex {vertex} lies beyond 6.9e10"),
        false => format!("vertex {vertex} has a value that is not finite"),
    };
    let (what, step, topology) = match primitive.topology {
        Topology::Points => ("points", 1, Topology::Points),
        Topology::Lines => ("lines", 2, Topology::Lines),
        _ => ("triangles", 1, Topology::List),
    };
    let all = primitive.triangle_count();
    let mut indices: Vec<u32> = Vec::new();
    for triangle in (0..all).step_by(step) {
        let [a, b, c] = primitive.corners(scene, triangle);
        if [a, b, c].iter().all(is_near) {
            match topology {
                Topology::Points => indices.push(a),
                Topology::Lines => indices.extend([a, c]),
                _ => indices.extend([a, b, c]),
            }
        }
    }
    let Some(&kept) = indices.first() else {
        return Err(LoadError::new(format!(
            "{reason}, as has each of its {what}; export it again"
        )));
    };
    let left = topology.triangles(indices.len() as u32);
    let told = format!(
        "{reason}; {} of {} {what} have such a vertex and are left out",
        (all - left) / step as u32,
        all / step as u32
    );
    // Nothing uses the others, which must not widen its box.
    let places: Vec<_> = (0..count)
        .map(|vertex| place(if is_near(&vertex) { vertex } else { kept }))
        .collect();
    primitive.positions = writer.append_vectors(places.len(), places.into_iter())?;
    primitive.indices = Some(writer.append_indices(&indices)?);
    primitive.topology = topology;
    Ok(Some(told))
}

/// Computes the bounds and the longest edge. Positions must be finite.
pub fn measure(scene: &Scene, primitive: &mut Primitive) -> Result<(), Canceled> {
    let at = |vertex: u32| DVec3::from(primitive.position(scene, vertex).map(f64::from));
    let boxes = map_parts(primitive.vertex_count(), |part| {
        let mut bounds = Bounds::EMPTY;
        part.for_each(|vertex| bounds.include(at(vertex)));
        bounds
    })?;
    let longest = map_parts(primitive.triangle_count(), |part| {
        let edge = |t| {
            let [a, b, c] = primitive.corners(scene, t).map(at);
            a.distance_squared(b)
                .max(b.distance_squared(c))
                .max(c.distance_squared(a))
        };
        part.map(edge).fold(0.0, f64::max)
    })?;
    let mut bounds = Bounds::EMPTY;
    boxes.iter().for_each(|part| {
        bounds.include(part.min);
        bounds.include(part.max);
    });
    (primitive.bounds, primitive.longest_edge) =
        (bounds, longest.into_iter().fold(0.0, f64::max).sqrt());
    Ok(())
}

/// Computes missing normals, not yet [normalized](normal): the sum of the normals of the adjoining
/// triangles, weighted by area.
///
/// glTF asks for flat normals. Without indices the result is flat. Shared vertices would have to be
/// split first, so theirs are smooth instead and the bytes of the file stay as they are.
///
/// # Errors
/// The work was canceled.
pub fn smooth_normals(scene: &Scene, primitive: &Primitive) -> Result<Vec<DVec3>, Canceled> {
    let at = |vertex: u32| DVec3::from(primitive.position(scene, vertex).map(f64::from));
    let mut sums = vec![DVec3::ZERO; primitive.vertex_count() as usize];
    let checkpoint = checkpoint();
    // Each thread looks at all triangles and adds up the normals of its own vertices, in the order
    // of the triangles: the order of a sum is seen in its last bits.
    let threads = if sums.len() < FEW_VERTICES {
        1
    } else {
        rayon::current_num_threads().min(MOST_THREADS)
    };
    let share = sums.len().div_ceil(threads).max(1);
    sums.par_chunks_mut(share)
        .enumerate()
        .try_for_each(|(part, sums)| {
            let first = part * share;
            let own = |corner: u32| (corner as usize).wrapping_sub(first);
            for t in 0..primitive.triangle_count() {
                if t.is_multiple_of(1 << 16) {
                    checkpoint.pass()?;
                }
                let corners = primitive.corners(scene, t);
                if corners.iter().all(|&corner| own(corner) >= sums.len()) {
                    continue;
                }
                let [a, b, c] = corners.map(at);
                let twice_area = (b - a).cross(c - a);
                for corner in corners {
                    if let Some(sum) = sums.get_mut(own(corner)) {
                        *sum += twice_area;
                    }
                }
            }
            Ok(())
        })?;
    Ok(sums)
}

/// The normal from a sum of normals.
pub fn normal(sum: DVec3) -> [f32; 3] {
    sum.normalize_or(DVec3::Y).as_vec3().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn normals_do_not_depend_on_the_number_of_threads() {
        let scene = builtin::build("sphere?triangles=200000").expect("a builtin");
        let normals = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            pool.install(|| {
                smooth_normals(&scene, &scene.primitives[0]).expect("nobody cancels it")
            })
        };
        let alone = normals(1);
        assert!(alone.len() > FEW_VERTICES && alone.iter().all(|sum| sum.length() > 0.0));
        let bits = |sums: &[DVec3]| {
            sums.iter()
                .flat_map(|sum| sum.to_array())
                .map(f64::to_bits)
                .collect::<Vec<_>>()
        };
        for threads in [2, 3, 5] {
            assert!(bits(&normals(threads)) == bits(&alone), "{threads} threads");
        }
    }
}
