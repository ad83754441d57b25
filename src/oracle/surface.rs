//! Shading in f64: what the sample of an triangle id knows about its surface, and the effects on it.

use glam::{DMat3, DVec2, DVec3, DVec4};
use rayon::prelude::*;

use super::{
    coverage::{OrientedTriangle, corner_records, doubled_area, draw_of, is_back},
    deform::{normal, place},
    light::{Light, Place, error_bound_m},
    moved::{Corner, VertexEvaluator},
    order::ranks,
    project::gated_lane,
    steps::Nudge,
    texels::{Aside, Material, Shares},
};
use crate::{
    effects::{Stack, Surface, hooks::Shape},
    frame::{Geometry, SnappedVertex, vertex_flags},
    math::srgb,
    scene::{Accessor, Scene, draw::Draw, view::View},
};

/// Below this squared length, at unit scale, a vector has no direction.
pub(super) const DEGENERATE: f64 = 1e-12;

/// Surface colours of all pixels, given who owns them, with steps and textures as `nudge` says. Row-major,
/// gamma-encoded; `background` where nobody does.
///
/// `geometry` supplies the snapped corners that carry the weights; triangle ids that were cut are weighted in clip space.
pub fn surfaces(
    scene: &Scene,
    draws: &[Draw],
    view: &View,
    stack: &Stack,
    (triangle_ids, background): (&[u32], DVec4),
    geometry: &Geometry,
    nudge: Nudge,
) -> Vec<DVec4> {
    let ranks = ranks(scene, draws, view, stack, geometry);
    let light = Light::of(scene, view, stack, geometry);
    each_surface((scene, draws, view, stack), triangle_ids, geometry, nudge.aside, |found| {
        let Some((triangle, surface)) = found else { return background };
        let rank = ranks.get(surface.triangle_id as usize).copied().unwrap_or(0.0);
        let lit = light.as_ref().map_or(0.0, |light| light.arrives(&triangle.place(view, &surface), surface.triangle_id, nudge.step));
        encoded(stack.shade(Surface { rank, lit, nudge: nudge.step, ..surface }).color)
    })
}

/// Visits the surface of every pixel before any surface effect, given who owns it; none where nobody does. Row-major.
pub(super) fn each_surface<T: Send>(
    (scene, draws, view, stack): (&Scene, &[Draw], &View, &Stack),
    triangle_ids: &[u32],
    geometry: &Geometry,
    aside: Aside,
    visit: impl Fn(Option<(&Triangle, Surface)>) -> T + Sync,
) -> Vec<T> {
    let width = view.width.max(1) as usize;
    let row = |(y, triangle_ids): (usize, &[u32])| {
        let mut triangle: Option<Triangle> = None;
        let pixel = |(x, &triangle_id): (usize, &u32)| {
            if triangle.as_ref().is_none_or(|triangle| triangle.triangle_id != triangle_id) {
                triangle = draw_of(scene, draws, triangle_id)
                    .and_then(|draw| Triangle::new(&VertexEvaluator::new(scene, draw, view, stack), scene, view, geometry, triangle_id));
            }
            visit(triangle.as_ref().map(|triangle| (triangle, triangle.surface(view, x, y, aside))))
        };
        triangle_ids.iter().enumerate().map(pixel).collect::<Vec<_>>()
    };
    triangle_ids.par_chunks(width).enumerate().flat_map_iter(row).collect()
}

/// Linear RGBA as sRGB, each 0 to 1; alpha is not gamma-encoded.
pub(super) fn encoded(color: DVec4) -> DVec4 {
    DVec4::new(srgb(color.x), srgb(color.y), srgb(color.z), color.w.clamp(0.0, 1.0))
}

/// How a triangle's corners share a sample.
enum Weights {
    /// Snapped corners, x and y in pixels, with 1/w: perspective-correct from screen-space areas.
    Snapped([DVec3; 3]),
    /// Cross products of the other two corners' (x, y, w) in clip space, which weigh a sample even where w <= 0
    /// (Olano and Greer 1997); turned so that they are positive inside.
    /// With the sums of the magnitudes of their terms.
    Homogeneous([DVec3; 3], [DVec3; 3]),
}

