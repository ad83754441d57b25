//! The model: primitives, materials and instances, and the bytes that they refer to.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use super::{
    accessor::Accessor,
    bounds::{Bounds, MAX_MAGNITUDE},
    camera::Camera,
    deformation::Deformation,
    framing::FramingPoints,
    material::{Material, TEXTURE_SLOTS},
    panorama::Panorama,
    punctual::SceneLight,
    rig::Rig,
    texture::Image,
    up::UpAxis,
};
use crate::work::{Canceled, map_parts};

/// How consecutive corners form triangles. A corner is a position in the index list, or in the
/// vertex list without indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Topology {
    List = 0,
    Strip = 1,
    Fan = 2,
    /// Every corner is a point. It is drawn as a triangle whose three corners it is, spread about it
    /// on the screen.
    Points = 3,
    /// Every two corners are a segment of a line. It is drawn as two triangles whose corners it has,
    /// spread to its sides on the screen.
    Lines = 4,
}

impl Topology {
    /// The number of triangles that `corners` corners form; left-over corners form none.
    pub const fn triangles(self, corners: u32) -> u32 {
        match self {
            Self::List => corners / 3,
            Self::Points => corners,
            Self::Lines => corners / 2 * 2,
            Self::Strip | Self::Fan => corners.saturating_sub(2),
        }
    }

    /// The three corners of triangle `t`, in the winding order of glTF 2.0, section 3.7.2.1.
    pub const fn corners(self, t: u32) -> [u32; 3] {
        match self {
            Self::List => [3 * t, 3 * t + 1, 3 * t + 2],
            Self::Points => [t; 3],
            Self::Lines => [t / 2 * 2, t, t / 2 * 2 + 1],
            Self::Strip => [t, t + 1 + t % 2, t + 2 - t % 2],
            Self::Fan => [t + 1, t + 2, 0],
        }
    }
}

/// Triangles that share attributes and a material.
#[derive(Clone, Debug, PartialEq)]
pub struct Primitive {
    /// Shown to people, for instance `mesh "Fox" primitive 0`.
    pub name: String,
    /// Name of the mesh that it belongs to.
    pub mesh: String,
    /// How corners form triangles.
    pub topology: Topology,
    /// One unsigned integer component, in `Scene::index_bytes`. `None`: the corners are the
    /// vertices in order.
    pub indices: Option<Accessor>,
    /// Object space, three components, in `Scene::vertex_bytes` as all attributes are.
    pub positions: Accessor,
    /// Object space, three components. Not necessarily unit vectors.
    pub normals: Accessor,
    /// Light falls on the planes of its triangles, deformed as they are; its normals only lead
    /// vertex effects.
    pub is_faceted: bool,
    /// Linear RGB or RGBA, three or four components.
    pub colors: Option<Accessor>,
    /// Texture coordinates for each [`TextureSlot`](super::material::TextureSlot), two components
    /// each. Present wherever the material has that texture.
    pub texcoords: [Option<Accessor>; TEXTURE_SLOTS],
    /// Directions along the texture of its normals, three components for each corner of its
    /// triangles in order ([`tangents`](super::tangents)). Present wherever the material has that
    /// texture.
    pub tangents: Option<Accessor>,
    /// Index into `Scene::materials`.
    pub material: usize,
    /// Box of all finite vertex positions, in object space.
    pub bounds: Bounds,
    /// Length of the longest triangle edge in object space, or an upper bound of it. Of points the
    /// diameter of their discs.
    pub longest_edge: f64,
    /// True if no interpolated normal can be near zero ([`Primitive::normals_agree`]). False is
    /// always safe.
    pub normals_agree: bool,
    /// Joint influences and morph targets, if it has any.
    pub deformation: Deformation,
}

impl Primitive {
    /// The number of vertices.
    pub fn vertex_count(&self) -> u32 {
        self.positions.count
    }

    /// The number of triangles.
    pub fn triangle_count(&self) -> u32 {
        self.topology.triangles(
            self.indices
                .map_or(self.positions.count, |indices| indices.count),
        )
    }

    /// Are they points?
    pub fn is_points(&self) -> bool {
        self.topology == Topology::Points
    }

    /// Are they lines?
    pub fn is_lines(&self) -> bool {
        self.topology == Topology::Lines
    }

