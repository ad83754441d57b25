//! Passes: the entry points of a frame, and what each raster pass writes.

/// One entry point of a frame. Its file in `shaders/stages` is [`Pass::path`], its name for
/// profilers [`Pass::label`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pass {
    /// Simulates particles and writes their discs.
    Particles,
    /// Writes the vertices of meshes that deform.
    Skin,
    /// Projects every vertex.
    Project,
    /// Lists the meshlets to draw.
    Cull(CullPhase),
    /// Projects the vertices of the listed meshlets alone.
    ProjectMeshlets,
    /// Finds the farthest depth of every tile, behind which meshlets are hidden.
    DepthReduce,
    /// Between the early and the late culling phase: makes the next passes start at the queue
    /// entries listed from here on, or at the first entry again.
    AdvanceQueues {
        reopens_queues: bool,
    },
    /// Computes what sample tests read once per triangle.
    SampleSetup(TriangleSource),
    /// Sums the samples of every block of triangles.
    OrderSums,
    /// Finds the triangle in which the sample limit lies.
    OrderLimit,
    /// Writes the fraction of all samples that precede each triangle.
    OrderRanks,
    /// Finds the pixel of the boundary triangle at which drawing stops.
    OrderCut,
    RasterSmall(RasterPhase),
    /// Draws points that no pass has projected.
    RasterCloud(RasterPhase),
    /// Draws corners as discs instead of triangles.
    RasterPoints(RasterPhase),
    /// Writes the arguments of indirect dispatches.
    Args,
    Clip,
    /// Divides large triangles into tiles.
    TileLarge,
    RasterMedium(RasterPhase),
    RasterLarge(RasterPhase),
    /// Draws triangles of all sizes, after a phase that has filled the queues.
    RasterAll(RasterPhase),
    /// Projects the ends of the segments along which dots lie.
    DotsEnds,
    /// Lists the dots that may be visible.
    DotsCull,
    /// Writes the number of listed dots as dispatch arguments.
    DotsArgs,
    DotsDraw,
    /// Writes the positions of all dots, for the judge alone.
    DotsProbe,
    /// Goes on to the next band of pixels whose layers of glass are drawn.
    GlassBand,
    /// Sorts and composes the layers of glass of a band.
    GlassCompose,
    /// Lists the tiles that a triangle touched.
    ListTiles,
    /// Shades every pixel, or those of the listed tiles.
    Resolve,
    /// Finishes the pixels of the tiles that no triangle touched.
    ResolveBackground,
    /// Takes the picture to linear light, for image passes.
    ImageBegin,
    /// The image pass of this number.
    Image(u8),
    /// Resamples the drawn picture to the shown size.
    Scale,
}

/// Which triangles a pass runs over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TriangleSource {
    /// The scene's.
    Triangles,
    /// Those that clipping produced.
    ClippedTriangles,
}

/// Against what a pass culls meshlets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CullPhase {
    /// The view frustum and the facing alone.
    FrustumOnly,
    /// Those, and the depths of the previous frame.
    PreviousFrame,
    /// First of two phases: passes what was visible in the previous frame.
    Early,
    /// Second of two phases: passes what the early phase did not draw and does not hide.
    Late,
}

/// What a raster pass writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RasterPhase {
    /// Depth key and triangle id in one 64-bit atomic.
    Packed,
    /// Triangle id and the upper bits of the depth key in one 32-bit atomic.
    Packed32,
    /// The nearest depth key.
    Depth,
    /// The triangle id of the nearest depth key.
    TriangleId,
    /// Layers per pixel: for the heat map, and for the judge.
    Count,
    /// Weighted colors of all layers.
    Sum,
    /// Both in the same pass: the nearest in one 64-bit atomic, and the colors of all layers.
    NearestAndSum,
    /// Every layer of glass before what is opaque, with its color.
    Glass,
    /// Depth key and triangle id without atomics.
    Race,
    /// Samples per triangle.
    CountSamples,
    /// The samples of the triangle in which drawing stops.
    BoundaryTriangle,
}

impl RasterPhase {
    /// What tells its passes apart from those of other phases in a label.
    const fn label(self) -> &'static str {
        match self {
            Self::Packed | Self::Packed32 => "",
            Self::Depth => "depth",
            Self::TriangleId => "triangle id",
            Self::Count => "count",
            Self::Sum => "sum",
            Self::NearestAndSum => "nearest and sum",
            Self::Glass => "glass",
            Self::Race => "race",
            Self::CountSamples => "count samples",
            Self::BoundaryTriangle => "boundary triangle",
        }
    }
}