/// All that does not change from sample to sample.
pub(super) struct Triangle<'a> {
    triangle_id: u32,
    weights: Weights,
    positions: [DVec3; 3],
    /// Mean of the corners before any vertex effect.
    center: DVec3,
    colors: [DVec4; 3],
    /// What its material is besides a base colour.
    paint: Option<Material<'a>>,
    /// In object space; none when a corner has no finite normal.
    normals: Option<[DVec3; 3]>,
    /// Takes object normals to the world's, of any length; turned over for a back face.
    world_from_normal: DMat3,
    /// Unit, world space; none when the triangle has no plane.
    flat_normal: Option<DVec3>,
    depths_m: [f64; 3],
    /// None where it lies behind the eye: then each sample takes its own place.
    center_screen: Option<DVec2>,
    shape: Shape,
    /// Where corners are drawn: their records, and the radius of their discs in units.
    disc: Option<([SnappedVertex; 3], i64)>,
}

impl<'a> Triangle<'a> {
    /// None for a triangle with a rejected corner, which owns nothing.
    pub fn new(vertex_evaluator: &VertexEvaluator, scene: &'a Scene, view: &View, geometry: &Geometry, triangle_id: u32) -> Option<Self> {
        let draw = vertex_evaluator.draw;
        let primitive = &scene.primitives[draw.primitive];
        let material = &scene.materials[primitive.material];
        let corners = primitive.corners(scene, triangle_id - draw.first_triangle);
        let [Ok(a), Ok(b), Ok(c)] = corners.map(|corner| place(scene, draw, corner)) else { return None };
        let object = [a, b, c];

        let records = corner_records(scene, draw, geometry, triangle_id);
        let is_cut = records.iter().any(|record| record.flags & vertex_flags::CLIPPED != 0);
        let places = corners.map(|vertex| Corner { vertex, triangle: triangle_id - draw.first_triangle });
        let screen = if is_cut { Screen::cut(vertex_evaluator, view, places) } else { Screen::snapped(&records, draw, view) };

        let base = DVec4::from_array(material.base_color.map(f64::from));
        let color = |corner| base * primitive.colors.map_or(DVec4::ONE, |colors| color(scene, &colors, corner));
        let [n0, n1, n2] = corners.map(|corner| normal(scene, draw, corner));
        let side = if material.double_sided && screen.is_back { -1.0 } else { 1.0 };
        let world_from_normal = inverse_transpose(DMat3::from_mat4(draw.world_from_object), draw.mirrored) * side;
        let mut triangle = Self {
            triangle_id,
            weights: screen.weights,
            center: draw.world_from_object.transform_point3(object.iter().sum::<DVec3>() / 3.0),
            positions: object.map(|position| draw.world_from_object.transform_point3(position)),
            colors: corners.map(color),
            paint: Material::of(scene, primitive, corners),
            normals: n0.zip(n1).zip(n2).map(|((n0, n1), n2)| [n0, n1, n2]),
            world_from_normal,
            flat_normal: plane_normal(object).and_then(|normal| (world_from_normal * normal).try_normalize()),
            depths_m: screen.depths_m,
            center_screen: screen.center,
            shape: vertex_evaluator.stack.shape(),
            disc: (vertex_evaluator.stack.shape() == Shape::Points).then_some((records, vertex_evaluator.stack.point_radius().into())),
        };
        if vertex_evaluator.moves {
            triangle.follow(vertex_evaluator, places, side);
        }
        Some(triangle)
    }

