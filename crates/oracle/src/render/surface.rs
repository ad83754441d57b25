//! What is known of the surface at a sample, in f64 (`docs/exactness.md` §7).

use glam::{DMat3, DVec2, DVec3, DVec4};

use super::{
    super::{
        arithmetic::{
            bits,
            vector::{DEGENERATE, direction, plane_normal},
        },
        perturbation::Perturbation,
        shot::Shot,
    },
    deform,
    material::{SampleWeights, TriangleMaterial},
    screen::ScreenTriangle,
    shadow::LitPoint,
    tangents::Tangents,
    triangles::OrientedTriangle,
    vertex::{Corner, VertexEvaluator},
    weights::{SamplePoint, Weights},
};
use crate::{
    effects::{
        Surface,
        hooks::{Finish, ROUNDING, Shape, Transmission},
    },
    frame::{Geometry, SnappedVertex},
    scene::{Accessor, Scene, view::View},
};

/// Everything about a triangle's surface that does not change from sample to sample.
pub struct SurfaceTriangle<'a> {
    pub id: u32,
    /// Those of its draw.
    pub scopes: u32,
    /// Its draw is glass.
    pub is_glass: bool,
    view: &'a View,
    weights: Weights,
    positions: [DVec3; 3],
    /// Mean of the corners before any vertex effect.
    center: DVec3,
    colors: [DVec4; 3],
    finish: Finish,
    /// What passes through its material, where it is drawn as glass.
    transmission: Option<Transmission>,
    /// None for a material that is only a base color.
    material: Option<TriangleMaterial<'a>>,
    /// In object space; none if a corner has no finite normal.
    normals: Option<[DVec3; 3]>,
    /// Transforms object normals to world space, of any length; negated for a back face.
    world_from_normal: DMat3,
    /// Unit, world space; none if the triangle has no plane.
    flat_normal: Option<DVec3>,
    depths_m: [f64; 3],
    /// None behind the eye: then each sample uses its own position.
    center_screen: Option<DVec2>,
    shape: Shape,
    /// If corners are drawn as points: their records, and the radius of their discs in sub-pixel
    /// units.
    points: Option<([SnappedVertex; 3], i64)>,
    /// The plane is that of displaced corners.
    is_deformed: bool,
    /// None where no texture turns its normals.
    tangents: Option<Tangents>,
    /// It is a point, whose normal is turned to the viewer: scanners do not tell the sides apart.
    is_point: bool,
}

/// What the corners of a triangle mix at a sample.
pub struct Interpolation {
    pub weights: [f64; 3],
    /// Of the corners, as parts of that of the sample.
    pub depths: [f64; 3],
    /// Of the corners, world space, of any length; none if one has no finite normal.
    pub normals: Option<[DVec3; 3]>,
    /// Linear RGBA of the corners.
    pub colors: [DVec4; 3],
    /// The corners, if the plane is that of displaced ones, meters.
    pub displaced: Option<[DVec3; 3]>,
    /// Those of the corners where a texture turns the normal, with their [`Tangents::reach`].
    pub tangents: Option<(Tangents, [f64; 2])>,
}

