//! The shadow pass: a second view of the scene, as a directional light sees it. Depths alone are
//! drawn, into the map by which the picture is shaded. The scene's buffers are read as the
//! picture's passes deformed them.

use glam::{DMat4, DVec3};

use super::{
    layer_sums::RoomForLayers,
    pass_purpose::pass_purpose,
    recording::{Device, Resources, Timing},
    view_resources::{Request, ViewResources},
};
use crate::{
    accuracy::{Coverage, Culling, DepthFormat, PinnedOptions, VertexTransform, Visibility},
    device::{Gpu, error::RenderError, timer::Timer},
    effects::Stack,
    layout::{
        BufferId, ClearedBy, TextureId,
        frame_layout::Target,
        queues::recorded_capacities,
        records::{CounterRecord, ShadowMapUniform},
    },
    plan::{AccuracyRequest, Note},
    resources::{
        buffers::{BufferNote, Buffers},
        textures::WordTexture,
    },
    scene::view::View,
    scene_data::scene_resources::SceneResources,
    shader::pass::Pass,
};

/// A second view of the scene, as a directional light sees it. Depths alone are drawn, into the
/// shadow map.
pub struct ShadowPass {
    pub resources: ViewResources,
    /// The scene as the light sees it.
    pub view: View,
    /// The uniform that maps positions to the shadow map.
    pub uniform: Buffers,
    /// A copy of the map for kernels that may bind no further storage buffer; see
    /// [`crate::plan::Tuning::buffered_shadow_map`].
    pub map: Option<WordTexture>,
}

impl ShadowPass {
    /// Plans what the light of the stack sees and allocates its buffers, with the resources of the
    /// pass before it; none where no effect asks for shadows.
    pub async fn prepare(
        previous: Option<Self>,
        device: &mut Device,
        scene: &mut SceneResources,
        view: &View,
        stack: &Stack,
    ) -> Result<Option<Self>, RenderError> {
        let picture = view;
        let Some(view) = stack.light_view(scene.scene(), picture) else {
            return Ok(None);
        };
        let (mut resources, mut uniform, map) = match previous {
            Some(Self {
                resources,
                uniform,
                map,
                ..
            }) => (resources, uniform, map),
            None => (
                ViewResources::new(Target::ShadowMap, Some(scene.scene())),
                Buffers::default(),
                None,
            ),
        };
        let accuracy = AccuracyRequest {
            pins: pins(),
            ..AccuracyRequest::default()
        };
        let shown = [view.width, view.height];
        let request = Request {
            view: &view,
            stack: &stack.shadow_casters(),
            accuracy: &accuracy,
            shown,
            room: RoomForLayers::default(),
        };
        resources.prepare(device, scene, &request).await?;
        uniform
            .fill(
                &device.gpu,
                BufferId::ShadowMapView,
                bytemuck::bytes_of(&ShadowMapUniform::new(&view, picture.eye)),
            )
            .await?;
        let map = match map.filter(|map| map.texture.width() == view.width) {
            _ if device.tuning.buffered_shadow_map => None,
            Some(map) => Some(map),
            None => Some(new_map(&device.gpu, view.width).await?),
        };
        let passes = resources.frame()?.plan.key.light_frame();
        resources
            .prepare_passes(device, passes, &Resources::of_scene(scene))
            .await?;
        Ok(Some(Self {
            resources,
            view,
            uniform,
            map,
        }))
    }

