//! Culling: meshlets of the scene's meshes, and what a picture knows of every instance. Mirrors of the structs in
//! `shaders/common/{meshlets,instances,culling}.wgsl`.

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3, DVec4};
use rayon::prelude::*;

use super::{
    Gpu, RenderError, STORAGE,
    buffers::Buffers,
    uniforms::{GpuRecord, gpu_record},
};
use crate::{
    accuracy::Culling,
    scene::{
        Scene,
        draw::Draw,
        meshlets::{Meshlet, Meshlets, center_and_half, rounded_up},
        view::View,
    },
};

gpu_record! {
    /// One meshlet. Each member is explained in `shaders/common/meshlets.wgsl`.
    pub struct MeshletRecord = "Meshlet" {
        pub center: [f32; 4],
        pub half: [f32; 4],
        pub axis: [f32; 4],
        pub first_triangle: u32,
        pub first_vertex: u32,
        pub triangles: u32,
        pub vertices: u32,
    }
}

gpu_record! {
    /// One draw, for culling. Each member is explained in `shaders/common/instances.wgsl`.
    pub struct InstanceRecord = "Instance" {
        pub eye: [f32; 4],
        pub center: [f32; 4],
        pub half: [f32; 4],
        pub first: u32,
        pub first_meshlet: u32,
        pub flags: u32,
        pub spare: u32,
    }
}

gpu_record! {
    /// Numbers of a picture. Each member is explained in `shaders/common/culling.wgsl`.
    pub struct CullingUniform = "Culling" {
        pub meshlet_count: u32,
        pub first_visible: u32,
        pub hiz_width: u32,
        pub hiz_first_block: u32,
    }
}

/// Words of a survivor.
const VISIBLE_MESHLET_WORDS: u64 = 4;

/// `INSTANCE_FACES` and `INSTANCE_DEFORMS` of the shaders.
const FACES: u32 = 1;
const DEFORMS: u32 = 2;

/// The meshlets of a scene's primitives, as the kernels read them.
#[derive(Default)]
pub struct MeshletBuffers {
    records: Vec<MeshletRecord>,
    /// Triangles and vertices of all meshlets.
    lists: Vec<u32>,
    /// First record of each primitive, and how many; none for one that nobody shows.
    spans: Vec<(u32, u32)>,
    /// Meshlets of all instances.
    pub count: u32,
}

impl MeshletBuffers {
    pub fn of(scene: &Scene) -> Self {
        let shown: BTreeSet<usize> = scene.instances.iter().map(|instance| instance.primitive).collect();
        let divided: Vec<(usize, Meshlets)> =
            shown.into_par_iter().map(|primitive| (primitive, Meshlets::of(scene, &scene.primitives[primitive]))).collect();
        let mut meshlet_buffers = Self { spans: vec![(0, 0); scene.primitives.len()], ..Self::default() };
        for (primitive, meshlets) in divided {
            let first_triangle = meshlet_buffers.lists.len() as u32;
            meshlet_buffers.lists.extend(&meshlets.triangles);
            let first_vertex = meshlet_buffers.lists.len() as u32;
            meshlet_buffers.lists.extend(&meshlets.vertices);
            meshlet_buffers.spans[primitive] = (meshlet_buffers.records.len() as u32, meshlets.list.len() as u32);
            meshlet_buffers.records.extend(meshlets.list.iter().map(|meshlet| record(meshlet, first_triangle, first_vertex)));
        }
        meshlet_buffers.count = scene.instances.iter().map(|instance| meshlet_buffers.spans[instance.primitive].1).sum();
        meshlet_buffers
    }

    /// What a picture knows of every draw; one record at least.
    fn instances(&self, scene: &Scene, draws: &[Draw], view: &View) -> Vec<InstanceRecord> {
        let mut first = 0;
        let mut records: Vec<InstanceRecord> = draws
            .iter()
            .map(|draw| {
                let (first_meshlet, count) = self.spans[draw.primitive];
                let instance = InstanceRecord { first, first_meshlet, ..instance(scene, draw, view) };
                first += count;
                instance
            })
            .collect();
        records.resize(draws.len().max(1), InstanceRecord::default());
        records
    }
}

fn record(meshlet: &Meshlet, first_triangle: u32, first_vertex: u32) -> MeshletRecord {
    let with = |[x, y, z]: [f32; 3], w: f32| [x, y, z, w];
    MeshletRecord {
        center: with(meshlet.center, meshlet.cos),
        half: with(meshlet.half, meshlet.sin),
        axis: with(meshlet.axis, meshlet.altitude),
        first_triangle: first_triangle + meshlet.first_triangle,
        first_vertex: first_vertex + meshlet.first_vertex,
        triangles: meshlet.triangle_count,
        vertices: meshlet.vertex_count,
    }
}

fn instance(scene: &Scene, draw: &Draw, view: &View) -> InstanceRecord {
    let primitive = &scene.primitives[draw.primitive];
    // Floats bend a vertex within 2^-18 of the places to which its joints take it; the box holds those.
    let (center, half) = center_and_half(&draw.object_bounds(primitive), 1.0 / f64::from(1 << 16));
    let deforms = draw.deform.is_some();
    let sight = if deforms || draw.double_sided { None } else { Sight::of(draw, view) };
    let Sight { eye, area, length } = sight.unwrap_or_default();
    InstanceRecord {
        eye,
        center: [center[0], center[1], center[2], area],
        half: [half[0], half[1], half[2], length],
        flags: if sight.is_some() { FACES } else { 0 } | if deforms { DEFORMS } else { 0 },
        ..InstanceRecord::default()
    }
}

