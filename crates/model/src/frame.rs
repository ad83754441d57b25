//! What a renderer produces and the oracle judges: integer images, snapped geometry and counters.
//! The oracle and the GPU renderer both fill these plain types and never import each other.

use crate::math::{SUBPIXEL_BITS, linear_light, srgb_byte};

/// Triangle id of a pixel that no triangle covers.
pub const NO_TRIANGLE: u32 = u32::MAX;

/// Why a projected vertex cannot be rasterized as it is; zero means ready.
pub mod vertex_flags {
    /// A coordinate is NaN or infinite: its triangles are dropped and counted.
    pub const NONFINITE: u32 = 1;
    /// A coordinate is 2^40 or more: its triangles are dropped and counted.
    pub const OUT_OF_RANGE: u32 = 2;
    /// In front of the near plane or behind the eye: its triangles are clipped.
    pub const NEAR: u32 = 4;
    /// Beyond the guard band on the left, right, top, bottom: its triangles are clipped.
    pub const GUARD: [u32; 4] = [8, 16, 32, 64];
    /// Any reason to drop the triangle.
    pub const REJECTED: u32 = NONFINITE | OUT_OF_RANGE;
    /// Any reason to clip the triangle.
    pub const CLIPPED: u32 = 4 | 8 | 16 | 32 | 64;
}

/// A vertex after projection and the one snap, as every later stage reads it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SnappedVertex {
    /// Right from the top left corner of the picture, in units of 2^-[`Geometry::subpixel_bits`]
    /// px. Without meaning unless `flags` is 0; so are the next three.
    pub x: i32,
    /// Down, in the same units.
    pub y: i32,
    /// Reversed depth z_c / w_c: 1 on the near plane, 0 at infinity.
    pub depth: f32,
    /// 1 / w_c, per meter.
    pub inv_w: f32,
    /// [`vertex_flags`].
    pub flags: u32,
}

/// One of the triangles into which clipping cuts a triangle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClippedTriangle {
    /// Global id of the triangle that was clipped.
    pub parent: u32,
    pub corners: [SnappedVertex; 3],
    /// Bit k is set if the edge opposite corner k lies on an edge of the parent, not on a clipping
    /// plane or inside.
    pub outline: u32,
}

/// Which buffers come from integer arithmetic alone and so are equal, bit by bit, on every adapter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BitExact {
    /// Vertex records and clipped triangles, given the bits of positions and matrices.
    pub vertices: bool,
    /// Depth keys, given the records.
    pub depth_keys: bool,
}

/// A particle between two steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParticleState {
    /// In the scene, meters.
    pub position: [f32; 3],
    /// Meters per second.
    pub velocity: [f32; 3],
    /// Steps since it was born.
    pub age: u32,
    /// How often it was born again.
    pub births: u32,
}

/// Particles before and after the last step of a picture, and what was drawn of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleReadback {
    /// Empty in the first frame, which no step leads to.
    pub before: Vec<ParticleState>,
    pub after: Vec<ParticleState>,
    /// The discs that were drawn: corners with color and normal, as they lie in the scene's vertex
    /// bytes.
    pub words: Vec<u32>,
    /// States are stored in 16 bits per number.
    pub has_half_precision: bool,
    /// The curl of the flow comes from finite differences, not from derivatives.
    pub has_difference_curl: bool,
}

/// The input of integer coverage: what the float vertex stage leaves behind.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// One per vertex of each draw, in draw order, beginning at `Draw::first_vertex`; with
    /// `has_unshared_vertices` three per triangle, by rising id.
    pub vertices: Vec<SnappedVertex>,
    /// Effects move triangles apart, so triangles share no vertices.
    pub has_unshared_vertices: bool,
    /// Position and normal, in object space, of every vertex of the draws that deform, in draw
    /// order.
    pub deformed: Vec<[f32; 6]>,
    /// The particles of the picture and their last step; none without particles.
    pub particle_readback: Option<ParticleReadback>,
    /// Ids of the triangles of which only the inscribed disc is drawn: particles.
    pub particle_discs: std::ops::Range<u32>,
    /// What clipping made; those of one parent are in fan order.
    pub clipped_triangles: Vec<ClippedTriangle>,
    /// The integers that sample effects and masks test against: for every triangle by id, then for
    /// every clipped triangle, one entry per effect with a setup, then those of masks.
    pub sample_setups: Vec<[u32; 4]>,
    /// One record per dot of all lines, always in units of 1/256 px.
    pub dots: Vec<SnappedVertex>,
    /// Bits of the fraction of snapped positions.
    pub subpixel_bits: u32,
    /// Render scale: drawn pixels per shown pixel along a side. Lengths of effects in pixels are
    /// scaled alike.
    pub scale: f64,
    /// Positions were taken relative to the eye before they met a matrix.
    pub is_relative: bool,
    /// Bits of each coordinate, where positions were stored as steps in the box of their
    /// primitive; none where they were stored as the scene has them.
    pub packed_bits: Option<u32>,
    /// Which of these buffers, and of the frame drawn from them, are bit-exact.
    pub bit_exact: BitExact,
    /// The shadow map; none if no effect reads it.
    pub shadow_map: Option<Box<ShadowMap>>,
}

