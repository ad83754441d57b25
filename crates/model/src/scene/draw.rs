//! Draws: every instance with its matrices and its ranges in the global lists of vertices and
//! triangles.

use glam::{DMat4, DVec3, DVec4};
use rayon::prelude::*;

pub use super::bounds::MAX_MAGNITUDE;
use super::{
    bounds::Bounds,
    model::{Instance, Primitive, Scene, Topology},
    parts::{Scope, scope_masks},
    pose::{Deform, Pose},
    view::View,
};
use crate::{math::rounded_columns, work::Canceled};

/// An instance with everything that its projection needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Draw {
    /// Index into `Scene::primitives`.
    pub primitive: usize,
    /// Index of its vertex 0 in `Geometry::vertices`.
    pub first_vertex: u32,
    /// Global id of its triangle 0.
    pub first_triangle: u32,
    /// Subtracted from object-space positions before `clip_from_object`: in a relative view the
    /// point of the mesh's box nearest to the eye, else 0.
    pub origin: [f32; 3],
    /// Columns, for positions relative to `origin`. Multiplied in f64 and rounded once, so that
    /// every renderer and the oracle start from the same bits.
    pub clip_from_object: [[f32; 4]; 4],
    /// From object space to the world, with the scene's spin.
    pub world_from_object: DMat4,
    /// Back faces are drawn.
    pub double_sided: bool,
    /// The transform mirrors, so front faces have the opposite winding.
    pub mirrored: bool,
    /// The transform shears, or scales unevenly: it changes the lengths of normals unequally, so
    /// each gets that of its own back before they are interpolated.
    pub is_uneven: bool,
    /// Normals are those of the triangles' planes.
    pub is_faceted: bool,
    /// What lies behind it is seen through it.
    pub is_glass: bool,
    /// Radius of the discs of points at a distance of 1, in pixels; 0 where there are none.
    pub point_radius_px: f32,
    /// What deforms its vertices before they are transformed.
    pub deform: Option<Deform>,
    /// Index of its vertex 0 among the vertices of all draws that can deform.
    pub first_deformable: u32,
    /// Bit k is set if it lies in scope k of the stack that is drawn.
    pub scopes: u32,
}

impl Draw {
    /// The origin in f64.
    pub fn origin(&self) -> DVec3 {
        DVec3::from_array(self.origin.map(f64::from))
    }

    /// Clip-space position of an object-space one.
    pub fn clip_point(&self, position: DVec3) -> DVec4 {
        DMat4::from_cols_array_2d(&self.clip_from_object.map(|column| column.map(f64::from)))
            * (position - self.origin()).extend(1.0)
    }

    /// Object-space box of its vertices after deformation.
    pub fn object_bounds(&self, primitive: &Primitive) -> Bounds {
        self.deform
            .as_ref()
            .map_or(primitive.bounds, |deform| deform.bounds(primitive))
    }
}

/// Does the transform change lengths by different factors in different directions? Differences of
/// less than a thousandth do not count: they are not seen, and matrices of files are rounded.
fn is_uneven(m: &DMat4) -> bool {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.truncate());
    let mean = (x.length_squared() + y.length_squared() + z.length_squared()) / 3.0;
    let differences = [
        x.length_squared() - mean,
        y.length_squared() - mean,
        z.length_squared() - mean,
        x.dot(y),
        y.dot(z),
        z.dot(x),
    ];
    differences.iter().any(|d| d.abs() > 1e-3 * mean)
}

