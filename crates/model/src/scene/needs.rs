//! Needs: what a scene in a view requires of the kernels. The planner omits what is not needed.
//!
//! Bounds are conservative: they may require a path that no triangle takes, and never omit one that
//! a triangle takes.

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3, DVec4};
use rayon::prelude::*;

use super::{
    accessor::ComponentType,
    bounds::Bounds,
    draw::{Draw, MANY_DRAWS},
    material::Material,
    model::{Primitive, Scene, Topology},
    shadow_resolution::ShadowResolution,
    sizes::TriangleSizes,
    view::View,
};
use crate::{
    accuracy::Skinning,
    math::{GUARD_BAND, MAX_POINT_RADIUS_PX, SUBPIXEL_BITS},
};

/// What a scene in a view requires of the kernels.
#[derive(Clone, Debug, PartialEq)]
pub struct Needs {
    /// Pixels of the picture.
    pub size: [u32; 2],
    pub triangles: u64,
    pub vertices: u64,
    /// Bytes of the scene's attributes; 0 where passes write more behind them.
    pub attribute_bytes: u64,
    pub draws: usize,
    /// Many draws show few primitives.
    pub instanced: bool,
    /// Some primitive has indices.
    pub indexed: bool,
    /// All indices are u32.
    pub u32_indices: bool,
    /// Strips or fans occur.
    pub has_strips_or_fans: bool,
    /// Positions are all f32.
    pub f32_positions: bool,
    /// Normals are all f32.
    pub f32_normals: bool,
    pub colors: bool,
    /// Materials that are more than a base color.
    pub material_count: usize,
    /// Of those, materials with a texture.
    pub textured: usize,
    /// Materials with textures that say how they reflect.
    pub finish_maps: usize,
    /// Materials with a texture that turns their normals.
    pub normal_maps: usize,
    /// The alpha of a texture discards samples of some material.
    pub masked: bool,
    /// Draws through which others are seen.
    pub glass_draws: usize,
    /// Materials that let light through.
    pub transmitting: usize,
    /// Some material that blends, or that lets light through where its alpha says, has a texture.
    pub has_blended_textures: bool,
    /// Lights that come with the scene.
    pub lights: u32,
    /// A picture of what surrounds the scene comes with it.
    pub has_panorama: bool,
    /// How finely shadows are drawn.
    pub shadow: ShadowResolution,
    /// The view is a light's.
    pub is_light: bool,
    /// Morph targets deform some mesh.
    pub morph_targets: bool,
    /// Some triangles are particle discs.
    pub particle_discs: bool,
    /// Some primitives are points or lines.
    pub points: bool,
    /// Some are points.
    pub clouds: bool,
    /// All primitives are points.
    pub only_points: bool,
    /// How joints are blended, where any deform a mesh.
    pub skinning: Option<Skinning>,
    /// Clips may move parts of the scene.
    pub moves: bool,
    /// Joints of all skins together.
    pub joints: usize,
    /// No interpolated normal ever needs a substitute.
    pub normals_agree: bool,
    /// w is meters; else depth is linear and w is 1.
    pub perspective: bool,
    /// Some vertex may lie before the near plane or beyond the guard band.
    pub clipping: bool,
    /// No triangle is wider or higher than this, in pixels; infinite where clipping is needed.
    pub largest_px: f64,
    /// No disc of a point has a larger radius, in pixels; the least one is not counted.
    pub largest_disc_px: f64,
    /// How large triangles are, from a sample of them.
    pub sizes: TriangleSizes,
    /// The most pixels that the box of a primitive spans on an axis; infinite where it may cross
    /// the near plane.
    pub box_px: f64,
    /// How far rounding may move a corner in the picture, pixels: from stored positions, and from
    /// positions relative to the eye. A bound at the boxes of a sample of the instances.
    pub rounding_px: [f64; 2],
    /// The view asks for positions relative to the eye, since the scene lies far from its origin.
    pub is_far: bool,
    /// Distances of the nearest and farthest corner of the scene's box along the viewing
    /// direction.
    pub depth_m: [f64; 2],
    /// Distance of the near plane, where there is one.
    pub near_m: f64,
    /// Largest ratio of w between the corners of one triangle.
    pub w_ratio: f64,
}