/// A shadow map with the geometry that it was drawn from.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadowMap {
    /// Depth key of every texel, row-major, top row first: bits of the reversed depth, larger is
    /// nearer to the light, 0 is empty.
    pub depth_keys: Vec<u32>,
    /// The scene as the light sees it.
    pub geometry: Geometry,
}

impl Default for Geometry {
    fn default() -> Self {
        Self {
            vertices: Vec::new(),
            has_unshared_vertices: false,
            deformed: Vec::new(),
            particle_readback: None,
            particle_discs: 0..0,
            clipped_triangles: Vec::new(),
            sample_setups: Vec::new(),
            dots: Vec::new(),
            subpixel_bits: SUBPIXEL_BITS,
            scale: 1.0,
            is_relative: false,
            packed_bits: None,
            bit_exact: BitExact::default(),
            shadow_map: None,
        }
    }
}

/// Counts of what a frame did not draw and of errors; most pictures have none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Counters {
    /// Triangles with a NaN or infinite vertex.
    pub rejected_nonfinite: u32,
    /// Triangles with a vertex coordinate of 2^40 or more.
    pub rejected_range: u32,
    /// Triangles with no area after the snap.
    pub degenerate: u32,
    /// Triangles that took the clipping path.
    pub clipped: u32,
    /// Clipped triangles that flipped or lost their area in the snap, and were dropped.
    pub flipped_clips: u32,
    /// Triangles dropped because they would have to be clipped, as the preset asks.
    #[serde(skip_serializing_if = "is_zero")]
    pub dropped: u32,
    /// Queue entries that did not fit; the frame is incomplete unless this is 0.
    pub overflow: u32,
    /// Pixels with a depth but no triangle id; must be 0.
    pub depth_without_id: u32,
    /// Pixels with more layers than the sums of the x-ray hold; their averages are wrong.
    #[serde(skip_serializing_if = "is_zero")]
    pub full_pixels: u32,
}

fn is_zero(count: &u32) -> bool {
    *count == 0
}

/// How many samples a draw order drew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct OrderStats {
    /// Samples drawn.
    pub drawn: u64,
    /// Samples that should have been drawn.
    pub limit: u64,
    /// Samples that are covered.
    pub covered: u64,
    /// The scheduler chose the samples, counted with one 32-bit counter.
    pub is_scheduler_order: bool,
}

impl OrderStats {
    /// Returns true if there are more samples than the counter holds, so that the number of drawn
    /// samples is unknown.
    pub const fn exceeds_sample_counter(&self) -> bool {
        self.is_scheduler_order && self.covered > u32::MAX as u64
    }
}

/// How many meshlets culling kept and removed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct CullingStats {
    pub drawn: u32,
    /// Outside the picture.
    pub outside: u32,
    /// All of whose triangles face away.
    pub backfacing: u32,
    /// Behind what was drawn before.
    pub hidden: u32,
}

impl CullingStats {
    /// Number of all meshlets.
    pub fn all(&self) -> u32 {
        self.drawn + self.outside + self.backfacing + self.hidden
    }

    /// How many were removed and why, as text.
    pub fn reasons(&self) -> String {
        format!(
            "{} outside, {} turned away, {} hidden",
            self.outside, self.backfacing, self.hidden
        )
    }
}

/// Which depths a depth key stands for: those from `down` below its own to `up + relative_up *
/// depth` above. The default is the key's own depth alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DepthRounding {
    pub down: f64,
    pub up: f64,
    pub relative_up: f64,
    /// This key and smaller ones stand for everything farther away too.
    pub least_key: u32,
}

impl DepthRounding {
    /// The range of depths that `key` stands for, the farthest first. A depth too small for a
    /// normal f32 has the key 1.
    pub fn depths(&self, key: u32) -> [f64; 2] {
        let depth = f64::from(f32::from_bits(key));
        let low = if key <= self.least_key.max(1) {
            0.0
        } else {
            depth - self.down
        };
        let high = depth * (1.0 + self.relative_up) + self.up;
        [
            low,
            if key == 1 {
                high.max(f64::from(f32::MIN_POSITIVE))
            } else {
                high
            },
        ]
    }
}

