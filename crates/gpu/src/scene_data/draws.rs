//! Draw data: what a view's passes read about every instance, computed on the CPU when the scene,
//! the viewpoint or the format of the positions change.

use std::{ops::Range, sync::Arc};

use super::{
    attributes::AttributeLayout,
    deforms::{Deforms, deformed_ranges},
    draw_records::{DrawRecords, Placement, placements},
    meshlets::{MeshletBuffers, is_outside},
    packing::PackedBox,
};
use crate::{
    effects::glass::GlassDraws,
    layout::{
        frame_layout::SceneCounts,
        records::{DrawRecord, InstanceRecord},
    },
    scene::{
        Scene,
        draw::{Draw, totals},
        parts::Scope,
        view::View,
    },
};

/// What draw data follow from; equal inputs give equal data.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawInputs {
    pub view: View,
    pub attributes: AttributeLayout,
    /// Meshlets are culled, so every instance needs its record.
    pub culls: bool,
    /// Draws share what they say of their primitives.
    pub is_instanced: bool,
    /// The view writes matrices of instances behind the attributes, where these have room for them.
    pub places_instances: bool,
    /// No pass writes the records of points.
    pub projects_points: bool,
    /// Draws outside the picture are deformed too.
    pub deforms_offscreen: bool,
    /// Scopes of the stack.
    pub scopes: Vec<Scope>,
    /// Which draws are glass.
    pub glass: GlassDraws,
}

/// What a view's passes read about every instance, computed on the CPU when the scene, the
/// viewpoint or the position format changes.
pub struct DrawData {
    scene: Arc<Scene>,
    inputs: DrawInputs,
    pub records: DrawRecords,
    /// The matrices of instances; none where the view writes none.
    pub placements: Vec<Placement>,
    /// They are others than those of the draw data before.
    pub has_new_placements: bool,
    pub deforms: Deforms,
    /// Which of all vertices that may be deformed are deformed.
    pub deformed: Vec<Range<u32>>,
    pub instances: Vec<InstanceRecord>,
    pub counts: SceneCounts,
}

impl DrawData {
    /// Of the draws of `scene` as the view has them. `boxes` are those of packed positions, one per
    /// primitive, `before` the draw data of the same buffers as they are.
    pub fn new(
        scene: &Arc<Scene>,
        draws: &[Draw],
        inputs: DrawInputs,
        boxes: &[PackedBox],
        meshlets: Option<&MeshletBuffers>,
        before: Option<Self>,
    ) -> Self {
        let attributes = &inputs.attributes;
        let record = |draw: &Draw| {
            let record = DrawRecord::new(draw, scene, attributes);
            boxes.get(draw.primitive).map_or(record, |packed| {
                record.packed(packed, attributes.first_packed() as u32)
            })
        };
        let mut records = if inputs.is_instanced {
            DrawRecords::instanced(draws, attributes, record)
        } else {
            DrawRecords::whole(draws, record)
        };
        let known = before
            .filter(|data| data.places_like(scene, &inputs))
            .map(|data| data.placements);
        let has_new_placements = known.is_none();
        let placements = known.unwrap_or_else(|| {
            if inputs.places_instances && attributes.has_placements() {
                placements(draws)
            } else {
                Vec::new()
            }
        });
        // Nothing outside the picture is drawn, so it need not be deformed, unless its shadow may
        // fall into the picture.
        let is_deformed = |draw: &&Draw| {
            draw.deform.is_some() && (inputs.deforms_offscreen || !is_outside(draw, scene))
        };
        let deforms = Deforms::of(scene, attributes, draws.iter().filter(is_deformed));
        let deformed = deformed_ranges(scene, draws);
        let instances = meshlets.map_or_else(Vec::new, |meshlets| {
            meshlets.instances(scene, draws, &inputs.view)
        });
        let [vertices, triangles] = totals(scene, draws);
        let points = records.number_points(scene, draws, inputs.projects_points);
        let counts = SceneCounts {
            vertices: vertices - u64::from(points.unwritten),
            triangles,
            points: points.points.into(),
            point_blocks: points.blocks,
            first_box: (inputs.attributes.first_box() / 4) as u32,
            draws: draws.len() as u64,
            deformable: deformed.last().map_or(0, |range| range.end),
            deforms: deforms.records.len() as u64,
            joint_vectors: deforms.joints.len() as u64,
            morph_targets: deforms.morph_targets.len() as u64,
            particles: 0,
            ..meshlets.map_or_else(SceneCounts::default, MeshletBuffers::counts)
        };
        Self {
            scene: scene.clone(),
            inputs,
            records,
            placements,
            has_new_placements,
            deforms,
            deformed,
            instances,
            counts,
        }
    }

    /// Do these inputs give instances the same matrices to the world? The camera does not count.
    fn places_like(&self, scene: &Arc<Scene>, inputs: &DrawInputs) -> bool {
        let of = |inputs: &DrawInputs| (inputs.attributes, inputs.places_instances);
        Arc::ptr_eq(&self.scene, scene)
            && of(&self.inputs) == of(inputs)
            && self.inputs.view.scene_state == inputs.view.scene_state
    }

    /// Would these inputs give the same data?
    pub fn is_of(&self, scene: &Arc<Scene>, inputs: &DrawInputs) -> bool {
        Arc::ptr_eq(&self.scene, scene) && self.inputs == *inputs
    }
}
