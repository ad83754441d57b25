//! STL: text, or binary with the colors of VisCAM and Magics. Its normals are those of the faces,
//! so that they are computed.

use std::collections::HashMap;

use super::{
    builder::{Builder, Kind, Room, Shape, Vertex},
    colors,
    findings::Findings,
    stream::{Stream, numbers, split},
};
use crate::legible::text_of;
use crate::scene::{
    bounds::is_near,
    gltf::{LoadError, ReadFile, Source, error::quoted, notes::Notes},
    memory::MemoryBudget,
    model::Scene,
};

/// Bytes before the triangles of a binary file, and of each triangle.
const HEAD: u64 = 84;
const TRIANGLE: u64 = 50;

/// Loads an STL model within a memory budget.
///
/// # Errors
/// There is nothing to draw, a limit is exceeded, or loading was canceled.
pub fn load(
    model: &dyn Source,
    budget: MemoryBudget,
    _read: &mut ReadFile,
) -> Result<Scene, LoadError> {
    let head = super::head(model, budget, "an STL file", |head| {
        head.starts_with(b"solid ")
    })?;
    let mut reader = Reader {
        builder: Builder::new(Scene::default(), Room::of(budget, model.size())),
        findings: Findings::default(),
        node: None,
        face: Vec::new(),
        known: HashMap::new(),
    };
    // Binary files may begin with the word of those of text, but their size is their own.
    match (stated(&head), is_text(&head)) {
        (Some(count), _) if HEAD + TRIANGLE * count == model.size() => {
            reader.binary(model, &head, count)?;
        }
        (_, true) => reader.text(model)?,
        (Some(count), false) => reader.binary(model, &head, count)?,
        (None, false) => {
            return Err(LoadError::new(
                "it is no STL file: it has neither text nor 84 bytes; fetch or export it again",
            ));
        }
    }
    let notes = Notes::default();
    reader.findings.tell(&notes);
    reader.builder.finish(notes, true, || {
        "it has no triangles; export it again".into()
    })
}

/// The number of triangles that a binary file states.
fn stated(head: &[u8]) -> Option<u64> {
    let count = head.get(80..84)?.as_array()?;
    Some(u32::from_le_bytes(*count).into())
}

fn is_text(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head).to_ascii_lowercase();
    !head.contains(&0)
        && ["solid", "facet", "vertex"]
            .iter()
            .any(|word| text.contains(word))
}

/// A number that tells colors apart, and the color.
type Paint = (u32, [u16; 4]);

const UNPAINTED: Paint = (0, [u16::MAX; 4]);

struct Reader {
    builder: Builder,
    findings: Findings,
    /// The solid.
    node: Option<usize>,
    /// The corners of the facet.
    face: Vec<Vertex>,
    /// The places of text by their bits: an f32 would take some for one, far from the origin.
    known: HashMap<[u64; 3], u32>,
}

impl Reader {
    fn kind(&self, has_colors: bool) -> Kind {
        Kind {
            node: self.node,
            material: 0,
            has_normals: false,
            has_colors,
            has_texcoords: false,
            shape: Shape::Faces,
        }
    }

    fn text(&mut self, model: &dyn Source) -> Result<(), LoadError> {
        let (mut stream, mut line) = (Stream::new(model), Vec::new());
        let mut is_broken = false;
        while stream.line(&mut line)? {
            let text = text_of(&line);
            let (mut keyword, mut rest) = split(&text);
            let at = stream.line;
            if keyword.eq_ignore_ascii_case("solid") {
                self.builder.room.take(rest.len() + size_of::<String>())?;
                self.node = (!rest.is_empty()).then(|| self.builder.node(rest, None));
                continue;
            }
            // A line may have several words that matter.
            while !keyword.is_empty() {
                match keyword.to_ascii_lowercase().as_str() {
                    "facet" => {
                        if !self.face.is_empty() && !is_broken {
                            self.facet(at)?;
                        }
                        self.face.clear();
                        is_broken = false;
                    }
                    "vertex" => match numbers(rest.split_ascii_whitespace()) {
                        Some(position) => {
                            self.builder.widen(self.face.len() + 1)?;
                            let key = self.key(position)?;
                            self.face.push(Vertex::at(key, position));
                        }
                        None => {
                            is_broken = true;
                            self.findings.fault("its triangle is left out", || {
                                format!(
                                    "line {at}: {} are not three numbers below 6.9e10",
                                    quoted(rest)
                                )
                            });
                        }
                    },
                    "endfacet" if !is_broken => self.facet(at)?,
                    // The name of the solid follows, which may contain keywords.
                    "endsolid" => break,
                    _ => {}
                }
                (keyword, rest) = split(rest);
            }
        }
        if !self.face.is_empty() && !is_broken {
            self.facet(stream.line)?;
        }
        Ok(())
    }