/// A layer of glass on a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GlassHit {
    pub triangle_id: u32,
    /// Bits of the reversed depth.
    pub depth_key: u32,
}

/// The layers of glass of every pixel that nothing opaque hides, and the opaque triangle behind
/// them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GlassLayers {
    /// Of one pixel after another, row-major, each with its nearest first.
    pub layers: Vec<GlassHit>,
    /// For every pixel the index in `layers` behind its last.
    ends: Vec<usize>,
    /// Nearest opaque triangle per pixel, or [`NO_TRIANGLE`].
    pub behind: Vec<u32>,
}

impl GlassLayers {
    /// Ends the layers of a pixel, which were pushed.
    pub fn end_pixel(&mut self, behind: u32) {
        self.ends.push(self.layers.len());
        self.behind.push(behind);
    }

    /// Layers of a pixel, nearest first.
    pub fn at(&self, pixel: usize) -> &[GlassHit] {
        let first = pixel.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.layers[first..self.ends[pixel]]
    }

    /// The nearest `most` per pixel.
    pub fn nearest(&self, most: usize) -> Self {
        let mut near = Self::default();
        for (pixel, behind) in self.behind.iter().enumerate() {
            near.layers.extend(self.at(pixel).iter().take(most));
            near.end_pixel(*behind);
        }
        near
    }

    /// Number of layers per pixel.
    pub fn counts(&self) -> Vec<u32> {
        (0..self.ends.len())
            .map(|pixel| self.at(pixel).len() as u32)
            .collect()
    }

    /// Does it hold no pixels?
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }
}

/// A finished picture with its integer images. Images are row-major, top row first, `width *
/// height` long.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    pub width: u32,
    pub height: u32,
    /// Global triangle id per pixel, or [`NO_TRIANGLE`].
    pub triangle_id: Vec<u32>,
    /// Depth key per pixel: bits of the reversed depth, larger is nearer, 0 is empty.
    pub depth_key: Vec<u32>,
    /// Which depths a key stands for.
    pub depth_rounding: DepthRounding,
    /// Depth keys may be those of another triangle, as the preset asks; they are not judged.
    pub depth_keys_are_approximate: bool,
    /// Gamma-encoded sRGB and alpha.
    pub color: Vec<[u8; 4]>,
    /// The picture before the passes of image effects; none where no effect has passes.
    pub resolved: Option<Vec<[u8; 4]>>,
    /// What the kept pass of an effect read and wrote; none where no pass is kept.
    pub kept: Option<KeptPass>,
    /// Sum of the weights of all layers of a pixel, or their number, if an effect fills the
    /// visibility slot; otherwise empty.
    pub layer_sums: Vec<u32>,
    /// Layers of glass, where something is seen through glass and an adapter can tell; else empty.
    pub glass: GlassLayers,
    /// Strength of the strongest dot per pixel, 0 to 256. Empty without dots.
    pub dots: Vec<u32>,
    pub counters: Counters,
}

impl Frame {
    /// The picture at another size with these colors; each pixel has the integers of the drawn
    /// pixel under its center.
    pub fn shown(&self, [width, height]: [u32; 2], color: Vec<[u8; 4]>) -> Self {
        let under = |at: u32, shown: u32, drawn: u32| {
            ((2 * u64::from(at) + 1) * u64::from(drawn) / (2 * u64::from(shown))) as usize
        };
        let drawn: Vec<usize> = (0..height)
            .flat_map(|y| {
                (0..width).map(move |x| {
                    under(y, height, self.height) * self.width as usize
                        + under(x, width, self.width)
                })
            })
            .collect();
        let of = |words: &[u32]| {
            if words.is_empty() {
                Vec::new()
            } else {
                drawn.iter().map(|&at| words[at]).collect()
            }
        };
        let (triangle_id, depth_key) = (of(&self.triangle_id), of(&self.depth_key));
        Self {
            width,
            height,
            triangle_id,
            depth_key,
            color,
            layer_sums: of(&self.layer_sums),
            dots: of(&self.dots),
            resolved: None,
            kept: None,
            glass: GlassLayers::default(),
            ..*self
        }
    }

    /// The picture before the passes of image effects.
    pub fn resolved(&self) -> &[[u8; 4]] {
        self.resolved.as_deref().unwrap_or(&self.color)
    }

    /// What the next picture of a sequence starts from.
    pub fn earlier(&self) -> Earlier<'_> {
        let kept = self.kept.as_ref();
        Earlier {
            resolved: self.resolved(),
            kept: kept.map_or(&[], |kept| &kept.after),
        }
    }

    /// Number of pixels with a triangle.
    pub fn covered(&self) -> usize {
        self.triangle_id
            .iter()
            .filter(|&&id| id != NO_TRIANGLE)
            .count()
    }
}

