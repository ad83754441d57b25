//! Corners as the vertex effects leave them, in f64, and how far a float renderer may be from that.

use glam::{DMat3, DVec2, DVec3};

use super::{
    deform::{self, Bounded},
    project::{Clip, clip_position},
    surface::{DEGENERATE, inverse_transpose, plane_normal},
};
use crate::{
    effects::{
        Stack,
        hooks::{ErrorBound, ROUNDING, Vertex},
    },
    math::rounded_columns,
    scene::{
        Scene,
        draw::{Draw, MAX_MAGNITUDE},
        view::View,
    },
};

/// A corner of a draw's triangle, both counted within the draw. Where triangles share vertices, any triangle will do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub vertex: u32,
    pub triangle: u32,
}

/// Places the corners of one draw.
pub(super) struct VertexEvaluator<'a> {
    scene: &'a Scene,
    pub draw: &'a Draw,
    pub stack: &'a Stack,
    pub moves: bool,
    /// Every triangle has three records to itself.
    has_unshared_vertices: bool,
    /// Rounded once, so that every judge starts from these bits.
    clip_from_world: [[f64; 4]; 4],
    world_from_normal: DMat3,
    /// Of the picture that a light's view is drawn for, rounded as above.
    picture_from_world: Option<[[f64; 4]; 4]>,
}

impl<'a> VertexEvaluator<'a> {
    pub fn new(scene: &'a Scene, draw: &'a Draw, view: &'a View, stack: &'a Stack) -> Self {
        Self {
            scene,
            draw,
            stack,
            moves: stack.moves(),
            has_unshared_vertices: stack.unshares_vertices(),
            clip_from_world: rounded_columns(&view.clip_from_world).map(|column| column.map(f64::from)),
            world_from_normal: inverse_transpose(DMat3::from_mat4(draw.world_from_object), draw.mirrored),
            picture_from_world: view.picture_from_world.map(|matrix| rounded_columns(&matrix).map(|column| column.map(f64::from))),
        }
    }

    /// Where a place of the world stands in the picture that a light's view is drawn for, its middle where that is behind the
    /// eye; none in a picture itself.
    pub fn in_picture(&self, place: DVec3) -> Option<DVec2> {
        let [x, y, _, w] = self.picture_rows(place, false)?;
        Some(if w > 0.0 { DVec2::new(0.5 + 0.5 * x / w, 0.5 - 0.5 * y / w) } else { DVec2::splat(0.5) })
    }

    /// Rows of that picture's matrix times a place, or the sums of the magnitudes of their terms.
    fn picture_rows(&self, p: DVec3, magnitudes: bool) -> Option<[f64; 4]> {
        let m = self.picture_from_world?;
        let sign = |v: f64| if magnitudes { v.abs() } else { v };
        Some([0, 1, 2, 3].map(|r| sign(m[0][r] * p.x) + sign(m[1][r] * p.y) + sign(m[2][r] * p.z) + sign(m[3][r])))
    }

    /// The corner of every record of this draw, in order.
    pub fn corners(&self) -> Vec<Corner> {
        let primitive = &self.scene.primitives[self.draw.primitive];
        if !self.has_unshared_vertices {
            return (0..primitive.vertex_count()).map(|vertex| Corner { vertex, triangle: 0 }).collect();
        }
        let corners = |triangle| primitive.corners(self.scene, triangle).map(|vertex| Corner { vertex, triangle });
        (0..primitive.triangle_count()).flat_map(corners).collect()
    }

    /// Place of this draw's first record in the geometry.
    pub fn first_record(&self) -> usize {
        if self.has_unshared_vertices { 3 * self.draw.first_triangle as usize } else { self.draw.first_vertex as usize }
    }

    /// Position in clip space after all effects, or why it was refused.
    pub fn clip(&self, corner: Corner) -> Result<Clip, u32> {
        let still = clip_position(self.scene, self.draw, corner.vertex)?;
        if !self.moves {
            return Ok(still);
        }
        let o = self.moved(corner).offset;
        let row = |r: usize| [0, 1, 2].map(|axis| self.clip_from_world[axis][r] * o[axis]).iter().sum::<f64>();
        // What passes the far plane of parallel rays is held on it: depths below 0 are none.
        Ok(Clip { x: still.x + row(0), y: still.y + row(1), z: (still.z + row(2)).max(0.0), w: still.w + row(3) })
    }

