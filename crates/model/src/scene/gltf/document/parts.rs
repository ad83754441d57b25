//! The parts of a document.

use std::collections::BTreeMap;

use crate::scene::{
    self,
    accessor::ComponentType,
    camera::Projection,
    material::TEXTURE_SLOTS,
    model::Topology,
    punctual::LightKind,
    rig::{Interpolation, Property},
    texture::{Filter, MipFilter, Wrap},
};

use super::super::{draco::CompressedPrimitive, meshopt::CompressedView};

/// A part, or why it cannot be read: the end of a sentence.
pub type Part<T> = Result<T, String>;

/// A model's JSON. Every index is in range.
#[derive(Debug, Default)]
pub struct Document {
    pub accessors: Vec<Part<Accessor>>,
    pub views: Vec<Part<View>>,
    pub buffers: Vec<Part<Buffer>>,
    pub images: Vec<Part<Image>>,
    pub textures: Vec<Part<Texture>>,
    pub materials: Vec<Material>,
    pub meshes: Vec<Mesh>,
    pub nodes: Vec<Node>,
    pub skins: Vec<Part<Skin>>,
    pub cameras: Vec<Part<Camera>>,
    pub lights: Vec<Part<Light>>,
    pub clips: Vec<Clip>,
    /// The nodes that the shown scene lists; none where the file has no scene.
    pub scene: Option<Scene>,
    /// Names of the variants of materials.
    pub variants: Vec<String>,
    pub extensions_used: Vec<String>,
    pub extensions_required: Vec<String>,
}

impl Document {
    /// The parts that cannot be read, with the reasons.
    pub fn broken(&self) -> impl Iterator<Item = (String, &str)> {
        fn of<'a, T>(
            kind: &'a str,
            parts: &'a [Part<T>],
        ) -> impl Iterator<Item = (String, &'a str)> {
            parts.iter().enumerate().filter_map(move |(index, part)| {
                let reason = part.as_ref().err()?;
                Some((format!("{kind} {index}"), reason.as_str()))
            })
        }
        of("accessor", &self.accessors)
            .chain(of("bufferView", &self.views))
            .chain(of("buffer", &self.buffers))
            .chain(of("image", &self.images))
            .chain(of("texture", &self.textures))
            .chain(of("skin", &self.skins))
            .chain(of("camera", &self.cameras))
            .chain(of("light", &self.lights))
    }
}

/// A list of nodes.
#[derive(Debug)]
pub struct Scene {
    pub index: usize,
    pub nodes: Vec<usize>,
}

/// Elements of one type in a buffer view.
#[derive(Debug)]
pub struct Accessor {
    /// `None`: zeros.
    pub view: Option<usize>,
    pub offset: u64,
    pub count: u64,
    pub component_type: ComponentType,
    /// Components per element. Padding between the columns of small matrices is not counted; no
    /// such matrix is read.
    pub components: u32,
    pub normalized: bool,
    pub sparse: Option<Sparse>,
    /// It states the least and the largest value of each component.
    pub has_bounds: bool,
}

impl Accessor {
    /// Bytes of a packed element.
    pub fn element_bytes(&self) -> u64 {
        u64::from(self.component_type.bytes() * self.components)
    }
}

/// Elements of an accessor that are replaced.
#[derive(Debug)]
pub struct Sparse {
    pub count: u64,
    /// View and offset of the indices, and their type.
    pub indices: (usize, u64),
    pub index_type: ComponentType,
    /// View and offset of the values.
    pub values: (usize, u64),
}

#[derive(Clone, Debug)]
pub struct View {
    pub buffer: usize,
    pub offset: u64,
    pub length: u64,
    pub stride: Option<u64>,
    /// EXT_meshopt_compression.
    pub meshopt: Option<CompressedView>,
}

#[derive(Debug)]
pub struct Buffer {
    pub uri: Option<String>,
    pub length: u64,
    /// Its views are compressed, and it has no bytes itself.
    pub is_fallback: bool,
}

#[derive(Debug)]
pub struct Image {
    pub name: Option<String>,
    pub from: ImageSource,
    pub mime_type: Option<String>,
}

#[derive(Debug)]
pub enum ImageSource {
    View(usize),
    Uri(String),
}

/// An image with its sampler.
#[derive(Debug)]
pub struct Texture {
    /// `None`: no image of a format that can be read.
    pub image: Option<usize>,
    pub sampler: Sampler,
}

#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    pub wrap: [Wrap; 2],
    pub mag_filter: Filter,
    pub min_filter: Filter,
    pub mip_filter: MipFilter,
}