    /// What the vertices at a place have in common.
    fn key(&mut self, position: [f64; 3]) -> Result<[u32; 4], LoadError> {
        let (bits, new) = (position.map(|v| (v + 0.0).to_bits()), self.known.len());
        if let Some(&known) = self.known.get(&bits) {
            return Ok([known, 0, 0, 0]);
        }
        self.builder.room.take(size_of::<([u64; 3], u32)>())?;
        self.known.insert(bits, new as u32);
        Ok([new as u32, 0, 0, 0])
    }

    fn facet(&mut self, line: u64) -> Result<(), LoadError> {
        if self.face.len() < 3 {
            self.findings.fault("it is left out", || {
                let count = self.face.len();
                format!("line {line}: the facet has {count} corners; it takes at least 3")
            });
        } else {
            let part = self.builder.part(self.kind(false))?;
            self.builder
                .face(part, &mut self.face, &mut self.findings, || {
                    format!("line {line}")
                })?;
        }
        self.face.clear();
        Ok(())
    }

    /// Reads a binary file that states so many triangles.
    fn binary(&mut self, model: &dyn Source, head: &[u8], count: u64) -> Result<(), LoadError> {
        let mut stream = Stream::new(model);
        stream.skip(HEAD)?;
        let there = stream.left() / TRIANGLE;
        if stream.left() != count * TRIANGLE {
            self.findings.fault("those that are whole are drawn", || {
                format!("the file states {count} triangles and has {there}")
            });
        }
        // Magics states a color for the whole, and its order of channels.
        let mut pairs = head[..80].windows(6);
        let whole = pairs
            .position(|start| start == b"COLOR=")
            .and_then(|at| head[..80].get(at + 6..at + 9))
            .map(|color| colors::of_vertex([0, 1, 2].map(|c| f32::from(color[c]) / 255.0)));
        for triangle in 0..there {
            let Some(bytes) = stream.bytes(TRIANGLE as usize)? else {
                break;
            };
            let word = |i: usize| bytes[4 * i..].first_chunk().copied().unwrap_or_default();
            let corners = [3, 6, 9].map(|i| [0, 1, 2].map(|c| f32::from_le_bytes(word(i + c))));
            let attribute = u16::from_le_bytes([bytes[48], bytes[49]]);
            let channel = |shift: u32| f32::from(attribute >> shift & 31) / 31.0;
            let paint = |channels: [u32; 3]| {
                let color = channels.map(channel);
                (1 + u32::from(attribute), colors::of_vertex(color))
            };
            let color = match (whole, attribute >> 15) {
                (Some(_), 0) => Some(paint([0, 5, 10])),
                (None, 1) => Some(paint([10, 5, 0])),
                (whole, _) => whole.map(|color| (1 << 16 | 1, color)),
            };
            if corners.iter().all(|corner| is_near(corner.map(f64::from))) {
                let part = self.builder.part(self.kind(color.is_some()))?;
                let corners = corners.map(|corner| vertex(corner, color.unwrap_or(UNPAINTED)));
                self.builder.triangle(part, corners)?;
            } else {
                self.findings.fault("it is left out", || {
                    format!("triangle {triangle}: the numbers of a corner are not below 6.9e10")
                });
            }
        }
        Ok(())
    }
}

/// A corner: those at the same place with the same `paint` are one vertex.
fn vertex(position: [f32; 3], (paint, color): Paint) -> Vertex {
    // -0 is 0.
    let [x, y, z] = position.map(|value| (value + 0.0).to_bits());
    Vertex {
        color,
        ..Vertex::at([x, y, z, paint], position.map(f64::from))
    }
}
