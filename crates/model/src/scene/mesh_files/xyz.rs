//! XYZ and PTS: text with a point on each line: x, y and z, then a gray, a color, or both, or a color
//! and a normal.

use super::{
    builder::{Builder, Kind, Room, Shape, Vertex},
    colors::{self, Shown},
    findings::Findings,
    stream::{Stream, number},
};
use crate::legible::text_of;
use crate::scene::{
    gltf::{LoadError, ReadFile, Source, notes::Notes},
    memory::MemoryBudget,
    model::Scene,
};

/// Numbers of a line with a gray and a color.
const BOTH: usize = 7;

/// Most numbers of a line that say something.
const MOST: usize = 9;

/// [`load_shown`] in the points' own color.
///
/// # Errors
/// Those of [`load_shown`].
pub fn load(
    model: &dyn Source,
    budget: MemoryBudget,
    read: &mut ReadFile,
) -> Result<Scene, LoadError> {
    load_shown(model, budget, "", read)
}

/// Loads a point cloud of text within a memory budget, in the color that is called `shown`: `color`, or
/// `intensity` where lines have both. Numbers stand between spaces, commas or
/// semicolons; a line that does not begin with three is left out.
///
/// # Errors
/// There is nothing to draw, a limit is exceeded, or loading was canceled.
pub fn load_shown(
    model: &dyn Source,
    budget: MemoryBudget,
    shown: &str,
    _read: &mut ReadFile,
) -> Result<Scene, LoadError> {
    super::head(model, budget, "an XYZ file", |_| false)?;
    let mut builder = Builder::new(Scene::default(), Room::of(budget, model.size()));
    let mut findings = Findings::default();
    let is_gray = Shown::named(shown, true) == Shown::Intensity;
    let mut has_both = false;
    let [darkest, brightest] = range(model, is_gray)?;
    let (mut stream, mut line) = (Stream::new(model), Vec::new());
    while stream.line(&mut line)? {
        let mut values = [0.0; MOST];
        let count = read(&line, &mut values);
        let [x, y, z, ..] = values;
        if count < 3 {
            // The first line may name the columns, or count the points.
            if stream.line > 1 && !is_bare(&line) {
                findings.fault("it is left out", || {
                    format!(
                        "line {}: it does not begin with three numbers below 6.9e10",
                        stream.line
                    )
                });
            }
            continue;
        }
        let kind = Kind {
            node: None,
            material: 0,
            has_normals: count == MOST,
            has_colors: count > 3,
            has_texcoords: false,
            shape: Shape::Points,
        };
        let mut point = Vertex::at([0; 4], [x, y, z]);
        let shown = |at: usize| ((values[at] - darkest) / (brightest - darkest)) as f32;
        has_both |= count == BOTH;
        point.color = colors::of_vertex(match channels(count, is_gray) {
            (first, 1) => [shown(first); 3],
            (first, _) => [0, 1, 2].map(|channel| shown(first + channel)),
        });
        point.normal = [6, 7, 8].map(|at: usize| values[at] as f32);
        let part = builder.part(kind)?;
        builder.point(part, point)?;
    }
    let notes = Notes::default();
    findings.tell(&notes);
    let mut scene = builder.finish(notes, true, || "it has no points; export it again".into())?;
    if has_both {
        scene.variants = Shown::offered(true, true, false);
    }
    Ok(scene)
}

/// The numbers at the beginning of a line.
fn read(line: &[u8], values: &mut [f64; MOST]) -> usize {
    let text = text_of(line);
    let is_between = |c: char| c.is_ascii_whitespace() || matches!(c, ',' | ';');
    let tokens = text.split(is_between).filter(|token| !token.is_empty());
    let numbers = tokens.map_while(number::<f64>);
    values
        .iter_mut()
        .zip(numbers)
        .map(|(value, number)| *value = number)
        .count()
}

/// It has nothing but a remark.
fn is_bare(line: &[u8]) -> bool {
    let text = line.trim_ascii();
    text.is_empty() || text.starts_with(b"#") || text.starts_with(b"//")
}

/// Where the color stands among so many numbers, and how many they are: one is a gray, and of seven
/// one stands before the color.
fn channels(count: usize, is_gray: bool) -> (usize, usize) {
    match count {
        ..=5 => (3, 1),
        BOTH if is_gray => (3, 1),
        BOTH => (4, 3),
        _ => (3, 3),
    }
}

/// The values of a channel that is empty and of one that is full: 0, or the least below, and one, a
/// byte's, that of two bytes, or else the largest.
fn range(model: &dyn Source, is_gray: bool) -> Result<[f64; 2], LoadError> {
    let (mut stream, mut line) = (Stream::new(model), Vec::new());
    let [mut least, mut most] = [0.0f64; 2];
    while stream.line(&mut line)? {
        let mut values = [0.0; MOST];
        let count = read(&line, &mut values);
        if count > 3 {
            let (first, channels) = channels(count, is_gray);
            for value in &values[first..first + channels] {
                (least, most) = (least.min(*value), most.max(*value));
            }
        }
    }
    let full = [1.0, 255.0, 65_535.0]
        .into_iter()
        .find(|full| most <= *full);
    // Grays around 0 have no such values.
    Ok(match least < 0.0 {
        true => [least, most],
        false => [0.0, full.unwrap_or(most)],
    })
}
