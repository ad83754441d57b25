//! What a picture shows, and how global triangle ids lead to draws and corner records.

use super::point;
use crate::{
    effects::{
        Stack,
        hooks::{Lighting, Shape},
    },
    frame::{Geometry, SnappedVertex},
    scene::{Scene, draw::Draw, view::View},
};

/// Everything that determines a picture: a scene, its draws for a view, and the effect stack.
#[derive(Clone, Copy)]
pub struct Shot<'a> {
    pub scene: &'a Scene,
    /// [`draws`](crate::scene::draw::draws) of `scene` for `view`.
    pub draws: &'a [Draw],
    pub view: &'a View,
    pub stack: &'a Stack,
}

impl<'a> Shot<'a> {
    pub const fn new(
        scene: &'a Scene,
        draws: &'a [Draw],
        view: &'a View,
        stack: &'a Stack,
    ) -> Self {
        Self {
            scene,
            draws,
            view,
            stack,
        }
    }

    /// The light that comes with the scene.
    pub fn light(&self) -> Lighting<'a> {
        Lighting {
            lights: &self.view.scene_state.lights,
            panorama: self.scene.panorama.as_deref(),
        }
    }

    /// Is something seen through glass?
    pub fn has_glass(&self) -> bool {
        self.draws.iter().any(|draw| draw.is_glass)
    }

    /// The draw with triangle `id`, a global id; none if there is no such triangle.
    pub fn draw_of(&self, id: u32) -> Option<&'a Draw> {
        draw_of(self.scene, self.draws, id)
    }

    /// Are points of `draw` drawn as triangles about them? An effect that draws corners draws theirs.
    pub fn draws_points(&self, draw: &Draw) -> bool {
        self.scene.primitives[draw.primitive].is_points() && self.stack.shape() != Shape::Points
    }

    /// The same for lines.
    pub fn draws_lines(&self, draw: &Draw) -> bool {
        self.scene.primitives[draw.primitive].is_lines() && self.stack.shape() != Shape::Points
    }

    /// Are corners of points and lines drawn, which have no area?
    pub fn draws_corners(&self, draw: &Draw) -> bool {
        self.scene.primitives[draw.primitive].is_spread() && self.stack.shape() == Shape::Points
    }

    /// Corner records of triangle `id` of `draw`, in the order of the file.
    pub fn corner_records(&self, draw: &Draw, geometry: &Geometry, id: u32) -> [SnappedVertex; 3] {
        let records = self
            .corner_indices(draw, geometry, id)
            .map(|index| geometry.vertices[index]);
        let bits = geometry.subpixel_bits;
        if self.draws_points(draw) {
            point::corners(&records[0], draw, bits)
        } else if self.draws_lines(draw) {
            let is_second = (id - draw.first_triangle) % 2 == 1;
            point::line_corners([&records[0], &records[2]], is_second, bits)
        } else {
            records
        }
    }

    /// Indices of those records in the geometry.
    pub fn corner_indices(&self, draw: &Draw, geometry: &Geometry, id: u32) -> [usize; 3] {
        if geometry.has_unshared_vertices {
            return [0, 1, 2].map(|k| 3 * id as usize + k);
        }
        let corners =
            self.scene.primitives[draw.primitive].corners(self.scene, id - draw.first_triangle);
        corners.map(|corner| (draw.first_vertex + corner) as usize)
    }
}

/// As [`Shot::draw_of`].
pub(super) fn draw_of<'a>(scene: &Scene, draws: &'a [Draw], id: u32) -> Option<&'a Draw> {
    // Draws without triangles share their first id with the next draw, which is the last of the
    // prefix.
    let draw = &draws[..draws.partition_point(|draw| draw.first_triangle <= id)].last()?;
    (id - draw.first_triangle < scene.primitives[draw.primitive].triangle_count()).then_some(draw)
}

/// The view as an adapter drew it: the grid, the origin of positions and the render scale are
/// promises of its accuracy options, so the oracle adopts them. Positions that a far scene rounds as
/// they are stored keep no promise: they are judged by those relative to the eye.
pub fn drawn_view(view: &View, geometry: &Geometry) -> View {
    view.scaled(geometry.scale).with_grid(
        geometry.subpixel_bits,
        geometry.is_relative || view.precision.is_relative,
    )
}
