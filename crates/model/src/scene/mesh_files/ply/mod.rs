//! PLY: its header says which elements follow, of which properties, as text or binary.

mod header;
mod rows;

use std::path::Path;

use super::{
    beside::Beside,
    builder::{Builder, Kind, Room, Shape, Vertex, plain_material},
    colors,
    findings::Findings,
    stream::Stream,
};
use crate::{
    scene::{
        bounds::is_near,
        gltf::{
            LoadError, ReadFile, Source,
            error::{part_name, quoted},
            limits::Limits,
            notes::Notes,
        },
        material::Material,
        memory::MemoryBudget,
        model::Scene,
    },
    work::checkpoint,
};
use header::{Element, Header};
use rows::{Read, Rows};

/// No texture coordinates.
const NONE: u32 = u32::MAX;

/// Most images that a file names.
const MOST_TEXTURES: usize = 256;

/// Loads a PLY model within a memory budget. `read` supplies images.
///
/// # Errors
/// There is nothing to draw, a limit is exceeded, or loading was canceled.
pub fn load(
    model: &dyn Source,
    budget: MemoryBudget,
    read: &mut ReadFile,
) -> Result<Scene, LoadError> {
    let is_ply = |head: &[u8]| {
        let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
        text.starts_with(b"ply")
    };
    let head = super::head(model, budget, "a PLY file", is_ply)?;
    if !is_ply(&head) {
        return Err(LoadError::new(
            "it is no PLY file: it does not begin with \"ply\"; fetch or export it again",
        ));
    }
    let mut stream = Stream::new(model);
    let header = Header::read(&mut stream)?;
    let (body, lines) = (model.size() - stream.left(), stream.line);
    let notes = Notes::default();
    let mut beside = Beside::of(model.size(), Limits::of_files(budget), read, &notes);
    let mut materials = Vec::new();
    for name in header.textures.iter().take(MOST_TEXTURES) {
        let place = part_name("texture", materials.len(), None);
        materials.push(Material {
            name: part_name("material", materials.len(), None),
            base_texture: beside.texture(Path::new(""), std::slice::from_ref(name), &place)?,
            ..plain_material()
        });
    }
    if materials.is_empty() {
        materials.push(plain_material());
    }
    let scene = Scene {
        materials,
        images: beside.images,
        ..Scene::default()
    };
    let mut reader = Reader {
        builder: Builder::new(scene, Room::of(budget, model.size())),
        findings: Findings::default(),
        vertices: Vertices::default(),
        face: Vec::new(),
    };
    let at = |name: &str| header.elements.iter().position(|one| one.name == name);
    let [vertices, faces, strips] = ["vertex", "face", "tristrips"].map(at);
    let is_early = |faces: Option<usize>| faces.is_some() && faces < vertices;
    let passes: &[&[&str]] = match is_early(faces) || is_early(strips) {
        true => &[&["vertex"], &["face", "tristrips"]],
        false => &[&["vertex", "face", "tristrips"]],
    };
    for (pass, wanted) in passes.iter().enumerate() {
        if pass > 0 {
            checkpoint().expect(model.size());
        }
        let mut stream = Stream::new(model);
        stream.skip(body)?;
        stream.line = lines;
        let mut rows = Rows::new(stream, header.encoding);
        for element in &header.elements {
            match wanted.contains(&element.name.as_str()) {
                true => reader.element(element, &mut rows)?,
                false => rows.skip(element, &mut reader.builder.room)?,
            }
        }
    }
    let has_faces = header
        .elements
        .iter()
        .any(|element| element.count > 0 && ["face", "tristrips"].contains(&element.name.as_str()));
    // Where all faces are broken, that is said.
    if !has_faces || !reader.builder.parts.is_empty() {
        reader.loose_points()?;
    }
    let Reader {
        builder, findings, ..
    } = reader;
    findings.tell(&notes);
    let has_rows = header.elements.iter().any(|element| element.count > 0);
    builder.finish(notes, has_rows, || {
        "it has no points and no faces".to_owned()
    })
}

/// The properties of vertices. All lists but that of positions may be empty.
#[derive(Default)]
struct Vertices {
    /// Not finite where the file has no three numbers.
    positions: Vec<[f64; 3]>,
    normals: Vec<[f32; 3]>,
    colors: Vec<[u16; 4]>,
    texcoords: Vec<[f32; 2]>,
    /// Those that a face has.
    of_faces: Vec<bool>,
}

/// Where an element has a color, and the value of its channels that are full.
struct Color([Option<usize>; 3], f64);

impl Color {
    fn of(element: &Element) -> Option<Self> {
        let names = [
            ["red", "r", "diffuse_red"],
            ["green", "g", "diffuse_green"],
            ["blue", "b", "diffuse_blue"],
        ];
        let channels = names.map(|names| element.find(&names));
        let first = &element.properties[channels[0]?];
        let is_whole = channels.iter().all(Option::is_some);
        is_whole.then(|| Self(channels, first.number.brightest()))
    }

    fn read(&self, rows: &Rows) -> [f32; 3] {
        self.0.map(|channel| (rows.value(channel) / self.1) as f32)
    }
}

