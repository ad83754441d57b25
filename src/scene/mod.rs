//! Scenes as plain data: bytes as the file had them, and how to read them.
//!
//! Attribute and index bytes are never repacked: an [`Accessor`] says where a value lies, and both the vertex
//! shader and the oracle pull it from there. What a file lacks (normals) is appended by the loader as more bytes.

pub mod builtin;
pub mod camera;
pub mod draw;
pub mod gltf;
pub mod joint_transforms;
pub mod light;
pub mod lines;
pub mod meshlets;
pub mod needs;
pub mod particle_discs;
pub mod pick;
pub mod pose;
pub mod rig;
mod room;
pub mod sizes;
pub mod texture;

use glam::{DMat4, DVec3};

use rig::{Deformation, Rig};
use texture::{Image, Texture};

/// Number format of one attribute component; the discriminant is glTF's `componentType`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Component {
    I8 = 5120,
    U8 = 5121,
    I16 = 5122,
    U16 = 5123,
    U32 = 5125,
    F32 = 5126,
}

impl Component {
    /// Size of one component in bytes.
    pub const fn bytes(self) -> u32 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// Where the elements of an attribute or index list lie in a byte buffer.
///
/// Promised by every constructor of scenes (the glTF loader checks it): `offset` and `stride` are multiples of the
/// component size, and the last element ends inside the buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Accessor {
    /// First byte of element 0.
    pub offset: u32,
    /// Bytes from one element to the next.
    pub stride: u32,
    pub component: Component,
    /// Components per element, 1 to 4.
    pub components: u32,
    /// Integers stand for [0, 1] or [-1, 1].
    pub normalized: bool,
    /// Number of elements.
    pub count: u32,
}

impl Accessor {
    /// Tightly packed f32 elements that begin at byte `offset`.
    pub fn packed_f32(offset: usize, components: u32, count: usize) -> Self {
        Self {
            offset: offset as u32,
            stride: components * 4,
            component: Component::F32,
            components,
            normalized: false,
            count: count as u32,
        }
    }

    fn raw<const N: usize>(&self, bytes: &[u8], element: u32, lane: u32) -> [u8; N] {
        let at = self.offset as usize + element as usize * self.stride as usize + lane as usize * N;
        bytes[at..at + N].try_into().expect("an accessor lies inside its buffer")
    }

    /// Bits of an f32 lane, or the exact integer value of an integer lane as f32 bits; not normalized.
    pub fn f32_bits(&self, bytes: &[u8], element: u32, lane: u32) -> u32 {
        match self.component {
            Component::F32 => u32::from_le_bytes(self.raw(bytes, element, lane)),
            _ => (self.integer(bytes, element, lane) as f32).to_bits(),
        }
    }

    /// The integer in a lane (an f32 lane is not an integer and reads as its bits).
    pub fn integer(&self, bytes: &[u8], element: u32, lane: u32) -> i64 {
        match self.component {
            Component::I8 => i8::from_le_bytes(self.raw(bytes, element, lane)).into(),
            Component::U8 => u8::from_le_bytes(self.raw(bytes, element, lane)).into(),
            Component::I16 => i16::from_le_bytes(self.raw(bytes, element, lane)).into(),
            Component::U16 => u16::from_le_bytes(self.raw(bytes, element, lane)).into(),
            Component::U32 | Component::F32 => u32::from_le_bytes(self.raw(bytes, element, lane)).into(),
        }
    }

    /// The value of a lane in f64, normalized where the accessor says so (glTF 2.0, section 3.6.2.2).
    pub fn value(&self, bytes: &[u8], element: u32, lane: u32) -> f64 {
        if self.component == Component::F32 {
            return f32::from_bits(self.f32_bits(bytes, element, lane)).into();
        }
        let integer = self.integer(bytes, element, lane) as f64;
        match (self.normalized, self.component) {
            (false, _) => integer,
            (true, Component::I8) => (integer / 127.0).max(-1.0),
            (true, Component::U8) => integer / 255.0,
            (true, Component::I16) => (integer / 32767.0).max(-1.0),
            (true, Component::U16) => integer / 65535.0,
            (true, _) => integer / 4_294_967_295.0,
        }
    }
}

/// How consecutive corners form triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Topology {
    List = 0,
    Strip = 1,
    Fan = 2,
}

impl Topology {
    /// Triangles that `corners` corners form.
    pub const fn triangles(self, corners: u32) -> u32 {
        match self {
            Self::List => corners / 3,
            Self::Strip | Self::Fan => corners.saturating_sub(2),
        }
    }

    /// Places of the corners of triangle `t`, in glTF 2.0's order (section 3.7.2.1).
    pub const fn corners(self, t: u32) -> [u32; 3] {
        match self {
            Self::List => [3 * t, 3 * t + 1, 3 * t + 2],
            Self::Strip => [t, t + 1 + t % 2, t + 2 - t % 2],
            Self::Fan => [t + 1, t + 2, 0],
        }
    }
}

