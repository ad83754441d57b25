//! A scene on the device: attributes and index lists as the file has them, with space behind them
//! for what passes write, and its materials. Every view of the scene reads the same.

use std::{borrow::Cow, sync::Arc};

use super::{
    attributes::AttributeLayout,
    draw_records::Placement,
    image_files::ImageFiles,
    material_atlas::{self, AtlasContents},
    meshlets::MeshletBuffers,
    packing::{PackedBox, Packing},
    point_boxes,
};
use crate::{
    device::{Gpu, error::RenderError},
    effects::Stack,
    layout::{BufferId, records::VertexRecord},
    resources::{buffers::Buffers, textures::WordTexture},
    scene::{Scene, particle_discs::ParticleSettings},
    shader::key::SurfaceInputs,
};

/// A scene on the device: its attributes, index lists and materials. Every view of the scene reads
/// the same.
pub struct SceneResources {
    /// The scene as it was set.
    base: Arc<Scene>,
    /// The base and the particle discs that the stack adds to it: what is on the device.
    scene: Arc<Scene>,
    particle_settings: Option<ParticleSettings>,
    pub buffers: Buffers,
    attributes: AttributeLayout,
    /// Boxes of packed positions, one per primitive; empty where positions are stored as the file
    /// has them.
    packed_boxes: Vec<PackedBox>,
    pub material_atlas: Option<WordTexture>,
    /// Pictures that the effects of the stack take as inputs.
    pub image_files: Option<ImageFiles>,
    /// What it tells beside colors.
    atlas_contents: AtlasContents,
    /// Meshlets of all primitives, once a view culls.
    meshlets: Option<Arc<MeshletBuffers>>,
}

impl SceneResources {
    /// Uploads a scene.
    pub async fn new(gpu: &Gpu, scene: &Arc<Scene>) -> Result<Self, RenderError> {
        let mut resources = Self {
            base: scene.clone(),
            scene: scene.clone(),
            particle_settings: None,
            buffers: Buffers::default(),
            attributes: AttributeLayout::default(),
            packed_boxes: Vec::new(),
            material_atlas: None,
            image_files: None,
            atlas_contents: AtlasContents::default(),
            meshlets: None,
        };
        resources.upload(gpu).await?;
        Ok(resources)
    }

    /// Checks that the buffers of a scene, and the projected vertices of a picture of it, are no
    /// larger than the adapter binds.
    /// Errors: names the first buffer that is.
    pub fn check(gpu: &Gpu, scene: &Scene) -> Result<(), RenderError> {
        let limit = gpu
            .caps
            .max_storage_binding_bytes
            .min(gpu.caps.max_buffer_bytes);
        // Points are projected as they are drawn.
        let projected: u64 = (scene.instances.iter())
            .map(|instance| &scene.primitives[instance.primitive])
            .filter(|primitive| !primitive.is_points())
            .map(|primitive| u64::from(primitive.vertex_count()))
            .sum();
        let attributes = AttributeLayout::new(scene, None).bytes();
        let parts = match gpu.caps.attribute_split(scene.constant_attribute_bytes()) {
            Some(_) => 2,
            None => 1,
        };
        let sizes = [
            (BufferId::VertexBytes, attributes.div_ceil(parts)),
            (BufferId::IndexBytes, scene.index_bytes.len() as u64),
            (
                BufferId::Vertices,
                size_of::<VertexRecord>() as u64 * projected,
            ),
        ];
        match sizes.into_iter().find(|(_, bytes)| *bytes > limit) {
            Some((buffer, bytes)) => Err(RenderError::TooLarge {
                buffer: buffer.name(),
                bytes,
                limit,
            }),
            None => Ok(()),
        }
    }

    /// Was this scene set?
    pub fn is_of(&self, scene: &Arc<Scene>) -> bool {
        Arc::ptr_eq(&self.base, scene)
    }

    /// The scene on the device, with its particle discs.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// How `vertex_bytes` is laid out.
    pub fn attributes(&self) -> AttributeLayout {
        self.attributes
    }

    /// Boxes of packed positions, one per primitive; empty where positions are not packed.
    pub fn packed_boxes(&self) -> &[PackedBox] {
        &self.packed_boxes
    }

    pub fn particle_count(&self) -> u32 {
        self.particle_settings.map_or(0, |settings| settings.count)
    }

    /// Writes the matrices of instances behind the attributes.
    pub async fn place_instances(
        &self,
        gpu: &Gpu,
        placements: &[Placement],
    ) -> Result<(), RenderError> {
        let first = self.attributes.first_placement();
        self.write_attributes(gpu, first, bytemuck::cast_slice(placements))
            .await
    }

    /// Writes attributes, which begin at a byte of all.
    async fn write_attributes(
        &self,
        gpu: &Gpu,
        first: u64,
        bytes: &[u8],
    ) -> Result<(), RenderError> {
        let split = self.split(gpu).unwrap_or(u64::MAX);
        let here = split.saturating_sub(first).min(bytes.len() as u64) as usize;
        let (here, rest) = bytes.split_at(here);
        let (id, rest_id) = (BufferId::VertexBytes, BufferId::VertexBytesRest);
        if !here.is_empty() {
            self.buffers.write_at(gpu, id, first, here).await?;
        }
        if rest.is_empty() {
            return Ok(());
        }
        let first = first.saturating_sub(split);
        self.buffers.write_at(gpu, rest_id, first, rest).await
    }

