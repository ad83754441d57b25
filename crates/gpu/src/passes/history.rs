//! Temporal history: what a picture starts from of the one before it.

use super::{layer_sums::RoomForLayers, view_resources::ViewResources};
use crate::{
    device::error::RenderError,
    effects::{Stack, hooks::Layers, xray},
    layout::{
        BufferId, ClearedBy,
        frame_layout::{FrameLayout, Region},
    },
    resources::buffers::Buffers,
    scene::view::View,
    shader::key::KernelKey,
};

/// What a picture starts from of the one before it.
#[derive(Default)]
pub struct History {
    /// What the color buffer shows, where an effect reads it as the previous picture.
    previous: Option<(View, Stack)>,
    /// The picture whose kept pass wrote the buffer of kept pixels last.
    kept: Option<(View, Stack)>,
    /// Size and stack of the picture whose depths and meshlets the next one may start from.
    occluders: Option<([u32; 2], Stack)>,
    /// The last picture.
    last: Option<(View, Stack)>,
    /// The last picture whose sums of layers overflowed, and the bits per channel that it gets
    /// instead.
    full_sums: Option<(View, Stack, u32)>,
    /// Pictures of this scene have had more layers on a pixel than sums in one 64-bit integer
    /// hold.
    is_deep: bool,
    /// Bands in which pictures of this scene had to draw glass; 0 as 1.
    glass_bands: u32,
}

impl History {
    /// Forgets what the next picture would start from: background comes before it.
    pub fn clear(&mut self) {
        (self.previous, self.kept, self.occluders) = (None, None, None);
    }

    /// Forgets all pictures of a scene.
    pub fn change_scene(&mut self) {
        self.clear();
        (self.full_sums, self.is_deep, self.glass_bands) = (None, false, 0);
    }

    /// Remembers the picture that was drawn.
    pub fn finish(&mut self, view: &View, stack: &Stack) {
        self.last = Some((view.clone(), stack.clone()));
    }

    /// What layers need on this picture, as far as earlier ones have shown.
    pub fn room_for_layers(&self, view: &View, stack: &Stack) -> RoomForLayers {
        let full = self
            .full_sums
            .as_ref()
            .filter(|(of, with, _)| (of, with) == (view, stack));
        RoomForLayers {
            fewer_bits: full.map(|(.., bits)| *bits),
            is_deep: self.is_deep,
            glass_bands: self.glass_bands,
        }
    }

    /// Draws glass in so many bands from now on.
    pub fn divide_glass(&mut self, bands: u32) {
        self.glass_bands = bands;
    }

    /// Makes room for the layers of the last picture, whose sums overflowed: a word for each sum,
    /// else fewer bits per channel; false where it has the fewest.
    pub fn make_room_for_layers(&mut self, key: &KernelKey) -> bool {
        if key.framebuffer.has_one64_sums {
            self.is_deep = true;
            return true;
        }
        let bits = match key.framebuffer.layers {
            Some(Layers::Xray { bits }) => xray::fewer(bits),
            _ => None,
        };
        let Some((bits, (view, stack))) = bits.zip(self.last.clone()) else {
            return false;
        };
        self.full_sums = Some((view, stack, bits));
        true
    }

    /// Clears the depths and meshlets that culling starts from, unless they are of a picture like
    /// this one.
    pub fn keep_occluders(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        resources: &ViewResources,
        view: &View,
        stack: &Stack,
    ) -> Result<(), RenderError> {
        let now = ([view.width, view.height], stack.clone());
        if self.occluders.as_ref() != Some(&now) {
            resources.clear(encoder, |occasion| occasion == ClearedBy::History)?;
        }
        self.occluders = resources
            .frame()?
            .plan
            .key
            .options
            .culling
            .occludes()
            .then_some(now);
        Ok(())
    }

    /// Makes the color buffer hold the previous picture where an effect reads it, and a copy that
    /// the resolve does not overwrite. A picture that is drawn again starts from the same one
    /// as before.
    pub fn keep_previous(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        resources: &ViewResources,
        view: &View,
        stack: &Stack,
    ) -> Result<(), RenderError> {
        let frame = resources.frame()?;
        if !frame.plan.key.reads_previous() {
            self.previous = None;
            return Ok(());
        }
        let now = (view.clone(), stack.clone());
        let buffers = &resources.buffers;
        let (previous, color) = (
            buffers.get(BufferId::Previous)?,
            buffers.get(BufferId::Color)?,
        );
        let bytes = frame
            .layout
            .region(Region::Pixels)
            .map_or(0, |span| span.bytes.end);
        match &self.previous {
            Some(previous_picture) if *previous_picture == now => {
                encoder.copy_buffer_to_buffer(previous, 0, color, 0, bytes)
            }
            other => {
                if other.as_ref().is_none_or(|(other, _)| {
                    [other.width, other.height] != [view.width, view.height]
                }) {
                    fill_background(encoder, buffers, &frame.layout)?;
                }
                encoder.copy_buffer_to_buffer(color, 0, previous, 0, bytes);
            }
        }
        self.previous = Some(now);
        Ok(())
    }

    /// Gives the kept pass of an effect what it wrote in the previous picture: zeros if that had
    /// another size or none. A picture that is drawn again starts from the same one as before.
    pub fn keep_pass(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        resources: &ViewResources,
        view: &View,
        stack: &Stack,
    ) -> Result<(), RenderError> {
        let frame = resources.frame()?;
        let Some(pass) = frame.plan.key.kept_pass() else {
            self.kept = None;
            return Ok(());
        };
        let (kept, before) = (
            resources.buffers.get(BufferId::ImageKept)?,
            resources.buffers.get(BufferId::ImageKeptBefore)?,
        );
        let is_next = |(other, with): &(View, Stack)| {
            let size = |view: &View| pass.size([view.width, view.height]);
            size(other) == size(view) && with.kept() == stack.kept()
        };
        let now = (view.clone(), stack.clone());
        match &self.kept {
            Some(last) if *last == now => {}
            Some(last) if is_next(last) => {
                let bytes = kept.size().min(before.size());
                encoder.copy_buffer_to_buffer(kept, 0, before, 0, bytes);
            }
            _ => encoder.clear_buffer(before, 0, None),
        }
        self.kept = Some(now);
        Ok(())
    }
}

/// Copies rows of background over the picture, for resolves that leave empty tiles alone, and for
/// what a first picture starts from.
pub fn fill_background(
    encoder: &mut wgpu::CommandEncoder,
    buffers: &Buffers,
    layout: &FrameLayout,
) -> Result<(), RenderError> {
    let (from, to) = (
        buffers.get(BufferId::Background)?,
        buffers.get(BufferId::Color)?,
    );
    let bytes = layout
        .region(Region::Pixels)
        .map_or(0, |span| span.bytes.end);
    let height = u64::from(layout.size[1].max(1));
    let step = bytes / height * u64::from(layout.background_rows());
    for first in (0..bytes).step_by(step.max(1) as usize) {
        encoder.copy_buffer_to_buffer(from, 0, to, first, step.min(bytes - first));
    }
    Ok(())
}
