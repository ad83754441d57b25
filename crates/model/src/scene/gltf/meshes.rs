//! Meshes: reads primitives with their attributes and creates the instances of the nodes that show
//! them.

use std::{
    collections::{BTreeSet, HashMap},
    ops::Range,
};

use glam::DMat4;
use gltf::json::{
    self,
    mesh::{Mode, Semantic},
    validation::Checked,
};

use super::{
    buffers::{Buffers, FLOAT, FLOAT_OR_UNORM, QUANTIZED, QUANTIZED_NORMALS, SceneWriter},
    checks::{check_finite, check_indices, check_repeats, measure, normal, smooth_normals},
    deformation,
    error::{LoadError, called, part_name},
    limits::{self, Limits},
    materials,
    nodes::{Tree, node_name},
};
use crate::{
    scene::{
        accessor::Accessor,
        bounds::Bounds,
        deformation::Deformation,
        material::Material,
        model::{Instance, Primitive, Scene, Topology},
        rig::Rig,
    },
    work::checkpoint,
};

/// Steps of reading a primitive after which progress is counted.
const STEPS: u64 = 4;

/// Reads meshes into a scene.
pub struct Loader<'a> {
    root: &'a json::Root,
    tree: &'a Tree,
    limits: &'a Limits,
    pub writer: SceneWriter<'a>,
    /// Messages about what was skipped or repaired, each once.
    pub notes: BTreeSet<String>,
    /// The JSON of each primitive of the scene.
    sources: Vec<&'a json::mesh::Primitive>,
    /// Primitives of each mesh that was read.
    meshes: HashMap<usize, Range<usize>>,
    default_material: Option<usize>,
    vertices: u64,
    triangles: u64,
}

impl<'a> Loader<'a> {
    /// A loader that adds to `scene`, which must have the file's materials and images.
    pub fn new(buffers: &'a Buffers<'a>, tree: &'a Tree, scene: Scene) -> Self {
        Self {
            root: buffers.root,
            tree,
            limits: &buffers.limits,
            writer: SceneWriter::new(buffers, scene),
            notes: BTreeSet::new(),
            sources: Vec::new(),
            meshes: HashMap::new(),
            default_material: None,
            vertices: 0,
            triangles: 0,
        }
    }

    /// Says how many bytes are to be decoded.
    pub fn expect(&self) {
        let shown: BTreeSet<usize> = self
            .tree
            .shown
            .iter()
            .filter_map(|&node| Some(self.root.nodes[node].mesh?.value()))
            .collect();
        let primitives = shown
            .iter()
            .filter_map(|&mesh| self.root.meshes.get(mesh))
            .flat_map(|mesh| &mesh.primitives);
        checkpoint().expect(
            primitives
                .map(|primitive| STEPS * self.step_bytes(primitive))
                .sum(),
        );
    }

    /// Bytes that count as done after each step of reading a primitive.
    fn step_bytes(&self, about: &json::mesh::Primitive) -> u64 {
        let accessors = about
            .attributes
            .values()
            .chain(&about.indices)
            .filter_map(|accessor| self.root.accessors.get(accessor.value()));
        let size = |accessor: &json::Accessor| match (accessor.component_type, accessor.type_) {
            (Checked::Valid(component), Checked::Valid(kind)) => {
                (component.0.size() * kind.multiplicity()) as u64
            }
            _ => 0,
        };
        accessors
            .fold(0, |sum: u64, accessor| {
                sum.saturating_add(accessor.count.0.saturating_mul(size(accessor)))
            })
            .min(1 << 40)
            / STEPS
    }

    /// Adds the instances of a node. A skinned mesh ignores the transform of its node: its joints
    /// place it.
    pub fn add_instances(&mut self, node: usize, rig: &Rig) -> Result<(), LoadError> {
        let about = &self.root.nodes[node];
        let Some(mesh) = about.mesh.map(|mesh| mesh.value()) else {
            return Ok(());
        };
        let range = self.mesh(mesh)?;
        if self.writer.scene.instances.len() + range.len() > limits::INSTANCES {
            return Err(LoadError::new(format!(
                "the nodes show more than {} primitives, which is the limit",
                limits::INSTANCES
            ))
            .within(node_name(self.root, node)));
        }
        let skin = about.skin.map(|skin| skin.value());
        let rig_node = (!rig.is_empty()).then(|| self.tree.rig_index[node]);
        for primitive in range {
            if let Some(skin) = skin {
                let follow = deformation::follow_skin(
                    &mut self.writer,
                    primitive,
                    self.sources[primitive],
                    &rig.skins[skin],
                );
                let notes = follow
                    .map_err(|error| error.within(&self.writer.scene.primitives[primitive].name))?;
                notes.into_iter().for_each(|note| self.note(|| note));
            }
            let world_from_object = if skin.is_some() {
                DMat4::IDENTITY
            } else {
                self.tree.world_from_node[node]
            };
            let named_node = Some(self.tree.rig_index[node]);
            self.writer.scene.instances.push(Instance {
                primitive,
                world_from_object,
                node: rig_node,
                skin,
                named_node,
            });
        }
        Ok(())
    }

