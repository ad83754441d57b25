//! OBJ: positions, texture coordinates and normals, then the faces, in two passes over the file.

use std::collections::{HashMap, HashSet};

use glam::DVec3;

use super::{
    beside::Beside,
    builder::{Builder, Kind, Room, Shape, Vertex, plain_material},
    colors,
    findings::Findings,
    mtl::{self, Library},
    stream::{Stream, numbers, split},
};
use crate::{
    legible::text_of,
    scene::{
        gltf::{
            LoadError, ReadFile, Source, checks,
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

/// Most lines that name material files.
const MOST_LIBRARIES: usize = 256;

/// Free-form curves and surfaces, which are not drawn.
const NOT_DRAWN: &[&str] = &["curv", "curv2", "surf"];

/// Keywords without a meaning for what is drawn.
const IGNORED: &[&str] = &[
    "vp",
    "cstype",
    "deg",
    "bmat",
    "step",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "mg",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "usemap",
    "maplib",
    "call",
    "csh",
];

/// No index.
const NONE: u32 = u32::MAX;

/// Loads an OBJ model within a memory budget. `read` supplies material files and images.
///
/// # Errors
/// There is nothing to draw, a limit is exceeded, or loading was canceled.
pub fn load(
    model: &dyn Source,
    budget: MemoryBudget,
    read: &mut ReadFile,
) -> Result<Scene, LoadError> {
    super::head(model, budget, "an OBJ file", |_| false)?;
    let (notes, mut findings) = (Notes::default(), Findings::default());
    let mut room = Room::of(budget, model.size());
    let mut lists = Lists::read(model, &mut room, &mut findings)?;
    let used = std::mem::take(&mut lists.used);
    let mut beside = Beside::of(model.size(), Limits::of_files(budget), read, &notes);
    let mut library = mtl::read(&lists.libraries, used, &mut beside, &notes)?;
    let scene = Scene {
        materials: std::mem::take(&mut library.materials),
        images: beside.images,
        ..Scene::default()
    };
    let mut faces = Faces {
        lists: &lists,
        library,
        builder: Builder::new(scene, room),
        findings,
        passed: [0; 3],
        has_faces: false,
        names: [None, None],
        node: None,
        nodes: HashMap::new(),
        material: None,
        smoothing: 0,
        smooth: HashMap::new(),
        sums: Vec::new(),
    };
    faces.read(model)?;
    if !faces.has_faces {
        faces.loose_points()?;
    }
    let Faces {
        mut builder,
        has_faces,
        findings,
        sums,
        smooth,
        ..
    } = faces;
    drop(smooth);
    for part in &mut builder.parts {
        part.set_normals(|[.., normal, is_smooth]| {
            (is_smooth == 1).then(|| checks::normal(sums[normal as usize]))
        });
    }
    let vertices = lists.positions.len();
    drop((lists, sums));
    findings.tell(&notes);
    builder.finish(notes, has_faces, || {
        format!("it has {vertices} vertices, of which none has a place; export it again")
    })
}

/// Replaces `line` by the next line with those that continue it; false where none is left.
fn next_line(stream: &mut Stream, line: &mut Vec<u8>) -> Result<bool, LoadError> {
    let is_there = stream.line(line)?;
    let mut more = Vec::new();
    // Comments end with the folders of other machines.
    while continues(line) && !line.trim_ascii_start().starts_with(b"#") {
        line.pop();
        line.push(b' ');
        stream.line(&mut more)?;
        line.extend_from_slice(&more);
    }
    Ok(is_there)
}

/// Does the next line continue it? A backslash may be the second byte of a character that is not
/// UTF-8.
fn continues(line: &[u8]) -> bool {
    let Some((b'\\', before)) = line.split_last() else {
        return false;
    };
    let tail = &before[before.len().saturating_sub(64)..];
    let run = tail.iter().rev().take_while(|&&byte| byte > 0x80).count();
    let is_second = run % 2 == 1 && std::str::from_utf8(&tail[tail.len() - run..]).is_err();
    !is_second
}

/// What faces refer to.
#[derive(Default)]
struct Lists {
    /// Not finite where the file has no three numbers.
    positions: Vec<[f64; 3]>,
    /// As many as positions, or none.
    colors: Vec<[u16; 4]>,
    texcoords: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    /// What the lines say that name material files.
    libraries: Vec<String>,
    /// Names of the materials that are used.
    used: HashSet<String>,
}

impl Lists {
    fn read(
        model: &dyn Source,
        room: &mut Room,
        findings: &mut Findings,
    ) -> Result<Self, LoadError> {
        let (mut stream, mut line) = (Stream::new(model), Vec::new());
        let mut lists = Self::default();
        while next_line(&mut stream, &mut line)? {
            let text = text_of(&line);
            let (keyword, rest) = split(&text);
            let tokens = rest.split_ascii_whitespace();
            let mut wrong = |remedy: &'static str| {
                findings.fault(remedy, || {
                    let (line, rest) = (stream.line, quoted(rest));
                    format!("line {line}: {rest} are not the numbers of a {keyword}")
                });
            };
            match keyword {
                "v" => {
                    room.take(size_of::<[f64; 3]>())?;
                    lists.position(tokens, room, || wrong("faces with it are left out"))?;
                }
                "vt" => {
                    room.take(size_of::<[f32; 2]>())?;
                    let given = numbers(tokens.clone()).or(numbers(tokens).map(|[u]| [u, 0.0]));
                    let [u, v] = given.unwrap_or_else(|| {
                        wrong("it is read as 0");
                        [0.0; 2]
                    });
                    lists.texcoords.push([u, 1.0 - v]);
                }
                "vn" => {
                    room.take(size_of::<[f32; 3]>())?;
                    lists.normals.push(numbers(tokens).unwrap_or_else(|| {
                        wrong("it is read as 0");
                        [0.0; 3]
                    }));
                }
                "mtllib" if lists.libraries.len() < MOST_LIBRARIES => {
                    room.take(rest.len())?;
                    let rest = rest.trim_matches('"').to_owned();
                    if !rest.is_empty() && !lists.libraries.contains(&rest) {
                        lists.libraries.push(rest);
                    }
                }
                "usemtl" if !lists.used.contains(rest) => {
                    room.take(rest.len() + 2 * size_of::<String>())?;
                    lists.used.insert(rest.to_owned());
                }
                _ => {}
            }
        }
        Ok(lists)
    }

    /// Adds a position, and its color where it has one: behind a weight, if any.
    fn position<'a>(
        &mut self,
        mut tokens: impl Iterator<Item = &'a str>,
        room: &mut Room,
        wrong: impl FnOnce(),
    ) -> Result<(), LoadError> {
        let position = numbers(tokens.by_ref());
        if position.is_none() {
            wrong();
        }
        let color = numbers(tokens);
        if color.is_some() && self.colors.is_empty() {
            room.take(self.positions.len() * size_of::<[u16; 4]>())?;
            self.colors.resize(self.positions.len(), [u16::MAX; 4]);
        }
        self.positions.push(position.unwrap_or([f64::NAN; 3]));
        if color.is_some() || !self.colors.is_empty() {
            room.take(size_of::<[u16; 4]>())?;
            self.colors
                .push(color.map_or([u16::MAX; 4], colors::of_vertex));
        }
        Ok(())
    }
}

/// A corner of a face: indices of its position, texture coordinates and normal.
type Corner = [u32; 3];

/// Reads the faces.
struct Faces<'a> {
    lists: &'a Lists,
    library: Library,
    builder: Builder,
    findings: Findings,
    /// How many positions, texture coordinates and normals came before.
    passed: [usize; 3],
    /// The file has a face, a point or a line, even if it is faulty.
    has_faces: bool,
    /// Of the object and of the group.
    names: [Option<String>; 2],
    /// The node of those names, once a face needs it.
    node: Option<Option<usize>>,
    /// Nodes by their parent and name.
    nodes: HashMap<(Option<usize>, String), usize>,
    /// Of `Scene::materials`.
    material: Option<usize>,
    /// The smoothing group; 0 for none.
    smoothing: u32,
    /// Where the normal of a position in a smoothing group is added up.
    smooth: HashMap<[u32; 2], u32>,
    sums: Vec<DVec3>,
}