impl<'a> SurfaceTriangle<'a> {
    /// Triangle `id`; none if there is no such triangle, or if it has a rejected corner and so
    /// covers nothing.
    pub fn new(shot: &Shot<'a>, geometry: &Geometry, id: u32) -> Option<Self> {
        let Shot {
            scene, view, stack, ..
        } = *shot;
        let draw = shot.draw_of(id)?;
        let evaluator = VertexEvaluator::new(scene, draw, view, stack);
        let primitive = &scene.primitives[draw.primitive];
        let material = &scene.materials[primitive.material];
        let triangle = id - draw.first_triangle;
        let vertices = primitive.corners(scene, triangle);
        let [Ok(a), Ok(b), Ok(c)] = vertices.map(|vertex| deform::position(scene, draw, vertex))
        else {
            return None;
        };
        let object = [a, b, c];

        let records = shot.corner_records(draw, geometry, id);
        let corners = vertices.map(|vertex| Corner { vertex, triangle });
        let screen = ScreenTriangle::of(&evaluator, view, &records, corners);

        let base = DVec4::from_array(material.base_color.map(f64::from));
        let color = |vertex| {
            let color = base
                * primitive
                    .colors
                    .map_or(DVec4::ONE, |colors| color(scene, &colors, vertex));
            // Where no glass is drawn, what would blend is opaque.
            if material.is_blended && !draw.is_glass {
                color.truncate().extend(1.0)
            } else {
                color
            }
        };
        let [n0, n1, n2] = vertices.map(|vertex| deform::normal(scene, draw, vertex));
        let side = if material.double_sided && screen.is_back {
            -1.0
        } else {
            1.0
        };
        let world_from_normal = evaluator.world_from_normal * side;
        let mut triangle = Self {
            id,
            scopes: draw.scopes,
            is_glass: draw.is_glass,
            view,
            weights: screen.weights,
            center: draw
                .world_from_object
                .transform_point3(object.iter().sum::<DVec3>() / 3.0),
            positions: object.map(|position| draw.world_from_object.transform_point3(position)),
            colors: vertices.map(color),
            finish: Finish::from(material),
            transmission: Transmission::of(material).filter(|_| draw.is_glass),
            material: TriangleMaterial::of(scene, primitive, vertices),
            normals: n0
                .zip(n1)
                .zip(n2)
                .filter(|_| !draw.is_faceted)
                .map(|((n0, n1), n2)| [n0, n1, n2]),
            world_from_normal,
            flat_normal: plane_normal(object)
                .and_then(|normal| (world_from_normal * normal).try_normalize()),
            depths_m: screen.depths_m,
            center_screen: screen.center,
            shape: stack.shape(),
            points: (stack.shape() == Shape::Points)
                .then_some((records, stack.point_radius().into())),
            is_deformed: false,
            tangents: Tangents::of(shot, draw, triangle, object, side),
            is_point: primitive.is_points(),
        };
        if draw.is_uneven {
            // Each normal as long in the world as in object space.
            let even = |normal: DVec3| direction(world_from_normal * normal) * normal.length();
            triangle.normals = triangle.normals.map(|normals| normals.map(even));
            triangle.world_from_normal = DMat3::IDENTITY;
        }
        if evaluator.moves {
            triangle.apply_vertex_effects(&evaluator, corners, side);
        }
        Some(triangle)
    }

    /// Its global id.
    pub fn id(&self) -> u32 {
        self.id
    }

    /// Have all corners the same normal and the same color, and is there no image?
    pub fn is_flat(&self) -> bool {
        let has_one_normal = self.normals.is_some_and(|[a, b, c]| a == b && b == c);
        has_one_normal
            && self.colors.iter().all(|color| *color == self.colors[0])
            && self.material.is_none()
    }

    /// Moves positions and normals as the vertex effects do; `side` turns normals to the viewer.
    /// The center does not move, so that the fronts of several effects meet.
    ///
    /// A triangle whose corners are displaced alike keeps its plane, and normals that no effect
    /// changes keep their bits.
    fn apply_vertex_effects(
        &mut self,
        evaluator: &VertexEvaluator,
        corners: [Corner; 3],
        side: f64,
    ) {
        let moved = evaluator.moved_all(&corners);
        for (position, vertex) in self.positions.iter_mut().zip(&moved) {
            *position += vertex.offset;
        }
        if moved.iter().any(|vertex| vertex.offset != moved[0].offset) {
            self.is_deformed = true;
            let side = if evaluator.draw.mirrored { -side } else { side };
            self.flat_normal =
                plane_normal(self.positions).and_then(|normal| (normal * side).try_normalize());
        }
        let has_new_normals = moved
            .iter()
            .zip(corners)
            .any(|(vertex, corner)| vertex.normal != evaluator.unmoved(corner).normal);
        if has_new_normals && self.normals.is_some() {
            // The lengths of the file's normals weigh them in interpolation, so they are kept.
            self.normals = Some(
                [0, 1, 2].map(|k| moved[k].normal * evaluator.normal_weight(corners[k].vertex)),
            );
            self.world_from_normal = DMat3::from_diagonal(DVec3::splat(side));
        }
    }

