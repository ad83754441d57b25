//! What the passes of a frame have to do, in numbers: those of its layout and queues, and estimates from a sample of its triangles.

use super::{
    frame_layout::{Dispatch, FrameLayout},
    records::CounterRecord,
    view_resources::PreparedFrame,
};
use crate::{
    accuracy::{DotCulling, VertexTransform},
    effects::{
        SetupRows,
        hooks::{Layers, Shape},
    },
    math::SMALL_EXTENT,
    plan::cost_model::Unit,
    scene::{
        raster_work::{PathWork, SizeWork},
        sizes::TriangleSizes,
        triangle_rows::RowWork,
    },
    shader::{
        key::KernelKey,
        pass::{Pass, RasterPhase, TriangleSource},
        weight::Weight,
    },
};

/// How often a loop over few items runs, as a rule: joints of a vertex, corners of a polygon, taps of a filter.
const TURNS: f64 = 4.0;

/// Loops over rows in the text of a sample setup, of which each holds as much as the other.
const ROW_LOOPS: f64 = 2.0;

/// Pixels of a block that a workgroup draws at once, and blocks of a tile.
const BLOCK: f64 = 64.0;
const BLOCKS_OF_TILE: f64 = 64.0;
const BLOCK_SIDE: f64 = 8.0;
/// Workgroups that share a medium triangle or a tile of a large one where there are few.
const QUEUE_PARTS: f64 = 4.0;
/// Samples in the box of a queued triangle whose size is not known.
const USUAL_CANDIDATES: f64 = 100.0;

/// Triangles that a workgroup clips together. Each takes its own way through the kernel, so that more of them take longer: one as long as
/// ten doublings of their number (13 µs on an H100, and 21 for 64 of them).
const CLIPPED_TOGETHER: f64 = 64.0;
const ONE_CLIPPED: f64 = 10.0;

/// Expected samples from which on there is one, as a rule.
const ANY: f64 = 0.5;

/// Side of a tile of the resolve where it visits listed tiles, pixels.
const TILE: u32 = 8;

/// What waits in the queues of a frame.
struct Queues {
    clip: f64,
    clipped_triangles: f64,
    medium: f64,
    tiles: f64,
}

/// The unit that operations of a pass over queues count as: those of layers that are shaded and added to sums have one of their own.
fn in_sums(phase: RasterPhase, unit: Unit) -> Unit {
    if matches!(phase, RasterPhase::Sum | RasterPhase::NearestAndSum) { Unit::SumOperation } else { unit }
}

/// What the passes of a frame have to do, in numbers.
pub(super) struct FrameCounts<'a> {
    key: &'a KernelKey,
    layout: &'a FrameLayout,
    sizes: SizeWork,
    queues: Queues,
    pixels: f64,
    /// Estimated fraction of the pixels in tiles that a triangle touches.
    touched: f64,
    /// Columns and rows of the square about a corner's disc.
    disc: [f64; 2],
    /// Pixels of that disc.
    disc_area: f64,
    /// Pixels in the square about a dot.
    dot: f64,
    /// Dots that are drawn.
    listed_dots: f64,
    /// Turns of the longest loop that an effect runs at every pixel.
    pub(super) turns: f64,
    /// Pixels that an image effect reads for each.
    neighbors: f64,
    /// The rows of a triangle that sample setups visit.
    setup_rows: SetupRows,
    /// The color of a material is seen.
    pub(super) shows_materials: bool,
}

