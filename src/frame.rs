//! What a renderer produces and a judge compares: integer images, snapped geometry and counters.
//!
//! The oracle and the GPU both fill these plain types and never see each other.

use crate::math::SUBPIXEL_BITS;

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
    /// Position right and down from the top left corner, in units: 1/256 px unless the geometry says otherwise. Meaningless when `flags` is not 0.
    pub x: i32,
    pub y: i32,
    /// Reversed depth z_c / w_c: 1 on the near plane, 0 at infinity.
    pub depth: f32,
    /// 1 / w_c, per metre.
    pub inv_w: f32,
    /// [`vertex_flags`].
    pub flags: u32,
}

/// One triangle left over from clipping `parent`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClippedTriangle {
    pub parent: u32,
    pub corners: [SnappedVertex; 3],
    /// Bit k: the edge opposite corner k lies on an edge of the parent, not on a cut or inside.
    pub outline: u32,
}

/// What of a picture comes from integer arithmetic alone, so that it is the same on every adapter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exactness {
    /// Vertex records and pieces, from the bits of positions and matrices on.
    pub vertices: bool,
    /// Depth keys, given the records.
    pub keys: bool,
}

/// A particle between two steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ParticleState {
    /// In the scene, metres.
    pub place: [f32; 3],
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
    /// Corners with colour and normal, as they lie among the scene's bytes.
    pub words: Vec<u32>,
    /// Flights are kept in 16 bits a number.
    pub has_half_precision: bool,
    /// The flow's curl comes from differences.
    pub has_difference_curl: bool,
}

/// Everything the rasterizer proper sees: what stands between the float vertex stage and integer coverage.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// One per vertex of each draw, in draw order (`Draw::first_vertex` indexes it); or, with `has_unshared_vertices`, three per
    /// triangle in order of their ids.
    pub vertices: Vec<SnappedVertex>,
    /// Effects part the triangles, so that they share no vertices.
    pub has_unshared_vertices: bool,
    /// Position and normal, in object space, of every vertex of the draws that bend, in draw order.
    pub deformed: Vec<[f32; 6]>,
    /// The particles that the picture shows, and how they came there; none without particles.
    pub particle_readback: Option<ParticleReadback>,
    /// Ids of the triangles that are splats.
    pub particle_discs: std::ops::Range<u32>,
    /// Fan pieces of clipped triangles; pieces of one parent stand in fan order.
    pub clipped_triangles: Vec<ClippedTriangle>,
    /// What sample effects settled: for every triangle by id, then for every piece, one entry per effect that decides.
    pub sample_setups: Vec<[u32; 4]>,
    /// One per dot of all lines, always in units of 1/256 px.
    pub dots: Vec<SnappedVertex>,
    /// Positions are in units of 2^-bits px.
    pub subpixel_bits: u32,
    /// Drawn pixels for one that is shown, along a side: the picture and its effects' lengths are this many times as large.
    pub scale: f64,
    /// Places were taken relative to the eye before they met a matrix.
    pub is_relative: bool,
    /// Places were rounded to fewer bits than the scene has, where the preset asks for that: how far off they are is measured,
    /// and no fault.
    pub has_approximate_positions: bool,
    /// What its maker promises about it, and about the keys of a frame drawn through it.
    pub exact: Exactness,
    /// What the light sees, where an effect asks.
    pub shadow_map: Option<Box<ShadowMap>>,
}

/// A shadow map with what it was drawn from.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadowMap {
    /// Depth key of every texel, row-major, top row first: bits of the reversed depth, larger is nearer to the light, 0 is
    /// empty.
    pub depth_keys: Vec<u32>,
    /// The scene as the light sees it.
    pub geometry: Geometry,
}

