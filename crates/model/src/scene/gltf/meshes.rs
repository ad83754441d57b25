//! Meshes: reads primitives with their attributes and materials.

use std::{
    collections::{BTreeSet, HashMap},
    ops::Range,
};

use glam::{DMat4, DVec3};

use super::{
    buffers::{Buffers, FLOAT, FLOAT_OR_UNORM, Format, QUANTIZED, QUANTIZED_NORMALS, SceneWriter},
    checks::{
        check_finite, check_indices, check_repeats, leave_out_far, measure, normal, smooth_normals,
    },
    deformation,
    document::{self, AlphaMode, Document},
    error::{LoadError, called, part_name},
    instances::Thickness,
    limits::Limits,
    mask,
    nodes::Tree,
};
use crate::{
    scene::{
        accessor::Accessor,
        bounds::Bounds,
        deformation::Deformation,
        material::{Material, TEXTURE_SLOTS, TextureSlot},
        model::{Primitive, Scene, Topology},
        point_cloud, tangents,
    },
    work::checkpoint,
};

/// Steps of reading a primitive after which progress is counted.
const STEPS: u64 = 4;

/// Reads meshes into a scene.
pub struct Loader<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'a Buffers<'a>,
    pub(super) tree: &'a Tree,
    pub(super) limits: &'a Limits,
    pub writer: SceneWriter<'a>,
    /// Why the first primitive that was left out is.
    pub first_lost: Option<String>,
    /// The JSON of each primitive of the scene.
    pub(super) sources: Vec<&'a document::Primitive>,
    /// [`Rig::placements`](crate::scene::rig::Rig::placements).
    pub placements: Vec<DMat4>,
    /// Instances that nodes asked for.
    pub(super) claimed: usize,
    /// Primitives of each mesh that was read.
    meshes: HashMap<usize, Range<usize>>,
    /// Materials that the file does not have as they are drawn: each with what it is made from.
    variants: HashMap<(Option<usize>, mask::Variant), usize>,
    /// Primitives whose materials are as thick as nodes scale them, each with what it is made from
    /// and [`Thickness`](super::instances::Thickness).
    pub(super) scaled: HashMap<(usize, Thickness), usize>,
    /// Primitives whose colors or texture coordinates the weights of nodes move, each with what it is
    /// made from and the bits of these weights.
    pub(super) morphed: HashMap<(usize, Vec<u32>), usize>,
    vertices: u64,
    triangles: u64,
}