    /// Takes positions and normals to where the vertex effects move the corners; `side` turns normals to the viewer. The
    /// centre stays where it was, so that fronts of several effects meet.
    ///
    /// A triangle that is only carried along keeps its plane, and normals that no effect turns stay what they were.
    fn follow(&mut self, vertex_evaluator: &VertexEvaluator, corners: [Corner; 3], side: f64) {
        let moved = corners.map(|corner| vertex_evaluator.moved(corner));
        for (position, vertex) in self.positions.iter_mut().zip(&moved) {
            *position += vertex.offset;
        }
        if moved.iter().any(|vertex| vertex.offset != moved[0].offset) {
            let side = if vertex_evaluator.draw.mirrored { -side } else { side };
            self.flat_normal = plane_normal(self.positions).and_then(|normal| (normal * side).try_normalize());
        }
        let is_turned = moved.iter().zip(corners).any(|(vertex, corner)| vertex.normal != vertex_evaluator.still(corner).normal);
        if is_turned && self.normals.is_some() {
            // Turned normals keep the lengths by which the file weighs them.
            self.normals = Some([0, 1, 2].map(|k| moved[k].normal * vertex_evaluator.world_normal(corners[k].vertex).length()));
            self.world_from_normal = DMat3::from_diagonal(DVec3::splat(side));
        }
    }

    /// The surface at the centre of a pixel, its textures looked up aside.
    pub fn surface(&self, view: &View, x: usize, y: usize, aside: Aside) -> Surface {
        let pixel = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let screen = pixel / DVec2::new(view.width.into(), view.height.into());
        let corner = self.disc.and_then(|(records, radius)| {
            let at = pixel * f64::from(view.units_per_pixel());
            OrientedTriangle::clockwise(self.triangle_id, records).corner_under(at.x as i64, at.y as i64, radius)
        });
        let weights = self.weights.at(pixel, screen, self.shape, corner);
        let (shares, edge_distance_px) = self.weights.on_screen(pixel, screen, view, self.shape, corner);
        let depth_m = mixed(weights, self.depths_m);
        // Not the corners' mean: their weights are those of snapped corners, which puts it aside by up to half a unit.
        let position = on_ray(view, screen, depth_m);
        let toward_eye = match view.linear_depth_m {
            Some(_) => -view.forward,
            None => (view.eye - position).try_normalize().unwrap_or(-view.forward),
        };
        let smooth = self.normals.and_then(|normals| self.smooth_normal(weights, normals));
        let normal = smooth.or(self.flat_normal).unwrap_or(toward_eye);
        let base = mixed(weights, self.colors);
        let painted = self.paint.as_ref().map(|paint| paint.seen(base.truncate(), &self.shares(weights, pixel, screen, view), aside));
        let (color, glow) = painted.unwrap_or((base.truncate(), DVec3::ZERO));
        Surface {
            color: color.extend(base.w),
            glow,
            position,
            normal,
            flat_normal: self.flat_normal.unwrap_or(normal),
            view: toward_eye,
            center: self.center,
            center_screen: self.center_screen.unwrap_or(screen),
            screen,
            pixel,
            barycentrics: shares,
            edge_distance_px,
            depth_m,
            pixel_size_m: view.ndc_axes[1].length() * 2.0 / f64::from(view.height)
                * if view.linear_depth_m.is_some() { 1.0 } else { depth_m },
            flat_depth_m: self.depths_m.iter().sum::<f64>() / 3.0,
            depth_range_m: DVec2::from_array(view.scene_range_m),
            triangle_id: self.triangle_id,
            rank: 0.0,
            lit: 0.0,
            nudge: 0.0,
        }
    }

    /// How the corners share a pixel's centre. Of boxes and discs the shares are taken not to change.
    fn shares(&self, weights: [f64; 3], pixel: DVec2, screen: DVec2, view: &View) -> Shares {
        let slopes = if self.shape == Shape::Triangles { self.weights.slopes(weights, pixel, screen, view) } else { [[0.0; 3]; 2] };
        Shares { weights, slopes, doubts: self.weights.doubts(weights, screen) }
    }