/// Why a scene and a viewpoint exceed the arithmetic.
#[derive(Debug, thiserror::Error)]
pub enum DrawError {
    #[error("the picture was canceled")]
    Canceled(#[from] Canceled),
    #[error(
        "{instance}: its transform or the camera has a matrix entry of {value:e}; entries must be finite and below 2^40 (1.1e12)"
    )]
    Matrix { instance: String, value: f64 },
    #[error("the scene has {count} {what}; a picture may have at most {limit}")]
    TooMany {
        what: &'static str,
        count: u64,
        limit: u64,
    },
    #[error(
        "the picture would take about {needed_gib:.1} GiB of memory, and the oracle may take {limit_gib}; draw it smaller or with fewer \
         triangles, or set {variable}"
    )]
    OracleMemory {
        needed_gib: f64,
        limit_gib: f64,
        variable: &'static str,
    },
    #[error(
        "the oracle would compute {positions} positions of vertices and morph targets, and may compute {limit}; place the model less often"
    )]
    OracleWork { positions: u64, limit: u64 },
    #[error(
        "the oracle would test {samples} samples of triangles for the {image}, and may test {limit}; take a smaller {image}, fewer triangles \
         or smaller ones"
    )]
    OracleSamples {
        image: &'static str,
        samples: u64,
        limit: u64,
    },
    #[error(
        "the CPU would test {samples} samples of triangles (pictures drawn one after the other: {pictures}), and may test \
         {limit}; take fewer frames, smaller pictures or shadow maps, fewer triangles, or take a GPU"
    )]
    SequenceSamples {
        pictures: u64,
        samples: u64,
        limit: u64,
    },
    #[error(
        "the CPU would follow {count} particles over {steps} steps with {octaves} octaves, which makes {work} evaluations of the flow, and \
         may make {limit}; take fewer particles, a lower rate, fewer octaves or an earlier time, or take a GPU"
    )]
    ParticleWork {
        count: u32,
        steps: u32,
        octaves: u32,
        work: u64,
        limit: u64,
    },
}

/// The point of a box nearest to `eye`, in f32; the origin if the box is empty or too large.
fn nearest(bounds: &Bounds, eye: DVec3) -> [f32; 3] {
    if bounds.is_empty()
        || !eye.is_finite()
        || bounds.min.abs().max(bounds.max.abs()).max_element() >= MAX_MAGNITUDE
    {
        return [0.0; 3];
    }
    eye.clamp(bounds.min, bounds.max).as_vec3().to_array()
}

/// Radius of the discs of a primitive's points at a distance of 1, in pixels: as large in the world
/// as a volume says that its transform scales.
fn point_radius_px(primitive: &Primitive, world_from_object: &DMat4, view: &View) -> f32 {
    if !primitive.is_points() {
        return 0.0;
    }
    let scale = libm::cbrt(world_from_object.determinant().abs());
    let pixel_m = view.ndc_axes[1].length() * 2.0 / f64::from(view.height.max(1));
    (0.5 * primitive.longest_edge * scale / pixel_m) as f32
}

/// The numbers of vertices and of triangles of all draws.
pub fn totals(scene: &Scene, draws: &[Draw]) -> [u64; 2] {
    draws.last().map_or([0; 2], |last| {
        let primitive = &scene.primitives[last.primitive];
        [
            (last.first_vertex, primitive.vertex_count()),
            (last.first_triangle, primitive.triangle_count()),
        ]
        .map(|(first, count)| u64::from(first) + u64::from(count))
    })
}

/// The most triangles in a picture: an id shares its word with two flags, and one value means none.
pub const MAX_TRIANGLES: u64 = (1 << 30) - 2;

/// Draws that one thread handles: waking others costs more than fewer take.
pub const MANY_DRAWS: usize = 1024;

/// The draws of `scene` as `view` sees it, in instance order, for a stack without scopes.
/// Errors: if there are more than [`MAX_TRIANGLES`] triangles or vertices, or a matrix entry
/// reaches [`MAX_MAGNITUDE`].
pub fn draws(scene: &Scene, view: &View) -> Result<Vec<Draw>, DrawError> {
    scoped_draws(scene, view, &[])
}