/// What the kept pass of an effect read and wrote, row-major, by its own pixels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KeptPass {
    /// What it had written in the previous frame; empty, which reads as zeros, before the first.
    pub before: Vec<[f32; 4]>,
    /// What it wrote in this one.
    pub after: Vec<[f32; 4]>,
}

/// What a picture starts from of the one before it.
#[derive(Clone, Copy, Debug)]
pub struct Earlier<'a> {
    /// The picture before passes of image effects, gamma-encoded.
    pub resolved: &'a [[u8; 4]],
    /// What the kept pass wrote; empty without one.
    pub kept: &'a [[f32; 4]],
}

/// A picture that an adapter drew, with everything that a judge compares.
#[derive(Clone, Copy, Debug)]
pub struct AdapterPicture<'a> {
    pub frame: &'a Frame,
    /// What the frame was drawn through.
    pub geometry: &'a Geometry,
    /// Triangles drawn per sample, row-major; none if they were not counted.
    pub layers: Option<&'a [u32]>,
    /// The adapter's own picture before this one; none for the first.
    pub previous: Option<&'a [[u8; 4]]>,
}

impl<'a> AdapterPicture<'a> {
    /// A first picture without counted layers.
    pub const fn new(frame: &'a Frame, geometry: &'a Geometry) -> Self {
        Self {
            frame,
            geometry,
            layers: None,
            previous: None,
        }
    }
}

/// Linear light of every byte.
pub fn linear_bytes() -> Vec<f64> {
    (0..=255u8)
        .map(|byte| linear_light(f64::from(byte) / 255.0))
        .collect()
}

/// A weighted sum of pixels in linear light.
#[derive(Clone, Copy, Default)]
pub struct LightSum {
    /// Weighted by alpha.
    opaque: [f64; 3],
    /// Not weighted by alpha.
    plain: [f64; 3],
    alpha: f64,
}

impl LightSum {
    /// Adds a pixel; `light` is [`linear_bytes`].
    pub fn add(&mut self, bytes: &[u8; 4], weight: f64, light: &[f64]) {
        let alpha = weight * f64::from(bytes[3]) / 255.0;
        self.alpha += alpha;
        for (channel, &byte) in bytes[..3].iter().enumerate() {
            self.opaque[channel] += alpha * light[usize::from(byte)];
            self.plain[channel] += weight * light[usize::from(byte)];
        }
    }

    fn scaled(&self, factor: f64) -> Self {
        Self {
            opaque: self.opaque.map(|v| v * factor),
            plain: self.plain.map(|v| v * factor),
            alpha: self.alpha * factor,
        }
    }

    /// The sum as a gamma-encoded pixel; without alpha it has the colors of its transparent pixels.
    pub fn bytes(&self) -> [u8; 4] {
        let [r, g, b] = if self.alpha > 0.0 {
            self.opaque.map(|v| v / self.alpha)
        } else {
            self.plain
        };
        [
            srgb_byte(r),
            srgb_byte(g),
            srgb_byte(b),
            (self.alpha.min(1.0) * 255.0 + 0.5) as u8,
        ]
    }
}

/// The mean of several pictures of the same size, in linear light.
#[derive(Default)]
pub struct MeanPicture {
    sums: Vec<LightSum>,
    count: u32,
    last: Option<Frame>,
}

impl MeanPicture {
    /// By which parts of a pixel pictures are moved, so that together they have `side` by `side`
    /// samples for each pixel.
    pub fn shifts(side: u32) -> impl Iterator<Item = [f64; 2]> {
        (0..side * side).map(move |sample| {
            [sample % side, sample / side].map(|i| 0.5 - (f64::from(i) + 0.5) / f64::from(side))
        })
    }

    /// Adds a picture.
    pub fn add(&mut self, frame: Frame) {
        let light = linear_bytes();
        self.sums.resize(frame.color.len(), LightSum::default());
        for (sum, pixel) in self.sums.iter_mut().zip(&frame.color) {
            sum.add(pixel, 1.0, &light);
        }
        self.count += 1;
        self.last = Some(frame);
    }

    /// The mean, with the integers of the last picture; none without pictures.
    pub fn frame(self) -> Option<Frame> {
        let weight = 1.0 / f64::from(self.count);
        let color = self.sums.iter().map(|sum| sum.scaled(weight).bytes());
        Some(Frame {
            color: color.collect(),
            ..self.last?
        })
    }
}
