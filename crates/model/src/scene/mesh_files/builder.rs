//! Parts of a model with one material each, which faces are added to, and the scene of them.

use std::collections::HashMap;

use glam::{DMat4, DVec3};

use super::{findings::Findings, polygons};
use crate::{
    scene::{
        accessor::{Accessor, ComponentType},
        bounds::{Bounds, MAX_MAGNITUDE},
        gltf::{
            LoadError,
            buffers::append,
            checks,
            error::{called, part_name},
            limits::Limits,
            load::check_size,
            notes::Notes,
        },
        material::Material,
        memory::MemoryBudget,
        model::{Instance, NamedNode, Primitive, Scene, Topology},
        point_cloud::PointCloud,
    },
    work::checkpoint,
};

/// What reading a model may take.
pub struct Room {
    limits: Limits,
    taken: u64,
}

impl Room {
    /// For a model file of so many bytes.
    pub fn of(budget: MemoryBudget, file: u64) -> Self {
        Self {
            limits: Limits::of_model(budget, file),
            taken: 0,
        }
    }

    /// Counts so many bytes of a list that grows, before it does. Such a list takes up to twice as
    /// much.
    pub fn take(&mut self, bytes: usize) -> Result<(), LoadError> {
        self.taken += 2 * bytes as u64;
        let most = 2 * self.limits.total_bytes;
        match self.taken > most {
            true => Err(self.limits.exceeded(
                format_args!("reading it takes {} bytes or more", self.taken),
                most,
            )),
            false => Ok(()),
        }
    }
}

/// A vertex of a face. Files with the same key for two vertices have only one.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Among the vertices of its part.
    pub key: [u32; 4],
    /// It [is near](crate::scene::bounds::is_near).
    pub position: [f64; 3],
    pub normal: [f32; 3],
    /// Linear, in units of 1/65535.
    pub color: [u16; 4],
    /// The origin is the upper left corner of the image.
    pub texcoord: [f32; 2],
}

impl Vertex {
    /// A white vertex at a place.
    pub fn at(key: [u32; 4], position: [f64; 3]) -> Self {
        Self {
            key,
            position,
            normal: [0.0; 3],
            color: [u16::MAX; 4],
            texcoord: [0.0; 2],
        }
    }
}

/// What the faces of a part have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Kind {
    /// The node that shows it, of `Scene::named_nodes`.
    pub node: Option<usize>,
    /// Of `Scene::materials`.
    pub material: usize,
    /// Light falls by the normals of the vertices, else on the planes of the faces.
    pub has_normals: bool,
    pub has_colors: bool,
    pub has_texcoords: bool,
    pub shape: Shape,
}

/// What the vertices of a part are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shape {
    Faces,
    Points,
    Lines,
}

/// Faces of one kind.
pub struct Part {
    kind: Kind,
    positions: Vec<[f64; 3]>,
    normals: Vec<[f32; 3]>,
    colors: Vec<[u16; 4]>,
    texcoords: Vec<[f32; 2]>,
    indices: Vec<u32>,
    known: HashMap<[u32; 4], u32>,
}

impl Part {
    fn push(&mut self, vertex: Vertex) {
        self.positions.push(vertex.position);
        if self.kind.has_normals {
            self.normals.push(vertex.normal);
        }
        if self.kind.has_colors {
            self.colors.push(vertex.color);
        }
        if self.kind.has_texcoords {
            self.texcoords.push(vertex.texcoord);
        }
    }

    /// Gives every vertex the normal that `normal` has for its key.
    pub fn set_normals(&mut self, normal: impl Fn([u32; 4]) -> Option<[f32; 3]>) {
        for (&key, &vertex) in &self.known {
            if let Some(normal) = normal(key) {
                self.normals[vertex as usize] = normal;
            }
        }
    }
}

/// The bytes that a vertex takes in a table of those that are known.
const TABLE_BYTES: usize = 24;

/// The bytes that a corner of a face takes while the face is cut.
const FACE_BYTES: usize = 2 * size_of::<Vertex>();

/// Collects faces.
pub struct Builder {
    /// Its materials, images and named nodes; the rest is added at the end.
    pub scene: Scene,
    pub room: Room,
    pub parts: Vec<Part>,
    by_kind: HashMap<Kind, usize>,
    vertices: u64,
    triangles: u64,
    /// Corners of the largest face.
    widest: usize,
    /// Of the face that is added.
    corners: Vec<DVec3>,
    cut: Vec<[u32; 3]>,
}

impl Builder {
    pub fn new(scene: Scene, room: Room) -> Self {
        Self {
            scene,
            room,
            parts: Vec::new(),
            by_kind: HashMap::new(),
            vertices: 0,
            triangles: 0,
            widest: 0,
            corners: Vec::new(),
            cut: Vec::new(),
        }
    }