    /// What the effects make of a corner; its movement is held below 2^40 m, as every coordinate is.
    pub fn moved(&self, corner: Corner) -> Vertex {
        let mut vertex = self.stack.moved(self.still(corner));
        vertex.offset = held(vertex.offset);
        vertex
    }

    /// A corner before any effect.
    pub fn still(&self, corner: Corner) -> Vertex {
        let object = self.place(corner.vertex);
        let position = held(self.draw.world_from_object.transform_point3(object));
        let normal = direction(self.world_from_normal * self.normal(corner.vertex));
        let alone = Vertex {
            position,
            offset: DVec3::ZERO,
            normal,
            flat_normal: DVec3::ZERO,
            center: position,
            arm: DVec3::ZERO,
            center_screen: DVec2::ZERO,
            triangle: 0,
        };
        if self.has_unshared_vertices { self.with_triangle(alone, corner, object) } else { alone }
    }

    /// Adds what effects may know of a corner's triangle.
    fn with_triangle(&self, alone: Vertex, corner: Corner, object: DVec3) -> Vertex {
        let corners = self.triangle_places(corner);
        let middle = corners.iter().sum::<DVec3>() / 3.0;
        let [x, y, _, w] = self.clip_rows(middle - self.draw.origin(), false);
        let center = held(self.draw.world_from_object.transform_point3(middle));
        let own = if w > 0.0 { DVec2::new(0.5 + 0.5 * x / w, 0.5 - 0.5 * y / w) } else { DVec2::splat(0.5) };
        Vertex {
            flat_normal: plane_normal(corners).map_or(DVec3::ZERO, |normal| direction(self.world_from_normal * normal)),
            center,
            arm: self.draw.world_from_object.transform_vector3(object - middle),
            center_screen: self.in_picture(center).unwrap_or(own),
            triangle: self.draw.first_triangle + corner.triangle,
            ..alone
        }
    }

    /// The three corners of a corner's triangle in object space.
    fn triangle_places(&self, corner: Corner) -> [DVec3; 3] {
        let primitive = &self.scene.primitives[self.draw.primitive];
        primitive.corners(self.scene, corner.triangle).map(|vertex| self.place(vertex))
    }

    /// Largest errors of those corners.
    fn triangle_errors(&self, corner: Corner) -> DVec3 {
        let primitive = &self.scene.primitives[self.draw.primitive];
        let errors = primitive.corners(self.scene, corner.triangle).map(|vertex| self.bounded_place(vertex).error);
        errors[0].max(errors[1]).max(errors[2])
    }

    /// A vertex in object space; the origin where a lane is refused.
    fn place(&self, vertex: u32) -> DVec3 {
        self.bounded_place(vertex).value
    }

    fn bounded_place(&self, vertex: u32) -> Bounded {
        deform::bounded_place(self.scene, self.draw, vertex).unwrap_or_default()
    }

    /// A normal in object space; zero where a lane is refused.
    fn normal(&self, vertex: u32) -> DVec3 {
        deform::normal(self.scene, self.draw, vertex).unwrap_or_default()
    }

    /// The stored normal in the world, of any length.
    pub fn world_normal(&self, vertex: u32) -> DVec3 {
        self.world_from_normal * self.normal(vertex)
    }

    /// Rows of the clip matrix times a point, already taken from the draw's origin, or the sums of the magnitudes of their
    /// terms.
    fn clip_rows(&self, p: DVec3, magnitudes: bool) -> [f64; 4] {
        let sign = |v: f64| if magnitudes { v.abs() } else { v };
        [0, 1, 2, 3].map(|r| {
            let m = |column: usize| f64::from(self.draw.clip_from_object[column][r]);
            sign(m(0) * p.x) + sign(m(1) * p.y) + sign(m(2) * p.z) + sign(m(3))
        })
    }
}