/// Triangles that share their attributes and their material.
#[derive(Clone, Debug, PartialEq)]
pub struct Primitive {
    /// For people, for instance `mesh "Fox" primitive 0`.
    pub name: String,
    pub topology: Topology,
    /// In `Scene::index_bytes`; none: corners count upwards.
    pub indices: Option<Accessor>,
    /// Three lanes. In `Scene::vertex_bytes`, as are the next two.
    pub positions: Accessor,
    /// Three lanes, need not be unit vectors.
    pub normals: Accessor,
    /// Three or four lanes, linear.
    pub colors: Option<Accessor>,
    /// Where its material's textures are looked up, two lanes each: of the base colour, and of the light that it emits. There
    /// where the material has that texture.
    pub texcoords: [Option<Accessor>; 2],
    /// Index into `Scene::materials`.
    pub material: usize,
    /// Box of all vertex positions that are finite, in object space.
    pub bounds: Bounds,
    /// Length of the longest triangle edge in object space; an upper bound is enough.
    pub longest_edge: f64,
    /// No mixture of a triangle's corner normals is near zero ([`Primitive::normals_agree`]); false is always right.
    pub normals_agree: bool,
    /// How it bends, if it does.
    pub deformation: Deformation,
}

impl Primitive {
    pub fn vertex_count(&self) -> u32 {
        self.positions.count
    }

    pub fn triangle_count(&self) -> u32 {
        self.topology.triangles(self.indices.map_or(self.positions.count, |indices| indices.count))
    }

    /// Vertex indices of triangle `t`.
    pub fn corners(&self, scene: &Scene, t: u32) -> [u32; 3] {
        let corners = self.topology.corners(t);
        match &self.indices {
            None => corners,
            Some(indices) => corners.map(|c| indices.integer(&scene.index_bytes, c, 0) as u32),
        }
    }

    /// Are all normals finite, of a length between 1/2 and 2, and within 90 degrees of each other at every triangle?
    /// Then their mixtures are at least a quarter long and never need a substitute.
    pub fn normals_agree(&self, scene: &Scene) -> bool {
        let normal = |vertex: u32| DVec3::from([0, 1, 2].map(|lane| self.normals.value(&scene.vertex_bytes, vertex, lane)));
        let is_sound = |n: DVec3| (0.25..=4.0).contains(&n.length_squared());
        (0..self.triangle_count()).all(|t| {
            let [a, b, c] = self.corners(scene, t).map(normal);
            is_sound(a) && is_sound(b) && is_sound(c) && a.dot(b) >= 0.0 && b.dot(c) >= 0.0 && c.dot(a) >= 0.0
        })
    }

    /// Position of a vertex in object space, as stored; integers are normalized where the file says so.
    pub fn position(&self, scene: &Scene, vertex: u32) -> [f32; 3] {
        [0, 1, 2].map(|lane| self.positions.value(&scene.vertex_bytes, vertex, lane) as f32)
    }
}

/// Colour of a surface, in linear light.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    /// Linear RGBA, each in [0, 1].
    pub base_color: [f32; 4],
    /// Multiplies the base colour; its alpha counts only where there is a cutoff.
    pub base_texture: Option<Texture>,
    /// Only where the alpha of the base texture is at least this is anything drawn; from 0 up, above 1 nothing is.
    pub alpha_cutoff: Option<f32>,
    /// Light that it emits, linear RGB, from 0 up.
    pub emission: [f32; 3],
    /// Multiplies the emission.
    pub emission_texture: Option<Texture>,
    /// No light changes its colour.
    pub unlit: bool,
    /// Draw back faces too, with the normal turned to the viewer.
    pub double_sided: bool,
}

impl Material {
    /// Its textures: of the base colour, and of the light that it emits.
    pub fn textures(&self) -> [Option<&Texture>; 2] {
        [self.base_texture.as_ref(), self.emission_texture.as_ref()]
    }

    /// The least alpha that is drawn, in 2^-16 of a byte's step, where some is left out.
    pub fn alpha_threshold(&self) -> Option<u32> {
        let alpha_cutoff = self.alpha_cutoff.filter(|_| self.base_texture.is_some())?;
        // A cutoff of k/255 is rounded to a float, up to half a unit up; an alpha of k bytes reaches it all the same.
        Some((f64::from(alpha_cutoff) * 255.0 * 65_536.0 - 0.5).ceil() as u32)
    }

    /// Is it no more than a base colour?
    pub fn is_plain(&self) -> bool {
        self.textures() == [None, None] && self.emission == [0.0; 3] && !self.unlit
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: "default".into(),
            base_color: [1.0; 4],
            base_texture: None,
            alpha_cutoff: None,
            emission: [0.0; 3],
            emission_texture: None,
            unlit: false,
            double_sided: false,
        }
    }
}

/// A primitive placed in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Index into `Scene::primitives`.
    pub primitive: usize,
    /// Where it stands at rest; where a skin holds it, its joints say the rest.
    pub world_from_object: DMat4,
    /// The node of `Scene::rig` that shows it; none: it stays where it is.
    pub node: Option<usize>,
    /// The skin of `Scene::rig` that holds it.
    pub skin: Option<usize>,
}