    /// Are they points or lines, which are triangles only on the screen?
    pub fn is_spread(&self) -> bool {
        self.is_points() || self.is_lines()
    }

    /// The three vertex indices of triangle `t`.
    #[inline]
    pub fn corners(&self, scene: &Scene, t: u32) -> [u32; 3] {
        let corners = self.topology.corners(t);
        match &self.indices {
            None => corners,
            Some(indices) => corners.map(|c| indices.integer(&scene.index_bytes, c, 0) as u32),
        }
    }

    /// Returns true if all normals are finite, have a length between 1/2 and 2, and lie within 90
    /// degrees of each other in every triangle. Their interpolations are then at least 1/4 long
    /// and never need a substitute.
    pub fn normals_agree(&self, scene: &Scene) -> Result<bool, Canceled> {
        let normal = |vertex: u32| DVec3::from(self.normals.vector(&scene.vertex_bytes, vertex));
        let is_sound = |n: DVec3| (0.25..=4.0).contains(&n.length_squared());
        let agree = |t: u32| {
            let [a, b, c] = self.corners(scene, t).map(normal);
            is_sound(a)
                && is_sound(b)
                && is_sound(c)
                && a.dot(b) >= 0.0
                && b.dot(c) >= 0.0
                && c.dot(a) >= 0.0
        };
        Ok(
            map_parts(self.triangle_count(), |mut part| part.all(agree))?
                .into_iter()
                .all(|agree| agree),
        )
    }

    /// The box of all positions that can be drawn: finite, and below the largest magnitude.
    pub fn drawable_box(&self, scene: &Scene) -> Bounds {
        let known = &self.bounds;
        if known.is_empty() || known.min.abs().max(known.max.abs()).max_element() < MAX_MAGNITUDE {
            return *known;
        }
        let places = (0..self.vertex_count())
            .map(|vertex| DVec3::from(self.position(scene, vertex).map(f64::from)));
        let mut bounds = Bounds::EMPTY;
        places
            .filter(|place| place.is_finite() && place.abs().max_element() < MAX_MAGNITUDE)
            .for_each(|place| bounds.include(place));
        bounds
    }

    /// Position of a vertex in object space as it is stored, normalized where the accessor says so.
    #[inline]
    pub fn position(&self, scene: &Scene, vertex: u32) -> [f32; 3] {
        self.positions
            .vector(&scene.vertex_bytes, vertex)
            .map(|value| value as f32)
    }
}

/// A primitive with its transform.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// Index into `Scene::primitives`.
    pub primitive: usize,
    /// Transform in the rest pose. The identity if it has a skin, whose joints place the vertices.
    pub world_from_object: DMat4,
    /// The node of `Scene::rig` whose transform and morph weights it uses. `None`: no clip moves
    /// it.
    pub node: Option<usize>,
    /// The skin of `Scene::rig` whose joints move its vertices.
    pub skin: Option<usize>,
    /// The node of `Scene::named_nodes` that shows it.
    pub named_node: Option<usize>,
    /// Index into `Rig::placements`: its transform relative to `node`. `None`: the identity.
    pub placement: Option<usize>,
}

impl Instance {
    /// An instance without a node or a skin.
    pub fn fixed(primitive: usize, world_from_object: DMat4) -> Self {
        Self {
            primitive,
            world_from_object,
            node: None,
            skin: None,
            named_node: None,
            placement: None,
        }
    }
}

/// The name of a node of the scene graph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedNode {
    pub name: String,
    /// Index of its parent in `Scene::named_nodes`, where parents come before their children.
    pub parent: Option<usize>,
}

/// A camera that comes with the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneCamera {
    pub name: String,
    /// Position and lens in the rest pose.
    pub pose: Camera,
    /// The node of `Scene::rig` that moves it. `None`: it does not move.
    pub node: Option<usize>,
}

impl SceneCamera {
    /// The same lens at the transform of its node: it looks along -z, +y is up, and the distance of
    /// the target is kept.
    pub fn carried(&self, scene_from_node: &DMat4) -> Camera {
        let eye = scene_from_node.w_axis.truncate();
        let forward = (-scene_from_node.z_axis.truncate())
            .try_normalize()
            .unwrap_or_else(|| self.pose.forward());
        let up = scene_from_node
            .y_axis
            .truncate()
            .try_normalize()
            .unwrap_or(self.pose.up);
        Camera {
            eye,
            target: eye + forward * (self.pose.target - self.pose.eye).length(),
            up,
            ..self.pose
        }
    }
}

