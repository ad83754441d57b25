//! Corners of triangles in f64: deformed, transformed, and moved by the vertex effects.

use glam::{DMat3, DMat4, DVec2, DVec3};

use super::{
    super::arithmetic::vector::{direction, normal_matrix, plane_normal},
    deform,
    snap::{ClipPosition, on_grid},
};
use crate::{
    effects::{Stack, hooks::Vertex},
    math::rounded_columns,
    scene::{
        Scene,
        draw::{Draw, MAX_MAGNITUDE},
        view::View,
    },
};

/// A corner of a draw's triangle, both counted within the draw. For vertices that triangles share,
/// any of these triangles will do.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    pub vertex: u32,
    pub triangle: u32,
}

/// A matrix whose entries have been rounded to f32 once, so that every renderer starts from the
/// same bits.
pub type RoundedMatrix = [[f64; 4]; 4];

/// Evaluates the vertex stage at the corners of one draw.
pub struct VertexEvaluator<'a> {
    pub scene: &'a Scene,
    pub draw: &'a Draw,
    pub view: &'a View,
    pub stack: &'a Stack,
    /// The stack has vertex effects.
    pub moves: bool,
    /// Every triangle has three records of its own.
    pub has_unshared_vertices: bool,
    pub clip_from_world: RoundedMatrix,
    pub world_from_normal: DMat3,
    /// Of the picture that a light's view is drawn for.
    picture_from_world: Option<RoundedMatrix>,
}

impl<'a> VertexEvaluator<'a> {
    pub fn new(scene: &'a Scene, draw: &'a Draw, view: &'a View, stack: &'a Stack) -> Self {
        let normal_matrix = normal_matrix(DMat3::from_mat4(draw.world_from_object));
        Self {
            scene,
            draw,
            view,
            stack,
            moves: stack.moves(),
            has_unshared_vertices: stack.unshares_vertices(),
            clip_from_world: round_matrix(&view.clip_from_world),
            world_from_normal: if draw.mirrored {
                -normal_matrix
            } else {
                normal_matrix
            },
            picture_from_world: match view.precision.is_relative {
                true => view.picture_from_world.map(|m| m.to_cols_array_2d()),
                false => view.picture_from_world.as_ref().map(round_matrix),
            },
        }
    }

    /// Where a point of the world lies in the picture that a light's view is drawn for, from 0 to
    /// 1; the middle if it is behind the eye. None in a view that is itself a picture.
    pub fn in_picture(&self, point: DVec3) -> Option<DVec2> {
        Some(in_unit_square(self.picture_rows(point, Terms::Signed)?))
    }

    /// That picture's matrix times a point.
    pub fn picture_rows(&self, p: DVec3, terms: Terms) -> Option<[f64; 4]> {
        let m = self.picture_from_world?;
        Some([0, 1, 2, 3].map(|r| {
            terms.of(m[0][r] * p.x)
                + terms.of(m[1][r] * p.y)
                + terms.of(m[2][r] * p.z)
                + terms.of(m[3][r])
        }))
    }

    /// The corner of every record of this draw, in order.
    pub fn corners(&self) -> Vec<Corner> {
        let primitive = &self.scene.primitives[self.draw.primitive];
        if !self.has_unshared_vertices {
            return (0..primitive.vertex_count())
                .map(|vertex| Corner {
                    vertex,
                    triangle: 0,
                })
                .collect();
        }
        (0..primitive.triangle_count())
            .flat_map(|triangle| self.triangle_corners(triangle))
            .collect()
    }

    /// The corner of a record of this draw, by its index in the geometry.
    pub fn corner(&self, record: usize) -> Corner {
        let own = (record - self.first_record()) as u32;
        if self.has_unshared_vertices {
            self.triangle_corners(own / 3)[own as usize % 3]
        } else {
            Corner {
                vertex: own,
                triangle: 0,
            }
        }
    }

    /// The corners of the draw's triangle with this index.
    pub fn triangle_corners(&self, triangle: u32) -> [Corner; 3] {
        let primitive = &self.scene.primitives[self.draw.primitive];
        primitive
            .corners(self.scene, triangle)
            .map(|vertex| Corner { vertex, triangle })
    }

    /// Index of this draw's first record in the geometry.
    pub fn first_record(&self) -> usize {
        if self.has_unshared_vertices {
            3 * self.draw.first_triangle as usize
        } else {
            self.draw.first_vertex as usize
        }
    }

    /// Position in clip space after all effects.
    /// Errors: the flags of a position that is refused.
    pub fn clip(&self, corner: Corner) -> Result<ClipPosition, u32> {
        let (position, cell_px) = self.clip_off_grid(corner)?;
        Ok(on_grid(position, cell_px, self.view))
    }