impl<'a> Loader<'a> {
    /// A loader that adds to `scene`, which must have the file's materials and images.
    pub fn new(buffers: &'a Buffers<'a>, tree: &'a Tree, scene: Scene) -> Self {
        Self {
            document: buffers.document,
            buffers,
            tree,
            limits: &buffers.limits,
            writer: SceneWriter::new(buffers, scene),
            first_lost: None,
            sources: Vec::new(),
            placements: Vec::new(),
            claimed: 0,
            meshes: HashMap::new(),
            variants: HashMap::new(),
            scaled: HashMap::new(),
            morphed: HashMap::new(),
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
            .filter_map(|&node| self.document.nodes[node].mesh)
            .collect();
        let primitives = shown
            .iter()
            .flat_map(|&mesh| self.document.meshes[mesh].sound());
        checkpoint().expect(
            primitives
                .map(|(_, primitive)| STEPS * self.step_bytes(primitive))
                .sum(),
        );
    }

    /// Bytes that count as done after each step of reading a primitive.
    fn step_bytes(&self, about: &document::Primitive) -> u64 {
        let size = |accessor: usize| match &self.document.accessors[accessor] {
            Ok(accessor) => accessor.count.saturating_mul(accessor.element_bytes()),
            Err(_) => 0,
        };
        about
            .accessors()
            .fold(0, |sum: u64, accessor| sum.saturating_add(size(accessor)))
            .min(1 << 40)
            / STEPS
    }

    /// The primitives of a mesh, which is read on its first use. What cannot be read is left out.
    pub(super) fn mesh(&mut self, mesh: usize) -> Result<Range<usize>, LoadError> {
        if let Some(range) = self.meshes.get(&mesh) {
            return Ok(range.clone());
        }
        let first = self.writer.scene.primitives.len();
        let about = &self.document.meshes[mesh];
        let part = part_name("mesh", mesh, about.name.as_deref());
        for (index, primitive) in about.primitives.iter().enumerate() {
            let name = format!(
                "{} primitive {index}",
                called("mesh", mesh, about.name.as_deref())
            );
            let read = match primitive {
                Ok(primitive) => self.primitive([&name, &part], primitive),
                Err(reason) => Err(LoadError::new(format_args!(": {reason}"))),
            };
            if let Err(error) = read {
                let reason = error.after(&name).of_part()?;
                self.buffers
                    .notes
                    .fault(|| format!("{reason}; it is left out"));
                self.first_lost.get_or_insert(reason);
            }
        }
        let range = first..self.writer.scene.primitives.len();
        self.meshes.insert(mesh, range.clone());
        Ok(range)
    }

    /// Reads a primitive of the mesh with this name; nothing where its kind is not drawn. Errors
    /// begin with ` ATTRIBUTE: ` or `: `, to follow the primitive's name.
    fn primitive(
        &mut self,
        [name, mesh]: [&str; 2],
        about: &'a document::Primitive,
    ) -> Result<(), LoadError> {
        let notes = self.buffers.notes;
        let topology = about.topology;
        let Some(&positions) = about.attributes.get("POSITION") else {
            notes.add(|| format!("{name} is skipped: it has no POSITION"));
            return Ok(());
        };
        let at = |coordinates: &'static str| {
            move |error: LoadError| error.after(format_args!(" {coordinates}: "))
        };
        let layout = self.writer.accessor(positions).map_err(at("POSITION"))?;
        let count = layout.count;
        self.budget_vertices(count.into()).map_err(at("POSITION"))?;
        if let Ok(accessor) = &self.document.accessors[positions]
            && !accessor.has_bounds
        {
            notes.fault(|| {
                format!(
                    "{name} POSITION: accessor {positions} has no min and max; they are computed"
                )
            });
        }
        let [position_formats, normal_formats, texcoord_formats] = match self.writer.is_quantized {
            true => [QUANTIZED, QUANTIZED_NORMALS, QUANTIZED],
            false => [FLOAT, FLOAT, FLOAT_OR_UNORM],
        };
        let positions = self
            .writer
            .attribute(positions, count, &[3], position_formats)
            .map_err(at("POSITION"))?;
        let normals = match topology {
            // A line has no sides.
            Topology::Lines => None,
            _ => self.optional(name, about, "NORMAL", count, (&[3], normal_formats))?,
        };
        let colors = self.optional(name, about, "COLOR_0", count, (&[3, 4], FLOAT_OR_UNORM))?;
        let indices = about
            .indices
            .map(|accessor| self.writer.indices(accessor).map_err(at("indices")))
            .transpose()?;
        let indices = match about.chain {
            None => indices,
            Some(chain) => {
                let joined = self.writer.joined(indices, count, chain);
                Some(joined.map_err(at("indices"))?)
            }
        };
        let corners = indices.map_or(count, |indices| indices.count);
        self.budget_triangles(topology, corners)
            .map_err(if indices.is_some() {
                at("indices")
            } else {
                at("POSITION")
            })?;
        let texcoords = self.texcoords(name, about, count, texcoord_formats)?;
        let morph_targets =
            deformation::morph_targets(&mut self.writer, (name, about), count, notes)?;
        let mut primitive = Primitive {
            name: name.into(),
            mesh: mesh.into(),
            topology,
            indices,
            positions,
            normals: normals.unwrap_or(positions),
            is_faceted: normals.is_none()
                && !matches!(topology, Topology::Points | Topology::Lines),
            colors,
            texcoords,
            tangents: None,
            material: 0,
            bounds: Bounds::EMPTY,
            longest_edge: 0.0,
            normals_agree: false,
            deformation: Deformation {
                morph_targets,
                ..Deformation::default()
            },
        };
        let (checkpoint, step) = (checkpoint(), self.step_bytes(about));
        checkpoint.advance(step)?;
        check_indices(&self.writer.scene, &primitive).map_err(at("indices"))?;
        checkpoint.advance(step)?;
        let far = leave_out_far(&mut self.writer, &mut primitive).map_err(at("POSITION"))?;
        if let Some(far) = far {
            notes.fault(|| format!("{name} POSITION: {far}"));
        }
        measure(&self.writer.scene, &mut primitive)?;
        checkpoint.advance(step)?;
        if primitive.is_points() {
            let at_vertex = |vertex| {
                DVec3::from(
                    primitive
                        .position(&self.writer.scene, vertex)
                        .map(f64::from),
                )
            };
            primitive.longest_edge =
                point_cloud::diameter((0..count).map(at_vertex), &primitive.bounds);
        }
        if primitive.is_spread() {
            if normals.is_none() {
                // One for all: what has none faces the viewer.
                let none = self.writer.append_vectors(1, [[0.0; 3]].into_iter());
                primitive.normals = Accessor {
                    stride: 0,
                    count,
                    ..none.map_err(at("NORMAL"))?
                };
            }
        } else if normals.is_none() {
            let smooth = smooth_normals(&self.writer.scene, &primitive)?;
            primitive.normals = self
                .writer
                .append_vectors(smooth.len(), smooth.iter().copied().map(normal))
                .map_err(at("NORMAL"))?;
        }
        checkpoint.advance(step)?;
        primitive.normals_agree =
            !primitive.is_faceted && primitive.normals_agree(&self.writer.scene)?;
        if !self.give_material(name, about.material, &mut primitive)? {
            return Ok(());
        }
        let normal_map = self.writer.scene.materials[primitive.material].normal_texture;
        if let Some(texture) = normal_map {
            let given = (&[4][..], normal_formats);
            let given = self.optional(name, about, "TANGENT", count, given)?;
            let tangents = tangents::of(&self.writer.scene, &primitive, &texture, given.as_ref());
            primitive.tangents = Some(
                self.writer
                    .append_vectors(tangents.len(), tangents.into_iter())
                    .map_err(at("TANGENT"))?,
            );
        }
        self.writer.scene.primitives.push(primitive);
        self.sources.push(about);
        Ok(())
    }