/// The use of a texture by a material.
#[derive(Clone, Debug)]
pub struct TextureUse {
    pub texture: usize,
    /// n of `TEXCOORD_n`.
    pub set: u32,
    /// Rows of the map from stored texture coordinates to image coordinates.
    pub image_from_texcoord: [[f32; 3]; 2],
}

pub use ::gltf::json::material::AlphaMode;

/// A material, of which the textures are still to be read.
#[derive(Debug)]
pub struct Material {
    pub name: Option<String>,
    /// As it is drawn without textures; its color has the alpha that a mask needs.
    pub plain: scene::Material,
    pub textures: [Option<TextureUse>; TEXTURE_SLOTS],
    pub alpha_mode: AlphaMode,
    pub alpha_cutoff: f32,
    /// It has textures of specular reflection or glossiness that are not drawn.
    pub has_more: bool,
    /// Of transmission, by its red, and of thickness, by its green.
    pub passing: [Option<TextureUse>; 2],
}

#[derive(Debug, Default)]
pub struct Mesh {
    pub name: Option<String>,
    pub primitives: Vec<Part<Primitive>>,
    pub weights: Vec<f32>,
}

impl Mesh {
    /// Its primitives that can be read, with their places in the file.
    pub fn sound(&self) -> impl Iterator<Item = (usize, &Primitive)> {
        self.primitives
            .iter()
            .enumerate()
            .filter_map(move |(at, part)| part.as_ref().ok().map(|primitive| (at, primitive)))
    }
}

/// How the corners of a line are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chain {
    Open,
    /// The last also to the first.
    Closed,
}

/// Triangles, points or lines.
#[derive(Debug)]
pub struct Primitive {
    /// Accessors by the names of attributes.
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    pub topology: Topology,
    /// Of lines whose corners are each joined to the next.
    pub chain: Option<Chain>,
    pub material: Option<usize>,
    /// Materials by variants.
    pub variants: BTreeMap<usize, usize>,
    /// Accessors by the names of attributes.
    pub targets: Vec<BTreeMap<String, usize>>,
    /// KHR_draco_mesh_compression.
    pub draco: Option<CompressedPrimitive>,
}

impl Primitive {
    /// All accessors of its attributes and indices.
    pub fn accessors(&self) -> impl Iterator<Item = usize> {
        self.attributes.values().chain(&self.indices).copied()
    }
}

#[derive(Debug, Default)]
pub struct Node {
    pub name: Option<String>,
    pub children: Vec<usize>,
    /// Neither it nor what is below it is shown.
    pub is_hidden: bool,
    pub matrix: Option<[f64; 16]>,
    pub translation: Option<[f64; 3]>,
    /// A quaternion of any length but 0.
    pub rotation: Option<[f32; 4]>,
    pub scale: Option<[f32; 3]>,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    pub camera: Option<usize>,
    pub light: Option<usize>,
    pub weights: Vec<f32>,
    /// EXT_mesh_gpu_instancing. Boxed: of millions of nodes few have it.
    pub instancing: Option<Box<Instancing>>,
}

/// The accessors of what places the instances of a node, at least one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Instancing {
    pub translation: Option<usize>,
    pub rotation: Option<usize>,
    pub scale: Option<usize>,
}

#[derive(Debug)]
pub struct Skin {
    pub name: Option<String>,
    /// Nodes, at least one.
    pub joints: Vec<usize>,
    /// The accessor of the inverse bind matrices.
    pub inverse_bind: Option<usize>,
}

#[derive(Debug)]
pub struct Camera {
    pub name: Option<String>,
    pub projection: Projection,
    pub near: f64,
}

/// KHR_lights_punctual.
#[derive(Debug)]
pub struct Light {
    pub name: Option<String>,
    /// `None`: of a type that the extension does not have (yet).
    pub kind: Option<LightKind>,
    /// Linear RGB times the intensity.
    pub light: [f64; 3],
    /// Meters, above 0.
    pub range_m: Option<f64>,
}

#[derive(Debug, Default)]
pub struct Clip {
    pub name: Option<String>,
    /// Those that move a node; others are valid and ignored.
    pub channels: Vec<(usize, Part<Channel>)>,
    pub samplers: Vec<Part<KeySampler>>,
}

#[derive(Debug)]
pub struct Channel {
    pub node: usize,
    pub property: Property,
    pub sampler: usize,
}

/// Key times and values of a clip.
#[derive(Debug)]
pub struct KeySampler {
    pub times: usize,
    pub values: usize,
    pub interpolation: Interpolation,
}