    /// Where a sample with such a surface lies, for a light.
    pub fn place(&self, view: &View, surface: &Surface) -> Place {
        let position = surface.position;
        let on_triangle = match self.shape {
            Shape::Triangles => mixed(self.weights.at(surface.pixel, surface.screen, self.shape, None), self.positions),
            // Beyond the triangle only the ray of the pixel says where.
            Shape::Boxes | Shape::Points => position,
        };
        let is_cut = matches!(self.weights, Weights::Homogeneous(..));
        Place { position, surface: on_triangle, flat_normal: surface.flat_normal, error_bound_m: error_bound_m(view, position, is_cut) }
    }

    /// Interpolated in object space; none when the corner normals cancel out.
    fn smooth_normal(&self, weights: [f64; 3], normals: [DVec3; 3]) -> Option<DVec3> {
        let largest = normals.iter().map(|normal| normal.abs().max_element()).fold(0.0, f64::max);
        let normal = mixed(weights, normals) / largest;
        // A division by zero fails the comparison, too.
        if normal.length_squared() >= DEGENERATE { (self.world_from_normal * normal).try_normalize() } else { None }
    }
}

/// Where the middle of a triangle of the mover's draw stands in the picture, from 0 to 1; the middle of the picture where
/// it lies behind the eye.
pub(super) fn center_screen(vertex_evaluator: &VertexEvaluator, view: &View, records: &[SnappedVertex; 3], corners: [Corner; 3]) -> DVec2 {
    let is_cut = records.iter().any(|record| record.flags & vertex_flags::CLIPPED != 0);
    let screen = if is_cut { Screen::cut(vertex_evaluator, view, corners) } else { Screen::snapped(records, vertex_evaluator.draw, view) };
    screen.center.unwrap_or(DVec2::splat(0.5))
}

/// What a triangle's place on the screen determines.
struct Screen {
    weights: Weights,
    is_back: bool,
    depths_m: [f64; 3],
    center: Option<DVec2>,
}

impl Screen {
    fn snapped(records: &[SnappedVertex; 3], draw: &Draw, view: &View) -> Self {
        let (size, unit) = (DVec2::new(view.width.into(), view.height.into()), f64::from(view.units_per_pixel()));
        let pixels = records.map(|r| DVec2::new(r.x.into(), r.y.into()) / unit);
        let places = pixels.map(|at| at / size);
        let w = records.map(|r| 1.0 / f64::from(r.inv_w));
        let depth_m = |i: usize| linear_depth(view, f64::from(records[i].depth)).unwrap_or(w[i]);
        Self {
            weights: Weights::Snapped([0, 1, 2].map(|k| pixels[k].extend(records[k].inv_w.into()))),
            is_back: is_back(doubled_area(records), draw),
            depths_m: [0, 1, 2].map(depth_m),
            center: Some((places[0] * w[0] + places[1] * w[1] + places[2] * w[2]) / (w[0] + w[1] + w[2])),
        }
    }

    fn cut(vertex_evaluator: &VertexEvaluator, view: &View, corners: [Corner; 3]) -> Self {
        let clip = corners.map(|corner| vertex_evaluator.clip(corner).expect("positions have passed the gate"));
        let v = clip.map(|p| DVec3::new(p.x, p.y, p.w));
        let sum = v[0] + v[1] + v[2];
        let rows = [v[1].cross(v[2]), v[2].cross(v[0]), v[0].cross(v[1])];
        let terms = cross_terms(&v);
        // y points up in clip space: a negative determinant runs clockwise on screen.
        let is_clockwise = v[0].dot(rows[0]) < 0.0;
        Self {
            weights: Weights::Homogeneous(if is_clockwise { rows.map(|row| -row) } else { rows }, terms),
            is_back: is_clockwise != vertex_evaluator.draw.mirrored,
            depths_m: clip.map(|p| linear_depth(view, p.z / p.w).unwrap_or(p.w)),
            center: (sum.z > 0.0).then(|| DVec2::new(0.5 + 0.5 * sum.x / sum.z, 0.5 - 0.5 * sum.y / sum.z)),
        }
    }
}

