//! The lamp: a renderer inside the renderer, which draws what a directional light sees, depth alone, into the map by which
//! the picture is shaded. It reads the scene's buffers, bent as the picture bends them, and has all others to itself.

use super::{
    BufferNote, RenderError, Renderer,
    explain::pass_purpose,
    prepare::{first_capacities, recorded_capacities},
    uniforms::{CounterRecord, LightUniform},
};
use crate::{
    accuracy::{Culling, PinnedOptions, Visibility},
    effects::Stack,
    frame::ShadowMap,
    plan::{AccuracyRequest, Note, Plan, Tuning},
    scene::view::View,
    shader::library::Library,
};

/// See the module's first line.
pub(super) struct ShadowPass {
    renderer: Renderer,
    plan: Plan,
    view: View,
}

/// Buffers that the lamp has from the picture.
const SHARED: [&str; 2] = ["vertex_bytes", "index_bytes"];

impl Renderer {
    /// Plans what the light of the stack sees, if it has one, and makes room for it.
    pub(super) fn prepare_shadow_pass(&mut self, view: &View, stack: &Stack) -> Result<(), RenderError> {
        let scene = self.scene.clone().ok_or(RenderError::NoScene)?;
        let Some(meshlet_visibility) = stack.light_view(&scene, view) else {
            self.shadow_pass = None;
            self.buffers.keep(|name| !matches!(name, "light" | "shadow_map"));
            return Ok(());
        };
        let casting = stack.casting();
        let mut renderer = match self.shadow_pass.take() {
            Some(shadow_pass) => shadow_pass.renderer,
            // The picture's own pipelines and stamps are lent to it while it records.
            None => Self { timer: None, is_shadow_pass: true, ..Self::with_library(self.gpu.clone(), Library::default()) },
        };
        if renderer.scene.is_none() {
            renderer.capacities = first_capacities(&scene);
        }
        renderer.tuning = Tuning { listed_tiles: false, ..self.tuning };
        renderer.scene = Some(scene);
        renderer.texels = self.texels.clone();
        SHARED.iter().for_each(|name| renderer.buffers.share(name, &self.buffers));
        let accuracy = AccuracyRequest { pins: PinnedOptions::of(Visibility::Split32).with(Culling::None), ..AccuracyRequest::default() };
        let plan = renderer.prepare(&meshlet_visibility, &casting, &accuracy)?;
        let uniform = LightUniform::new(&meshlet_visibility);
        let usage = wgpu::BufferUsages::UNIFORM;
        self.buffers.fill(&self.gpu, "light", bytemuck::bytes_of(&uniform), usage, "what takes places to the shadow map")?;
        self.buffers.ensure_texels(
            &self.gpu,
            "shadow_map",
            meshlet_visibility.width,
            "nearest depth key to the light per texel, 4 bytes",
        )?;
        self.shadow_pass = Some(Box::new(ShadowPass { renderer, plan, view: meshlet_visibility }));
        Ok(())
    }

    /// Draws what the light sees, and copies it to where the shading reads it.
    pub(super) fn record_shadow_pass(&mut self, encoder: &mut wgpu::CommandEncoder) -> Result<(), RenderError> {
        let Some(mut shadow_pass) = self.shadow_pass.take() else { return Ok(()) };
        let inner = &mut shadow_pass.renderer;
        std::mem::swap(&mut inner.pipelines, &mut self.pipelines);
        std::mem::swap(&mut inner.timer, &mut self.timer);
        inner.clear(encoder, &["counters", "depth_keys"]);
        let recorded = inner.record(encoder, &shadow_pass.plan.key, &shadow_pass.plan.key.light_frame(), &shadow_pass.view, false);
        std::mem::swap(&mut inner.pipelines, &mut self.pipelines);
        std::mem::swap(&mut inner.timer, &mut self.timer);
        self.buffers.fill_texels(encoder, "shadow_map", inner.buffers.get("depth_keys"));
        self.shadow_pass = Some(shadow_pass);
        recorded
    }

    /// How many entries the lamp's queues lost; they grow, so that the next picture is whole.
    pub(super) fn collect_shadow_stats(&mut self, record: &CounterRecord) -> u32 {
        let Some(shadow_pass) = &mut self.shadow_pass else { return 0 };
        let lost = record.counters(&recorded_capacities(&shadow_pass.plan.key, &shadow_pass.renderer.capacities)).overflow;
        if lost > 0 {
            let key = shadow_pass.plan.key.clone();
            shadow_pass.renderer.grow_queues(&key, record);
        }
        lost
    }
}

impl ShadowPass {
    pub fn counters(&self) -> &wgpu::Buffer {
        self.renderer.buffers.get("counters")
    }

    /// The map, and the scene as the light sees it.
    pub fn read(&self) -> Result<ShadowMap, RenderError> {
        let keys = self.renderer.words("depth_keys", self.view.pixels() as u64)?;
        Ok(ShadowMap { depth_keys: keys, geometry: self.renderer.read_geometry(&self.plan.key)? })
    }

    /// Its passes with their purposes.
    pub fn passes(&self) -> impl Iterator<Item = Note> {
        let why = |pass| format!("for the light: {}", pass_purpose(pass));
        self.plan.key.light_frame().into_iter().map(move |pass| Note { name: format!("light {}", pass.label()), why: why(pass) })
    }

    /// What it holds besides the scene.
    pub fn buffers(&self) -> impl Iterator<Item = BufferNote> {
        let own = self.renderer.buffers.notes().into_iter().filter(|note| !SHARED.contains(&note.name.as_str()));
        own.map(|note| BufferNote { name: format!("light {}", note.name), why: format!("for the light: {}", note.why), ..note })
    }
}
