//! Meshes: reads primitives with their attributes and creates the instances of the nodes that show them.

use std::{
    collections::{BTreeSet, HashMap},
    ops::Range,
};

use glam::{DMat4, DVec3};
use gltf::json::{
    self,
    mesh::{Mode, Semantic},
    validation::Checked,
};

use super::{
    LoadError, ReadFile,
    buffers::Buffers,
    called, clips, container, limits, materials,
    nodes::{Tree, node_name},
    quoted, skin, soft,
};
use crate::scene::{
    Accessor, Bounds, Component, Instance, Material, Primitive, Scene, Topology, pose,
    rig::{Deformation, Rig},
    texture::{MAX_REPEATS, stored},
};

/// Reads a whole model.
pub fn scene(bytes: &[u8], read: &mut ReadFile) -> Result<Scene, LoadError> {
    let (json, binary) = container::split(bytes)?;
    let root = container::root(json)?;
    let mut buffers = Buffers::read(&root, binary, read)?;
    materials::check_images(&buffers)?;
    let tree = Tree::walk(&root)?;
    let (mut rig, mut repairs) = (Rig::default(), Vec::from_iter(tree.uneven(&root)));
    let (materials, images) = materials::read(&mut buffers, &tree.shown, read, &mut repairs)?;
    if soft::moves(&root) {
        rig.nodes = tree.rig_nodes(&root)?;
        rig.skins = skin::skins(&buffers, &tree)?;
        clips::read(&buffers, &tree, &mut rig, &mut repairs)?;
    }
    let mut loader = Loader::new(&buffers, &tree, Scene { materials, images, ..Scene::default() });
    for &node in &tree.shown {
        loader.place(node, &rig)?;
    }
    let Loader { mut scene, notes, .. } = loader;
    scene.rig = rig;
    if !scene.rig.is_empty() {
        scene.rig.reach = pose::reach(&scene);
    }
    scene.notes = notes.into_iter().chain(repairs).chain(omissions(&root)).collect();
    if scene.instances.is_empty() {
        scene.notes.push("nothing to draw: the scene shows no triangles".into());
    }
    scene.cameras = tree.cameras(&root, &scene.bounds(), !scene.rig.is_empty(), &mut scene.notes);
    scene.notes.truncate(limits::NOTES);
    Ok(scene)
}

/// Messages about features of the file that are not drawn.
fn omissions(root: &json::Root) -> Vec<String> {
    let is_read = |name: &str| name == container::QUANTIZATION || materials::EXTENSIONS.contains(&name);
    let ignored = root.extensions_used.iter().filter(|name| !is_read(name));
    let mut notes: Vec<String> = ignored.map(|name| format!("the extension {} is not supported and is ignored", quoted(name))).collect();
    let has_more = |material: &json::Material| {
        let roughness = material.pbr_metallic_roughness.metallic_roughness_texture.is_some();
        roughness || material.normal_texture.is_some() || material.occlusion_texture.is_some()
    };
    if root.materials.iter().any(has_more) {
        notes.push("normal, occlusion and metallic-roughness textures are not drawn".into());
    }
    notes
}

pub(super) struct Loader<'a> {
    pub(super) buffers: &'a Buffers<'a>,
    tree: &'a Tree,
    pub(super) scene: Scene,
    /// The file declares KHR_mesh_quantization: attributes may be small integers.
    pub(super) is_quantized: bool,
    notes: BTreeSet<String>,
    /// Byte offset of each copied buffer view or sparse accessor in the scene's bytes.
    vertex_places: HashMap<Source, u32>,
    index_places: HashMap<Source, u32>,
    /// The JSON of each primitive of the scene.
    pub(super) origins: Vec<&'a json::mesh::Primitive>,
    /// Primitives of each mesh that was read.
    meshes: HashMap<usize, Range<usize>>,
    default_material: Option<usize>,
    vertices: u64,
    triangles: u64,
}

/// A source of bytes that several primitives may share.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Source {
    View(usize),
    Accessor(usize),
}