    /// An attribute that a primitive is drawn without where it cannot be read.
    ///
    /// # Errors
    /// Loading ends.
    fn optional(
        &mut self,
        name: &str,
        about: &document::Primitive,
        attribute: &str,
        count: u32,
        (components, formats): (&[u32], &[Format]),
    ) -> Result<Option<Accessor>, LoadError> {
        let Some(&accessor) = about.attributes.get(attribute) else {
            return Ok(None);
        };
        let read = self.writer.attribute(accessor, count, components, formats);
        let read = read.and_then(|accessor| {
            check_finite(&self.writer.scene, &accessor)?;
            Ok(accessor)
        });
        match read {
            Ok(accessor) => Ok(Some(accessor)),
            Err(error) => {
                let place = format_args!("{name} {attribute}");
                let reason = error.within(place).of_part()?;
                self.buffers
                    .notes
                    .fault(|| format!("{reason}; it is left out"));
                Ok(None)
            }
        }
    }

    /// The texture coordinates of the textures of a primitive's material, those that can be read.
    fn texcoords(
        &mut self,
        name: &str,
        about: &document::Primitive,
        count: u32,
        formats: &[Format],
    ) -> Result<[Option<Accessor>; TEXTURE_SLOTS], LoadError> {
        let Some(material) = about.material else {
            return Ok([None; TEXTURE_SLOTS]);
        };
        let textures = self.writer.scene.materials[material]
            .textures()
            .map(|texture| texture.copied());
        let mut texcoords = [None; TEXTURE_SLOTS];
        for (texcoords, texture) in texcoords.iter_mut().zip(textures) {
            let Some(texture) = texture else { continue };
            let attribute = format!("TEXCOORD_{}", texture.set);
            if !about.attributes.contains_key(&attribute) {
                self.buffers.notes.fault(|| {
                    format!("{name} {attribute}: it is missing, although a texture of the material uses it; the texture is left out")
                });
                continue;
            }
            let read = self.optional(name, about, &attribute, count, (&[2], formats))?;
            let Some(accessor) = read else { continue };
            match check_repeats(&self.writer.scene, &accessor, &texture) {
                Ok(()) => *texcoords = Some(accessor),
                Err(error) => {
                    let place = format_args!("{name} {attribute}");
                    let reason = error.within(place).of_part()?;
                    self.buffers
                        .notes
                        .add(|| format!("{reason}; the texture is left out"));
                }
            }
        }
        Ok(texcoords)
    }