impl Needs {
    /// Reads `scene` as `view` sees it through `draws`.
    pub fn of(scene: &Scene, draws: &[Draw], view: &View) -> Self {
        // Of millions of draws few primitives are drawn.
        let [mut is_drawn, mut is_unbent] = [(); 2].map(|()| vec![false; scene.primitives.len()]);
        for draw in draws {
            is_drawn[draw.primitive] = true;
            is_unbent[draw.primitive] |= draw.deform.is_none();
        }
        let drawn = || primitives_of(scene, &is_drawn);
        // Deformed vertices are stored as f32, in place of any other format.
        let unbent = || primitives_of(scene, &is_unbent);
        let materials: BTreeSet<usize> = drawn().map(|p| p.material).collect();
        let count = |is_counted: fn(&Material) -> bool| {
            let has = |&&material: &&usize| is_counted(&scene.materials[material]);
            materials.iter().filter(has).count()
        };
        let all_f32 =
            |pick: fn(&Primitive) -> ComponentType| unbent().all(|p| pick(p) == ComponentType::F32);
        let largest = |of: fn(&Primitive, &Draw, &View) -> f64| {
            draws
                .par_iter()
                .with_min_len(MANY_DRAWS)
                .map(|draw| of(&scene.primitives[draw.primitive], draw, view))
                .reduce_with(f64::max)
                .map_or(0.0, |largest| largest.max(0.0))
        };
        let largest_px = largest(largest_px);
        Self {
            size: [view.width, view.height],
            triangles: scene.triangle_count(),
            vertices: scene.vertex_count(),
            attribute_bytes: scene.constant_attribute_bytes(),
            draws: draws.len(),
            instanced: scene.is_instanced(),
            indexed: drawn().any(|p| p.indices.is_some()),
            u32_indices: drawn().all(|p| {
                p.indices
                    .is_some_and(|i| i.component_type == ComponentType::U32 && i.stride == 4)
            }),
            has_strips_or_fans: drawn().any(|p| p.topology != Topology::List),
            f32_positions: all_f32(|p| p.positions.component_type),
            f32_normals: all_f32(|p| p.normals.component_type),
            lights: view.scene_state.lights.len() as u32,
            has_panorama: scene.panorama.is_some(),
            shadow: view.precision.shadow,
            is_light: view.is_light(),
            colors: drawn().any(|p| p.colors.is_some()),
            material_count: count(|material| !material.is_plain()),
            textured: count(Material::has_color_texture),
            finish_maps: count(Material::has_finish_maps),
            normal_maps: count(Material::has_normal_map),
            masked: drawn().any(|p| scene.materials[p.material].alpha_threshold().is_some()),
            glass_draws: draws.iter().filter(|draw| draw.is_glass).count(),
            transmitting: count(Material::transmits),
            has_blended_textures: drawn().any(|p| {
                let material = &scene.materials[p.material];
                let has_alpha = material.is_blended || material.transmits_by_alpha;
                has_alpha && material.base_texture.is_some()
            }),
            morph_targets: draws.iter().any(|draw| {
                draw.deform
                    .as_ref()
                    .is_some_and(|deform| deform.weights.iter().any(|weight| *weight != 0.0))
            }),
            particle_discs: scene.particle_discs.is_some(),
            points: drawn().any(Primitive::is_spread),
            clouds: drawn().any(Primitive::is_points),
            only_points: !draws.is_empty() && drawn().all(Primitive::is_points),
            skinning: draws
                .iter()
                .find_map(|draw| Some(draw.deform.as_ref()?.joint_transforms.as_ref()?.skinning())),
            moves: !scene.rig.is_empty(),
            joints: if draws.iter().any(|draw| draw.deform.is_some()) {
                scene.rig.skins.iter().map(|skin| skin.joints.len()).sum()
            } else {
                0
            },
            normals_agree: draws.iter().all(|draw| draw.deform.is_none())
                && drawn().all(|p| p.normals_agree)
                && draws
                    .par_iter()
                    .with_min_len(MANY_DRAWS)
                    .all(|draw| keeps_normals(draw) && !draw.is_uneven && !draw.is_faceted),
            perspective: view.linear_depth_m.is_none(),
            clipping: largest_px.is_infinite(),
            largest_px,
            largest_disc_px: largest(disc_px),
            sizes: TriangleSizes::of(scene, draws, view),
            box_px: largest(box_px),
            rounding_px: rounding_px(
                view,
                sampled(draws).map(|(_, draw)| {
                    let bounds = draw.object_bounds(&scene.primitives[draw.primitive]);
                    (draw.world_from_object, bounds)
                }),
            ),
            is_far: view.precision.is_relative,
            depth_m: view.depth_range_m,
            near_m: view.clip_from_world.w_axis.z.abs(),
            w_ratio: w_ratio(largest_px, view),
        }
    }

    /// Meters that one unit of the depth buffer spans at a distance.
    pub fn depth_unit_m(&self, at_m: f64) -> f64 {
        if self.perspective {
            at_m * at_m / self.near_m.max(f64::MIN_POSITIVE)
        } else {
            self.depth_m[1] - self.depth_m[0]
        }
    }

