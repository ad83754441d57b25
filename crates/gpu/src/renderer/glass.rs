//! Room for layers of glass, as pictures ask for it.

use super::drawing::Renderer;
use crate::{
    device::error::RenderError,
    layout::{
        BufferId,
        glass::{FEWEST_LAYERS, more_bands, most_layers},
    },
    shader::KernelKey,
};

impl Renderer {
    /// Makes room for the layers of glass of a band, which are `demand`, or has the next pictures
    /// drawn in more bands; false where they are as many as can be.
    pub(crate) fn make_room_for_glass(&mut self, key: &KernelKey, demand: u32) -> bool {
        let Ok(frame) = self.picture.frame() else {
            return false;
        };
        let (pixels, bands) = (frame.view.pixels() as u64, key.framebuffer.glass_bands);
        let (caps, tuned) = (&self.device.gpu.caps, self.device.tuning.glass_layers);
        let most = |bands| most_layers(pixels, bands, caps, tuned);
        let (capacity, room) = (&mut self.picture.capacities.glass, most(bands));
        let wanted = demand.checked_next_power_of_two().unwrap_or(u32::MAX);
        if demand <= room {
            *capacity = wanted.min(room);
            return true;
        }
        let more = more_bands(bands, demand, most);
        if let Some(more) = more {
            *capacity = wanted.min(most(more));
            self.history.divide_glass(more);
        }
        more.is_some()
    }

    /// Has layers of glass take half the memory from now on, where an error says that there is none
    /// left and they may be the reason; false where they are not.
    pub(crate) fn makes_do_with_less_glass(&mut self, error: &RenderError) -> bool {
        let room = &mut self.picture.capacities.glass;
        if !matches!(error, RenderError::OutOfMemory { .. }) || *room <= FEWEST_LAYERS {
            return false;
        }
        *room /= 2;
        // A buffer that is somewhat larger than it must be would be kept.
        let layered = [
            BufferId::DepthKeys,
            BufferId::DepthAndId,
            BufferId::PackedDepthId,
        ];
        self.picture.buffers.keep(|id| !layered.contains(&id));
        self.device.tuning.glass_layers = self.device.tuning.glass_layers.min(*room);
        true
    }
}
