//! Meshlets of the scene's meshes as the culling pass reads them, and the record that it reads of
//! every instance.

use std::collections::BTreeSet;

use glam::{DMat3, DMat4, DVec3, DVec4};
use rayon::prelude::*;

use crate::{
    device::{Gpu, error::RenderError},
    layout::{
        BufferId,
        frame_layout::SceneCounts,
        records::{InstanceRecord, MeshletRecord},
    },
    resources::buffers::Buffers,
    scene::{
        Scene,
        draw::{Draw, MANY_DRAWS},
        meshlets::{Meshlet, Meshlets, center_and_half, rounded_up},
        view::View,
    },
};

/// `INSTANCE_FACES` and `INSTANCE_DEFORMS` of the shaders.
const FACES: u32 = 1;
const DEFORMS: u32 = 2;

/// The meshlets of a scene's primitives, as the kernels read them.
#[derive(Default)]
pub struct MeshletBuffers {
    pub records: Vec<MeshletRecord>,
    /// Triangles and vertices of all meshlets.
    pub lists: Vec<u32>,
    /// First record of each primitive, and how many; none for a primitive without instances.
    spans: Vec<(u32, u32)>,
    /// Meshlets of all instances.
    count: u32,
}

impl MeshletBuffers {
    /// Divides every primitive that has an instance.
    pub fn of(scene: &Scene) -> Self {
        let shown: BTreeSet<usize> = scene
            .instances
            .iter()
            .map(|instance| instance.primitive)
            .collect();
        let divided: Vec<(usize, Meshlets)> = shown
            .into_par_iter()
            .map(|primitive| (primitive, Meshlets::of(scene, &scene.primitives[primitive])))
            .collect();
        let mut meshlet_buffers = Self {
            spans: vec![(0, 0); scene.primitives.len()],
            ..Self::default()
        };
        for (primitive, meshlets) in divided {
            let first_triangle = meshlet_buffers.lists.len() as u32;
            meshlet_buffers.lists.extend(&meshlets.triangles);
            let first_vertex = meshlet_buffers.lists.len() as u32;
            meshlet_buffers.lists.extend(&meshlets.vertices);
            meshlet_buffers.spans[primitive] = (
                meshlet_buffers.records.len() as u32,
                meshlets.list.len() as u32,
            );
            meshlet_buffers.records.extend(
                meshlets
                    .list
                    .iter()
                    .map(|meshlet| record(meshlet, first_triangle, first_vertex)),
            );
        }
        meshlet_buffers.count = scene.instances.iter().fold(0, |sum: u32, instance| {
            sum.saturating_add(meshlet_buffers.spans[instance.primitive].1)
        });
        meshlet_buffers
    }

    /// How many meshlets there are.
    pub fn counts(&self) -> SceneCounts {
        let (meshlet_records, meshlet_words) = (self.records.len() as u64, self.lists.len() as u32);
        SceneCounts {
            meshlets: self.count,
            meshlet_records,
            meshlet_words,
            ..SceneCounts::default()
        }
    }

    /// Writes them.
    pub async fn write(&self, gpu: &Gpu, buffers: &Buffers) -> Result<(), RenderError> {
        let (records, lists) = (
            bytemuck::cast_slice(&self.records),
            bytemuck::cast_slice(&self.lists),
        );
        buffers
            .write_at(gpu, BufferId::Meshlets, 0, records)
            .await?;
        buffers
            .write_at(gpu, BufferId::MeshletLists, 0, lists)
            .await
    }

    /// A record of every draw as `view` sees it; one at least.
    pub fn instances(&self, scene: &Scene, draws: &[Draw], view: &View) -> Vec<InstanceRecord> {
        let mut records: Vec<InstanceRecord> = draws
            .par_iter()
            .with_min_len(MANY_DRAWS)
            .map(|draw| instance(scene, draw, view))
            .collect();
        let mut first = 0;
        for (record, draw) in records.iter_mut().zip(draws) {
            let (first_meshlet, count) = self.spans[draw.primitive];
            (record.first, record.first_meshlet) = (first, first_meshlet);
            first += count;
        }
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
    // In floats, joints take a vertex to within 2^-18 of its exact position; the box holds both.
    let (center, half) = center_and_half(&draw.object_bounds(primitive), 1.0 / f64::from(1 << 16));
    let deforms = draw.deform.is_some();
    let sight = if deforms || draw.double_sided {
        None
    } else {
        Sight::of(draw, view)
    };
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
    let columns = draw
        .clip_from_object
        .map(|column| DVec4::from(column.map(f64::from)));
    let corners = draw
        .object_bounds(&scene.primitives[draw.primitive])
        .corners();
    let ends = corners.map(|corner| {
        let p = corner - draw.origin();
        let terms = [
            columns[0] * p.x,
            columns[1] * p.y,
            columns[2] * p.z,
            columns[3],
        ];
        let (c, sums) = (
            terms.iter().sum::<DVec4>(),
            terms.iter().map(|term| term.abs()).sum::<DVec4>() * SLACK,
        );
        let least = |beyond: f64, sum: f64| beyond + sum + sums.w;
        [
            least(c.w + c.x, sums.x),
            least(c.w - c.x, sums.x),
            least(c.w + c.y, sums.y),
            least(c.w - c.y, sums.y),
            least(c.w - c.z, sums.z),
        ]
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
        let clip_from_object =
            DMat4::from_cols_array_2d(&draw.clip_from_object.map(|column| column.map(f64::from)));
        let [x, y, w] = [0, 1, 3].map(|row| clip_from_object.row(row));
        let size = [view.width, view.height]
            .map(|pixels| f64::from(pixels) * f64::from(view.units_per_pixel()) * 0.5);
        // Where front faces turn clockwise on screen, sides are exchanged.
        let hand = if draw.mirrored { -1.0 } else { 1.0 };
        let (eye, area) = if w.truncate() == DVec3::ZERO {
            let along = x.truncate().cross(y.truncate());
            (
                (along.normalize_or_zero() * -hand).extend(0.0),
                if w.w == 1.0 { along.length() } else { 0.0 },
            )
        } else {
            // The columns of the transpose are the rows; x, y and w vanish at the eye.
            let rows = DMat3::from_cols(x.truncate(), y.truncate(), w.truncate()).transpose();
            let eye = rows.inverse() * -DVec3::new(x.w, y.w, w.w);
            (
                eye.extend(-(rows.determinant() * hand).signum()),
                rows.determinant().abs(),
            )
        };
        let area = area * size[0] * size[1] * (1.0 - 1e-5);
        let lengths = [(x, size[0]), (y, size[1])]
            .map(|(row, size)| (row.truncate().length() + 2.0 * w.truncate().length()) * size);
        let length = (lengths[0] * lengths[0] + lengths[1] * lengths[1]).sqrt() * (1.0 + 1e-5);
        let is_usable = eye.is_finite()
            && eye.abs().max_element() < 1e12
            && (1e-24..1e24).contains(&area)
            && length < 1e24;
        is_usable.then(|| Self {
            eye: eye.as_vec4().into(),
            area: area as f32,
            length: rounded_up(length),
        })
    }
}