impl<'a> Loader<'a> {
    /// A loader that adds to `scene`, which must have the file's materials and images.
    fn new(buffers: &'a Buffers<'a>, tree: &'a Tree, scene: Scene) -> Self {
        Self {
            buffers,
            tree,
            scene,
            is_quantized: buffers.root.extensions_used.iter().any(|name| name == container::QUANTIZATION),
            notes: BTreeSet::new(),
            vertex_places: HashMap::new(),
            index_places: HashMap::new(),
            origins: Vec::new(),
            meshes: HashMap::new(),
            default_material: None,
            vertices: 0,
            triangles: 0,
        }
    }

    /// Adds the instances of a node. A skinned mesh ignores the transform of its node: its joints place it.
    fn place(&mut self, node: usize, rig: &Rig) -> Result<(), LoadError> {
        let about = &self.buffers.root.nodes[node];
        let Some(mesh) = about.mesh.map(|mesh| mesh.value()) else { return Ok(()) };
        let range = self.mesh(mesh)?;
        if self.scene.instances.len() + range.len() > limits::INSTANCES {
            return Err(
                LoadError::new(format!("the nodes show more than {} primitives, which is the limit", limits::INSTANCES)).within(node_name(self.buffers.root, node))
            );
        }
        let skin = about.skin.map(|skin| skin.value());
        let place = (!rig.is_empty()).then(|| self.tree.place_of[node]);
        for primitive in range {
            if let Some(skin) = skin {
                self.hold(primitive, skin, rig).map_err(|error| error.within(&self.scene.primitives[primitive].name))?;
            }
            let world_from_object = if skin.is_some() { DMat4::IDENTITY } else { self.tree.world_from_node[node] };
            self.scene.instances.push(Instance { primitive, world_from_object, node: place, skin });
        }
        Ok(())
    }

    pub(super) fn note(&mut self, note: String) {
        self.notes.insert(note);
    }

    /// The primitives of a mesh, which is read on its first use.
    fn mesh(&mut self, mesh: usize) -> Result<Range<usize>, LoadError> {
        if let Some(range) = self.meshes.get(&mesh) {
            return Ok(range.clone());
        }
        let first = self.scene.primitives.len();
        for (index, primitive) in self.buffers.root.meshes[mesh].primitives.iter().enumerate() {
            let name = primitive_name(self.buffers.root, mesh, index);
            let topology = match primitive.mode {
                Checked::Valid(Mode::Triangles) => Topology::List,
                Checked::Valid(Mode::TriangleStrip) => Topology::Strip,
                Checked::Valid(Mode::TriangleFan) => Topology::Fan,
                _ => {
                    self.notes.insert(format!("{name} is skipped: points and lines are not drawn"));
                    continue;
                }
            };
            let material = primitive.material.map(|material| &self.buffers.root.materials[material.value()]);
            if material.is_some_and(materials::is_invisible) {
                self.notes.insert(format!("{name} is skipped: the alpha of its material is below the cutoff everywhere"));
                continue;
            }
            self.primitive(&name, topology, primitive).map_err(|LoadError(reason)| LoadError(format!("{name}{reason}")))?;
        }
        let range = first..self.scene.primitives.len();
        self.meshes.insert(mesh, range.clone());
        Ok(range)
    }