/// Sums of the magnitudes of the terms of the cross products of the other two.
pub(super) fn cross_terms(v: &[DVec3; 3]) -> [DVec3; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j): (usize, usize)| {
        let (a, b) = (v[i].abs(), v[j].abs());
        DVec3::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x)
    })
}

/// Metres of an orthographic depth; none in a perspective.
fn linear_depth(view: &View, depth: f64) -> Option<f64> {
    view.linear_depth_m.map(|[near, far]| far + depth * (near - far))
}

impl Weights {
    /// Shares of the corners at a pixel's centre, summing to 1; equal shares where the triangle has no extent. In a box no
    /// share turns negative, and a disc is all its `corner`'s.
    fn at(&self, pixel: DVec2, screen: DVec2, shape: Shape, corner: Option<usize>) -> [f64; 3] {
        let shares = match self {
            Self::Snapped(corners) => {
                let areas = areas(corners, pixel, shape, corner);
                [0, 1, 2].map(|k| areas[k] * corners[k].z)
            }
            Self::Homogeneous(rows, _) => {
                let p = DVec3::new(2.0 * screen.x - 1.0, 1.0 - 2.0 * screen.y, 1.0);
                // A snapped piece may own a sample a hair outside, where near a horizon the sum would vanish.
                rows.map(|row| p.dot(row).max(0.0))
            }
        };
        let sum: f64 = shares.iter().sum();
        let weights = shares.map(|share| share / sum);
        if weights.iter().all(|weight| weight.is_finite()) { weights } else { [1.0 / 3.0; 3] }
    }

    /// How far an f32 renderer's weights may be off.
    fn doubts(&self, weights: [f64; 3], screen: DVec2) -> [f64; 3] {
        // Fifteen roundings of numbers of one sign.
        const WHOLE: f64 = 15.0 / (1 << 23) as f64;
        match self {
            Self::Snapped(_) => weights.map(|weight| weight * WHOLE),
            Self::Homogeneous(rows, terms) => {
                let p = DVec3::new(2.0 * screen.x - 1.0, 1.0 - 2.0 * screen.y, 1.0);
                let sum: f64 = rows.iter().map(|row| p.dot(*row)).sum();
                // Terms of either sign: an error is proportional to them and not to what they come to.
                terms.map(|terms| p.abs().dot(terms) / sum.abs() / f64::from(1 << 20))
            }
        }
    }

    /// How `weights` change from a pixel to the next on the right, and to the next below. Each is a share of a sum, and shares
    /// run linearly over the screen.
    fn slopes(&self, weights: [f64; 3], pixel: DVec2, screen: DVec2, view: &View) -> [[f64; 3]; 2] {
        let (shares, steps) = match self {
            Self::Snapped(corners) => {
                let at = |pixel: DVec2| {
                    let [a, b, c] = corners.map(|corner| corner.truncate() - pixel);
                    let areas = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
                    DVec3::from([0, 1, 2].map(|k| areas[k] * corners[k].z))
                };
                let here = at(pixel);
                (here, [DVec2::X, DVec2::Y].map(|step| at(pixel + step) - here))
            }
            Self::Homogeneous(rows, _) => {
                let p = DVec3::new(2.0 * screen.x - 1.0, 1.0 - 2.0 * screen.y, 1.0);
                let shares = DVec3::from(rows.map(|row| p.dot(row)));
                let right = DVec3::from(rows.map(|row| row.x * 2.0 / f64::from(view.width)));
                (shares, [right, DVec3::from(rows.map(|row| row.y * -2.0 / f64::from(view.height)))])
            }
        };
        let (weights, sum) = (DVec3::from(weights), shares.element_sum());
        steps.map(|step| ((step - weights * step.element_sum()) / sum).to_array())
    }