    /// The surface at the center of a pixel.
    pub fn surface(&self, x: usize, y: usize, perturbation: &Perturbation) -> Surface {
        let view = self.view;
        let point = self.sample_point(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        let weights = self.weights.at(&point);
        let (barycentrics, edge_distance_px) = self.weights.on_screen(&point, view);
        let [x, y, z, along] = perturbation.place.map(|roundings| roundings * ROUNDING);
        let moved = perturbation.interpolated;
        let edge_distance_px = (edge_distance_px + moved.edge_distance_px).max(DVec3::ZERO);
        let depth_m = mix_values(weights, self.depths_m) * (1.0 + along) * (1.0 + moved.depth);
        // Where nothing is turned, the normal keeps its bits.
        let turned = |normal: DVec3, turn: DVec3| match turn {
            DVec3::ZERO => normal,
            turn => (normal + turn).try_normalize().unwrap_or(normal),
        };
        // Not the weighted mean of the corners: snapping moves that by up to half a sub-pixel unit.
        let position = on_ray(view, point.screen, depth_m);
        let position =
            position + DVec3::new(x, y, z) * (view.eye.abs() + (position - view.eye).abs());
        let toward_eye = match view.linear_depth_m {
            Some(_) => -view.forward,
            // Not from the position: where a clipped triangle covers a sample outside its plane's
            // visible part, that lies behind the eye.
            None => -(view.forward + across(view, point.screen)).normalize(),
        };
        let smooth = self
            .normals
            .and_then(|normals| self.smooth_normal(weights, normals))
            .map(
                |normal| match self.is_point && normal.dot(toward_eye) < 0.0 {
                    true => -normal,
                    false => normal,
                },
            );
        let side = if perturbation.is_turned { -1.0 } else { 1.0 };
        let flat_normal = self
            .flat_normal
            .map(|normal| turned(normal, moved.plane) * side);
        let unmapped = flat_normal
            .or(smooth.map(|normal| turned(normal, moved.normal) * side))
            .unwrap_or(toward_eye);
        let looked_up = self
            .material
            .as_ref()
            .map(|material| (material, self.sample_weights(weights, &point)));
        let bump = self.tangents.zip(
            looked_up
                .as_ref()
                .and_then(|(material, at)| material.bump(at, perturbation.texture)),
        );
        // The bound of a turned normal holds all that the surface's own normal may do to it.
        let mapped = |normal: DVec3| match bump {
            None => normal,
            Some((tangents, bump)) => tangents.turned(weights, normal, bump),
        };
        let normal = smooth
            .map(|normal| turned(mapped(normal), moved.normal) * side)
            .or(self
                .flat_normal
                .map(|normal| turned(mapped(normal), moved.plane) * side))
            .unwrap_or(toward_eye);
        let base = self.base_color(weights, moved.color);
        let textured = looked_up
            .as_ref()
            .map(|(material, at)| material.color(base.truncate(), at, perturbation.texture));
        let alpha = looked_up
            .as_ref()
            .filter(|_| self.is_glass)
            .map_or(1.0, |(material, at)| {
                material.alpha(at, perturbation.texture)
            });
        let (color, glow) = textured.unwrap_or((base.truncate(), DVec3::ZERO));
        let finish = looked_up.as_ref().map_or(self.finish, |(material, at)| {
            material.finish(self.finish, at, perturbation.texture)
        });
        let across_m = view.ndc_axes[1].length() * 2.0 / f64::from(view.height);
        let surface = Surface {
            color: color.extend(base.w * alpha),
            glow,
            position,
            normal,
            flat_normal: unmapped,
            view: toward_eye,
            center: self.center,
            center_screen: self.center_screen.unwrap_or(point.screen),
            screen: point.screen,
            pixel: point.pixel,
            barycentrics,
            edge_distance_px,
            depth_m,
            pixel_size_m: across_m
                * if view.linear_depth_m.is_some() {
                    1.0
                } else {
                    depth_m
                },
            flat_depth_m: self.depths_m.iter().sum::<f64>() / 3.0,
            depth_range_m: DVec2::from_array(view.content_depth_m),
            triangle_id: self.id,
            rank: 0.0,
            lit: 0.0,
            finish,
            passed: DVec3::ZERO,
            step_offset: 0.0,
        };
        self.transmission
            .map_or(surface, |transmission| transmission.through(surface))
    }

    /// What is interpolated at the center of a pixel, and from what.
    pub fn interpolation(&self, x: usize, y: usize) -> Interpolation {
        let point = self.sample_point(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        let weights = self.weights.at(&point);
        let depth_m = mix_values(weights, self.depths_m);
        Interpolation {
            weights,
            depths: self.depths_m.map(|depth| depth / depth_m),
            normals: self
                .normals
                .map(|normals| normals.map(|normal| self.world_from_normal * normal)),
            colors: self.colors,
            displaced: self.is_deformed.then_some(self.positions),
            tangents: self.tangents.map(|tangents| {
                let smooth = self.normals.and_then(|n| self.smooth_normal(weights, n));
                let normal = smooth.or(self.flat_normal).unwrap_or(self.view.forward);
                (tangents, tangents.reach(weights, normal))
            }),
        }
    }

    /// The color that the corners' mix, moved by `offset`. Whatever the weights are, it lies
    /// between theirs.
    fn base_color(&self, weights: [f64; 3], offset: DVec4) -> DVec4 {
        let [a, b, c] = self.colors;
        match (mix_values(weights, self.colors), offset) {
            (color, DVec4::ZERO) => color,
            (color, offset) => (color + offset).clamp(a.min(b).min(c), a.max(b).max(c)),
        }
    }

    /// How far the weights at the center of a pixel may err, where the corners err by so much in x,
    /// y and w of clip space: in any direction, and along one.
    pub fn weight_errors(&self, x: usize, y: usize, clip_errors: &[[DVec3; 2]; 3]) -> [f64; 3] {
        let point = self.sample_point(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        self.weights
            .errors_from(clip_errors, self.weights.at(&point), &point)
    }

    /// Bounds of the errors in f32 of the distances from the edges at the center of a pixel, where the
    /// corners err by so much in x, y and w of clip space: in any direction, and along one; pixels.
    pub fn edge_distance_errors_px(
        &self,
        x: usize,
        y: usize,
        clip_errors: &[[DVec3; 2]; 3],
    ) -> DVec3 {
        let point = self.sample_point(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        self.weights
            .edge_distance_errors_px(clip_errors, &point, [self.view.width, self.view.height])
            .into()
    }

    /// Returns true if f32 may see the other side of the triangle, or of a point, at the center of a pixel, where
    /// the corners err by so much in x, y and w of clip space: in any direction, and along one.
    pub fn may_turn(&self, x: usize, y: usize, clip_errors: &[[DVec3; 2]; 3]) -> bool {
        let point = self.sample_point(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        if self.is_point {
            // Of the roundings of a product of unit vectors this is a thousand times as much.
            const EDGE_ON: f64 = 1e-3;
            let surface = self.surface(x, y, &Perturbation::default());
            return surface.normal.dot(surface.view).abs() < EDGE_ON;
        }
        self.weights.may_turn(clip_errors, &point)
    }

    /// The offsets of texture lookups across and down, in error bounds, between which colors change
    /// evenly at the center of a pixel: both ends, and where a bound crosses the middles of texels.
    pub fn texture_offsets(&self, x: usize, y: usize) -> [Vec<f64>; 2] {
        let Some(material) = &self.material else {
            return [vec![0.0], vec![0.0]];
        };
        let point = self.sample_point(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        material.offsets(&self.sample_weights(self.weights.at(&point), &point))
    }

    fn sample_point(&self, pixel: DVec2) -> SamplePoint {
        let screen = pixel / DVec2::new(self.view.width.into(), self.view.height.into());
        let corner = self.points.and_then(|(records, radius)| {
            let at = pixel * f64::from(self.view.units_per_pixel());
            OrientedTriangle::clockwise(self.id, records).corner_under(
                at.x as i64,
                at.y as i64,
                radius,
            )
        });
        SamplePoint {
            pixel,
            screen,
            shape: self.shape,
            corner,
        }
    }

    /// Weights for texture lookups. In boxes and discs they are taken to be constant.
    fn sample_weights(&self, weights: [f64; 3], point: &SamplePoint) -> SampleWeights {
        let slopes = if self.shape == Shape::Triangles {
            self.weights.slopes(weights, point, self.view)
        } else {
            [[0.0; 3]; 2]
        };
        SampleWeights {
            weights,
            slopes,
            errors: self.weights.errors(weights, point),
        }
    }

    /// Where a sample with this surface lies, for a light.
    pub fn lit_point(&self, surface: &Surface) -> LitPoint {
        // From the eye: not moved by the rounding of the place in the world.
        let on_ray = on_ray(self.view, surface.screen, surface.depth_m);
        let on_triangle = match self.shape {
            Shape::Triangles => {
                let point = SamplePoint {
                    pixel: surface.pixel,
                    screen: surface.screen,
                    shape: self.shape,
                    corner: None,
                };
                mix_values(self.weights.at(&point), self.positions)
            }
            // Outside the triangle only the ray of the pixel is defined.
            Shape::Boxes | Shape::Points => on_ray,
        };
        LitPoint {
            on_ray,
            on_triangle,
            flat_normal: surface.flat_normal,
            error_m: self.weights.position_error_m(self.view, on_ray),
        }
    }

    /// Interpolated in object space; none if the corner normals cancel out.
    fn smooth_normal(&self, weights: [f64; 3], normals: [DVec3; 3]) -> Option<DVec3> {
        let largest = normals
            .iter()
            .map(|normal| normal.abs().max_element())
            .fold(0.0, f64::max);
        let normal = mix_values(weights, normals) / largest;
        // A division by zero makes NaN, for which the comparison is false.
        if normal.length_squared() >= DEGENERATE {
            (self.world_from_normal * normal).try_normalize()
        } else {
            None
        }
    }
}

/// From the middle of the picture to a point of it (as a fraction), in world space; at a depth of 1
/// in perspective.
fn across(view: &View, screen: DVec2) -> DVec3 {
    view.ndc_axes[0] * (2.0 * screen.x - 1.0) + view.ndc_axes[1] * (1.0 - 2.0 * screen.y)
}

/// The point at a depth along the viewing direction, on the ray through a point of the picture (as
/// a fraction of it).
fn on_ray(view: &View, screen: DVec2, depth_m: f64) -> DVec3 {
    let across = across(view, screen);
    match view.linear_depth_m {
        None => view.eye + (view.forward + across) * depth_m,
        Some(_) => view.eye + across + view.forward * depth_m,
    }
}

fn mix_values<T: std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>>(
    weights: [f64; 3],
    [a, b, c]: [T; 3],
) -> T {
    a * weights[0] + b * weights[1] + c * weights[2]
}

/// Linear RGBA of a vertex, opaque if it has three components; white if a component is refused.
fn color(scene: &Scene, colors: &Accessor, vertex: u32) -> DVec4 {
    let component = |i: u32| {
        if i < colors.components {
            bits::component(&scene.vertex_bytes, colors, vertex, i)
        } else {
            Ok(1.0)
        }
    };
    match [0, 1, 2, 3].map(component) {
        [Ok(r), Ok(g), Ok(b), Ok(a)] => DVec4::new(r, g, b, a),
        _ => DVec4::ONE,
    }
}