impl<'a> FrameCounts<'a> {
    pub(super) fn new(
        frame: &'a PreparedFrame,
        triangles: &TriangleSizes,
        demand: Option<&CounterRecord>,
        dot_radius: Option<u32>,
    ) -> Self {
        let (key, layout) = (&frame.plan.key, &frame.layout);
        let large = f64::from(SMALL_EXTENT >> key.options.coverage.subpixel_bits());
        let sizes = triangles.work(key.paths.max_small_samples, key.paths.max_small_side, large);
        let queues = match demand {
            Some(counted) => Queues {
                clip: counted.clip.into(),
                clipped_triangles: counted.clipped_triangles.into(),
                medium: counted.medium.into(),
                tiles: counted.tiles.into(),
            },
            None => Queues {
                clip: sizes.cut.triangles,
                clipped_triangles: 2.0 * sizes.cut.triangles,
                medium: sizes.medium.triangles,
                tiles: sizes.large.triangles + sizes.large.candidates / (BLOCK * BLOCKS_OF_TILE),
            },
        };
        // The part of a square that lies in the picture.
        let square = |units: u32| layout.size.map(|side| (f64::from(units) / 128.0).clamp(1.0, f64::from(side).max(1.0)));
        Self {
            key,
            layout,
            queues,
            pixels: f64::from(layout.size[0]) * f64::from(layout.size[1]),
            touched: triangles.touched_fraction(layout.size, TILE),
            disc: square(frame.point_radius),
            disc_area: std::f64::consts::PI * (f64::from(frame.point_radius) / 256.0).powi(2),
            dot: dot_radius.map_or(0.0, |radius| square(radius + 128).iter().product()),
            listed_dots: layout.dots.map_or(0.0, |dots| match key.options.dot_culling {
                DotCulling::Brute => dots.dots.into(),
                DotCulling::Cpu => dots.chosen.into(),
                DotCulling::Gpu => demand.map_or(dots.dots, |counted| counted.listed_dots).into(),
            }),
            turns: frame.turns,
            neighbors: frame.neighbors,
            setup_rows: frame.setup_rows,
            shows_materials: true,
            sizes,
        }
    }

    fn triangles(&self) -> f64 {
        self.layout.scene.triangles as f64
    }

    fn is_strict(&self) -> bool {
        self.key.options.vertex_transform == VertexTransform::Strict
    }

    /// Are images of materials seen?
    fn shows_textures(&self) -> bool {
        let SizeWork { textured, textured_corners, .. } = self.sizes;
        self.shows_materials && self.covered(textured, textured_corners) >= ANY
    }

    /// Samples that are drawn of triangles that cover so many and have so many corners in the picture.
    fn covered(&self, samples: f64, corners: f64) -> f64 {
        if self.key.samples.shape == Shape::Points { corners * self.disc_area } else { samples }
    }

    /// Is any pixel shaded?
    fn shades(&self) -> bool {
        let SizeWork { small, medium, large, corners, .. } = self.sizes;
        self.covered(small.covered + medium.covered + large.covered, corners) >= ANY
    }

    /// Invocations of a pass that is dispatched over a known number; none for one whose number a pass before it decides.
    fn invocations(&self, pass: Pass) -> Option<f64> {
        match self.layout.dispatch(self.key, pass, None) {
            Dispatch::Direct { groups: [x, y] } => Some(f64::from(x) * f64::from(y) * f64::from(self.key.work.group_size)),
            Dispatch::Indirect { .. } => None,
        }
    }

    /// Of so many covered samples those that blocks do not hide before they are drawn: where many layers lie on a pixel in any order, the n-th
    /// is the nearest so far with a probability of 1/n. Passes that count or sum layers draw all.
    fn drawn(&self, covered: f64, phase: RasterPhase) -> f64 {
        let layers = covered / self.pixels.max(1.0);
        let hides = matches!(phase, RasterPhase::Packed | RasterPhase::Depth | RasterPhase::TriangleId);
        if self.key.work.hides_blocks && hides && layers > 1.0 { self.pixels * (1.0 + layers.ln()) } else { covered }
    }

    /// Samples that workgroups visit for medium triangles: squares of 64 pixels inside them, and along their edges.
    fn medium_samples(&self, phase: RasterPhase) -> f64 {
        let PathWork { triangles, candidates, covered, .. } = self.sizes.medium;
        let (candidates, covered) = match triangles > 0.0 {
            true => (candidates / triangles, covered / triangles),
            false => (USUAL_CANDIDATES, 0.5 * USUAL_CANDIDATES),
        };
        self.drawn(self.queues.medium * covered, phase) + self.queues.medium * (16.0 * candidates.sqrt() + BLOCK)
    }