    /// Reads a primitive. Errors begin with ` ATTRIBUTE: ` or `: `, to follow the primitive's name.
    fn primitive(&mut self, name: &str, topology: Topology, about: &'a json::mesh::Primitive) -> Result<(), LoadError> {
        let attribute = |semantic: Semantic| about.attributes.get(&Checked::Valid(semantic)).map(|accessor| accessor.value());
        let at = |place: &'static str| move |error: LoadError| LoadError(format!(" {place}: {error}"));
        let plain = |error: LoadError| LoadError(format!(": {error}"));
        let positions = attribute(Semantic::Positions).ok_or_else(|| plain(LoadError::new("it has no POSITION attribute")))?;
        let count = self.buffers.layout(positions).map_err(at("POSITION"))?.accessor.count;
        self.budget_vertices(count.into()).map_err(at("POSITION"))?;
        let (places, directions) = if self.is_quantized { (PLACES, DIRECTIONS) } else { (FLOAT, FLOAT) };
        let positions = self.attribute(positions, count, &[3], places).map_err(at("POSITION"))?;
        let normals = attribute(Semantic::Normals).map(|a| self.attribute(a, count, &[3], directions).map_err(at("NORMAL"))).transpose()?;
        let colors = attribute(Semantic::Colors(0)).map(|a| self.attribute(a, count, &[3, 4], COLOR).map_err(at("COLOR_0"))).transpose()?;
        let material = self.material(about);
        let texcoords = self.texcoords(about, material, count)?;
        let indices = about.indices.map(|a| self.indices(a.value()).map_err(at("indices"))).transpose()?;
        let corners = indices.map_or(count, |indices| indices.count);
        self.budget_triangles(topology, corners).map_err(if indices.is_some() { at("indices") } else { at("POSITION") })?;

        let mut primitive = Primitive {
            name: name.into(),
            topology,
            indices,
            positions,
            normals: normals.unwrap_or(positions),
            colors,
            texcoords,
            material,
            bounds: Bounds::EMPTY,
            longest_edge: 0.0,
            normals_agree: false,
            deformation: Deformation { morph_targets: self.morph_targets(about, count)?, ..Deformation::default() },
        };
        check_indices(&self.scene, &primitive).map_err(at("indices"))?;
        measure(&self.scene, &mut primitive).map_err(at("POSITION"))?;
        if normals.is_none() {
            let smooth = smooth_normals(&self.scene, &primitive);
            primitive.normals = self.append_vectors(&smooth).map_err(at("NORMAL"))?;
        } else {
            check_finite(&self.scene, &primitive.normals).map_err(at("NORMAL"))?;
        }
        primitive.normals_agree = primitive.normals_agree(&self.scene);
        if let Some(colors) = &primitive.colors {
            check_finite(&self.scene, colors).map_err(at("COLOR_0"))?;
            if colors.components == 4 && self.scene.materials[material].alpha_cutoff.is_some() {
                self.notes.insert(format!("{name}: alpha masking uses the alpha of the image, not that of the vertex colours"));
            }
        }
        self.scene.primitives.push(primitive);
        self.origins.push(about);
        Ok(())
    }

    fn material(&mut self, about: &json::mesh::Primitive) -> usize {
        let materials = &mut self.scene.materials;
        about.material.map(|material| material.value()).unwrap_or_else(|| {
            *self.default_material.get_or_insert_with(|| {
                materials.push(Material::default());
                materials.len() - 1
            })
        })
    }

    /// The texture coordinates of a material's textures. Errors begin as those of attributes do.
    fn texcoords(&mut self, about: &json::mesh::Primitive, material: usize, count: u32) -> Result<[Option<Accessor>; 2], LoadError> {
        let textures = self.scene.materials[material].textures().map(|texture| texture.copied());
        let mut texcoords = [None; 2];
        for (texcoords, texture) in texcoords.iter_mut().zip(textures) {
            let Some(texture) = texture else { continue };
            let at = |error: LoadError| LoadError(format!(" TEXCOORD_{}: {error}", texture.set));
            let index = about.attributes.get(&Checked::Valid(Semantic::TexCoords(texture.set)));
            let index = index.ok_or_else(|| at(LoadError::new("it is missing, although a texture of the material uses it")))?;
            let kinds = if self.is_quantized { QUANTIZED_COORDS } else { COORDS };
            let accessor = self.attribute(index.value(), count, &[2], kinds).map_err(at)?;
            check_finite(&self.scene, &accessor).map_err(at)?;
            let place = |vertex| texture.placed(stored(&accessor, &self.scene.vertex_bytes, vertex));
            if let Some(vertex) = (0..count).find(|&vertex| place(vertex).abs().max_element() > MAX_REPEATS) {
                let place = place(vertex);
                let reason =
                    format!("vertex {vertex} has the image coordinates {} {}; allowed: magnitudes up to {MAX_REPEATS}", place.x, place.y);
                return Err(at(LoadError::new(reason)));
            }
            *texcoords = Some(accessor);
        }
        Ok(texcoords)
    }

    fn budget_vertices(&mut self, more: u64) -> Result<(), LoadError> {
        self.vertices += more;
        if self.vertices > limits::VERTICES {
            return Err(LoadError::new(format!("the model has {} vertices or more; allowed: at most {}", self.vertices, limits::VERTICES)));
        }
        Ok(())
    }