    /// Adds a message while there is room for it.
    fn note(&mut self, message: impl FnOnce() -> String) {
        if self.notes.len() < limits::NOTES {
            self.notes.insert(message());
        }
    }

    /// The primitives of a mesh, which is read on its first use.
    fn mesh(&mut self, mesh: usize) -> Result<Range<usize>, LoadError> {
        if let Some(range) = self.meshes.get(&mesh) {
            return Ok(range.clone());
        }
        let first = self.writer.scene.primitives.len();
        for (index, primitive) in self.root.meshes[mesh].primitives.iter().enumerate() {
            let name = primitive_name(self.root, mesh, index);
            let topology = match primitive.mode {
                Checked::Valid(Mode::Triangles) => Topology::List,
                Checked::Valid(Mode::TriangleStrip) => Topology::Strip,
                Checked::Valid(Mode::TriangleFan) => Topology::Fan,
                _ => {
                    self.note(|| format!("{name} is skipped: points and lines are not drawn"));
                    continue;
                }
            };
            let material = primitive
                .material
                .map(|material| &self.root.materials[material.value()]);
            if material.is_some_and(materials::is_invisible) {
                self.note(|| format!("{name} is skipped: the alpha of its material is below the cutoff everywhere"));
                continue;
            }
            let part = part_name("mesh", mesh, self.root.meshes[mesh].name.as_deref());
            self.primitive([&name, &part], topology, primitive)
                .map_err(|LoadError(reason)| LoadError(format!("{name}{reason}")))?;
        }
        let range = first..self.writer.scene.primitives.len();
        self.meshes.insert(mesh, range.clone());
        Ok(range)
    }

    /// Reads a primitive of the mesh with this name. Errors begin with ` ATTRIBUTE: ` or `: `, to
    /// follow the primitive's name.
    fn primitive(
        &mut self,
        [name, mesh]: [&str; 2],
        topology: Topology,
        about: &'a json::mesh::Primitive,
    ) -> Result<(), LoadError> {
        let attribute = |semantic: Semantic| {
            about
                .attributes
                .get(&Checked::Valid(semantic))
                .map(|accessor| accessor.value())
        };
        let at = |coordinates: &'static str| {
            move |error: LoadError| LoadError(format!(" {coordinates}: {error}"))
        };
        let plain = |error: LoadError| LoadError(format!(": {error}"));
        let positions = attribute(Semantic::Positions)
            .ok_or_else(|| plain(LoadError::new("it has no POSITION attribute")))?;
        let count = self
            .writer
            .accessor(positions)
            .map_err(at("POSITION"))?
            .count;
        self.budget_vertices(count.into()).map_err(at("POSITION"))?;
        let [position_formats, normal_formats] = if self.writer.is_quantized {
            [QUANTIZED, QUANTIZED_NORMALS]
        } else {
            [FLOAT; 2]
        };
        let positions = self
            .writer
            .attribute(positions, count, &[3], position_formats)
            .map_err(at("POSITION"))?;
        let normals = attribute(Semantic::Normals)
            .map(|a| {
                self.writer
                    .attribute(a, count, &[3], normal_formats)
                    .map_err(at("NORMAL"))
            })
            .transpose()?;
        let colors = attribute(Semantic::Colors(0))
            .map(|a| {
                self.writer
                    .attribute(a, count, &[3, 4], FLOAT_OR_UNORM)
                    .map_err(at("COLOR_0"))
            })
            .transpose()?;
        let material = self.material(about);
        let texcoords = self.texcoords(about, material, count)?;
        let indices = about
            .indices
            .map(|a| self.writer.indices(a.value()).map_err(at("indices")))
            .transpose()?;
        let corners = indices.map_or(count, |indices| indices.count);
        self.budget_triangles(topology, corners)
            .map_err(if indices.is_some() {
                at("indices")
            } else {
                at("POSITION")
            })?;