/// The draws of `scene` as `view` sees it, in instance order, for a stack with these scopes.
pub fn scoped_draws(scene: &Scene, view: &View, scopes: &[Scope]) -> Result<Vec<Draw>, DrawError> {
    for (what, count) in [
        ("triangles", scene.triangle_count()),
        ("vertices", scene.vertex_count()),
    ] {
        if count > MAX_TRIANGLES {
            return Err(DrawError::TooMany {
                what,
                count,
                limit: MAX_TRIANGLES,
            });
        }
    }
    let at_rest = if view.scene_state.pose.is_none() {
        Pose::at_rest(scene)
    } else {
        None
    };
    let pose = view.scene_state.pose.as_deref().or(at_rest.as_ref());
    // The view of a light leaves out ground and walls, which are last in the list.
    let drawn = if view.is_light() {
        scene.shadow_casters()
    } else {
        &scene.instances
    };
    let masks = if scopes.is_empty() {
        Vec::new()
    } else {
        scope_masks(scene, scopes)
    };
    let make_draw = |(index, instance): (usize, &Instance)| {
        let primitive = &scene.primitives[instance.primitive];
        let deform = pose.and_then(|pose| pose.deform(index)).cloned();
        let world_from_object = view.world_from_instance(scene, index, pose);
        let bounds = deform
            .as_ref()
            .map_or(primitive.bounds, |deform| deform.bounds(primitive));
        let origin = if view.precision.is_relative {
            nearest(
                &bounds,
                world_from_object.inverse().transform_point3(view.eye),
            )
        } else {
            [0.0; 3]
        };
        let moved = DMat4::from_translation(DVec3::from_array(origin.map(f64::from)));
        let clip_from_object = rounded_columns(&(view.clip_from_world * world_from_object * moved));
        let entries = clip_from_object
            .iter()
            .flatten()
            .map(|&v| f64::from(v))
            .chain(world_from_object.to_cols_array());
        let joints = deform
            .iter()
            .filter_map(|deform| deform.joint_transforms.as_ref())
            .flat_map(|joint_transforms| joint_transforms.matrices());
        let entries = entries
            .chain(view.clip_from_world.to_cols_array())
            .chain(joints.flat_map(|joint| joint.to_cols_array()));
        if let Some(value) = entries
            .into_iter()
            .find(|v| !v.is_finite() || v.abs() >= MAX_MAGNITUDE)
        {
            return Err(DrawError::Matrix {
                instance: primitive.name.clone(),
                value,
            });
        }
        Ok(Draw {
            primitive: instance.primitive,
            first_vertex: 0,
            first_triangle: 0,
            origin,
            clip_from_object,
            world_from_object,
            // A point faces the viewer, and a line has no sides.
            double_sided: match primitive.topology {
                Topology::Points => false,
                Topology::Lines => true,
                _ => scene.materials[primitive.material].double_sided || view.is_light(),
            },
            mirrored: (world_from_object.determinant() < 0.0)
                != deform.as_ref().is_some_and(Deform::mirrors),
            is_uneven: is_uneven(&world_from_object),
            is_faceted: primitive.is_faceted,
            is_glass: scene.materials[primitive.material].is_glass(),
            point_radius_px: point_radius_px(primitive, &world_from_object, view),
            deform,
            first_deformable: 0,
            scopes: masks.get(index).copied().unwrap_or_default(),
        })
    };
    let made: Vec<Result<Draw, DrawError>> = drawn
        .par_iter()
        .enumerate()
        .with_min_len(MANY_DRAWS)
        .map(make_draw)
        .collect();
    let (mut first_vertex, mut first_triangle, mut first_deformable) = (0, 0, 0);
    let place = |draw: Result<Draw, DrawError>| {
        let draw = Draw {
            first_vertex,
            first_triangle,
            first_deformable,
            ..draw?
        };
        let primitive = &scene.primitives[draw.primitive];
        first_deformable += if primitive.deformation.is_none() {
            0
        } else {
            primitive.vertex_count()
        };
        first_vertex += primitive.vertex_count();
        first_triangle += primitive.triangle_count();
        Ok(draw)
    };
    made.into_iter().map(place).collect()
}
