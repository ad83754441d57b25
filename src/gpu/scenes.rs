//! Scenes on the device: uploaded as they are, with the cloud that a stack puts beside them.

use std::{borrow::Cow, sync::Arc};

use super::{RenderError, Renderer, STORAGE, deforms::DEFORMED_BYTES, prepare::first_capacities};
use crate::{effects::Stack, scene::Scene};

impl Renderer {
    /// Uploads a scene's bytes as they are. The one in place stays when the new one does not fit.
    pub fn set_scene(&mut self, scene: &Arc<Scene>) -> Result<(), RenderError> {
        if self.base.as_ref().is_some_and(|current| Arc::ptr_eq(current, scene)) {
            return Ok(());
        }
        self.upload(scene)?;
        (self.base, self.particle_settings) = (Some(scene.clone()), None);
        Ok(())
    }

    /// Puts the cloud of a stack beside the scene, or takes it away.
    pub(super) fn attach_particles(&mut self, stack: &Stack) -> Result<(), RenderError> {
        let particle_settings = stack.particle_settings();
        if particle_settings == self.particle_settings {
            return Ok(());
        }
        let base = self.base.clone().ok_or(RenderError::NoScene)?;
        let scene = match base.with_particles(particle_settings.as_ref()) {
            Cow::Borrowed(_) => base.clone(),
            Cow::Owned(scene) => Arc::new(scene),
        };
        if particle_settings.map(|particle_settings| particle_settings.count)
            == self.particle_settings.map(|particle_settings| particle_settings.count)
        {
            // Another room has the same bytes.
            self.scene = Some(scene);
        } else {
            self.upload(&scene)?;
        }
        self.particle_settings = particle_settings;
        Ok(())
    }

    fn upload(&mut self, scene: &Arc<Scene>) -> Result<(), RenderError> {
        let limit = self.gpu.caps.max_storage_binding_bytes.min(self.gpu.caps.max_buffer_bytes);
        let vertices = 16 * scene.vertex_count();
        let room = scene.vertex_bytes.len() as u64 + u64::from(DEFORMED_BYTES) * scene.deformable_vertex_count();
        for (buffer, bytes) in [("vertex_bytes", room), ("index_bytes", scene.index_bytes.len() as u64), ("vertices", vertices)] {
            if bytes > limit {
                return Err(RenderError::TooLarge { buffer, bytes, limit });
            }
        }
        self.buffers.keep(|name| {
            !matches!(name, "vertex_bytes" | "index_bytes" | "vertices" | "meshlets" | "meshlet_lists" | "meshlet_visibility" | "hiz")
        });
        self.meshlet_buffers = None;
        self.occluders = None;
        self.hold_attributes(scene, None)?;
        if !scene.index_bytes.is_empty() {
            self.buffers.fill(
                &self.gpu,
                "index_bytes",
                &scene.index_bytes,
                STORAGE | wgpu::BufferUsages::INDEX,
                "index lists as the file has them",
            )?;
        }
        self.capacities = first_capacities(scene);
        self.force_all_paths = false;
        self.history = None;
        self.full = None;
        self.dots = None;
        self.texels = None;
        self.shadow_pass = None;
        self.scene = Some(scene.clone());
        Ok(())
    }
}