    /// Samples that workgroups visit for large triangles: what these cover, and blocks along their edges in every tile.
    fn large_samples(&self, phase: RasterPhase) -> f64 {
        if self.queues.tiles > 0.0 { self.drawn(self.sizes.large.covered, phase) + 16.0 * BLOCK * self.queues.tiles } else { 0.0 }
    }

    /// Blocks that a workgroup draws one after another of the medium triangle that has most.
    fn medium_turns(&self) -> f64 {
        if self.queues.medium > 0.0 { (self.sizes.medium.longest / BLOCK / QUEUE_PARTS).max(1.0) } else { 0.0 }
    }

    /// Blocks that a workgroup draws one after another of a tile.
    fn tile_turns(&self) -> f64 {
        let blocks: f64 = self.layout.size.iter().map(|side| (f64::from(*side) / BLOCK_SIDE).ceil().min(BLOCKS_OF_TILE.sqrt())).product();
        if self.queues.tiles > 0.0 { (blocks / QUEUE_PARTS).max(1.0) } else { 0.0 }
    }

    /// Those of the blocks of both that one triangle covers.
    fn covered_blocks(&self) -> f64 {
        let SizeWork { medium, large, .. } = &self.sizes;
        let blocks = |path: &PathWork| (path.most_covered / BLOCK / QUEUE_PARTS).max(1.0);
        self.medium_turns().min(blocks(medium)).max(self.tile_turns().min(blocks(large)))
    }

    /// Sample setups of so many triangles, of which some have these rows.
    fn setups(&self, triangles: f64, rows: &RowWork, Weight { once, looped }: Weight) -> Vec<(Unit, f64)> {
        let (all, most) = match self.setup_rows {
            SetupRows::None => (TURNS * triangles, TURNS),
            SetupRows::First => (rows.first / ROW_LOOPS, rows.most_first / ROW_LOOPS),
            SetupRows::All(times) => (times * rows.all / ROW_LOOPS, times * rows.most / ROW_LOOPS),
        };
        vec![(Unit::SetupChain, most * looped), (Unit::SetupOperation, triangles * once + all * looped)]
    }