/// Everything that can be drawn. Built by [`gltf::load`](super::gltf::load) or
/// [`builtin::build`](super::builtin::build).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Shown to people: the file name without its extension, or the name of the built-in scene.
    pub name: String,
    /// All vertex attributes. Its length is a multiple of 4.
    pub vertex_bytes: Vec<u8>,
    /// All index lists. Its length is a multiple of 4.
    pub index_bytes: Vec<u8>,
    /// Meshes with one material each.
    pub primitives: Vec<Primitive>,
    /// The materials that primitives refer to.
    pub materials: Vec<Material>,
    /// The images that textures refer to.
    pub images: Vec<Image>,
    /// Names of the variants of materials that its file has, or of what may color the points of a
    /// cloud. Primitives have those of the one with which it was loaded.
    pub variants: Vec<String>,
    /// What is drawn, in order.
    pub instances: Vec<Instance>,
    /// The number of instances at the end of the list that are walls around the others. Walls cast
    /// no shadow and do not spin.
    pub walls: usize,
    /// The number of instances before the walls that are a ground under the others. It casts no
    /// shadow.
    pub grounds: usize,
    /// The box of what the walls surround; none without walls.
    pub content: Option<Bounds>,
    /// The axis of its file that is up.
    pub up: UpAxis,
    /// Cameras that come with the scene.
    pub cameras: Vec<SceneCamera>,
    /// The picture of what surrounds it.
    pub panorama: Option<Arc<Panorama>>,
    /// Lights that come with the scene, at most [`MAX_LIGHTS`](super::punctual::MAX_LIGHTS).
    pub lights: Vec<SceneLight>,
    /// Nodes, skins and clips.
    pub rig: Rig,
    /// The names of the nodes that instances come from.
    pub named_nodes: Vec<NamedNode>,
    /// The primitive that holds the particle discs. Exactly one instance shows it.
    pub particle_discs: Option<usize>,
    /// Messages of the loader for the user, for instance about extensions that it ignores.
    pub notes: Vec<String>,
    /// Those of the messages that say how the file breaks its standard.
    pub faults: Vec<String>,
    /// The point from which the world of its pictures counts: of a model that does not stand about its
    /// file's origin its middle, so that patterns in the world are the same wherever it lies.
    pub origin: DVec3,
    /// The points that a camera frames.
    pub framing: FramingPoints,
}

/// The index of what is called `name`. `#2` is what is at index 2, under any name.
pub fn named(names: &[String], name: &str) -> Option<usize> {
    let by_index = || {
        let index = name.strip_prefix('#')?.parse().ok();
        index.filter(|&index: &usize| index < names.len())
    };
    names
        .iter()
        .position(|known| known == name)
        .or_else(by_index)
}

/// Instances up to which every draw has a whole record on the device.
pub const MANY_INSTANCES: usize = 4096;

/// Most primitives of a scene whose draws share what they say of them: a uniform buffer holds as
/// many shapes.
pub const MOST_SHAPES: usize = 512;

impl Scene {
    /// Returns true if many instances show few primitives, so that what a primitive says is kept
    /// once on the device and not once for each draw. What deforms has vertices of its own in each
    /// draw.
    pub fn is_instanced(&self) -> bool {
        self.instances.len() > MANY_INSTANCES
            && self.primitives.len() <= MOST_SHAPES
            && self.particle_discs.is_none()
            && self
                .primitives
                .iter()
                .all(|p| p.deformation.is_none() && !p.is_spread())
    }

    /// The index of the variant of materials called `name`. `#2` is the variant at index 2, under
    /// any name.
    pub fn variant(&self, name: &str) -> Option<usize> {
        named(&self.variants, name)
    }

    /// The index of the camera called `name`. `#2` is the camera at index 2, under any name.
    pub fn camera(&self, name: &str) -> Option<usize> {
        let by_index = || {
            name.strip_prefix('#')?
                .parse()
                .ok()
                .filter(|&index: &usize| index < self.cameras.len())
        };
        self.cameras
            .iter()
            .position(|camera| camera.name == name)
            .or_else(by_index)
    }