impl Instance {
    /// An instance that nothing moves.
    pub fn fixed(primitive: usize, world_from_object: DMat4) -> Self {
        Self { primitive, world_from_object, node: None, skin: None }
    }
}

/// A camera that came with the file.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneCamera {
    pub name: String,
    /// Where it stands at rest.
    pub pose: camera::Camera,
    /// The node of `Scene::rig` that carries it; none: it stays where it is.
    pub node: Option<usize>,
}

impl SceneCamera {
    /// The same camera carried by a node that stands there: it looks along -z with +y up, and as far as at rest.
    pub fn carried(&self, scene_from_node: &DMat4) -> camera::Camera {
        let eye = scene_from_node.w_axis.truncate();
        let forward = (-scene_from_node.z_axis.truncate()).try_normalize().unwrap_or_else(|| self.pose.forward());
        let up = scene_from_node.y_axis.truncate().try_normalize().unwrap_or(self.pose.up);
        camera::Camera { eye, target: eye + forward * (self.pose.target - self.pose.eye).length(), up, ..self.pose }
    }
}

/// Axis-aligned box; empty when `min` exceeds `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub min: DVec3,
    pub max: DVec3,
}

impl Default for Bounds {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Bounds {
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    pub fn include(&mut self, point: DVec3) {
        self.min = self.min.min(point);
        self.max = self.max.max(point);
    }

    /// Takes in what `matrix` makes of a box whose sides were moved out by `slack`.
    pub fn include_transformed(&mut self, matrix: &DMat4, placed: &Self, error_bound: f64) {
        if !placed.is_empty() {
            let grown = Self { min: placed.min - error_bound, max: placed.max + error_bound };
            grown.corners().into_iter().for_each(|corner| self.include(matrix.transform_point3(corner)));
        }
    }

    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    pub fn center(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { (self.min + self.max) * 0.5 }
    }

    /// Half the diagonal; 0 when empty.
    pub fn radius(&self) -> f64 {
        if self.is_empty() { 0.0 } else { (self.max - self.min).length() * 0.5 }
    }
}

/// Everything to be drawn. Built by [`gltf::load`] or [`builtin::build`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// For people: the file's stem, or the builtin's name.
    pub name: String,
    /// All attributes; its length is a multiple of 4.
    pub vertex_bytes: Vec<u8>,
    /// All index lists; its length is a multiple of 4.
    pub index_bytes: Vec<u8>,
    pub primitives: Vec<Primitive>,
    pub materials: Vec<Material>,
    /// What the textures of materials show.
    pub images: Vec<Image>,
    pub instances: Vec<Instance>,
    /// How many of them, at the end, are walls round the others: they cast no shadows and do not spin.
    pub walls: usize,
    pub cameras: Vec<SceneCamera>,
    /// What moves.
    pub rig: Rig,
    /// The primitive whose triangles are splats, which one instance alone shows.
    pub particle_discs: Option<usize>,
    /// What the loader wants the user to know, for instance extensions it ignored.
    pub notes: Vec<String>,
}

impl Scene {
    /// The camera called `name`; `#2` names the third one, whatever it is called.
    pub fn camera(&self, name: &str) -> Option<usize> {
        let by_place = || name.strip_prefix('#')?.parse().ok().filter(|&place: &usize| place < self.cameras.len());
        self.cameras.iter().position(|camera| camera.name == name).or_else(by_place)
    }

    /// Triangles of all instances together.
    pub fn triangle_count(&self) -> u64 {
        self.instances.iter().map(|instance| u64::from(self.primitives[instance.primitive].triangle_count())).sum()
    }

    /// Vertices of all instances together.
    pub fn vertex_count(&self) -> u64 {
        self.instances.iter().map(|instance| u64::from(self.primitives[instance.primitive].vertex_count())).sum()
    }

    /// Does the alpha of an image leave out a part of something?
    pub fn is_masked(&self) -> bool {
        let materials = self.instances.iter().map(|instance| &self.materials[self.primitives[instance.primitive].material]);
        materials.into_iter().any(|material| material.alpha_threshold().is_some())
    }

    /// Vertices of all instances of meshes that bend.
    pub fn deformable_vertex_count(&self) -> u64 {
        let soft = self.instances.iter().map(|instance| &self.primitives[instance.primitive]).filter(|p| !p.deformation.is_none());
        soft.map(|primitive| u64::from(primitive.vertex_count())).sum()
    }

    /// Box round all instances, in world space; round all places that a scene which moves reaches.
    pub fn bounds(&self) -> Bounds {
        if !self.rig.is_empty() {
            return self.rig.reach;
        }
        self.bounds_of(&self.instances)
    }

    /// Box round some of its instances where they stand at rest.
    pub fn bounds_of(&self, instances: &[Instance]) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        for instance in instances {
            bounds.include_transformed(&instance.world_from_object, &self.primitives[instance.primitive].bounds, 0.0);
        }
        bounds
    }
}
