//! Scenes from explicit vertices, and views with known coordinates, for the cases and for tests of
//! the renderer.

use std::{panic, sync::Arc};

use glam::{DMat4, DVec3, DVec4};

use crate::{
    effects::Stack,
    math::hash,
    oracle::{self, Shot},
    scene::{
        Accessor, Bounds, ComponentType, Instance, Material, Primitive, Scene, Topology,
        camera::Camera,
        draw::{DrawError, draws},
        view::View,
    },
};

/// A mesh given by explicit vertices, with its instances.
#[derive(Clone)]
pub struct SimpleMesh {
    /// Object space.
    pub positions: Vec<[f32; 3]>,
    /// One per vertex, or empty: (0, 0, 1) everywhere.
    pub normals: Vec<[f32; 3]>,
    /// Linear RGBA, one per vertex, or empty: no vertex colors.
    pub colors: Vec<[f32; 4]>,
    /// Three per triangle, or empty: the vertices in order.
    pub indices: Vec<u32>,
    /// Back faces are drawn; true by default.
    pub double_sided: bool,
    /// One per instance; a single identity by default.
    pub transforms: Vec<DMat4>,
}

impl Default for SimpleMesh {
    fn default() -> Self {
        let transforms = vec![DMat4::IDENTITY];
        Self {
            positions: vec![],
            normals: vec![],
            colors: vec![],
            indices: vec![],
            double_sided: true,
            transforms,
        }
    }
}

impl SimpleMesh {
    /// The same mesh with one instance at this transform.
    #[must_use]
    pub fn at(self, world_from_object: DMat4) -> Self {
        Self {
            transforms: vec![world_from_object],
            ..self
        }
    }
}

/// A double-sided mesh of separate triangles.
pub fn triangle_soup(positions: impl IntoIterator<Item = [f32; 3]>) -> SimpleMesh {
    SimpleMesh {
        positions: positions.into_iter().collect(),
        ..SimpleMesh::default()
    }
}

/// Separate triangles with corners in units of 1/256 px and one depth each. Exact in a
/// [`pixel_view`] up to the guard band.
pub fn triangle_soup_in_units(triangles: &[([[i32; 2]; 3], f32)]) -> SimpleMesh {
    let position = |[x, y]: [i32; 2], depth: f32| [x as f32 / 256.0, y as f32 / 256.0, depth];
    triangle_soup(
        triangles
            .iter()
            .flat_map(|(corners, depth)| corners.map(|corner| position(corner, *depth))),
    )
}

/// A scene of these meshes.
pub fn scene_of_meshes(meshes: &[SimpleMesh]) -> Arc<Scene> {
    let mut scene = Scene {
        name: "hand-made".into(),
        ..Scene::default()
    };
    for (i, mesh) in meshes.iter().enumerate() {
        let mut push = |components: u32, values: &[f32]| {
            let offset = scene.vertex_bytes.len();
            scene
                .vertex_bytes
                .extend(values.iter().flat_map(|v| v.to_le_bytes()));
            Accessor::packed_f32(offset, components, values.len() / components as usize)
        };
        let positions = push(3, mesh.positions.as_flattened());
        let normals = if mesh.normals.is_empty() {
            vec![[0.0, 0.0, 1.0]; mesh.positions.len()]
        } else {
            mesh.normals.clone()
        };
        let normals = push(3, normals.as_flattened());
        let colors = (!mesh.colors.is_empty()).then(|| push(4, mesh.colors.as_flattened()));
        let indices = (!mesh.indices.is_empty()).then(|| {
            let (offset, count) = (scene.index_bytes.len() as u32, mesh.indices.len() as u32);
            scene
                .index_bytes
                .extend(mesh.indices.iter().flat_map(|i| i.to_le_bytes()));
            Accessor {
                offset,
                stride: 4,
                component_type: ComponentType::U32,
                components: 1,
                normalized: false,
                count,
            }
        });
        let mut bounds = Bounds::EMPTY;
        let finite = mesh
            .positions
            .iter()
            .filter(|p| p.iter().all(|v| v.is_finite()));
        finite.for_each(|p| bounds.include(DVec3::from_array(p.map(f64::from))));
        let corner = |position: usize| {
            let vertex = mesh.indices.get(position).map_or(position, |&i| i as usize);
            DVec3::from_array(mesh.positions[vertex].map(f64::from))
        };
        let corners = if mesh.indices.is_empty() {
            mesh.positions.len()
        } else {
            mesh.indices.len()
        };
        let edges = (0..corners / 3).flat_map(|t| {
            [(0, 1), (1, 2), (2, 0)].map(|(a, b)| corner(3 * t + a).distance(corner(3 * t + b)))
        });
        let longest_edge = edges.filter(|edge| edge.is_finite()).fold(0.0, f64::max);
        let material = scene.materials.len();
        scene.materials.push(Material {
            double_sided: mesh.double_sided,
            ..Material::default()
        });
        scene.primitives.push(Primitive {
            name: format!("part {i}"),
            mesh: format!("part {i}"),
            topology: Topology::List,
            indices,
            positions,
            normals,
            colors,
            texcoords: Default::default(),
            tangents: None,
            material,
            bounds,
            longest_edge,
            is_faceted: false,
            normals_agree: false,
            deformation: Default::default(),
        });
        scene.instances.extend(
            mesh.transforms
                .iter()
                .map(|&world_from_object| Instance::fixed(i, world_from_object)),
        );
    }
    Arc::new(scene)
}