struct Reader {
    builder: Builder,
    findings: Findings,
    vertices: Vertices,
    /// The corners of the face.
    face: Vec<Vertex>,
}

impl Reader {
    fn element(&mut self, element: &Element, rows: &mut Rows) -> Result<(), LoadError> {
        let color = Color::of(element);
        let indices = element.find(&["vertex_indices", "vertex_index"]);
        match element.name.as_str() {
            "vertex" => {
                let columns = Columns::of(element);
                self.rows(element, rows, |reader, rows, row| {
                    reader.vertex(&columns, color.as_ref(), rows, row)
                })
            }
            "face" => {
                let [wedges, texture] =
                    [["texcoord"], ["texnumber"]].map(|name| element.find(&name));
                self.rows(element, rows, |reader, rows, row| {
                    let material = rows.value(texture).max(0.0) as usize;
                    let corners = rows.list(indices);
                    let color = color.as_ref().map(|color| color.read(rows));
                    reader.face(corners, (rows.list(wedges), material, color), row)
                })
            }
            _ => self.rows(element, rows, |reader, rows, row| {
                reader.strip(rows.list(indices), row)
            }),
        }
    }

    /// Reads all rows of an element; `each` is given the rows and their index.
    fn rows(
        &mut self,
        element: &Element,
        rows: &mut Rows,
        mut each: impl FnMut(&mut Self, &Rows, u64) -> Result<(), LoadError>,
    ) -> Result<(), LoadError> {
        let name = quoted(&element.name);
        for row in 0..element.count {
            match rows.read(element, &mut self.builder.room)? {
                Read::Whole => {}
                Read::Broken => self.findings.fault("it is incomplete", || {
                    format!("line {}: values of {name} are missing", rows.stream.line)
                }),
                Read::Ended => {
                    let count = element.count;
                    self.findings.fault("what is there is drawn", || {
                        format!("the file ends after {row} of {count} rows of {name}")
                    });
                    break;
                }
            }
            each(self, rows, row)?;
        }
        Ok(())
    }

    fn vertex(
        &mut self,
        columns: &Columns,
        color: Option<&Color>,
        rows: &Rows,
        row: u64,
    ) -> Result<(), LoadError> {
        self.builder.room.take(size_of::<Vertex>())?;
        let values = |at: [Option<usize>; 3]| at.map(|at| rows.value(at) as f32);
        let is_finite = |values: &[f32]| values.iter().all(|value| value.is_finite());
        let vertices = &mut self.vertices;
        let position = columns.position.map(|at| rows.value(at));
        let is_placed = is_near(position);
        if !is_placed {
            self.findings
                .fault("it and faces with it are left out", || {
                    format!("vertex {row}: its x, y and z are not three numbers below 6.9e10")
                });
        }
        vertices
            .positions
            .push(if is_placed { position } else { [f64::NAN; 3] });
        if let Some(normal) = columns.normal {
            let normal = values(normal);
            let is_sound = is_finite(&normal);
            vertices
                .normals
                .push(if is_sound { normal } else { [0.0; 3] });
        }
        if let Some(color) = color {
            vertices.colors.push(colors::of_vertex(color.read(rows)));
        }
        if let Some(texcoord) = columns.texcoord {
            let [u, v] = texcoord.map(|at| rows.value(Some(at)) as f32);
            let is_sound = is_finite(&[u, v]);
            let place = if is_sound { [u, 1.0 - v] } else { [0.0; 2] };
            vertices.texcoords.push(place);
        }
        Ok(())
    }