    /// Shares of the corners on the screen (on its plane, of a triangle that was cut), and the distances of a pixel's
    /// centre from the edges opposite the corners, pixels.
    fn on_screen(&self, pixel: DVec2, screen: DVec2, view: &View, shape: Shape, corner: Option<usize>) -> (DVec3, DVec3) {
        match self {
            Self::Snapped(corners) => {
                let [a, b, c] = corners.map(|corner| corner.truncate());
                let areas = areas(corners, pixel, shape, corner);
                let lengths = [(b, c), (c, a), (a, b)].map(|(from, to)| (to - from).length());
                let sum: f64 = areas.iter().sum();
                let edge_distance_px = [0, 1, 2].map(|k| areas[k] / lengths[k]);
                (DVec3::from_array(areas) / sum, DVec3::from_array(edge_distance_px))
            }
            Self::Homogeneous(rows, _) => {
                let p = DVec3::new(2.0 * screen.x - 1.0, 1.0 - 2.0 * screen.y, 1.0);
                let steps = DVec2::new(2.0 / f64::from(view.width), 2.0 / f64::from(view.height));
                let edge_distance_px = rows.map(|row| p.dot(row).abs() / (row.truncate() * steps).length().max(1e-30));
                (DVec3::from_array(self.at(pixel, screen, shape, corner)), DVec3::from_array(edge_distance_px))
            }
        }
    }
}

/// Doubled areas opposite the corners at a pixel's centre, positive inside whichever way the triangle runs.
fn areas(corners: &[DVec3; 3], pixel: DVec2, shape: Shape, corner: Option<usize>) -> [f64; 3] {
    let [a, b, c] = corners.map(|corner| corner.truncate() - pixel);
    let areas = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
    let turn = areas.iter().sum::<f64>().signum();
    match (shape, corner) {
        (Shape::Points, Some(corner)) => [0, 1, 2].map(|k| f64::from(u8::from(k == corner))),
        (Shape::Boxes, _) => areas.map(|area| (area * turn).max(0.0)),
        _ => areas.map(|area| area * turn),
    }
}

/// The point of the ray through a place of the picture at a depth along the viewing direction.
fn on_ray(view: &View, screen: DVec2, depth_m: f64) -> DVec3 {
    let aside = view.ndc_axes[0] * (2.0 * screen.x - 1.0) + view.ndc_axes[1] * (1.0 - 2.0 * screen.y);
    match view.linear_depth_m {
        None => view.eye + (view.forward + aside) * depth_m,
        Some(_) => view.eye + aside + view.forward * depth_m,
    }
}

fn mixed<T: std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>>(weights: [f64; 3], [a, b, c]: [T; 3]) -> T {
    a * weights[0] + b * weights[1] + c * weights[2]
}

/// Linear RGBA of a vertex, opaque where it has three lanes; white when a lane is refused.
fn color(scene: &Scene, colors: &Accessor, vertex: u32) -> DVec4 {
    let lane = |lane: u32| if lane < colors.components { gated_lane(&scene.vertex_bytes, colors, vertex, lane) } else { Ok(1.0) };
    match [0, 1, 2, 3].map(lane) {
        [Ok(r), Ok(g), Ok(b), Ok(a)] => DVec4::new(r, g, b, a),
        _ => DVec4::ONE,
    }
}

/// Normal of the plane through three points, counterclockwise outward, of any length; none for a needle or a point.
pub(super) fn plane_normal([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    let [u, v] = [b - a, c - a].map(|edge| edge / edge.abs().max_element());
    let normal = u.cross(v);
    // False for NaN, which an edge of no length makes.
    (normal.length_squared() >= DEGENERATE).then_some(normal)
}

/// What takes normals where `m` takes points, up to a positive factor: cofactors, turned over by a mirror.
pub(super) fn inverse_transpose(m: DMat3, mirrored: bool) -> DMat3 {
    let cofactors = DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
    let largest = cofactors.to_cols_array().into_iter().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
    let scale = if largest > 0.0 { 1.0 / largest } else { 0.0 };
    cofactors * if mirrored { -scale } else { scale }
}
