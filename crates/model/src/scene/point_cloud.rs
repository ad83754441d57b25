//! Point clouds: points with colors and perhaps normals, as a primitive.

use std::collections::HashSet;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{
    accessor::{Accessor, ComponentType},
    bounds::Bounds,
    model::{Primitive, Scene, Topology},
};

/// Points to be added to a scene.
#[derive(Clone, Debug, Default)]
pub struct PointCloud {
    /// Object space; finite.
    pub positions: Vec<[f32; 3]>,
    /// Empty, or one per point.
    pub normals: Vec<[f32; 3]>,
    /// Linear, in units of 1/65535; empty, or one per point.
    pub colors: Vec<[u16; 4]>,
}

impl PointCloud {
    /// The primitive of these points; `append` adds bytes to the scene's vertices and says where they
    /// begin. A point without a normal faces the viewer.
    ///
    /// # Errors
    /// Those of `append`.
    pub fn primitive<E>(
        self,
        name: &str,
        material: usize,
        mut append: impl FnMut(&[u8]) -> Result<u32, E>,
    ) -> Result<Primitive, E> {
        let cloud = self.in_places();
        let count = cloud.positions.len();
        let mut bounds = Bounds::EMPTY;
        let place = |position: &[f32; 3]| DVec3::from(position.map(f64::from));
        cloud
            .positions
            .iter()
            .for_each(|position| bounds.include(place(position)));
        let positions = append(bytemuck::cast_slice(&cloud.positions))?;
        let normals = match cloud.normals.is_empty() {
            // One for all.
            true => Accessor {
                stride: 0,
                ..Accessor::packed_f32(append(&[0; 12])? as usize, 3, count)
            },
            false => Accessor::packed_f32(
                append(bytemuck::cast_slice(&cloud.normals))? as usize,
                3,
                count,
            ),
        };
        let colors = match cloud.colors.is_empty() {
            true => None,
            false => Some(Accessor {
                offset: append(bytemuck::cast_slice(&cloud.colors))?,
                stride: size_of::<[u16; 4]>() as u32,
                component_type: ComponentType::U16,
                components: 3,
                normalized: true,
                count: count as u32,
            }),
        };
        Ok(Primitive {
            name: name.into(),
            mesh: name.into(),
            topology: Topology::Points,
            indices: None,
            positions: Accessor::packed_f32(positions as usize, 3, count),
            normals,
            is_faceted: false,
            colors,
            texcoords: Default::default(),
            tangents: None,
            material,
            longest_edge: diameter(cloud.positions.iter().map(place), &bounds),
            bounds,
            normals_agree: false,
            deformation: Default::default(),
        })
    }

