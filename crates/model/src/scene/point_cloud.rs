//! Point clouds: points with colors and perhaps normals, as a primitive.

use std::collections::HashSet;

use glam::DVec3;

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
        let count = self.positions.len();
        let mut bounds = Bounds::EMPTY;
        let place = |position: &[f32; 3]| DVec3::from(position.map(f64::from));
        self.positions
            .iter()
            .for_each(|position| bounds.include(place(position)));
        let positions = append(bytemuck::cast_slice(&self.positions))?;
        let normals = match self.normals.is_empty() {
            // One for all.
            true => Accessor {
                stride: 0,
                ..Accessor::packed_f32(append(&[0; 12])? as usize, 3, count)
            },
            false => Accessor::packed_f32(
                append(bytemuck::cast_slice(&self.normals))? as usize,
                3,
                count,
            ),
        };
        let colors = match self.colors.is_empty() {
            true => None,
            false => Some(Accessor {
                offset: append(bytemuck::cast_slice(&self.colors))?,
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
            longest_edge: diameter(self.positions.iter().map(place), &bounds),
            bounds,
            normals_agree: false,
            deformation: Default::default(),
        })
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
    let cells: HashSet<[i32; 3]> = places
        .map(|place| {
            ((place - bounds.min) / cell)
                .floor()
                .to_array()
                .map(|k| k as i32)
        })
        .collect();
    OVERLAP * cell * (cells.len() as f64 / count).sqrt().min(1.0)
}