    /// Meters that a depth twice as far spans from a distance on: what a logarithm divides evenly.
    pub fn doubling_span_m(&self, at_m: f64) -> f64 {
        if self.perspective {
            at_m
        } else {
            self.depth_m[1] - self.depth_m[0]
        }
    }

    /// As if the scene might hold anything its bytes allow: nothing that depends on bounds or
    /// formats can be left out.
    pub fn everything(&self) -> Self {
        Self {
            draws: self.draws.max(2),
            u32_indices: false,
            has_strips_or_fans: true,
            f32_positions: false,
            f32_normals: false,
            colors: true,
            material_count: self.material_count.max(1),
            normals_agree: false,
            only_points: false,
            largest_disc_px: f64::INFINITY,
            clipping: true,
            largest_px: f64::INFINITY,
            ..self.clone()
        }
    }
}

/// The primitives that are chosen, in their order.
fn primitives_of<'a>(
    scene: &'a Scene,
    is_chosen: &'a [bool],
) -> impl Iterator<Item = &'a Primitive> {
    scene
        .primitives
        .iter()
        .zip(is_chosen)
        .filter_map(|(primitive, is_chosen)| is_chosen.then_some(primitive))
}

/// See [`Needs::box_px`].
fn box_px(primitive: &Primitive, draw: &Draw, view: &View) -> f64 {
    let bounds = draw.object_bounds(primitive);
    if bounds.is_empty() {
        return 0.0;
    }
    let nearest = bounds
        .corners()
        .map(|corner| draw.clip_point(corner).w)
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    if nearest <= 0.0 {
        return f64::INFINITY;
    }
    let column = |axis: usize| draw.clip_from_object[axis].map(f64::from);
    let widest = |axis: usize| {
        let across = |row: usize, pixels: u32| column(axis)[row].abs() * f64::from(pixels) * 0.5;
        (bounds.max - bounds.min)[axis] * across(0, view.width).max(across(1, view.height))
            / nearest
    };
    [0, 1, 2].map(widest).into_iter().fold(0.0, f64::max)
}

/// Must positions be taken relative to the eye, since rounding would move stored ones visibly? The
/// answer follows from scene and view alone, so that the oracle and every adapter give the same.
pub fn is_far(scene: &Scene, view: &View) -> bool {
    let pose = view.scene_state.pose.as_deref();
    let placed = sampled(&scene.instances).map(|(index, instance)| {
        let primitive = &scene.primitives[instance.primitive];
        let deform = pose.and_then(|pose| pose.deform(index));
        let bounds = deform.map_or(primitive.bounds, |deform| deform.bounds(primitive));
        (view.world_from_instance(scene, index, pose), bounds)
    });
    outgrows(rounding_px(view, placed))
}

/// Does rounding move stored positions so much farther than those relative to the eye that it shows?
/// Within a unit of the grid every bound is at home; beyond it the relative one tells what the
/// offset costs.
pub fn outgrows([stored, relative]: [f64; 2]) -> bool {
    stored > 2.0 * relative.max(1.0 / f64::from(1u32 << SUBPIXEL_BITS))
}

/// Of many, a sample is enough.
fn sampled<T>(all: &[T]) -> impl Iterator<Item = (usize, &T)> {
    const SAMPLED: usize = 1024;
    let step = all.len().div_ceil(SAMPLED).max(1);
    all.iter().enumerate().step_by(step)
}

/// See [`Needs::rounding_px`]: the forward error bound of the vertex stage at the corners and
/// middles of boxes, where they are in the picture. Each box comes with its transform to the world.
fn rounding_px(view: &View, placed: impl Iterator<Item = (DMat4, Bounds)>) -> [f64; 2] {
    const ULP: f64 = 1.0 / (1 << 23) as f64;
    let size = [f64::from(view.width), f64::from(view.height)];
    let of_box = |(world_from_object, bounds): (DMat4, Bounds)| {
        if bounds.is_empty() {
            return [0.0; 2];
        }
        let m = view.clip_from_world * world_from_object;
        let eye = world_from_object.inverse().transform_point3(view.eye);
        let origin = if eye.is_finite() {
            eye.clamp(bounds.min, bounds.max)
        } else {
            DVec3::ZERO
        };
        let moved = m * DMat4::from_translation(origin);
        let points = bounds.corners().into_iter().chain([bounds.center()]);
        let bound = |m: &DMat4, point: DVec3, clip: DVec4| {
            let sums = |row: usize| {
                let row = m.row(row).abs();
                row.x * point.x.abs() + row.y * point.y.abs() + row.z * point.z.abs() + row.w
            };
            let w = clip.w;
            let along = |axis: usize| {
                let bound =
                    4.0 * sums(axis) / w + (4.0 * sums(3) / w + 4.5) * (clip[axis] / w).abs();
                0.5 * size[axis] * ULP * bound
            };
            along(0).max(along(1))
        };
        points.fold([0.0f64; 2], |[stored, relative], point| {
            let clip = m * point.extend(1.0);
            let is_seen = clip.w > 0.0
                && clip.z <= clip.w
                && clip.x.abs() <= 1.5 * clip.w
                && clip.y.abs() <= 1.5 * clip.w;
            if !is_seen {
                return [stored, relative];
            }
            [
                stored.max(bound(&m, point, clip)),
                relative.max(bound(&moved, point - origin, clip)),
            ]
        })
    };
    placed
        .map(of_box)
        .fold([0.0; 2], |[a, b], [c, d]| [a.max(c), b.max(d)])
}