    /// Reads a face of these corners: with texture coordinates of each, its texture and its color.
    fn face(
        &mut self,
        corners: &[f64],
        (wedges, texture, color): (&[f64], usize, Option<[f32; 3]>),
        row: u64,
    ) -> Result<(), LoadError> {
        let vertices = &self.vertices;
        let count = vertices.positions.len();
        let material = texture.min(self.builder.scene.materials.len() - 1);
        let is_textured = self.builder.scene.materials[material]
            .base_texture
            .is_some();
        let has_wedges = wedges.len() >= 2 * corners.len() && wedges.iter().all(|v| v.is_finite());
        let has_texcoords = has_wedges || !vertices.texcoords.is_empty();
        // A byte for each channel, as files have them.
        let color = color.map(|color| color.map(|v| (v.clamp(0.0, 1.0) * 255.0).round() as u8));
        let paint = color.map(|[r, g, b]| {
            let shown = [r, g, b].map(|channel| f32::from(channel) / 255.0);
            (u32::from_le_bytes([r, g, b, 1]), colors::of_vertex(shown))
        });
        let kind = Kind {
            node: None,
            material,
            has_normals: !vertices.normals.is_empty(),
            has_colors: paint.is_some() || !vertices.colors.is_empty(),
            has_texcoords: is_textured && has_texcoords,
            shape: Shape::Faces,
        };
        self.builder.widen(corners.len())?;
        self.face.clear();
        let mut is_placed = true;
        for (corner, &index) in corners.iter().enumerate() {
            if !(0.0..count as f64).contains(&index) {
                self.findings.fault("it is left out", || {
                    format!("face {row}: it has the vertex {index}, but there are {count}")
                });
                return Ok(());
            }
            let at = index as usize;
            self.vertices.of_faces.resize(count, false);
            self.vertices.of_faces[at] = true;
            let vertices = &self.vertices;
            let mut vertex = Vertex::at([at as u32, NONE, NONE, 0], vertices.positions[at]);
            is_placed &= vertex.position.iter().all(|value| value.is_finite());
            if kind.has_normals {
                vertex.normal = vertices.normals[at];
            }
            if let Some((number, color)) = paint {
                (vertex.key[3], vertex.color) = (number, color);
            } else if kind.has_colors {
                vertex.color = vertices.colors[at];
            }
            if kind.has_texcoords && has_wedges {
                let [u, v] = [0, 1].map(|i| wedges[2 * corner + i] as f32);
                vertex.texcoord = [u, 1.0 - v];
                [vertex.key[1], vertex.key[2]] = vertex.texcoord.map(f32::to_bits);
            } else if kind.has_texcoords {
                vertex.texcoord = vertices.texcoords[at];
            }
            self.face.push(vertex);
        }
        if self.face.len() < 3 {
            self.findings.fault("it is left out", || {
                let count = corners.len();
                format!("face {row}: it has {count} corners; it takes at least 3")
            });
        } else if is_placed {
            let part = self.builder.part(kind)?;
            let place = || format!("face {row}");
            self.builder
                .face(part, &mut self.face, &mut self.findings, place)?;
        }
        Ok(())
    }

    /// Adds the vertices that no face has.
    fn loose_points(&mut self) -> Result<(), LoadError> {
        let vertices = std::mem::take(&mut self.vertices);
        let is_loose = |at: usize| !vertices.of_faces.get(at).copied().unwrap_or(false);
        let kind = Kind {
            node: None,
            material: 0,
            has_normals: !vertices.normals.is_empty(),
            has_colors: !vertices.colors.is_empty(),
            has_texcoords: false,
            shape: Shape::Points,
        };
        let reach = reach(&vertices.positions);
        for (at, &position) in vertices.positions.iter().enumerate() {
            if !is_loose(at) || !is_near(position) {
                continue;
            }
            if size(position) > reach {
                self.findings.fault("it is left out", || {
                    format!(
                        "vertex {at}: it lies far from most, and many have no place: what follows is misread where bytes are missing, so \
                         fetch the file again"
                    )
                });
            } else {
                let mut point = Vertex::at([at as u32, NONE, NONE, 0], position);
                if kind.has_normals {
                    point.normal = vertices.normals[at];
                }
                if kind.has_colors {
                    point.color = vertices.colors[at];
                }
                let part = self.builder.part(kind)?;
                self.builder.point(part, point)?;
            }
        }
        Ok(())
    }

    /// Reads strips of triangles. They end at negative indices.
    fn strip(&mut self, indices: &[f64], row: u64) -> Result<(), LoadError> {
        for strip in indices.split(|&index| index < 0.0) {
            for (i, triangle) in strip.windows(3).enumerate() {
                let &[a, b, c] = triangle else { continue };
                let turned = if i % 2 == 0 { [a, b, c] } else { [b, a, c] };
                if a != b && b != c && c != a {
                    self.face(&turned, (&[], 0, None), row)?;
                }
            }
        }
        Ok(())
    }
}

/// The largest coordinate.
fn size(place: [f64; 3]) -> f64 {
    place.into_iter().fold(0.0, |most, v| v.abs().max(most))
}

/// How far loose points may lie. Where a quarter of them or more has no place, numbers were read at
/// the wrong bytes, and what lies far from the nearest quarter is none of the cloud either.
fn reach(places: &[[f64; 3]]) -> f64 {
    const FAR: f64 = 4.0;
    let mut sizes: Vec<f64> = places
        .iter()
        .copied()
        .filter(|&p| is_near(p))
        .map(size)
        .collect();
    let quarter = places.len() / 4;
    if quarter == 0 || sizes.len() <= quarter || sizes.len() > places.len() - quarter {
        return f64::INFINITY;
    }
    FAR * *sizes.select_nth_unstable_by(quarter, f64::total_cmp).1
}

/// Where the properties of vertices are.
struct Columns {
    position: [Option<usize>; 3],
    normal: Option<[Option<usize>; 3]>,
    texcoord: Option<[usize; 2]>,
}

impl Columns {
    fn of(element: &Element) -> Self {
        let find = |name: &str| element.find(&[name]);
        let normal = ["nx", "ny", "nz"].map(find);
        let pairs = [
            ["s", "t"],
            ["u", "v"],
            ["texture_u", "texture_v"],
            ["texture_s", "texture_t"],
        ];
        let pair = |[u, v]: [&str; 2]| Some([find(u)?, find(v)?]);
        Self {
            position: ["x", "y", "z"].map(find),
            normal: normal.iter().all(Option::is_some).then_some(normal),
            texcoord: pairs.into_iter().find_map(pair),
        }
    }
}