impl Default for Geometry {
    fn default() -> Self {
        let (vertices, deformed, pieces, sample_setups, dots) = (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (subpixel_bits, exact) = (SUBPIXEL_BITS, Exactness::default());
        Self {
            vertices,
            scale: 1.0,
            has_unshared_vertices: false,
            deformed,
            particle_readback: None,
            particle_discs: 0..0,
            clipped_triangles: pieces,
            sample_setups,
            dots,
            subpixel_bits,
            is_relative: false,
            has_approximate_positions: false,
            exact,
            shadow_map: None,
        }
    }
}

/// Counts of what a frame did not draw, and of what went wrong. All zero in a plain healthy picture.
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
    /// Clipped pieces that turned over or vanished in the snap, and were dropped.
    pub flipped_clips: u32,
    /// Triangles left out because they would have to be clipped, where the preset asks for that.
    #[serde(skip_serializing_if = "is_zero")]
    pub dropped: u32,
    /// Queue entries that did not fit; the frame is incomplete unless 0.
    pub overflow: u32,
    /// Pixels with a depth but no triangle id; must be 0.
    pub depth_without_id: u32,
    /// Pixels with more layers than the x-ray's sums hold; their averages are wrong unless 0.
    #[serde(skip_serializing_if = "is_zero")]
    pub full_pixels: u32,
}

fn is_zero(count: &u32) -> bool {
    *count == 0
}

/// What a draw order let through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct OrderStats {
    /// Samples drawn.
    pub drawn: u64,
    /// Samples that should have been drawn.
    pub limit: u64,
    /// Samples that there are.
    pub covered: u64,
    /// The hardware chose, by tickets that are one word each.
    pub is_chosen: bool,
}

impl OrderStats {
    /// Are there more samples than tickets? Then nobody knows how many were drawn.
    pub const fn exceeds_sample_counter(&self) -> bool {
        self.is_chosen && self.covered > u32::MAX as u64
    }
}

/// Meshlets that culling left, and those that it left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct CullingStats {
    pub drawn: u32,
    /// Outside the picture.
    pub outside: u32,
    /// All their triangles face away.
    pub backfacing: u32,
    /// Behind what was drawn.
    pub hidden: u32,
}

impl CullingStats {
    /// All meshlets there are.
    pub fn all(&self) -> u32 {
        self.drawn + self.outside + self.backfacing + self.hidden
    }

    /// For people: how many were left out, and why.
    pub fn reasons(&self) -> String {
        format!("{} outside, {} turned away, {} hidden", self.outside, self.backfacing, self.hidden)
    }
}

/// One finished picture with the integers that decided it. Images are row-major, top row first, `width * height` long.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    pub width: u32,
    pub height: u32,
    /// Global triangle id per pixel, or [`NO_TRIANGLE`].
    pub triangle_id: Vec<u32>,
    /// Depth key per pixel: bits of the reversed depth, larger is nearer, 0 is empty.
    pub depth_key: Vec<u32>,
    /// Keys are cut short, or another sample's, where the preset asks for that; they promise nothing and are not judged.
    pub depth_keys_are_approximate: bool,
    /// Gamma-encoded sRGB and alpha.
    pub color: Vec<[u8; 4]>,
    /// What an effect in the visibility slot added up per pixel: weights of layers, or their number. Empty without one.
    pub counted: Vec<u32>,
    /// Strength of the strongest dot per pixel, 0 to 256. Empty without dots.
    pub dots: Vec<u32>,
    pub counters: Counters,
}

impl Frame {
    /// The same picture at another size in these colours; a pixel has the integers of the drawn one under its middle.
    pub fn shown(&self, [width, height]: [u32; 2], color: Vec<[u8; 4]>) -> Self {
        let under = |at: u32, shown: u32, drawn: u32| ((2 * u64::from(at) + 1) * u64::from(drawn) / (2 * u64::from(shown))) as usize;
        let places: Vec<usize> = (0..height)
            .flat_map(|y| (0..width).map(move |x| under(y, height, self.height) * self.width as usize + under(x, width, self.width)))
            .collect();
        let of = |words: &[u32]| if words.is_empty() { Vec::new() } else { places.iter().map(|&at| words[at]).collect() };
        let (triangle_id, key, counted, dots) = (of(&self.triangle_id), of(&self.depth_key), of(&self.counted), of(&self.dots));
        Self { width, height, triangle_id, depth_key: key, color, counted, dots, ..*self }
    }

    /// Number of pixels that have an triangle id.
    pub fn covered(&self) -> usize {
        self.triangle_id.iter().filter(|&&triangle_id| triangle_id != NO_TRIANGLE).count()
    }
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
        Self { frame, geometry, layers: None, previous: None }
    }
}