    /// The byte at which attributes go on in a second buffer, if they do.
    fn split(&self, gpu: &Gpu) -> Option<u64> {
        let word = (gpu.caps).attribute_split(self.scene.constant_attribute_bytes());
        word.map(|word| 4 * u64::from(word))
    }

    /// The meshlets of the scene, which are found at the first call.
    pub fn meshlets(&mut self) -> Arc<MeshletBuffers> {
        self.meshlets
            .get_or_insert_with(|| Arc::new(MeshletBuffers::of(&self.scene)))
            .clone()
    }

    /// Are the particle discs of a stack in the scene already?
    pub fn has_particles_of(&self, stack: &Stack) -> bool {
        stack.particle_settings() == self.particle_settings
    }

    /// Puts the particle discs of a stack beside the scene, or takes them away; true if that
    /// changed the vertices.
    pub async fn attach_particles(
        &mut self,
        gpu: &Gpu,
        stack: &Stack,
    ) -> Result<bool, RenderError> {
        let settings = stack.particle_settings();
        if settings == self.particle_settings {
            return Ok(false);
        }
        let scene = match self.base.with_particles(settings.as_ref()) {
            Cow::Borrowed(_) => self.base.clone(),
            Cow::Owned(scene) => Arc::new(scene),
        };
        // As many particles in another box have the same bytes.
        let is_other = settings.map(|settings| settings.count)
            != self.particle_settings.map(|settings| settings.count);
        if is_other {
            Self::check(gpu, &scene)?;
        }
        (self.scene, self.particle_settings) = (scene, settings);
        if is_other {
            self.upload(gpu).await?;
        }
        Ok(is_other)
    }

    /// Stores positions as the file has them, or beside that in so many bits per axis.
    pub async fn pack_positions(
        &mut self,
        gpu: &Gpu,
        bits: Option<u32>,
    ) -> Result<(), RenderError> {
        if self.attributes.packed_bits == bits && self.buffers.has(BufferId::VertexBytes) {
            Ok(())
        } else {
            self.upload_attributes(gpu, bits).await
        }
    }

    /// Uploads the materials where `inputs` look them up, else drops them.
    pub async fn keep_materials(
        &mut self,
        gpu: &Gpu,
        inputs: &SurfaceInputs,
    ) -> Result<(), RenderError> {
        let Some(contents) = AtlasContents::of(inputs) else {
            self.material_atlas = None;
            return Ok(());
        };
        if self.material_atlas.is_none() || !self.atlas_contents.includes(contents) {
            self.material_atlas = None;
            let atlas = material_atlas::upload(gpu, &self.scene, contents).await?;
            (self.material_atlas, self.atlas_contents) = (Some(atlas), contents);
        }
        Ok(())
    }

    /// Keeps the pictures that the effects of a stack take as inputs and that of what surrounds the
    /// scene, where an effect shows it, and no others.
    pub async fn keep_image_files(
        &mut self,
        gpu: &Gpu,
        stack: &Stack,
        shows_panorama: bool,
    ) -> Result<(), RenderError> {
        let panorama = self.base.panorama.as_ref().filter(|_| shows_panorama);
        let known = self.image_files.take();
        self.image_files = ImageFiles::of(gpu, stack, panorama, known).await?;
        Ok(())
    }

    async fn upload(&mut self, gpu: &Gpu) -> Result<(), RenderError> {
        self.buffers.keep(|id| id != BufferId::IndexBytes);
        (self.material_atlas, self.meshlets) = (None, None);
        self.upload_attributes(gpu, None).await?;
        if !self.scene.index_bytes.is_empty() {
            self.buffers
                .fill(gpu, BufferId::IndexBytes, &self.scene.index_bytes)
                .await?;
        }
        Ok(())
    }

    /// Uploads the bytes of all attributes, with space for deformed vertices, and positions in
    /// `packed_bits` per axis if any.
    async fn upload_attributes(
        &mut self,
        gpu: &Gpu,
        packed_bits: Option<u32>,
    ) -> Result<(), RenderError> {
        let packing = packed_bits
            .map(|bits| Packing::new(&self.scene, bits))
            .unwrap_or_default();
        // Until all is there, nothing is.
        self.attributes = AttributeLayout::default();
        self.buffers
            .keep(|id| !matches!(id, BufferId::VertexBytes | BufferId::VertexBytesRest));
        let attributes = AttributeLayout::new(&self.scene, packed_bits);
        let (bytes, purpose) = (attributes.bytes(), attributes.purpose());
        let split = self.split(gpu).unwrap_or(u64::MAX);
        self.buffers
            .ensure_for(gpu, BufferId::VertexBytes, bytes.min(split), purpose)
            .await?;
        if split != u64::MAX {
            let rest = bytes.saturating_sub(split);
            (self.buffers)
                .ensure(gpu, BufferId::VertexBytesRest, rest)
                .await?;
        }
        let packed: &[u8] = bytemuck::cast_slice(&packing.words);
        let boxes = point_boxes::boxes_of(&self.scene);
        let parts = [
            (0, self.scene.vertex_bytes.as_slice()),
            (attributes.first_packed(), packed),
            (attributes.first_box(), bytemuck::cast_slice(&boxes)),
        ];
        for (first, bytes) in parts {
            self.write_attributes(gpu, first, bytes).await?;
        }
        (self.attributes, self.packed_boxes) = (attributes, packing.boxes);
        Ok(())
    }
}