    fn budget_triangles(&mut self, topology: Topology, corners: u32) -> Result<(), LoadError> {
        let (fits, wanted) = match topology {
            Topology::List => (corners.is_multiple_of(3), "a multiple of 3"),
            Topology::Strip | Topology::Fan => (corners >= 3, "at least 3"),
        };
        if !fits {
            return Err(LoadError::new(format!("{corners} corners do not form whole triangles; their number must be {wanted}")));
        }
        self.triangles += u64::from(topology.triangles(corners));
        if self.triangles > limits::TRIANGLES {
            return Err(LoadError::new(format!(
                "the model has {} triangles or more; allowed: at most {}",
                self.triangles,
                limits::TRIANGLES
            )));
        }
        Ok(())
    }

    /// Copies an attribute of `count` vertices if its type is among the allowed ones.
    pub(super) fn attribute(
        &mut self,
        index: usize,
        count: u32,
        components: &[u32],
        kinds: &[(Component, bool)],
    ) -> Result<Accessor, LoadError> {
        let layout = self.buffers.layout(index)?;
        let accessor = layout.accessor;
        if !components.contains(&accessor.components) || !kinds.contains(&(accessor.component, accessor.normalized)) {
            return Err(LoadError::new(format!("accessor {index} has the type {}, which glTF does not allow for it", type_name(&accessor))));
        }
        if accessor.count != count {
            return Err(LoadError::new(format!("accessor {index} has {} elements, but the primitive has {count} vertices", accessor.count)));
        }
        self.take_over(index)
    }

    pub(super) fn take_over(&mut self, index: usize) -> Result<Accessor, LoadError> {
        take_over(self.buffers, index, &mut self.vertex_places, &mut self.scene.vertex_bytes)
    }

    fn indices(&mut self, index: usize) -> Result<Accessor, LoadError> {
        let accessor = self.buffers.layout(index)?.accessor;
        let is_index = matches!(accessor.component, Component::U8 | Component::U16 | Component::U32)
            && accessor.components == 1
            && !accessor.normalized;
        if !is_index {
            return Err(LoadError::new(format!("accessor {index} has the type {}, which glTF does not allow for it", type_name(&accessor))));
        }
        if accessor.stride != accessor.component.bytes() {
            return Err(LoadError::new(format!("the bufferView of accessor {index} has a byteStride; indices must not have one")));
        }
        take_over(self.buffers, index, &mut self.index_places, &mut self.scene.index_bytes)
    }

    fn append_vectors(&mut self, vectors: &[[f32; 3]]) -> Result<Accessor, LoadError> {
        let offset = append(&mut self.scene.vertex_bytes, bytemuck::cast_slice(vectors))?;
        Ok(Accessor::packed_f32(offset as usize, 3, vectors.len()))
    }
}

pub(super) const FLOAT: &[(Component, bool)] = &[(Component::F32, false)];
/// Component types of positions under KHR_mesh_quantization.
const PLACES: &[(Component, bool)] = &[
    (Component::F32, false),
    (Component::I8, false),
    (Component::I8, true),
    (Component::U8, false),
    (Component::U8, true),
    (Component::I16, false),
    (Component::I16, true),
    (Component::U16, false),
    (Component::U16, true),
];
/// Component types of normals under KHR_mesh_quantization.
const DIRECTIONS: &[(Component, bool)] = &[(Component::F32, false), (Component::I8, true), (Component::I16, true)];
const COORDS: &[(Component, bool)] = &[(Component::F32, false), (Component::U8, true), (Component::U16, true)];
/// Component types of texture coordinates under KHR_mesh_quantization.
const QUANTIZED_COORDS: &[(Component, bool)] = PLACES;
const COLOR: &[(Component, bool)] = &[(Component::F32, false), (Component::U8, true), (Component::U16, true)];

fn type_name(accessor: &Accessor) -> String {
    let normalized = if accessor.normalized { " normalized" } else { "" };
    format!("{} x {:?}{normalized}", accessor.components, accessor.component)
}

fn primitive_name(root: &json::Root, mesh: usize, primitive: usize) -> String {
    format!("{} primitive {primitive}", called("mesh", mesh, root.meshes[mesh].name.as_deref()))
}

