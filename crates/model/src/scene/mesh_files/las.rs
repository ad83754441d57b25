//! LAS: points of surveys, with colors or intensities, each of a class. Height is its z.

use super::{
    builder::{Builder, Kind, Room, Vertex},
    colors,
    findings::Findings,
    stream::Stream,
};
use crate::scene::{
    gltf::{LoadError, ReadFile, Source, notes::Notes},
    memory::MemoryBudget,
    model::Scene,
};

/// Bytes of the first header, and of that of version 1.4.
const HEADER: usize = 227;
const HEADER_1_4: usize = 255;

/// The names of classes by the standard.
const CLASSES: &[&str] = &[
    "unclassified",
    "unclassified",
    "ground",
    "low vegetation",
    "medium vegetation",
    "high vegetation",
    "building",
    "low point",
    "model key",
    "water",
    "rail",
    "road",
];

/// Loads a LAS file within a memory budget. Its classes are parts, so that effects can be limited to
/// them.
///
/// # Errors
/// It is compressed, there is nothing to draw, a limit is exceeded, or loading was canceled.
pub fn load(
    model: &dyn Source,
    budget: MemoryBudget,
    _read: &mut ReadFile,
) -> Result<Scene, LoadError> {
    let head = super::head(model, budget, "a LAS file", |head| {
        head.starts_with(b"LASF")
    })?;
    if !head.starts_with(b"LASF") || head.len() < HEADER {
        return Err(LoadError::new(
            "it is no LAS file: it does not begin with \"LASF\" and a header; fetch or export it again",
        ));
    }
    let layout = Layout::of(&head)?;
    let brightest = layout.brightest(model)?;
    let mut builder = Builder::new(Scene::default(), Room::of(budget, model.size()));
    let mut findings = Findings::default();
    let mut nodes = [None; 256];
    let read = layout.each(model, |record| {
        let class = layout.class(record);
        let node = *nodes[class].get_or_insert_with(|| {
            let name = CLASSES
                .get(class)
                .map_or_else(|| format!("class {class}"), |name| (*name).to_owned());
            builder.node(&name, None)
        });
        let kind = Kind {
            node: Some(node),
            material: 0,
            has_normals: false,
            has_colors: true,
            has_texcoords: false,
            is_points: true,
        };
        let mut point = Vertex::at([0; 4], layout.place(record));
        let shown = layout
            .channels(record)
            .map(|channel| (f64::from(channel) / brightest) as f32);
        point.color = colors::of_vertex(shown);
        if point
            .position
            .iter()
            .all(|value| (*value as f32).is_finite())
        {
            let part = builder.part(kind)?;
            builder.point(part, point)?;
        }
        Ok(())
    })?;
    if read < layout.count {
        findings.fault("what is there is drawn", || {
            format!("the file ends after {read} of {} points", layout.count)
        });
    }
    let notes = Notes::default();
    findings.tell(&notes);
    builder.finish(notes, true, || "it has no points; export it again".into())
}

/// Where the header says that the values of points lie.
struct Layout {
    /// Bytes before the first point, and of each.
    first: u64,
    stride: usize,
    count: u64,
    /// Of the classification.
    class: usize,
    /// Later formats have a byte for it, earlier ones five bits.
    class_mask: u8,
    /// Of red, if points have colors.
    color: Option<usize>,
    scale: [f64; 3],
    offset: [f64; 3],
}

impl Layout {
    fn of(head: &[u8]) -> Result<Self, LoadError> {
        let u16_at = |at: usize| u16::from_le_bytes([head[at], head[at + 1]]);
        let u32_at = |at: usize| u32::from(u16_at(at)) | u32::from(u16_at(at + 2)) << 16;
        let u64_at = |at: usize| u64::from(u32_at(at)) | u64::from(u32_at(at + 4)) << 32;
        let f64_at = |at: usize| f64::from_bits(u64_at(at));
        let format = head[104];
        if format & 0xc0 != 0 {
            return Err(LoadError::new(
                "it is compressed (LAZ), which is not read; unpack it to LAS",
            ));
        }
        let is_late = (head[24], head[25]) >= (1, 4) && head.len() >= HEADER_1_4;
        let (class, class_mask, least) = match format {
            0..=5 => (15, 0x1f, [20, 28, 26, 34, 57, 63][usize::from(format)]),
            6..=10 => (16, 0xff, [30, 36, 38, 59, 67][usize::from(format) - 6]),
            _ => {
                return Err(LoadError::new(format!(
                    "its points are of the format {format}; allowed: 0 to 10"
                )));
            }
        };
        let layout = Self {
            first: u32_at(96).into(),
            stride: u16_at(105).into(),
            count: match (u32_at(107), is_late) {
                (0, true) => u64_at(247),
                (count, _) => count.into(),
            },
            class,
            class_mask,
            color: match format {
                2 => Some(20),
                3 | 5 => Some(28),
                7 | 8 | 10 => Some(30),
                _ => None,
            },
            scale: [131, 139, 147].map(f64_at),
            offset: [155, 163, 171].map(f64_at),
        };
        match layout.stride < least {
            true => Err(LoadError::new(format!(
                "its points have {} bytes; those of the format {format} have {least} or more",
                layout.stride
            ))),
            false => Ok(layout),
        }
    }

    /// Visits the points; returns how many there are.
    fn each(
        &self,
        model: &dyn Source,
        mut visit: impl FnMut(&[u8]) -> Result<(), LoadError>,
    ) -> Result<u64, LoadError> {
        let mut stream = Stream::new(model);
        stream.skip(self.first)?;
        for read in 0..self.count {
            let Some(record) = stream.bytes(self.stride)? else {
                return Ok(read);
            };
            visit(record)?;
        }
        Ok(self.count)
    }

    fn class(&self, record: &[u8]) -> usize {
        usize::from(record[self.class] & self.class_mask)
    }

    fn place(&self, record: &[u8]) -> [f64; 3] {
        [0, 1, 2].map(|axis: usize| {
            let at = 4 * axis;
            let steps = [0, 1, 2, 3].map(|byte: usize| record[at + byte]);
            f64::from(i32::from_le_bytes(steps)) * self.scale[axis] + self.offset[axis]
        })
    }

    /// Its color, or its intensity.
    fn channels(&self, record: &[u8]) -> [u16; 3] {
        let value = |at: usize| u16::from_le_bytes([record[at], record[at + 1]]);
        match self.color {
            Some(at) => [0, 2, 4].map(|byte| value(at + byte)),
            None => [value(12); 3],
        }
    }

    /// The value of a channel that is full: colors that fit a byte are meant as such, and intensities
    /// have none.
    fn brightest(&self, model: &dyn Source) -> Result<f64, LoadError> {
        let mut most = 1;
        self.each(model, |record| {
            most = self.channels(record).into_iter().fold(most, u16::max);
            Ok(())
        })?;
        Ok(match (self.color, most) {
            (None, most) => most.into(),
            (Some(_), 0..=255) => 255.0,
            (Some(_), _) => 65_535.0,
        })
    }
}