impl Pass {
    /// Stem of the file below `shaders/stages`, and name of the entry point in it.
    pub const fn stem(self) -> &'static str {
        match self {
            Self::Particles => "simulate_particles",
            Self::Skin => "deform",
            Self::Project => "project",
            Self::Cull(_) => "cull",
            Self::ProjectMeshlets => "project_meshlets",
            Self::DepthReduce => "depth_reduce",
            Self::AdvanceQueues { .. } => "advance_queues",
            Self::SampleSetup(_) => "sample_setup",
            Self::OrderSums => "order_sums",
            Self::OrderLimit => "order_limit",
            Self::OrderRanks => "order_ranks",
            Self::OrderCut => "order_cut",
            Self::RasterSmall(_) => "raster_small",
            Self::RasterCloud(_) => "raster_cloud",
            Self::RasterPoints(_) => "raster_points",
            Self::Args => "dispatch_args",
            Self::Clip => "clip",
            Self::TileLarge => "tile_large",
            Self::RasterMedium(_) => "raster_medium",
            Self::RasterLarge(_) => "raster_large",
            Self::RasterAll(_) => "raster_all",
            Self::DotsEnds => "dots_ends",
            Self::DotsCull => "dots_cull",
            Self::DotsArgs => "dots_args",
            Self::DotsDraw => "dots_draw",
            Self::DotsProbe => "dots_probe",
            Self::GlassBand => "glass_band",
            Self::GlassCompose => "glass_compose",
            Self::ListTiles => "list_tiles",
            Self::Resolve => "resolve",
            Self::ResolveBackground => "resolve_background",
            Self::ImageBegin => "image_begin",
            Self::Image(_) => "image_pass",
            Self::Scale => "scale",
        }
    }

    /// The file below `shaders`, without `.wgsl`.
    pub fn path(self) -> String {
        let folder = match self {
            Self::Particles
            | Self::Skin
            | Self::Project
            | Self::ProjectMeshlets
            | Self::Cull(_)
            | Self::DepthReduce => "geometry",
            Self::AdvanceQueues { .. } | Self::SampleSetup(_) | Self::Args | Self::Clip => {
                "geometry"
            }
            Self::RasterSmall(_)
            | Self::RasterCloud(_)
            | Self::RasterPoints(_)
            | Self::RasterMedium(_)
            | Self::RasterLarge(_) => "raster",
            Self::RasterAll(_) | Self::TileLarge => "raster",
            Self::OrderSums | Self::OrderLimit | Self::OrderRanks | Self::OrderCut => "order",
            Self::DotsEnds | Self::DotsCull | Self::DotsArgs | Self::DotsDraw | Self::DotsProbe => {
                "lines"
            }
            Self::GlassBand | Self::GlassCompose => "shade",
            Self::ListTiles | Self::Resolve | Self::ResolveBackground => "shade",
            Self::ImageBegin | Self::Image(_) | Self::Scale => "shade",
        };
        format!("stages/{folder}/{}", self.stem())
    }

    /// Does it write the colors of the picture?
    pub const fn resolves(self) -> bool {
        matches!(self, Self::Resolve | Self::ResolveBackground)
    }

    /// What it writes, if it is a raster pass.
    pub const fn phase(self) -> Option<RasterPhase> {
        match self {
            Self::RasterSmall(phase) | Self::RasterCloud(phase) => Some(phase),
            Self::RasterPoints(phase) => Some(phase),
            Self::RasterMedium(phase) | Self::RasterLarge(phase) | Self::RasterAll(phase) => {
                Some(phase)
            }
            _ => None,
        }
    }

    /// Label for profilers and tables: the stem, and what tells the pass apart from others of the
    /// same file.
    pub fn label(self) -> String {
        let stem = self.stem();
        let detail = match self {
            Self::SampleSetup(TriangleSource::ClippedTriangles) => "clipped triangles",
            Self::Cull(CullPhase::Early) => "early",
            Self::Cull(CullPhase::Late) => "late",
            _ => self.phase().map_or("", RasterPhase::label),
        };
        if detail.is_empty() {
            stem.into()
        } else {
            format!("{stem} {detail}")
        }
    }
}