impl Faces<'_> {
    fn read(&mut self, model: &dyn Source) -> Result<(), LoadError> {
        checkpoint().expect(model.size());
        let (mut stream, mut line) = (Stream::new(model), Vec::new());
        let (mut corners, mut face) = (Vec::new(), Vec::new());
        while next_line(&mut stream, &mut line)? {
            let text = text_of(&line);
            let (keyword, rest) = split(&text);
            let at = stream.line;
            let named = || (!rest.is_empty()).then(|| rest.to_owned());
            match keyword {
                "v" => self.passed[0] += 1,
                "vt" => self.passed[1] += 1,
                "vn" => self.passed[2] += 1,
                "f" | "fo" => {
                    self.has_faces = true;
                    if self.corners(rest, at, ("face", 3), &mut corners)? {
                        self.face(&corners, at, &mut face)?;
                    }
                }
                "p" | "l" => {
                    self.has_faces = true;
                    let (what, least) = if keyword == "p" {
                        ("point", 1)
                    } else {
                        ("line", 2)
                    };
                    if self.corners(rest, at, (what, least), &mut corners)? {
                        self.spread(&corners, keyword == "p")?;
                    }
                }
                "o" => (self.names, self.node) = ([named(), None], None),
                "g" => (self.names[1], self.node) = (named(), None),
                "s" => {
                    self.smoothing = match rest {
                        "off" => 0,
                        other => other.parse().unwrap_or(1),
                    }
                }
                "usemtl" => self.material = Some(self.named_material(rest, at)?),
                "" | "mtllib" => {}
                other if other.starts_with('#') || IGNORED.contains(&other) => {}
                other if NOT_DRAWN.contains(&other) => {
                    self.findings.note("it is not drawn", || {
                        format!("line {at}: {} is no face", quoted(other))
                    });
                }
                other => self.findings.fault("it is ignored", || {
                    format!("line {at}: {} is no keyword of OBJ", quoted(other))
                }),
            }
        }
        Ok(())
    }

    /// The index of a material, which is white where no file has it.
    fn named_material(&mut self, name: &str, line: u64) -> Result<usize, LoadError> {
        if let Some(&known) = self.library.by_name.get(name) {
            return Ok(known);
        }
        if !self.library.is_incomplete {
            self.findings.fault("it is white", || {
                format!("line {line}: no material file has {}", quoted(name))
            });
        }
        self.builder.room.take(size_of::<Material>())?;
        let materials = &mut self.builder.scene.materials;
        materials.push(Material {
            name: part_name("material", materials.len(), Some(name)),
            ..plain_material()
        });
        self.library
            .by_name
            .insert(name.to_owned(), materials.len() - 1);
        Ok(materials.len() - 1)
    }

    /// Reads the corners of a face; false where it is left out.
    fn corners(
        &mut self,
        rest: &str,
        line: u64,
        (what, least): (&str, usize),
        corners: &mut Vec<Corner>,
    ) -> Result<bool, LoadError> {
        let lists = self.lists;
        let counts = [
            lists.positions.len(),
            lists.texcoords.len(),
            lists.normals.len(),
        ];
        corners.clear();
        let mut wrong: Option<(&str, usize)> = None;
        let tokens = rest.split_ascii_whitespace();
        for token in tokens.take_while(|token| !token.starts_with('#')) {
            let mut corner = [NONE; 3];
            for (i, part) in token.split('/').take(3).enumerate() {
                corner[i] = index(part, self.passed[i], counts[i]).unwrap_or(NONE);
                let is_worst = wrong.is_none_or(|(_, first)| first > 0 && i == 0);
                if corner[i] == NONE && (i == 0 || !part.is_empty()) && is_worst {
                    wrong = Some((part, i));
                }
            }
            self.builder.widen(corners.len() + 1)?;
            corners.push(corner);
        }
        if let Some((part, i)) = wrong {
            let is_lost = i == 0;
            let of = ["vertex", "texture coordinates", "normal"][i];
            let (part, count) = (quoted(part), counts[i]);
            let remedy = match is_lost {
                true => "it is left out",
                false => "it is drawn without",
            };
            self.findings.fault(remedy, || {
                format!("line {line}: the {what} has the {of} {part}, but there are {count}")
            });
            if is_lost {
                return Ok(false);
            }
        }
        if corners.len() < least {
            self.findings.fault("it is left out", || {
                let count = corners.len();
                format!("line {line}: the {what} has {count} corners; it takes at least {least}")
            });
        }
        Ok(corners.len() >= least)
    }

    /// Adds points, or the segments of a line.
    fn spread(&mut self, corners: &[Corner], is_points: bool) -> Result<(), LoadError> {
        let material = self.material.map_or_else(|| self.named_plain(), Ok)?;
        let kind = Kind {
            node: self.node()?,
            material,
            has_normals: false,
            has_colors: !self.lists.colors.is_empty(),
            has_texcoords: false,
            shape: if is_points {
                Shape::Points
            } else {
                Shape::Lines
            },
        };
        let lists = self.lists;
        let vertex = |[v, ..]: &Corner| {
            let position = lists.positions[*v as usize];
            let is_placed = position.iter().all(|value| value.is_finite());
            let mut vertex = Vertex::at([*v, NONE, NONE, 0], position);
            if kind.has_colors {
                vertex.color = lists.colors[*v as usize];
            }
            is_placed.then_some(vertex)
        };
        for pair in corners.windows(if is_points { 1 } else { 2 }) {
            let (Some(from), Some(to)) = (vertex(&pair[0]), vertex(&pair[pair.len() - 1])) else {
                continue;
            };
            let part = self.builder.part(kind)?;
            match is_points {
                true => self.builder.point(part, from)?,
                false => self.builder.segment(part, [from, to])?,
            }
        }
        Ok(())
    }

    /// Of a file without faces, points and lines, every vertex is a point.
    fn loose_points(&mut self) -> Result<(), LoadError> {
        for at in 0..self.lists.positions.len() as u32 {
            self.spread(&[[at, NONE, NONE]], true)?;
        }
        Ok(())
    }

    fn face(
        &mut self,
        corners: &[Corner],
        line: u64,
        face: &mut Vec<Vertex>,
    ) -> Result<(), LoadError> {
        let lists = self.lists;
        let position = |corner: &Corner| lists.positions[corner[0] as usize];
        // What is wrong with a position was told already.
        if corners
            .iter()
            .any(|corner| !position(corner).iter().all(|value| value.is_finite()))
        {
            return Ok(());
        }
        let material = self.material.map_or_else(|| self.named_plain(), Ok)?;
        let node = self.node()?;
        let [has_texcoords, has_normals] =
            [1, 2].map(|list| corners.iter().all(|corner| corner[list] != NONE));
        let is_textured = self.builder.scene.materials[material].has_color_texture();
        if is_textured && !has_texcoords {
            self.findings.fault("it is drawn without its texture", || {
                format!("line {line}: the face has no texture coordinates")
            });
        }
        let is_smooth = !has_normals && self.smoothing > 0;
        let kind = Kind {
            node,
            material,
            has_normals: has_normals || is_smooth,
            has_colors: !lists.colors.is_empty(),
            has_texcoords: is_textured && has_texcoords,
            shape: Shape::Faces,
        };
        let first = DVec3::from(position(&corners[0]));
        let edge = |corner: &Corner| DVec3::from(position(corner)) - first;
        let area: DVec3 = corners
            .windows(2)
            .map(|pair| edge(&pair[0]).cross(edge(&pair[1])))
            .sum();
        face.clear();
        for corner in corners {
            let [v, t, n] = *corner;
            let mut vertex = Vertex::at([v, NONE, NONE, 0], position(corner));
            if kind.has_texcoords {
                vertex.key[1] = t;
                vertex.texcoord = lists.texcoords[t as usize];
            }
            if has_normals {
                vertex.key[2] = n;
                vertex.normal = lists.normals[n as usize];
            } else if is_smooth {
                vertex.key[2] = self.add_to_normal(v, area)?;
                vertex.key[3] = 1;
            }
            if kind.has_colors {
                vertex.color = lists.colors[v as usize];
            }
            face.push(vertex);
        }
        let part = self.builder.part(kind)?;
        self.builder
            .face(part, face, &mut self.findings, || format!("line {line}"))
    }

    /// The material of faces that name none.
    fn named_plain(&mut self) -> Result<usize, LoadError> {
        self.builder.scene.materials.push(plain_material());
        let plain = self.builder.scene.materials.len() - 1;
        self.material = Some(plain);
        Ok(plain)
    }

    /// The node of the group, or else of the object.
    fn node(&mut self) -> Result<Option<usize>, LoadError> {
        if let Some(known) = self.node {
            return Ok(known);
        }
        let mut node = None;
        for name in self.names.iter().flatten() {
            let key = (node, name.clone());
            node = Some(match self.nodes.get(&key) {
                Some(&known) => known,
                None => {
                    let bytes = size_of::<(Option<usize>, String)>() + 3 * name.len();
                    self.builder.room.take(bytes)?;
                    let new = self.builder.node(name, node);
                    self.nodes.insert(key, new);
                    new
                }
            });
        }
        self.node = Some(node);
        Ok(node)
    }

    /// Adds the normal of a face to that of a position in the smoothing group; returns its place.
    fn add_to_normal(&mut self, position: u32, area: DVec3) -> Result<u32, LoadError> {
        let key = [position, self.smoothing];
        let at = match self.smooth.get(&key) {
            Some(&at) => at,
            None => {
                self.builder.room.take(2 * size_of::<DVec3>())?;
                self.sums.push(DVec3::ZERO);
                let at = self.sums.len() as u32 - 1;
                self.smooth.insert(key, at);
                at
            }
        };
        self.sums[at as usize] += area;
        Ok(at)
    }
}

/// The place in a list of `count` that the text of an index stands for: from 1 up, or from -1 down,
/// back from the last of those that `passed`.
fn index(text: &str, passed: usize, count: usize) -> Option<u32> {
    let place = match text.parse::<i64>().ok()? {
        0 => return None,
        index @ 1.. => index - 1,
        index => passed as i64 + index,
    };
    u32::try_from(place)
        .ok()
        .filter(|&place| (place as usize) < count)
}