/// Errors of a float renderer.
impl VertexEvaluator<'_> {
    /// Sums of magnitudes of the terms of each clip coordinate, and bounds of their errors: rounding errors are
    /// proportional to the terms, however much cancels, and what the effects err by comes on top.
    pub fn clip_errors(&self, corner: Corner) -> ([f64; 4], [f64; 4]) {
        let place = self.bounded_place(corner.vertex);
        let mut sums = self.clip_rows(place.value - self.draw.origin(), true);
        // Taking it from an origin rounds once more.
        let steps = if self.draw.origin == [0.0; 3] { 4.0 } else { 5.0 };
        // What bending errs by, an error of the position that every row takes along.
        let deformed = [0, 1, 2, 3].map(|r| {
            [0, 1, 2].map(|axis| f64::from(self.draw.clip_from_object[axis][r]).abs() * place.error[axis]).iter().sum::<f64>()
                * (17.0 / 16.0)
        });
        let (error_bound, offset) = if self.moves { self.offset_slack(corner) } else { (0.0, DVec3::ZERO) };
        if error_bound == 0.0 && offset == DVec3::ZERO {
            return (sums, [0, 1, 2, 3].map(|r| steps * ROUNDING * sums[r] + deformed[r]));
        }
        let errors = [0, 1, 2, 3].map(|r| {
            let row = [0, 1, 2].map(|axis| self.clip_from_world[axis][r].abs());
            sums[r] += row[0] * offset.x.abs() + row[1] * offset.y.abs() + row[2] * offset.z.abs();
            // Three products more, in whatever order they are added; a sixteenth for what is of second order in the quotient.
            ((steps + 3.0) * ROUNDING * sums[r] + error_bound * (row[0] + row[1] + row[2])) * (16.0 / 15.0) + deformed[r]
        });
        (sums, errors)
    }

    /// How far what the effects err by may carry a corner over the picture where it is cut, at depth `w`: in half pictures.
    pub fn wander(&self, corner: Corner, w: f64) -> f64 {
        if !self.moves {
            return 0.0;
        }
        let row = |r: usize| [0, 1, 2].map(|axis| self.clip_from_world[axis][r].abs()).iter().sum::<f64>();
        self.offset_slack(corner).0 * (row(0).max(row(1)) + row(3)) / w
    }

    fn offset_slack(&self, corner: Corner) -> (f64, DVec3) {
        let still = self.still(corner);
        (self.stack.error_bound(still, self.still_slack(corner)).offset_m, self.stack.moved(still).offset)
    }

    /// How far a corner of a float renderer may be from [`VertexEvaluator::still`].
    fn still_slack(&self, corner: Corner) -> ErrorBound {
        let m = self.draw.world_from_object;
        let magnitude = |p: DVec3| {
            let terms = m.x_axis.abs() * p.x.abs() + m.y_axis.abs() * p.y.abs() + m.z_axis.abs() * p.z.abs();
            terms.truncate()
        };
        let place = |p: DVec3| (magnitude(p) + m.w_axis.abs().truncate()).max_element();
        let here = self.bounded_place(corner.vertex);
        let deformed = |error: DVec3| magnitude(error).max_element();
        // The matrix is rounded, then four products are added.
        let position_m = 5.0 * ROUNDING * place(here.value) + deformed(here.error);
        let stored = deform::bounded_normal(self.scene, self.draw, corner.vertex).unwrap_or_default();
        let normal = self.direction_slack(stored.value, stored.error);
        if !self.has_unshared_vertices {
            return ErrorBound { position_m, normal, center_m: position_m, ..ErrorBound::default() };
        }
        let corners = self.triangle_places(corner);
        let middle = corners.iter().map(|c| c.abs()).sum::<DVec3>() / 3.0;
        let edges = corners.iter().map(|c| (here.value - c).abs()).sum::<DVec3>() / 3.0;
        let error = self.triangle_errors(corner);
        let center_screen = self.screen_slack(corners.iter().sum::<DVec3>() / 3.0, middle, error);
        ErrorBound {
            position_m,
            normal,
            center_m: 10.0 * ROUNDING * place(middle) + deformed(error),
            arm_m: 12.0 * ROUNDING * magnitude(edges).max_element() + 2.0 * deformed(error),
            center_screen,
            flat_normal: self.plane_slack(corners, error.max_element()),
            offset_m: 0.0,
        }
    }

    /// Error of the direction of a normal that is taken to the world, itself known to within `given`.
    fn direction_slack(&self, normal: DVec3, given: DVec3) -> f64 {
        let n = self.world_from_normal;
        let spread = |v: DVec3| n.x_axis.abs() * v.x + n.y_axis.abs() * v.y + n.z_axis.abs() * v.z;
        let error = spread(given) + 4.0 * ROUNDING * spread(normal.abs());
        if error == DVec3::ZERO {
            return 0.0;
        }
        let (length, error) = ((n * normal).length(), error.length() + 4.0 * f64::from(f32::MIN_POSITIVE));
        if error < 0.5 * length { error / (length - error) + 10.0 * ROUNDING } else { 2.0 }
    }

    /// Error of the direction of a triangle's plane: large for needles, 2 where even its being a plane is in doubt.
    /// Corners are known to within `given`.
    fn plane_slack(&self, [a, b, c]: [DVec3; 3], given: f64) -> f64 {
        let (ab, ac) = (b - a, c - a);
        let (long, wide) = (ab.abs().max_element(), ac.abs().max_element());
        if long == 0.0 || wide == 0.0 {
            return 0.0;
        }
        if long.min(wide) < 1e-36 {
            return 2.0;
        }
        let (u, v) = (ab / long, ac / wide);
        let term = |i: usize, j: usize| (u[i] * v[j]).abs() + (u[j] * v[i]).abs();
        // An edge errs by as much as both its ends, before it is scaled.
        let edges = 5.0 * given * (1.0 / long + 1.0 / wide);
        let error = 9.0 * ROUNDING * DVec3::new(term(1, 2), term(2, 0), term(0, 1)) + edges;
        let (normal, length) = (u.cross(v), u.cross(v).length());
        let doubt = 2.0 * length * error.length() + error.length_squared() + 8.0 * ROUNDING * length * length;
        match length * length - DEGENERATE {
            over if over.abs() <= doubt => 2.0,
            over if over < 0.0 => 0.0,
            _ => self.direction_slack(normal, error),
        }
    }

    /// Error of the place of a triangle's middle in the picture; beyond all bounds where it may lie behind the eye.
    fn screen_slack(&self, middle: DVec3, magnitudes: DVec3, given: DVec3) -> f64 {
        let origin = self.draw.origin();
        let ([x, y, _, w], sums) = (self.clip_rows(middle - origin, false), self.clip_rows(magnitudes + origin.abs(), true));
        let deformed =
            |r: usize| [0, 1, 2].map(|axis| f64::from(self.draw.clip_from_object[axis][r]).abs() * given[axis]).iter().sum::<f64>();
        // An error of the corners counts as a rounding of the sums does.
        let mut sums = [0, 1, 2, 3].map(|r| sums[r] + deformed(r) / (8.0 * ROUNDING));
        let mut rows = [x, y, w];
        // In the picture for which a light looks: the place in the world is rounded first.
        let world = self.draw.world_from_object;
        let reach = |v: DVec3| (world.x_axis.abs() * v.x + world.y_axis.abs() * v.y + world.z_axis.abs() * v.z).truncate();
        let magnitude = reach(magnitudes) + world.w_axis.abs().truncate() + reach(given) / (8.0 * ROUNDING);
        if let (Some([x, y, _, w]), Some(picture)) =
            (self.picture_rows(world.transform_point3(middle), false), self.picture_rows(magnitude, true))
        {
            (rows, sums) = ([x, y, w], picture.map(|sum| 2.0 * sum));
        }
        let ([x, y, w], [sx, sy, _, sw]) = (rows, sums);
        let error_w = 10.0 * ROUNDING * sw;
        if w.abs() <= error_w {
            return f64::INFINITY;
        }
        let error = |c: f64, s: f64| (10.0 * ROUNDING * s + (error_w + 6.0 * ROUNDING * w.abs()) * (c / w).abs()) / (w.abs() - error_w);
        if w < 0.0 { 0.0 } else { 0.5 * error(x, sx).max(error(y, sy)) + 2.0 * ROUNDING }
    }
}

fn direction(v: DVec3) -> DVec3 {
    v.try_normalize().unwrap_or(DVec3::ZERO)
}

/// Held within ±2^40 m per axis, so that no later product overflows a float.
fn held(v: DVec3) -> DVec3 {
    v.clamp(DVec3::splat(-MAX_MAGNITUDE), DVec3::splat(MAX_MAGNITUDE))
}