    /// Gives a primitive its material, without the textures that it has no coordinates for, and
    /// with the mask that the alpha of its vertices makes. False where masking leaves nothing.
    fn give_material(
        &mut self,
        name: &str,
        material: Option<usize>,
        primitive: &mut Primitive,
    ) -> Result<bool, LoadError> {
        let about = material.map(|material| &self.document.materials[material]);
        let mode = about.map_or(AlphaMode::Opaque, |about| about.alpha_mode);
        let as_read = material.map(|material| {
            let plain = &self.writer.scene.materials[material];
            mask::Variant::of_material(plain)
        });
        let textures = primitive.texcoords.map(|texcoords| texcoords.is_some());
        let base = textures[TextureSlot::Base as usize];
        let mut variant = mask::Variant {
            textures,
            cutoff: as_read.and_then(|as_read| as_read.cutoff).filter(|_| base),
            is_ramp: false,
        };
        if let (AlphaMode::Mask, Some(about)) = (mode, about) {
            let alphas = mask::Alphas::of(&self.writer.scene, primitive.colors.as_ref())?;
            variant.cutoff = None;
            match mask::masked(about, base, alphas) {
                mask::Masked::Whole => {}
                mask::Masked::Nothing => {
                    self.buffers.notes.add(|| {
                        format!("{name} is skipped: the alpha of its material is below the cutoff everywhere")
                    });
                    return Ok(false);
                }
                mask::Masked::Image { cutoff } => variant.cutoff = Some(cutoff.to_bits()),
                mask::Masked::Ramp { cutoff } => {
                    variant.cutoff = Some(cutoff.to_bits());
                    variant.is_ramp = true;
                    let alphas = mask::ramp_texcoords(&self.writer.scene, primitive);
                    primitive.texcoords[0] = Some(self.writer.append_pairs(&alphas)?);
                }
            }
            if base && !alphas.is_uniform() {
                self.buffers.notes.add(|| {
                    format!("{name}: alpha masking uses the alpha of the image, not that of the vertex colors")
                });
            }
        }
        // What does not blend is opaque, whatever the alpha of its colors.
        if let Some(colors) = primitive
            .colors
            .as_mut()
            .filter(|_| mode != AlphaMode::Blend)
        {
            colors.components = 3;
        }
        primitive.material = match material {
            Some(material) if as_read == Some(variant) => material,
            _ => {
                let scene = &mut self.writer.scene;
                *self.variants.entry((material, variant)).or_insert_with(|| {
                    let plain = match material {
                        Some(material) => scene.materials[material].clone(),
                        // As the specification says.
                        None => Material {
                            metallic: 1.0,
                            roughness: 1.0,
                            ..Material::default()
                        },
                    };
                    let made = variant.made_of(plain, &mut scene.images);
                    scene.materials.push(made);
                    scene.materials.len() - 1
                })
            }
        };
        Ok(true)
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
        let triangles = topology.triangles(corners);
        if triangles == 0 {
            return Err(LoadError::new(format!(
                "{corners} corners form no {}",
                match topology {
                    Topology::Points => "point; it takes at least 1",
                    Topology::Lines => "line; it takes at least 2",
                    _ => "triangle; it takes at least 3",
                }
            )));
        }
        self.triangles += u64::from(triangles);
        match self.triangles > self.limits.triangles {
            true => Err(self.limits.exceeded(
                format_args!("the model has {} triangles or more", self.triangles),
                self.limits.triangles,
            )),
            false => Ok(()),
        }
    }
}