    /// The work of one pass, whose kernel has this weight.
    pub(super) fn counts(&self, pass: Pass, weight: Weight) -> Vec<(Unit, f64)> {
        let Weight { once, looped } = weight;
        let few_turns = once + TURNS * looped;
        let small = &self.sizes.small;
        match pass {
            Pass::Particles => {
                vec![(Unit::ParticleChain, few_turns), (Unit::ParticleOperation, f64::from(self.layout.scene.particles) * few_turns)]
            }
            Pass::Skin => {
                vec![(Unit::DeformChain, few_turns), (Unit::DeformOperation, f64::from(self.layout.scene.deformable) * few_turns)]
            }
            Pass::Project | Pass::Cull(_) | Pass::ProjectMeshlets => {
                let vertices = self.invocations(pass).unwrap_or(0.5 * self.layout.scene.vertices as f64);
                let is_strict = self.is_strict() && !matches!(pass, Pass::Cull(_));
                vec![(Unit::VertexOperation, vertices * few_turns), (Unit::StrictVertices, f64::from(u8::from(is_strict)))]
            }
            Pass::SampleSetup(TriangleSource::Triangles) => {
                self.setups(self.invocations(pass).unwrap_or_else(|| self.triangles()), &self.sizes.rows, weight)
            }
            Pass::SampleSetup(TriangleSource::ClippedTriangles) if self.queues.clipped_triangles > 0.0 => {
                self.setups(self.queues.clipped_triangles, &self.sizes.cut_rows, weight)
            }
            Pass::Clip if self.queues.clip > 0.0 => {
                let doublings = |triangles: f64| ONE_CLIPPED + triangles.min(CLIPPED_TOGETHER).log2();
                vec![
                    (Unit::Clipping, doublings(self.queues.clip) / doublings(CLIPPED_TOGETHER)),
                    (Unit::StrictClipping, f64::from(u8::from(self.is_strict()))),
                    (Unit::ClipOperation, self.queues.clip * few_turns),
                ]
            }
            Pass::RasterSmall(phase) => {
                let triangles = if self.invocations(pass).is_some() { self.triangles() } else { 0.5 * self.triangles() };
                let mut counts = self.turns(phase, small, 0.0, looped);
                counts.push((Unit::SmallOperation, triangles * once + small.candidates * looped));
                counts
            }
            // Its text holds the code of three paths, each about as long as the others.
            Pass::RasterAll(phase) => {
                let (once, looped) = (once / 3.0, looped / 3.0);
                let mut counts = self.turns(phase, small, self.medium_turns().max(self.tile_turns()), looped);
                counts.push((Unit::SmallOperation, self.triangles() * once + small.candidates * looped));
                counts.push((in_sums(phase, Unit::MediumOperation), self.medium_samples(phase) * looped));
                counts.push((in_sums(phase, Unit::LargeOperation), self.large_samples(phase) * looped));
                counts
            }
            Pass::TileLarge => vec![(Unit::LargeOperation, self.sizes.large.triangles * few_turns)],
            Pass::RasterMedium(phase) => {
                self.queued(phase, self.medium_turns(), looped, (Unit::MediumOperation, self.medium_samples(phase) * looped))
            }
            Pass::RasterLarge(phase) => {
                self.queued(phase, self.tile_turns(), looped, (Unit::LargeOperation, self.large_samples(phase) * looped))
            }
            // All discs but those of one triangle are left out before their samples.
            Pass::RasterPoints(RasterPhase::BoundaryTriangle) => vec![(Unit::SmallOperation, self.triangles() * once)],
            Pass::RasterPoints(phase) => {
                // Parts beyond the rows of a disc end at once.
                let parts = f64::from(self.key.work.invocations_per_triangle).min(self.disc[1] + 2.0);
                let turns = self.sizes.most_corners * (self.disc[1] / parts).ceil() * self.disc[0];
                let samples = self.sizes.corners * self.disc[0] * self.disc[1];
                vec![
                    (if phase == RasterPhase::Race { Unit::RaceTurn } else { Unit::DiscTurn }, turns),
                    (Unit::SmallOperation, parts * self.triangles() * once),
                    (Unit::DiscOperation, samples * looped),
                ]
            }
            Pass::OrderSums | Pass::OrderRanks => vec![(Unit::OrderedTriangle, self.triangles())],
            Pass::DotsEnds => vec![(Unit::VertexOperation, self.layout.dots.map_or(0.0, |dots| dots.segments.into()) * few_turns)],
            Pass::DotsCull => {
                let runs = self.layout.dots.map_or(0.0, |dots| dots.runs.into());
                vec![(Unit::RunChain, if runs > 0.0 { few_turns } else { 0.0 }), (Unit::VertexOperation, runs * few_turns)]
            }
            Pass::DotsDraw | Pass::DotsProbe => {
                let turn = if self.listed_dots > 0.0 { self.dot } else { 0.0 };
                let (samples, operations) = (self.listed_dots * self.dot, self.listed_dots * once);
                vec![(Unit::DotTurn, turn), (Unit::DotOperation, samples * looped), (Unit::ListedOperation, operations)]
            }
            Pass::Resolve => self.resolve(once, looped),
            Pass::ResolveBackground => {
                let pixels = (1.0 - self.touched) * self.pixels;
                let turns = self.turns.max(self.neighbors).max(TURNS);
                vec![
                    (Unit::Pixel, pixels),
                    (Unit::NeighborPixel, self.neighbors * pixels),
                    (Unit::PixelOperation, pixels * (once + turns * looped)),
                ]
            }
            Pass::Scale => {
                let shown = f64::from(self.layout.shown[0]) * f64::from(self.layout.shown[1]);
                let taps = (self.pixels / shown.max(1.0)).max(1.0);
                vec![(Unit::PixelOperation, shown * (once + taps * looped))]
            }
            Pass::DepthReduce | Pass::ListTiles => vec![(Unit::Pixel, self.pixels / 16.0)],
            Pass::SampleSetup(_)
            | Pass::Clip
            | Pass::AdvanceQueues { .. }
            | Pass::Args
            | Pass::OrderLimit
            | Pass::OrderCut
            | Pass::DotsArgs => Vec::new(),
        }
    }