    /// Adds a node that patterns find by its name.
    pub fn node(&mut self, name: &str, parent: Option<usize>) -> usize {
        let nodes = &mut self.scene.named_nodes;
        let name = part_name("node", nodes.len(), Some(name));
        nodes.push(NamedNode { name, parent });
        nodes.len() - 1
    }

    /// The index of the part with faces of this kind.
    pub fn part(&mut self, kind: Kind) -> Result<usize, LoadError> {
        if let Some(&part) = self.by_kind.get(&kind) {
            return Ok(part);
        }
        let count = self.parts.len() + 1;
        self.room
            .limits
            .check_instances(count, || format!("it has {count} parts or more"))?;
        self.room.take(size_of::<Part>() + size_of::<Primitive>())?;
        self.parts.push(Part {
            kind,
            positions: Vec::new(),
            normals: Vec::new(),
            colors: Vec::new(),
            texcoords: Vec::new(),
            indices: Vec::new(),
            known: HashMap::new(),
        });
        self.by_kind.insert(kind, count - 1);
        Ok(count - 1)
    }

    /// Counts what a face of so many corners takes while it is read.
    pub fn widen(&mut self, corners: usize) -> Result<(), LoadError> {
        if corners > self.widest {
            self.room.take((corners - self.widest) * FACE_BYTES)?;
            self.widest = corners;
        }
        Ok(())
    }

    /// Adds a face with at least three corners, cut into triangles. `place` names it in messages.
    ///
    /// # Errors
    /// A limit is exceeded, or loading was canceled.
    pub fn face(
        &mut self,
        part: usize,
        face: &mut Vec<Vertex>,
        findings: &mut Findings,
        place: impl FnOnce() -> String,
    ) -> Result<(), LoadError> {
        if let [a, b, c] = face[..] {
            return self.triangle(part, [a, b, c]);
        } else {
            face.dedup_by_key(|corner| corner.position);
            if face.len() > 1 && face[0].position == face[face.len() - 1].position {
                face.pop();
            }
        }
        self.corners.clear();
        self.corners
            .extend(face.iter().map(|corner| DVec3::from(corner.position)));
        self.cut.clear();
        if !polygons::cut(&self.corners, &mut self.cut)? {
            findings.fault("it is left out", || {
                format!(
                    "{}: it is not convex and has {} corners; allowed: at most {}",
                    place(),
                    face.len(),
                    polygons::MOST_CORNERS
                )
            });
        }
        for triangle in 0..self.cut.len() {
            let [a, b, c] = self.cut[triangle].map(|corner| face[corner as usize]);
            self.triangle(part, [a, b, c])?;
        }
        Ok(())
    }

    /// Adds a segment to a part of lines.
    pub fn segment(&mut self, part: usize, ends: [Vertex; 2]) -> Result<(), LoadError> {
        self.count_triangles(2)?;
        self.room.take(size_of::<[u32; 2]>())?;
        for end in ends {
            let index = self.vertex(part, end)?;
            self.parts[part].indices.push(index);
        }
        Ok(())
    }

    /// Adds a point to a part of points.
    pub fn point(&mut self, part: usize, point: Vertex) -> Result<(), LoadError> {
        self.triangles += 1;
        self.vertices += 1;
        let most = self.room.limits.vertices.min(self.room.limits.triangles);
        if self.vertices.max(self.triangles) > most {
            return Err(self
                .room
                .limits
                .exceeded("the model has as many points or more", most));
        }
        self.room.take(size_of::<Vertex>())?;
        let part = &mut self.parts[part];
        part.push(point);
        Ok(())
    }

    /// Gives every vertex with a color the one that `paint` makes of its channels.
    pub fn paint(&mut self, paint: impl Fn([u16; 3]) -> [u16; 4]) {
        let colors = self.parts.iter_mut().flat_map(|part| &mut part.colors);
        colors.for_each(|color| *color = paint([color[0], color[1], color[2]]));
    }

    /// Adds a triangle.
    pub fn triangle(&mut self, part: usize, corners: [Vertex; 3]) -> Result<(), LoadError> {
        self.count_triangles(1)?;
        self.room.take(size_of::<[u32; 3]>())?;
        for corner in corners {
            let index = self.vertex(part, corner)?;
            self.parts[part].indices.push(index);
        }
        Ok(())
    }