        let mut primitive = Primitive {
            name: name.into(),
            mesh: mesh.into(),
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
            deformation: Deformation {
                morph_targets: deformation::morph_targets(&mut self.writer, about, count)?,
                ..Deformation::default()
            },
        };
        let (checkpoint, step) = (checkpoint(), self.step_bytes(about));
        checkpoint.advance(step)?;
        check_indices(&self.writer.scene, &primitive).map_err(at("indices"))?;
        checkpoint.advance(step)?;
        measure(&self.writer.scene, &mut primitive).map_err(at("POSITION"))?;
        checkpoint.advance(step)?;
        if normals.is_none() {
            let smooth = smooth_normals(&self.writer.scene, &primitive)?;
            primitive.normals = self
                .writer
                .append_vectors(smooth.len(), smooth.iter().copied().map(normal))
                .map_err(at("NORMAL"))?;
        } else {
            check_finite(&self.writer.scene, &primitive.normals).map_err(at("NORMAL"))?;
        }
        checkpoint.advance(step)?;
        primitive.normals_agree = primitive.normals_agree(&self.writer.scene)?;
        if let Some(colors) = &primitive.colors {
            check_finite(&self.writer.scene, colors).map_err(at("COLOR_0"))?;
            if colors.components == 4
                && self.writer.scene.materials[material].alpha_cutoff.is_some()
            {
                self.note(|| format!("{name}: alpha masking uses the alpha of the image, not that of the vertex colors"));
            }
        }
        self.writer.scene.primitives.push(primitive);
        self.sources.push(about);
        Ok(())
    }

    fn material(&mut self, about: &json::mesh::Primitive) -> usize {
        let materials = &mut self.writer.scene.materials;
        about
            .material
            .map(|material| material.value())
            .unwrap_or_else(|| {
                *self.default_material.get_or_insert_with(|| {
                    materials.push(Material::default());
                    materials.len() - 1
                })
            })
    }

    /// The texture coordinates of a material's textures. Errors begin as those of attributes do.
    fn texcoords(
        &mut self,
        about: &json::mesh::Primitive,
        material: usize,
        count: u32,
    ) -> Result<[Option<Accessor>; 2], LoadError> {
        let textures = self.writer.scene.materials[material]
            .textures()
            .map(|texture| texture.copied());
        let mut texcoords = [None; 2];
        for (texcoords, texture) in texcoords.iter_mut().zip(textures) {
            let Some(texture) = texture else { continue };
            let at = |error: LoadError| LoadError(format!(" TEXCOORD_{}: {error}", texture.set));
            let index = about
                .attributes
                .get(&Checked::Valid(Semantic::TexCoords(texture.set)));
            let index = index.ok_or_else(|| {
                at(LoadError::new(
                    "it is missing, although a texture of the material uses it",
                ))
            })?;
            let formats = if self.writer.is_quantized {
                QUANTIZED
            } else {
                FLOAT_OR_UNORM
            };
            let accessor = self
                .writer
                .attribute(index.value(), count, &[2], formats)
                .map_err(at)?;
            check_finite(&self.writer.scene, &accessor).map_err(at)?;
            check_repeats(&self.writer.scene, &accessor, &texture).map_err(at)?;
            *texcoords = Some(accessor);
        }
        Ok(texcoords)
    }

    fn budget_vertices(&mut self, more: u64) -> Result<(), LoadError> {
        self.vertices += more;
        match self.vertices > self.limits.vertices {
            true => Err(self.limits.exceeded(
                format_args!("the model has {} vertices or more", self.vertices),
                self.limits.vertices,
            )),
            false => Ok(()),
        }
    }

    fn budget_triangles(&mut self, topology: Topology, corners: u32) -> Result<(), LoadError> {
        let (fits, expected) = match topology {
            Topology::List => (corners.is_multiple_of(3), "a multiple of 3"),
            Topology::Strip | Topology::Fan => (corners >= 3, "at least 3"),
        };
        if !fits {
            return Err(LoadError::new(format!(
                "{corners} corners do not form whole triangles; their number must be {expected}"
            )));
        }
        self.triangles += u64::from(topology.triangles(corners));
        match self.triangles > self.limits.triangles {
            true => Err(self.limits.exceeded(
                format_args!("the model has {} triangles or more", self.triangles),
                self.limits.triangles,
            )),
            false => Ok(()),
        }
    }
}

fn primitive_name(root: &json::Root, mesh: usize, primitive: usize) -> String {
    format!(
        "{} primitive {primitive}",
        called("mesh", mesh, root.meshes[mesh].name.as_deref())
    )
}