    /// Bytes of its attributes, index lists and images.
    pub fn byte_count(&self) -> u64 {
        let texels: usize = self
            .images
            .iter()
            .flat_map(|image| &image.levels)
            .map(|level| level.texels.len())
            .sum();
        (self.vertex_bytes.len() + self.index_bytes.len() + 4 * texels) as u64
    }

    /// The number of triangles of all instances.
    pub fn triangle_count(&self) -> u64 {
        self.instances
            .iter()
            .map(|instance| u64::from(self.primitives[instance.primitive].triangle_count()))
            .sum()
    }

    /// The number of vertices of all instances.
    pub fn vertex_count(&self) -> u64 {
        self.instances
            .iter()
            .map(|instance| u64::from(self.primitives[instance.primitive].vertex_count()))
            .sum()
    }

    /// Bytes of the attributes where no pass writes others behind them, else 0.
    pub fn constant_attribute_bytes(&self) -> u64 {
        let is_constant = self.particle_discs.is_none() && self.deformable_vertex_count() == 0;
        self.vertex_bytes.len() as u64 * u64::from(is_constant)
    }

    /// Returns true if an alpha cutoff can discard samples of any instance.
    pub fn is_masked(&self) -> bool {
        let materials = self
            .instances
            .iter()
            .map(|instance| &self.materials[self.primitives[instance.primitive].material]);
        materials
            .into_iter()
            .any(|material| material.alpha_threshold().is_some())
    }

    /// Returns true if a texture turns the normals of any instance.
    pub fn has_normal_maps(&self) -> bool {
        let material =
            |instance: &Instance| &self.materials[self.primitives[instance.primitive].material];
        self.instances
            .iter()
            .any(|instance| material(instance).has_normal_map())
    }

    /// The number of vertices of all instances whose primitives have joint influences or morph
    /// targets.
    pub fn deformable_vertex_count(&self) -> u64 {
        let soft = self
            .instances
            .iter()
            .map(|instance| &self.primitives[instance.primitive])
            .filter(|p| !p.deformation.is_none());
        soft.map(|primitive| u64::from(primitive.vertex_count()))
            .sum()
    }

    /// World-space box of all instances but the ground. Of a scene with a rig,
    /// [`Rig::motion_bounds`].
    pub fn bounds(&self) -> Bounds {
        if !self.rig.is_empty() {
            return self.rig.motion_bounds;
        }
        let walls = &self.instances[self.instances.len() - self.walls..];
        self.bounds_of(self.shadow_casters().iter().chain(walls))
    }

    /// [`Scene::bounds`] without the walls of a room: the box of the scene itself.
    pub fn content_bounds(&self) -> Bounds {
        self.content.unwrap_or_else(|| self.bounds())
    }

    /// A point of the vertical axis about which the scene turns and a room stands: the file's origin
    /// where the scene stands about that, else the middle of what is shown.
    pub fn axis(&self) -> DVec3 {
        let bounds = self.content_bounds();
        let (middle, half) = (bounds.center().with_y(0.0), (bounds.max - bounds.min) * 0.5);
        let is_about = middle.abs().max_element() <= 0.5 * half.x.max(half.z);
        if is_about { DVec3::ZERO } else { middle }
    }

    /// What counts from the file's origin where the scene is about that, and else from `center`, so
    /// that a scene looks the same wherever it lies: meshes of a ground and a room, which reach so
    /// far, and shadow maps.
    pub(super) fn mesh_origin(content: &Bounds, center: DVec3, reach: f64) -> DVec3 {
        let Bounds { min, max } = content;
        let is_inside = min.x.max(min.z) < 0.0 && max.x.min(max.z) > 0.0;
        let is_near = is_inside && center.y.abs() <= 8.0 * reach;
        if is_near { DVec3::ZERO } else { center }
    }

    /// The scene with the [origin](Scene::origin) of a model.
    #[must_use]
    pub fn counted(mut self) -> Self {
        let content = self.content_bounds();
        if !content.is_empty() && content.center().is_finite() {
            self.origin = Self::mesh_origin(&content, content.center(), content.radius());
        }
        self
    }

    /// World-space box of `instances` in their rest pose.
    pub fn bounds_of<'a>(&self, instances: impl IntoIterator<Item = &'a Instance>) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        for instance in instances {
            bounds.include_transformed(
                &instance.world_from_object,
                &self.primitives[instance.primitive].bounds,
                0.0,
            );
        }
        bounds
    }
}