    fn count_triangles(&mut self, more: u64) -> Result<(), LoadError> {
        self.triangles += more;
        let most = self.room.limits.triangles;
        match self.triangles > most {
            true => Err(self.room.limits.exceeded(
                format_args!("the model has {} triangles or more", self.triangles),
                most,
            )),
            false => Ok(()),
        }
    }

    fn vertex(&mut self, part: usize, vertex: Vertex) -> Result<u32, LoadError> {
        let part = &mut self.parts[part];
        if let Some(&index) = part.known.get(&vertex.key) {
            return Ok(index);
        }
        self.vertices += 1;
        let most = self.room.limits.vertices;
        if self.vertices > most {
            return Err(self.room.limits.exceeded(
                format_args!("the model has {} vertices or more", self.vertices),
                most,
            ));
        }
        self.room.take(size_of::<Vertex>() + TABLE_BYTES)?;
        let index = part.positions.len() as u32;
        part.push(vertex);
        part.known.insert(vertex.key, index);
        Ok(index)
    }

    /// The scene. `nothing` says what a file has that has no faces, or none that are drawn although
    /// nothing is wrong with it.
    ///
    /// # Errors
    /// There is nothing to draw, or a limit is exceeded.
    pub fn finish(
        self,
        notes: Notes,
        has_faces: bool,
        nothing: impl FnOnce() -> String,
    ) -> Result<Scene, LoadError> {
        let Self {
            mut scene,
            parts,
            room: Room { limits, .. },
            by_kind,
            ..
        } = self;
        drop(by_kind);
        if scene.materials.is_empty() {
            scene.materials.push(plain_material());
        }
        let mut plain = HashMap::new();
        let center = far_center(parts.iter());
        for part in parts {
            if !part.indices.is_empty() || part.kind.shape == Shape::Points {
                let own = || far_center(std::iter::once(&part));
                let center = center.or_else(own).unwrap_or_default();
                add(part, center, &limits, &mut scene, &mut plain, &notes)?;
            }
        }
        if scene.instances.is_empty() {
            return Err(LoadError::new(format_args!(
                "there is nothing to draw: {}",
                notes
                    .first_fault()
                    .filter(|_| has_faces)
                    .map_or_else(nothing, |fault| format!(
                        "{}; fetch or export it again",
                        fault.trim_end_matches("; what is there is drawn")
                    ))
            )));
        }
        check_size(&scene)?;
        [scene.notes, scene.faults] = notes.into_lists();
        Ok(scene)
    }
}

/// The material of faces without another: none of the formats tells the front of a face.
pub fn plain_material() -> Material {
    Material {
        double_sided: true,
        ..Material::default()
    }
}

/// The middle of parts that lie far from the origin for their size: positions relative to it keep in
/// an f32 what the file says. It is rounded to a power of two of about their size, so that little of
/// a decimal is lost where it is subtracted.
fn far_center<'a>(parts: impl Iterator<Item = &'a Part>) -> Option<DVec3> {
    // Nearer, an f32 errs by a millionth of the size.
    const FAR: f64 = 8.0;
    let mut bounds = Bounds::EMPTY;
    let positions = parts.flat_map(|part| &part.positions);
    positions.for_each(|&position| bounds.include(DVec3::from(position)));
    let size = (bounds.max - bounds.min).max_element();
    let (middle, is_sized) = (bounds.center(), size > 0.0 && size.is_finite());
    let distance = middle.abs().max_element();
    let step = libm::exp2(libm::log2(size).floor());
    (is_sized && distance > FAR * size && distance < MAX_MAGNITUDE)
        .then(|| (middle / step).round() * step)
}

