//! The past: what a picture starts from of the one before it.

use super::{Renderer, prepare::BACKGROUND_ROWS, uniforms::color_stride};
use crate::{effects::Stack, scene::view::View, shader::key::KernelKey};

impl Renderer {
    /// Empties what culling remembers of the picture before, unless that was one like this.
    pub(super) fn keep_occluders(&mut self, encoder: &mut wgpu::CommandEncoder, key: &KernelKey, view: &View, stack: &Stack) {
        if self.is_judged {
            return;
        }
        let now = ([view.width, view.height], stack.clone());
        if self.occluders.as_ref() != Some(&now) {
            self.clear(encoder, &["meshlet_visibility", "hiz"]);
        }
        self.occluders = key.options.culling.occludes().then_some(now);
    }

    /// Makes the colour buffer hold the picture before this one where an effect reads it, and a copy that outlives the
    /// resolve. A picture that is drawn again stands after the same one as before.
    pub(super) fn keep_previous(&mut self, encoder: &mut wgpu::CommandEncoder, key: &KernelKey, view: &View, stack: &Stack) {
        if !key.reads_previous() {
            self.history = None;
            return;
        }
        let now = (view.clone(), stack.clone());
        let bytes = 4 * u64::from(color_stride(view.width)) * u64::from(view.height);
        match &self.history {
            Some(history) if *history == now => {
                encoder.copy_buffer_to_buffer(self.buffers.get("previous"), 0, self.buffers.get("color"), 0, bytes);
            }
            history => {
                if history.as_ref().is_none_or(|(history, _)| [history.width, history.height] != [view.width, view.height]) {
                    self.fill_background(encoder, view);
                }
                encoder.copy_buffer_to_buffer(self.buffers.get("color"), 0, self.buffers.get("previous"), 0, bytes);
            }
        }
        self.history = Some(now);
    }

    /// Copies rows of background over the picture, for resolves that leave empty tiles alone, or what they come after.
    pub(super) fn fill_background(&self, encoder: &mut wgpu::CommandEncoder, view: &View) {
        let (from, to) = (self.buffers.get("background"), self.buffers.get("color"));
        let row = 4 * u64::from(color_stride(view.width));
        for first in (0..view.height).step_by(BACKGROUND_ROWS as usize) {
            let rows = BACKGROUND_ROWS.min(view.height - first);
            encoder.copy_buffer_to_buffer(from, 0, to, row * u64::from(first), row * u64::from(rows));
        }
    }
}