    /// Draws what the light sees, and copies it to the texture if there is one.
    pub fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timer: Option<&mut Timer>,
    ) -> Result<(), RenderError> {
        self.resources
            .clear(encoder, |occasion| occasion != ClearedBy::History)?;
        self.resources.record(
            self.resources.passes(),
            encoder,
            Timing {
                timer,
                ends_frame: false,
            },
        )?;
        let Some(map) = &self.map else { return Ok(()) };
        // Rows of the map are multiples of 256 bytes.
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * self.view.width),
            rows_per_image: None,
        };
        let source = wgpu::TexelCopyBufferInfo {
            buffer: self.resources.buffers.get(BufferId::DepthKeys)?,
            layout,
        };
        encoder.copy_buffer_to_texture(source, map.texture.as_image_copy(), map.texture.size());
        Ok(())
    }

    /// How many entries the queues lost; they grow, so that the next picture is complete.
    pub fn collect_stats(&mut self, record: &CounterRecord) -> u32 {
        self.resources.demand = Some(*record);
        let Ok(frame) = self.resources.frame() else {
            return 0;
        };
        let lost = record
            .counters(&recorded_capacities(
                &frame.plan.key,
                &self.resources.capacities,
            ))
            .overflow;
        if lost > 0 {
            self.resources.grow_queues(record);
        }
        lost
    }

    /// Its passes with their purposes.
    pub fn passes(&self) -> Vec<Note> {
        let passes = self
            .resources
            .frame()
            .map(|frame| frame.plan.key.light_frame())
            .unwrap_or_default();
        let note = |pass: Pass| Note {
            name: format!("light {}", pass.label()),
            why: format!("for the light: {}", pass_purpose(pass)),
        };
        passes.into_iter().map(note).collect()
    }

    /// What it holds for itself.
    pub fn notes(&self) -> Vec<BufferNote> {
        let own = self.resources.buffers.notes().into_iter();
        own.map(|note| BufferNote {
            name: format!("light {}", note.name),
            why: format!("for the light: {}", note.why),
            ..note
        })
        .collect()
    }
}

/// The options that every shadow map is drawn with, as the oracle takes for granted. A planner
/// would choose cheaper ones where a light sees its scene edge-on: nothing is covered then, and
/// nothing can be wrong.
fn pins() -> PinnedOptions {
    PinnedOptions::of(Visibility::Split32)
        .with(Culling::None)
        .with(Coverage::Fixed8)
        .with(VertexTransform::Snapped)
        .with(DepthFormat::Reversed)
}

async fn new_map(gpu: &Gpu, side: u32) -> Result<WordTexture, RenderError> {
    let size = wgpu::Extent3d {
        width: side,
        height: side,
        depth_or_array_layers: 1,
    };
    WordTexture::new(
        gpu,
        TextureId::ShadowMap,
        size,
        wgpu::TextureViewDimension::D2,
    )
    .await
}

impl ShadowMapUniform {
    /// The uniform of a light's view, for positions relative to `eye`.
    pub fn new(view: &View, eye: DVec3) -> Self {
        let half = f64::from(view.width) * 0.5;
        let clip_from_eye = view.clip_from_world * DMat4::from_translation(eye);
        let row = |i: usize| clip_from_eye.row(i);
        let rounded = |row: glam::DVec4| row.to_array().map(|v| v as f32);
        // Half a picture is one unit of normalized device coordinates, whose y points up.
        let [column, down, depth] = [(row(0) + row(3)) * half, (row(3) - row(1)) * half, row(2)];
        Self {
            column: rounded(column),
            row: rounded(down),
            depth: rounded(depth),
            texel_m: (1.0 / column.truncate().length()) as f32,
            range_m: (1.0 / depth.truncate().length()) as f32,
            side: view.width,
            spare: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{
        accuracy::AccuracyOptions,
        plan::{Caps, Planner},
        scene::{builtin, camera::Camera, light::light_view, needs::Needs},
    };

    #[test]
    fn a_scene_seen_edge_on_is_drawn_with_the_options_of_every_shadow_map() {
        let scene = builtin::build("slivers").unwrap();
        let picture = View::new(
            &Camera::default(),
            64,
            64,
            &scene.bounds(),
            DMat4::IDENTITY,
            [0.0; 4],
        );
        let light = light_view(DVec3::Y, &scene, &picture, 0.0);
        let stack = Stack::default();
        let needs = Arc::new(Needs::of(
            &scene,
            &stack.draws(&scene, &light).unwrap(),
            &light,
        ));
        let options = |pins: PinnedOptions| -> AccuracyOptions {
            let request = AccuracyRequest {
                pins,
                ..AccuracyRequest::default()
            };
            Planner::default()
                .plan(&needs, &stack, &Caps::ALL, &Caps::ALL.tuning(), &request)
                .unwrap()
                .key
                .options
        };
        assert_eq!(
            options(PinnedOptions::of(Visibility::Split32)).coverage,
            Coverage::Fixed4,
            "nothing is covered, so nothing can be wrong"
        );
        let drawn = options(pins());
        assert_eq!(
            (drawn.coverage, drawn.vertex_transform, drawn.depth),
            (
                Coverage::Fixed8,
                VertexTransform::Snapped,
                DepthFormat::Reversed
            )
        );
    }
}