    /// What the invocation with most samples of small triangles, or with most blocks of queued ones, does one after another.
    fn turns(&self, phase: RasterPhase, small: &PathWork, blocks: f64, looped: f64) -> Vec<(Unit, f64)> {
        let (longest, covered) = (small.longest, small.most_covered.min(small.longest));
        match phase {
            RasterPhase::Sum | RasterPhase::NearestAndSum => {
                let textures = if self.shows_textures() { 1.0 } else { 0.0 };
                let blocks = if blocks > 0.0 { self.covered_blocks() } else { 0.0 };
                vec![
                    (Unit::SumTurn, covered),
                    (Unit::SumBlock, blocks),
                    (Unit::Textures, textures),
                    (Unit::TexturedTurn, blocks.max(covered) * textures),
                ]
            }
            // No sample is stored: an invocation counts for itself, and triangles but one are left out before their samples.
            RasterPhase::CountSamples => vec![(Unit::SmallChain, longest.max(blocks) * looped)],
            RasterPhase::BoundaryTriangle => Vec::new(),
            RasterPhase::Race => vec![(Unit::RaceTurn, covered.max(blocks)), (Unit::SmallChain, longest.max(blocks) * looped)],
            _ if self.key.samples.has_mask => vec![(Unit::MaskTurn, covered.max(blocks))],
            _ => vec![(Unit::SmallTurn, covered.max(blocks)), (Unit::SmallChain, longest.max(blocks) * looped)],
        }
    }

    /// Passes over the queues of medium triangles or of tiles.
    fn queued(&self, phase: RasterPhase, blocks: f64, looped: f64, operations: (Unit, f64)) -> Vec<(Unit, f64)> {
        let mut counts = match phase {
            RasterPhase::Sum | RasterPhase::NearestAndSum => self.turns(phase, &PathWork::default(), blocks, looped),
            _ => vec![(Unit::QueuedTurn, blocks)],
        };
        counts.push((in_sums(phase, operations.0), operations.1));
        counts
    }

    fn resolve(&self, once: f64, looped: f64) -> Vec<(Unit, f64)> {
        let shades = self.shades();
        let if_shaded = |count: f64| if shades { count } else { 0.0 };
        // Averages and counts of layers read no image.
        let shows_layers = matches!(self.key.framebuffer.layers, Some(Layers::Xray { .. } | Layers::Overdraw));
        let textures = f64::from(u8::from(self.shows_textures() && !shows_layers));
        let visited = if self.key.work.listed_tiles { self.touched } else { 1.0 };
        let shaded = if self.key.finishes_pixels() && !self.key.work.listed_tiles { 1.0 } else { self.touched };
        let several = if_shaded(f64::from(u8::from(!self.key.vertices.is_single_draw && !shows_layers)));
        let textures = if_shaded(textures);
        let turns = if_shaded(self.turns);
        // A picture of few pixels waits for the slowest of them, one of many for all.
        let [shaded, touched] = [shaded, self.touched].map(|part| part * self.pixels);
        vec![
            (Unit::Pixel, visited * self.pixels),
            (Unit::PixelTurn, turns),
            (Unit::LoopedPixel, turns * shaded),
            (Unit::Neighbor, self.neighbors),
            (Unit::NeighborPixel, self.neighbors * shaded),
            (Unit::NeighborDraw, if self.key.vertices.is_single_draw { 0.0 } else { self.neighbors }),
            (Unit::SeveralDraws, several),
            (Unit::SearchedPixel, several * touched),
            (Unit::Textures, textures),
            (Unit::TexturedPixel, textures * touched),
            (Unit::PixelOperation, shaded * (once + self.turns.max(self.neighbors).max(TURNS) * looped)),
        ]
    }
}
