//! LAS, and LAZ, which is the same compressed: points of surveys, with colors or intensities, each of a
//! class. Height is its z.

use super::{
    builder::{Builder, Kind, Room, Shape, Vertex},
    colors::{self, Shown},
    findings::Findings,
    laz::Packing,
    stream::Stream,
};
use crate::scene::{
    bounds::is_near,
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

/// Loads a LAS or LAZ file within a memory budget, in the color that is called `shown`: `color`,
/// `intensity` or `class`; by any other name its own, unless that is black everywhere, or else its
/// intensity or class. Its classes are parts, so that effects can be limited to them.
///
/// # Errors
/// There is nothing to draw, a limit is exceeded, or loading was canceled.
pub fn load_shown(
    model: &dyn Source,
    budget: MemoryBudget,
    name: &str,
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
    let layout = Layout::of(model, &head)?;
    let has_color = layout.color.is_some();
    let shown = Shown::named(name, has_color);
    let mut builder = Builder::new(Scene::default(), Room::of(budget, model.size()));
    let mut findings = Findings::default();
    let mut nodes = [None; 256];
    let (mut brightest, mut strongest, mut is_colored) = (0, 0, false);
    let read = layout.each(model, &mut |record| {
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
            shape: Shape::Points,
        };
        let mut point = Vertex::at([0; 4], layout.place(record));
        let [r, g, b] = match shown {
            Shown::Color => layout.own_color(record),
            Shown::Intensity => [layout.intensity(record); 3],
            Shown::Class => colors::of_class(class).map(|channel| 257 * u16::from(channel)),
        };
        point.color = [r, g, b, u16::MAX];
        brightest = brightest.max(r).max(g).max(b);
        strongest = strongest.max(layout.intensity(record));
        is_colored |= has_color && layout.own_color(record) != [0; 3];
        if is_near(point.position) {
            let part = builder.part(kind)?;
            builder.point(part, point)?;
        } else {
            findings.fault("it is left out", || {
                "the x, y and z of a point are not three numbers below 6.9e10".into()
            });
        }
        Ok(())
    })?;
    if shown == Shown::Color && !is_colored && read > 0 && name != shown.name() {
        let other = if strongest > 0 {
            Shown::Intensity
        } else {
            Shown::Class
        };
        let mut scene = load_shown(model, budget, other.name(), _read)?;
        let note = format!(
            "the colors of its points are black; their {} is shown",
            other.name()
        );
        scene.notes.push(note);
        return Ok(scene);
    }
    if read < layout.count {
        let count = layout.count;
        findings.fault("what is there is drawn", || match layout.packing {
            None => format!("the file ends after {read} of {count} points"),
            Some(_) => {
                format!("the file ends or is damaged after {read} of {count} points")
            }
        });
    }
    // Colors that fit a byte are meant as such, and intensities have no largest value.
    let full = match shown {
        Shown::Color if brightest <= 255 => 255.0,
        Shown::Intensity => f64::from(brightest.max(1)),
        _ => 65_535.0,
    };
    let is_black = brightest == 0 && shown == Shown::Intensity;
    builder.paint(|channels| match is_black {
        true => [u16::MAX; 4],
        false => colors::of_vertex(channels.map(|channel| (f64::from(channel) / full) as f32)),
    });
    let notes = Notes::default();
    findings.tell(&notes);
    let mut scene = builder.finish(notes, true, || "it has no points; export it again".into())?;
    scene.variants = Shown::offered(is_colored, strongest > 0, scene.named_nodes.len() > 1);
    Ok(scene)
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
    /// How points are compressed, if they are.
    packing: Option<Packing>,
}

impl Layout {
    fn of(model: &dyn Source, head: &[u8]) -> Result<Self, LoadError> {
        let u16_at = |at: usize| u16::from_le_bytes([head[at], head[at + 1]]);
        let u32_at = |at: usize| u32::from(u16_at(at)) | u32::from(u16_at(at + 2)) << 16;
        let u64_at = |at: usize| u64::from(u32_at(at)) | u64::from(u32_at(at + 4)) << 32;
        let f64_at = |at: usize| f64::from_bits(u64_at(at));
        // The upper bits tell that points are compressed.
        let (format, is_packed) = (head[104] & 0x3f, head[104] & 0xc0 != 0);
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
        let (first, stride) = (u64::from(u32_at(96)), usize::from(u16_at(105)));
        if stride < least {
            return Err(LoadError::new(format!(
                "its points have {stride} bytes; those of the format {format} have {least} or more"
            )));
        }
        let packing = || {
            let records = [u64::from(u16_at(94)), first];
            Packing::of(model, records, format, [stride, stride - least])
        };
        Ok(Self {
            first,
            stride,
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
            packing: is_packed.then(packing).transpose()?,
        })
    }

    /// Visits the points; returns how many there are.
    fn each(
        &self,
        model: &dyn Source,
        visit: &mut dyn FnMut(&[u8]) -> Result<(), LoadError>,
    ) -> Result<u64, LoadError> {
        let mut stream = Stream::new(model);
        if !stream.skip(self.first)? {
            return Ok(0);
        }
        if let Some(packing) = &self.packing {
            return packing.each(&mut stream, self.count, visit);
        }
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

    fn intensity(&self, record: &[u8]) -> u16 {
        u16::from_le_bytes([record[12], record[13]])
    }

    /// Black where there is none.
    fn own_color(&self, record: &[u8]) -> [u16; 3] {
        let value = |at: usize| u16::from_le_bytes([record[at], record[at + 1]]);
        self.color
            .map_or([0; 3], |at| [0, 2, 4].map(|byte| value(at + byte)))
    }
}