/// A triangle of so many pixels that lies along the viewing direction, as near as the scene comes.
fn w_ratio(largest_px: f64, view: &View) -> f64 {
    let pixel = view.ndc_axes[1].length() * 2.0 / f64::from(view.height.max(1));
    1.0 + largest_px * pixel * 1.5
}

/// Is the placement far enough from singular that a normal keeps a direction?
fn keeps_normals(draw: &Draw) -> bool {
    let m = DMat3::from_mat4(draw.world_from_object);
    let largest = m
        .to_cols_array()
        .iter()
        .fold(0.0, |max: f64, v| max.max(v.abs()));
    largest > 0.0 && (m * (1.0 / largest)).determinant().abs() > 1e-9
}

/// Upper bound of the radius of the discs of a draw's points, in pixels; 0 where it has none.
fn disc_px(primitive: &Primitive, draw: &Draw, _: &View) -> f64 {
    let bounds = draw.object_bounds(primitive);
    if !primitive.is_points() || bounds.is_empty() {
        return 0.0;
    }
    let corners = bounds.corners().map(|corner| draw.clip_point(corner).w);
    let nearest = corners.into_iter().fold(f64::INFINITY, f64::min);
    match nearest > 0.0 {
        true => (f64::from(draw.point_radius_px) / nearest).min(MAX_POINT_RADIUS_PX),
        false => MAX_POINT_RADIUS_PX,
    }
}

/// Upper bound of the extent of a draw's triangles in pixels; infinite if one may need clipping.
///
/// On a segment of object-space length l, clip x changes by at most |row 0| l and w by |row 3| l,
/// hence x/w by at most (|row 0| + max|x/w| |row 3|) l / min w. Both extrema of the box are at its
/// corners while w stays positive.
fn largest_px(primitive: &Primitive, draw: &Draw, view: &View) -> f64 {
    let bounds = draw.object_bounds(primitive);
    if bounds.is_empty() {
        return 0.0;
    }
    if primitive.is_points() {
        // Two roots of 3 about the radius, with what is added to it. Points are not clipped.
        return 3.5 * disc_px(primitive, draw, view).max(1.0) + 1.0;
    }
    // No edge of a deformed mesh is longer than its box.
    let longest_edge = if draw.deform.is_some() {
        2.0 * bounds.radius()
    } else {
        primitive.longest_edge
    };
    let clip_from_object =
        DMat4::from_cols_array_2d(&draw.clip_from_object.map(|column| column.map(f64::from)));
    // To both sides of a line.
    let width = if primitive.is_lines() { 1.0 } else { 0.0 };
    let corners = bounds.corners().map(|corner| draw.clip_point(corner));
    let error_bound = 1.0 + 1e-4;
    let is_before_near =
        |c: &DVec4| c.w <= 0.0 || c.z * error_bound > c.w && view.linear_depth_m.is_none();
    if corners.iter().any(is_before_near) {
        return f64::INFINITY;
    }
    let min_w = corners.iter().fold(f64::INFINITY, |min, c| min.min(c.w));
    let linear_row = |i: usize| clip_from_object.row(i).truncate().length();
    [(0, view.width), (1, view.height)]
        .map(|(axis, pixels)| {
            let reach = corners
                .iter()
                .fold(0.0, |max: f64, c| max.max((c[axis] / c.w).abs()));
            let half = f64::from(pixels) * 0.5;
            if (reach + 1.0) * half * f64::from(view.units_per_pixel()) * error_bound
                > f64::from(GUARD_BAND)
            {
                return f64::INFINITY;
            }
            (linear_row(axis) + reach * linear_row(3)) * longest_edge / min_w * half * error_bound
                + 1.0 / 128.0
                + width
        })
        .into_iter()
        .fold(0.0, f64::max)
}