/// A view in which positions are pixels right and down and z is the depth (larger is nearer). Exact
/// for sides that are powers of two.
pub fn pixel_view(width: u32, height: u32) -> View {
    let (w, h) = (f64::from(width), f64::from(height));
    View {
        width,
        height,
        clip_from_world: DMat4::from_cols(
            DVec4::X * 2.0 / w,
            DVec4::Y * -2.0 / h,
            DVec4::Z,
            DVec4::new(-1.0, 1.0, 0.0, 1.0),
        ),
        eye: DVec3::new(w / 2.0, h / 2.0, 1.0),
        forward: DVec3::NEG_Z,
        ndc_axes: [DVec3::X * w / 2.0, DVec3::NEG_Y * h / 2.0],
        linear_depth_m: Some([0.0, 1.0]),
        depth_range_m: [0.0, 1.0],
        content_depth_m: [0.0, 1.0],
        background: Default::default(),
        picture_from_world: None,
        scene_state: Default::default(),
        precision: Default::default(),
    }
}

/// A perspective view in which (x w, y w, -w) lands on (x, y) in normalized device coordinates.
pub fn square_perspective(width: u32, height: u32, near: f64) -> View {
    View {
        clip_from_world: DMat4::from_cols(
            DVec4::X,
            DVec4::Y,
            DVec4::new(0.0, 0.0, 0.0, -1.0),
            DVec4::new(0.0, 0.0, near, 0.0),
        ),
        eye: DVec3::ZERO,
        ndc_axes: [DVec3::X, DVec3::Y],
        linear_depth_m: None,
        depth_range_m: [near, near + 10.0],
        content_depth_m: [near, near + 10.0],
        ..pixel_view(width, height)
    }
}

/// The view of `scene` by `camera`.
pub fn camera_view(scene: &Scene, camera: &Camera, [width, height]: [u32; 2]) -> View {
    View::new(
        camera,
        width,
        height,
        &scene.bounds(),
        DMat4::IDENTITY,
        [0.01, 0.02, 0.03, 1.0],
    )
}

/// The coverage that the oracle computes without any data of an adapter.
pub fn reference_coverage(scene: &Scene, view: &View) -> Result<oracle::Coverage, DrawError> {
    let draws = draws(scene, view)?;
    let stack = Stack::default();
    let shot = Shot::new(scene, &draws, view, &stack);
    let (triangles, _) = oracle::triangles(&shot, &oracle::project(&shot)?)?;
    Ok(oracle::cover(&triangles, view)?)
}

/// The four corners of a rotated square; `half` is half its diagonal.
pub fn rotated_square(center: [f64; 2], half: f64, angle: f64) -> [[f64; 2]; 4] {
    [0.0, 1.0, 2.0, 3.0].map(|quarter| {
        let (sin, cos) = libm::sincos(angle + quarter * std::f64::consts::FRAC_PI_2);
        [center[0] + half * cos, center[1] + half * sin]
    })
}

/// The winding of triangles relative to the order of their corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Winding {
    /// In the order of the corners.
    Forward,
    /// In the opposite order.
    Reversed,
}

/// Two triangles through four corners in normalized device coordinates, with a w for each corner.
pub fn quad(corners: [[f64; 2]; 4], w: [f64; 4], winding: Winding) -> Vec<[f32; 3]> {
    let position = |i: usize| [corners[i][0] * w[i], corners[i][1] * w[i], -w[i]].map(|v| v as f32);
    let order: [usize; 6] = match winding {
        Winding::Forward => [0, 1, 2, 2, 3, 0],
        Winding::Reversed => [0, 2, 1, 2, 0, 3],
    };
    order.map(position).to_vec()
}

/// Calls `check` with `count` generators. A failure names its `RASTERLAB_SEED`.
pub fn for_seeds(count: u32, check: impl Fn(&mut Rng)) {
    let first = std::env::var("RASTERLAB_SEED").map_or(0, |seed| seed.parse().expect("a number"));
    for seed in first..first + count {
        let case = panic::AssertUnwindSafe(|| check(&mut Rng(seed)));
        if let Err(why) = panic::catch_unwind(case) {
            eprintln!("RASTERLAB_SEED={seed}");
            panic::resume_unwind(why);
        }
    }
}

/// Random numbers, the same on every machine.
pub struct Rng(pub u32);

impl Rng {
    /// Any of the 2^32 values.
    pub fn next_u32(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9);
        hash(self.0)
    }

    /// From `low` up to but without `high`.
    pub fn between(&mut self, low: i32, high: i32) -> i32 {
        low + ((u64::from(self.next_u32()) * u64::from(high.abs_diff(low))) >> 32) as i32
    }

    /// The same of real numbers.
    pub fn real(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.next_u32()) / 4_294_967_296.0
    }

    pub fn shuffle<T>(&mut self, list: &mut [T]) {
        for last in (1..list.len()).rev() {
            list.swap(last, self.between(0, last as i32 + 1) as usize);
        }
    }
}