/// Adds a part to a scene, with positions relative to `center`. `plain` are the materials without their textures.
fn add(
    part: Part,
    center: DVec3,
    limits: &Limits,
    scene: &mut Scene,
    plain: &mut HashMap<usize, usize>,
    notes: &Notes,
) -> Result<(), LoadError> {
    let Part {
        kind,
        positions,
        normals,
        colors,
        texcoords,
        indices,
        known,
    } = part;
    drop(known);
    let positions: Vec<[f32; 3]> = positions
        .into_iter()
        .map(|position| (DVec3::from(position) - center).as_vec3().to_array())
        .collect();
    let vertices = positions.len();
    if kind.shape == Shape::Points {
        let cloud = PointCloud {
            positions,
            normals,
            colors,
        };
        let bytes = &mut scene.vertex_bytes;
        let primitive = cloud.primitive("points", kind.material, |added| {
            append(limits, bytes, added)
        })?;
        let instance = Instance {
            named_node: kind.node,
            ..Instance::fixed(scene.primitives.len(), DMat4::from_translation(center))
        };
        scene.instances.push(instance);
        scene.primitives.push(primitive);
        return Ok(());
    }
    let mut stored = |bytes: &[u8]| append(limits, &mut scene.vertex_bytes, bytes);
    let positions_at = stored(bytemuck::cast_slice(&positions))? as usize;
    drop(positions);
    let normals_at = stored(bytemuck::cast_slice(&normals))? as usize;
    drop(normals);
    let normals_at = match kind.shape {
        Shape::Lines => stored(&[0; 12])? as usize,
        _ => normals_at,
    };
    let colors_at = stored(bytemuck::cast_slice(&colors))?;
    drop(colors);
    let texcoords_at = stored(bytemuck::cast_slice(&texcoords))? as usize;
    drop(texcoords);
    let indices_at = append(
        limits,
        &mut scene.index_bytes,
        bytemuck::cast_slice(&indices),
    )?;
    let mesh = kind.node.map(|node| scene.named_nodes[node].name.clone());
    let positions = Accessor::packed_f32(positions_at, 3, vertices);
    let is_lines = kind.shape == Shape::Lines;
    let is_faceted = !kind.has_normals && !is_lines;
    let mut primitive = Primitive {
        name: called("mesh", 0, mesh.as_deref()),
        mesh: part_name("mesh", 0, mesh.as_deref()),
        topology: if is_lines {
            Topology::Lines
        } else {
            Topology::List
        },
        indices: Some(Accessor {
            offset: indices_at,
            stride: 4,
            component_type: ComponentType::U32,
            components: 1,
            normalized: false,
            count: indices.len() as u32,
        }),
        positions,
        normals: match is_faceted {
            true => positions,
            // One for all: a line faces the viewer.
            false if is_lines => Accessor {
                stride: 0,
                ..Accessor::packed_f32(normals_at, 3, vertices)
            },
            false => Accessor::packed_f32(normals_at, 3, vertices),
        },
        is_faceted,
        colors: kind.has_colors.then_some(Accessor {
            offset: colors_at,
            stride: size_of::<[u16; 4]>() as u32,
            component_type: ComponentType::U16,
            components: 3,
            normalized: true,
            count: vertices as u32,
        }),
        texcoords: Default::default(),
        tangents: None,
        material: kind.material,
        bounds: Bounds::EMPTY,
        longest_edge: 0.0,
        normals_agree: false,
        deformation: Default::default(),
    };
    drop(indices);
    checkpoint().pass()?;
    checks::measure(scene, &mut primitive)?;
    if is_faceted {
        let smooth = checks::smooth_normals(scene, &primitive)?;
        let normals: Vec<[f32; 3]> = smooth.into_iter().map(checks::normal).collect();
        let at = append(
            limits,
            &mut scene.vertex_bytes,
            bytemuck::cast_slice(&normals),
        )?;
        primitive.normals = Accessor::packed_f32(at as usize, 3, vertices);
    } else if !is_lines {
        primitive.normals_agree = primitive.normals_agree(scene)?;
    }
    let texcoords = Accessor::packed_f32(texcoords_at, 2, vertices);
    texture(
        scene,
        &mut primitive,
        kind.has_texcoords.then_some(texcoords),
        plain,
        notes,
    )?;
    let instance = Instance {
        named_node: kind.node,
        ..Instance::fixed(scene.primitives.len(), DMat4::from_translation(center))
    };
    scene.instances.push(instance);
    scene.primitives.push(primitive);
    Ok(())
}

/// Gives a primitive its texture coordinates, or a material without the textures that it has none
/// for.
fn texture(
    scene: &mut Scene,
    primitive: &mut Primitive,
    texcoords: Option<Accessor>,
    plain: &mut HashMap<usize, usize>,
    notes: &Notes,
) -> Result<(), LoadError> {
    let textures = scene.materials[primitive.material]
        .textures()
        .map(|texture| texture.copied());
    let Some(first) = textures.into_iter().flatten().next() else {
        return Ok(());
    };
    let usable = match texcoords {
        None => None,
        Some(texcoords) => match checks::check_repeats(scene, &texcoords, &first) {
            Ok(()) => Some(texcoords),
            Err(error) => {
                let reason = error.within(&primitive.name).of_part()?;
                notes.add(|| format!("{reason}; the texture is left out"));
                None
            }
        },
    };
    if usable.is_some() {
        primitive.texcoords = textures.map(|texture| texture.and(usable));
    } else {
        let textured = primitive.material;
        primitive.material = *plain.entry(textured).or_insert_with(|| {
            scene.materials.push(Material {
                base_texture: None,
                emission_texture: None,
                alpha_cutoff: None,
                ..scene.materials[textured].clone()
            });
            scene.materials.len() - 1
        });
    }
    Ok(())
}