/// Does a draw lie outside the picture, with ten times as much to spare as the kernels leave?
pub fn is_outside(draw: &Draw, scene: &Scene) -> bool {
    const SLACK: f64 = 1e-4;
    let columns = draw.clip_from_object.map(|column| DVec4::from(column.map(f64::from)));
    let corners = draw.object_bounds(&scene.primitives[draw.primitive]).corners();
    let ends = corners.map(|corner| {
        let p = corner - draw.origin();
        let terms = [columns[0] * p.x, columns[1] * p.y, columns[2] * p.z, columns[3]];
        let (c, sums) = (terms.iter().sum::<DVec4>(), terms.iter().map(|term| term.abs()).sum::<DVec4>() * SLACK);
        let least = |beyond: f64, sum: f64| beyond + sum + sums.w;
        [least(c.w + c.x, sums.x), least(c.w - c.x, sums.x), least(c.w + c.y, sums.y), least(c.w - c.y, sums.y), least(c.w - c.z, sums.z)]
    });
    (0..5).any(|side| ends.iter().all(|end| end[side] < 0.0))
}

/// From where a draw is seen, in object space.
#[derive(Clone, Copy, Default)]
struct Sight {
    eye: [f32; 4],
    area: f32,
    length: f32,
}

impl Sight {
    /// None where the numbers run out of range.
    fn of(draw: &Draw, view: &View) -> Option<Self> {
        let clip_from_object = DMat4::from_cols_array_2d(&draw.clip_from_object.map(|column| column.map(f64::from)));
        let [x, y, w] = [0, 1, 3].map(|row| clip_from_object.row(row));
        let size = [view.width, view.height].map(|pixels| f64::from(pixels) * f64::from(view.units_per_pixel()) * 0.5);
        // Where front faces turn clockwise on screen, sides are exchanged.
        let hand = if draw.mirrored { -1.0 } else { 1.0 };
        let (eye, area) = if w.truncate() == DVec3::ZERO {
            let along = x.truncate().cross(y.truncate());
            ((along.normalize_or_zero() * -hand).extend(0.0), if w.w == 1.0 { along.length() } else { 0.0 })
        } else {
            // The columns of the transpose are the rows; x, y and w vanish at the eye.
            let rows = DMat3::from_cols(x.truncate(), y.truncate(), w.truncate()).transpose();
            let eye = rows.inverse() * -DVec3::new(x.w, y.w, w.w);
            (eye.extend(-(rows.determinant() * hand).signum()), rows.determinant().abs())
        };
        let area = area * size[0] * size[1] * (1.0 - 1e-5);
        let lengths = [(x, size[0]), (y, size[1])].map(|(row, size)| (row.truncate().length() + 2.0 * w.truncate().length()) * size);
        let length = (lengths[0] * lengths[0] + lengths[1] * lengths[1]).sqrt() * (1.0 + 1e-5);
        let is_usable = eye.is_finite() && eye.abs().max_element() < 1e12 && (1e-24..1e24).contains(&area) && length < 1e24;
        is_usable.then(|| Self { eye: eye.as_vec4().into(), area: area as f32, length: rounded_up(length) })
    }
}

/// Whole blocks of 64 x 64 pixels.
fn blocks(view: &View) -> [u32; 2] {
    [view.width.div_ceil(64), view.height.div_ceil(64)]
}

impl Buffers {
    /// Makes everything that culling reads hold this picture. The meshlets themselves stay while the scene does.
    pub(super) fn fill_culling(
        &mut self,
        gpu: &Gpu,
        meshlet_buffers: &MeshletBuffers,
        option: Culling,
        (scene, draws, view): (&Scene, &[Draw], &View),
    ) -> Result<(), RenderError> {
        let [across, down] = blocks(view);
        let (tiles, lists) = (64 * across * down, meshlet_buffers.lists.len() as u64);
        let uniform = CullingUniform {
            meshlet_count: meshlet_buffers.count,
            first_visible: lists as u32,
            hiz_width: 8 * across,
            hiz_first_block: tiles,
        };
        self.fill(gpu, "culling", bytemuck::bytes_of(&uniform), wgpu::BufferUsages::UNIFORM, "how many meshlets there are")?;
        let instances = meshlet_buffers.instances(scene, draws, view);
        self.fill(gpu, "instances", bytemuck::cast_slice(&instances), STORAGE, "a box round every instance, and from where it is seen")?;
        if !self.has("meshlets") {
            self.fill(
                gpu,
                "meshlets",
                bytemuck::cast_slice(&meshlet_buffers.records),
                STORAGE,
                "bounds of meshlet_buffers of up to 64 triangles",
            )?;
            let room = 4 * (lists + VISIBLE_MESHLET_WORDS * u64::from(meshlet_buffers.count));
            let why = "triangles and vertices of every meshlet, and behind them the meshlets that culling left";
            self.fill_room(gpu, "meshlet_lists", bytemuck::cast_slice(&meshlet_buffers.lists), room, STORAGE, why)?;
        }
        if option == Culling::TwoPass {
            self.ensure(
                gpu,
                "meshlet_visibility",
                4 * u64::from(meshlet_buffers.count),
                STORAGE,
                "which meshlets nothing hid in the picture before",
            )?;
        }
        if option.occludes() {
            let words = u64::from(tiles) + u64::from(across * down);
            self.ensure(gpu, "hiz", 4 * words, STORAGE, "the farthest depth of every 8 x 8 and every 64 x 64 pixels")?;
        }
        Ok(())
    }
}