    /// The same points along a curve that fills space, where there are many, so that neighbors in
    /// memory are neighbors in the picture; else as they are.
    fn in_places(self) -> Self {
        let count = self.positions.len();
        if count < MANY_POINTS || u32::try_from(count).is_err() {
            return self;
        }
        let bounds = |a: [Vec3; 2], b: [Vec3; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let ends = (self.positions.par_iter())
            .map(|position| [Vec3::from(*position); 2])
            .reduce_with(bounds);
        let [low, high] = ends.unwrap_or_default();
        let cell = ((high - low).max_element() / CELLS_OF_AXIS).max(f32::MIN_POSITIVE);
        let place = |(point, position): (u32, &[f32; 3])| {
            let cells = ((Vec3::from(*position) - low) / cell).as_uvec3().to_array();
            let [x, y, z] = cells.map(|cell| every_third_bit(u64::from(cell)));
            (x | y << 1 | z << 2) << 32 | u64::from(point)
        };
        let mut order: Vec<u64> = (self.positions.par_iter())
            .enumerate()
            .map(|(point, position)| place((point as u32, position)))
            .collect();
        order.par_sort_unstable();
        Self {
            positions: chosen(&order, &self.positions),
            normals: chosen(&order, &self.normals),
            colors: chosen(&order, &self.colors),
        }
    }

    /// Adds the points to a scene; returns the index of their primitive.
    pub fn append(self, scene: &mut Scene, name: &str, material: usize) -> usize {
        let bytes = &mut scene.vertex_bytes;
        let primitive = self.primitive::<std::convert::Infallible>(name, material, |added| {
            let first = bytes.len() as u32;
            bytes.extend_from_slice(added);
            Ok(first)
        });
        scene.primitives.extend(primitive);
        scene.primitives.len() - 1
    }
}

/// Points from which on they are put in an order of places.
pub const MANY_POINTS: usize = 1 << 20;

/// Cells of the longest axis: ten bits of each fit beside the number of a point.
const CELLS_OF_AXIS: f32 = 1023.0;

/// Ten bits, two apart.
const fn every_third_bit(bits: u64) -> u64 {
    let spread = (bits | bits << 16) & 0x0300_00ff;
    let spread = (spread | spread << 8) & 0x0300_f00f;
    let spread = (spread | spread << 4) & 0x030c_30c3;
    (spread | spread << 2) & 0x0924_9249
}

/// The values of all points in an order, whose low words are their numbers; none where there are none.
fn chosen<T: Copy + Send + Sync>(order: &[u64], values: &[T]) -> Vec<T> {
    let value = |point: &u64| values[(point & u64::from(u32::MAX)) as usize];
    if values.is_empty() {
        return Vec::new();
    }
    order.par_iter().map(value).collect()
}

/// The diameter at which the discs of points on a surface leave no gaps, mostly: from the area of the
/// cells of a lattice that hold some.
pub fn diameter(places: impl ExactSizeIterator<Item = DVec3>, bounds: &Bounds) -> f64 {
    // Cells as wide as this many points that lie evenly on the box's diagonal square.
    const CELL: f64 = 4.0;
    // From the middle of four points of a square lattice to each, with something for uneven ones.
    const OVERLAP: f64 = 1.7;
    let (count, size) = (places.len() as f64, (bounds.max - bounds.min).length());
    if count < 2.0 || !size.is_finite() || size <= 0.0 {
        return 0.0;
    }
    let cell = CELL * size / count.sqrt();
    let cell_of = |place: DVec3| ((place - bounds.min) / cell).floor().as_ivec3();
    let mut cells = HashSet::new();
    let mut last = None;
    for place in places {
        // Neighbors mostly share one.
        let found = cell_of(place);
        if last.replace(found) != Some(found) {
            cells.insert(found);
        }
    }
    OVERLAP * cell * (cells.len() as f64 / count).sqrt().min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::hash_unit;

    #[test]
    fn many_points_are_neighbors_of_their_neighbors_and_stay_themselves() {
        let place = |point: u32| {
            [0, 1, 2].map(|axis| hash_unit(crate::math::hash(4 * point + axis)) as f32)
        };
        let cloud = PointCloud {
            positions: (0..MANY_POINTS as u32).map(place).collect(),
            normals: Vec::new(),
            colors: (0..MANY_POINTS as u32)
                .map(|point| [point as u16, (point >> 16) as u16, 0, 0])
                .collect(),
        };
        let few = PointCloud {
            positions: cloud.positions[1..].to_vec(),
            ..PointCloud::default()
        };
        let kept = few.positions.clone();
        assert!(few.in_places().positions == kept, "few points moved");
        let length = |positions: &[[f32; 3]]| -> f32 {
            let step = |pair: &[[f32; 3]]| Vec3::from(pair[0]).distance(Vec3::from(pair[1]));
            positions.windows(2).map(step).sum()
        };
        let before = length(&cloud.positions);
        let cloud = cloud.in_places();
        assert!(length(&cloud.positions) * 20.0 < before);
        let mut seen = vec![false; MANY_POINTS];
        for (position, [low, high, ..]) in cloud.positions.iter().zip(&cloud.colors) {
            let point = u32::from(*high) << 16 | u32::from(*low);
            assert!(
                *position == place(point),
                "point {point} has another's color"
            );
            assert!(!std::mem::replace(&mut seen[point as usize], true));
        }
    }
}