/// Copies the buffer view of an accessor (or its sparse elements) unless that was done before.
fn take_over(buffers: &Buffers, index: usize, places: &mut HashMap<Source, u32>, bytes: &mut Vec<u8>) -> Result<Accessor, LoadError> {
    let layout = buffers.layout(index)?;
    let accessor = layout.accessor;
    let (source, placed) = match layout.view {
        Some(view) if !layout.is_sparse => (Source::View(view), accessor),
        _ => (Source::Accessor(index), Accessor { offset: 0, stride: accessor.component.bytes() * accessor.components, ..accessor }),
    };
    let start = match places.get(&source) {
        Some(&start) => start,
        None => {
            let start = match source {
                Source::View(view) => append(bytes, buffers.view(view)?)?,
                Source::Accessor(_) => append(bytes, &buffers.materialized(index, &layout)?)?,
            };
            places.insert(source, start);
            start
        }
    };
    Ok(Accessor { offset: start + placed.offset, ..placed })
}

/// Appends at a multiple of 4 bytes and pads to one; returns the offset.
fn append(bytes: &mut Vec<u8>, more: &[u8]) -> Result<u32, LoadError> {
    let total = bytes.len() as u64 + more.len().next_multiple_of(4) as u64;
    if total > limits::BINDING_BYTES {
        return Err(LoadError::new(format!("the model needs {total} bytes or more in one buffer; allowed: at most {}", limits::BINDING_BYTES)));
    }
    let start = bytes.len() as u32;
    bytes.extend_from_slice(more);
    bytes.resize(total as usize, 0);
    Ok(start)
}

pub(super) fn check_finite(scene: &Scene, accessor: &Accessor) -> Result<(), LoadError> {
    let value = |vertex, lane| accessor.value(&scene.vertex_bytes, vertex, lane);
    match (0..accessor.count).find(|&vertex| (0..accessor.components).any(|lane| !value(vertex, lane).is_finite())) {
        Some(vertex) => Err(LoadError::new(format!("vertex {vertex} has a value that is not finite"))),
        None => Ok(()),
    }
}

fn check_indices(scene: &Scene, primitive: &Primitive) -> Result<(), LoadError> {
    let Some(indices) = &primitive.indices else { return Ok(()) };
    let count = primitive.vertex_count();
    let beyond = |corner: &u32| indices.integer(&scene.index_bytes, *corner, 0) >= i64::from(count);
    match (0..indices.count).find(beyond) {
        Some(corner) => {
            let index = indices.integer(&scene.index_bytes, corner, 0);
            Err(LoadError::new(format!("corner {corner} refers to vertex {index}, but there are only {count}")))
        }
        None => Ok(()),
    }
}

/// Computes the bounds and the longest edge. Positions must be finite.
fn measure(scene: &Scene, primitive: &mut Primitive) -> Result<(), LoadError> {
    check_finite(scene, &primitive.positions)?;
    let at = |vertex: u32| DVec3::from(primitive.position(scene, vertex).map(f64::from));
    let mut bounds = Bounds::EMPTY;
    (0..primitive.vertex_count()).for_each(|vertex| bounds.include(at(vertex)));
    let mut longest: f64 = 0.0;
    for t in 0..primitive.triangle_count() {
        let [a, b, c] = primitive.corners(scene, t).map(at);
        longest = longest.max(a.distance_squared(b)).max(b.distance_squared(c)).max(c.distance_squared(a));
    }
    (primitive.bounds, primitive.longest_edge) = (bounds, longest.sqrt());
    Ok(())
}

/// Computes missing normals: the mean of the normals of the adjoining triangles, weighted by area.
///
/// glTF asks for flat normals. Without indices the result is flat. Shared vertices would have to be split first, so theirs
/// are smooth instead and the bytes of the file stay as they are.
fn smooth_normals(scene: &Scene, primitive: &Primitive) -> Vec<[f32; 3]> {
    let at = |vertex: u32| DVec3::from(primitive.position(scene, vertex).map(f64::from));
    let mut sums = vec![DVec3::ZERO; primitive.vertex_count() as usize];
    for t in 0..primitive.triangle_count() {
        let corners = primitive.corners(scene, t);
        let [a, b, c] = corners.map(at);
        let twice_area = (b - a).cross(c - a);
        corners.into_iter().for_each(|corner| sums[corner as usize] += twice_area);
    }
    sums.into_iter().map(|sum| sum.normalize_or(DVec3::Y).as_vec3().into()).collect()
}