    /// The same before the place is rounded to the cells of an effect, and the side of these, pixels;
    /// 0 where there are none.
    /// Errors: the flags of a position that is refused.
    pub fn clip_off_grid(&self, corner: Corner) -> Result<(ClipPosition, u32), u32> {
        let position = deform::position(self.scene, self.draw, corner.vertex)?;
        let [x, y, z, w] = self.clip_rows(position - self.draw.origin(), Terms::Signed);
        if !self.moves {
            return Ok((ClipPosition { x, y, z, w }, 0));
        }
        let Vertex {
            offset: o, cell_px, ..
        } = self.moved(corner);
        let row = |r: usize| {
            [0, 1, 2]
                .map(|axis| self.clip_from_world[axis][r] * o[axis])
                .iter()
                .sum::<f64>()
        };
        // A corner moved behind the far plane of parallel rays stays on it: there are no negative
        // depths.
        let position = ClipPosition {
            x: x + row(0),
            y: y + row(1),
            z: (z + row(2)).max(0.0),
            w: w + row(3),
        };
        // A shadow map has no grid.
        let is_picture = self.picture_from_world.is_none();
        Ok((position, if is_picture { cell_px } else { 0 }))
    }

    /// The draw's clip matrix times a point relative to the draw's origin.
    pub fn clip_rows(&self, p: DVec3, terms: Terms) -> [f64; 4] {
        [0, 1, 2, 3].map(|r| {
            let m = |column: usize| f64::from(self.draw.clip_from_object[column][r]);
            terms.of(m(0) * p.x) + terms.of(m(1) * p.y) + terms.of(m(2) * p.z) + terms.of(m(3))
        })
    }

    /// A corner after all effects; its displacement is clamped to 2^40 m, as every coordinate is.
    pub fn moved(&self, corner: Corner) -> Vertex {
        let mut vertex = self.stack.moved(self.unmoved(corner), self.draw.scopes);
        vertex.offset = clamped(vertex.offset);
        vertex
    }

    /// A corner before any effect.
    pub fn unmoved(&self, corner: Corner) -> Vertex {
        let object = self.object_position(corner.vertex);
        let position = clamped(self.draw.world_from_object.transform_point3(object));
        let vertex = Vertex {
            position,
            offset: DVec3::ZERO,
            normal: direction(self.world_normal(corner.vertex)),
            flat_normal: DVec3::ZERO,
            center: position,
            arm: DVec3::ZERO,
            center_screen: DVec2::ZERO,
            triangle: 0,
            cell_px: 0,
        };
        if self.has_unshared_vertices {
            self.with_triangle(vertex, corner, object)
        } else {
            vertex
        }
    }

    /// Adds what effects may know about a corner's triangle.
    fn with_triangle(&self, vertex: Vertex, corner: Corner, object: DVec3) -> Vertex {
        let corners = self.triangle_positions(corner);
        let middle = corners.iter().sum::<DVec3>() / 3.0;
        let center = clamped(self.draw.world_from_object.transform_point3(middle));
        let own = in_unit_square(self.clip_rows(middle - self.draw.origin(), Terms::Signed));
        Vertex {
            flat_normal: plane_normal(corners).map_or(DVec3::ZERO, |normal| {
                direction(self.world_from_normal * normal)
            }),
            center,
            arm: self
                .draw
                .world_from_object
                .transform_vector3(object - middle),
            center_screen: self.in_picture(center).unwrap_or(own),
            triangle: self.draw.first_triangle + corner.triangle,
            ..vertex
        }
    }

    /// The three corners of a corner's triangle in object space.
    pub fn triangle_positions(&self, corner: Corner) -> [DVec3; 3] {
        let primitive = &self.scene.primitives[self.draw.primitive];
        primitive
            .corners(self.scene, corner.triangle)
            .map(|vertex| self.object_position(vertex))
    }

    /// A vertex in object space, deformed; the origin if it is refused.
    fn object_position(&self, vertex: u32) -> DVec3 {
        deform::position(self.scene, self.draw, vertex).unwrap_or_default()
    }

    /// The normal of a vertex in world space, of any length; zero if it is refused.
    pub fn world_normal(&self, vertex: u32) -> DVec3 {
        self.world_from_normal * deform::normal(self.scene, self.draw, vertex).unwrap_or_default()
    }

    /// The length by which the normal of a vertex is weighed in interpolation.
    pub fn normal_weight(&self, vertex: u32) -> f64 {
        if self.draw.is_uneven {
            let stored = deform::normal(self.scene, self.draw, vertex);
            stored.unwrap_or_default().length()
        } else {
            self.world_normal(vertex).length()
        }
    }
}

/// Which sum of a matrix product's terms is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Terms {
    /// The product itself.
    Signed,
    /// The sum of magnitudes, to which rounding errors are proportional.
    Magnitudes,
}

impl Terms {
    fn of(self, term: f64) -> f64 {
        if self == Self::Magnitudes {
            term.abs()
        } else {
            term
        }
    }
}

fn round_matrix(matrix: &DMat4) -> RoundedMatrix {
    rounded_columns(matrix).map(|column| column.map(f64::from))
}

/// A clip-space position as a fraction of the picture, from the top left; its middle if it is
/// behind the eye.
fn in_unit_square([x, y, _, w]: [f64; 4]) -> DVec2 {
    if w > 0.0 {
        DVec2::new(0.5 + 0.5 * x / w, 0.5 - 0.5 * y / w)
    } else {
        DVec2::splat(0.5)
    }
}

/// Clamped to ±2^40 m per axis, so that no later product overflows a float.
fn clamped(v: DVec3) -> DVec3 {
    v.clamp(DVec3::splat(-MAX_MAGNITUDE), DVec3::splat(MAX_MAGNITUDE))
}
