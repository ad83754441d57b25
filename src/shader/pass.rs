//! Passes: the entry points of a frame, and what each raster pass writes.

/// One entry point of the frame; the name is the file's stem in `shaders/passes` plus, for a repeated one, its phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pass {
    Particles,
    Skin,
    Project,
    /// Which meshlets are drawn.
    Cull(CullPhase),
    /// The vertices of those alone.
    ProjectMeshlets,
    /// The farthest depth of every tile, behind which meshlets hide.
    DepthReduce,
    /// The end of the first round, or of both.
    AdvanceQueues {
        reopens_queues: bool,
    },
    /// What sample effects settle about triangles, or about pieces.
    SampleSetup(TriangleSource),
    /// Samples of every block of triangles.
    OrderSums,
    /// In which triangle the limit falls.
    OrderLimit,
    /// Which share of all samples comes before each triangle.
    OrderRanks,
    /// At which pixel of that triangle the drawing stops.
    OrderCut,
    RasterSmall(RasterPhase),
    /// Corners as discs, instead of the triangles.
    RasterPoints(RasterPhase),
    Args,
    Clip,
    TileLarge,
    RasterMedium(RasterPhase),
    RasterLarge(RasterPhase),
    /// Lists of the tiles that medium triangles touch.
    BinMedium(RasterPhase),
    /// The same of large ones.
    BinLarge(RasterPhase),
    /// Where the list of each tile begins.
    BinScan,
    /// Every tile by itself, from its list.
    RasterTiles,
    /// Ends of the segments on which dots are strung.
    DotsEnds,
    /// Which dots may show.
    DotsCull,
    /// How many those are, as a dispatch size.
    DotsArgs,
    DotsDraw,
    /// Where all dots lie, for a judge alone.
    DotsProbe,
    ListTiles,
    Resolve,
    /// From the pixels that were drawn to those that are shown.
    Scale,
}

/// Over what a pass runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TriangleSource {
    Triangles,
    ClippedTriangles,
}

/// In which round of a frame meshlets are culled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CullPhase {
    /// The only one: nothing hides anything.
    Only,
    /// The only one: what the picture before hides is left out.
    Before,
    /// Those that were seen in the picture before.
    Seen,
    /// Those that the first round did not draw and does not hide.
    Behind,
}

/// What a raster pass writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RasterPhase {
    /// Key and triangle id at once.
    Packed,
    /// Triangle id and what fits of the key, in one word.
    Packed32,
    /// The nearest key.
    Depth,
    /// The triangle id of the nearest key.
    TriangleId,
    /// Layers per pixel: for the heat map, and for the judge.
    Count,
    /// Weighted colours of all layers.
    Sum,
    /// Key and triangle id without atomics.
    Race,
    /// Samples per triangle.
    CountSamples,
    /// The samples of the triangle in which the drawing stops.
    BoundaryTriangle,
    /// How many triangles each tile has to look at.
    BinCount,
    /// Which ones.
    BinFill,
    /// Key and triangle id, tile by tile.
    Tiles,
}

impl RasterPhase {
    /// Does it put triangles on lists instead of visiting their samples?
    pub const fn is_bin(self) -> bool {
        matches!(self, Self::BinCount | Self::BinFill)
    }

    /// Is it one of the three that together find triangle ids tile by tile?
    pub const fn is_tiled(self) -> bool {
        self.is_bin() || matches!(self, Self::Tiles)
    }
}

impl Pass {
    /// Stem of the file in `shaders/passes`.
    pub const fn stem(self) -> &'static str {
        match self {
            Self::Particles => "particles",
            Self::Skin => "skin",
            Self::Project => "project",
            Self::Cull(_) => "cull",
            Self::ProjectMeshlets => "project_meshlets",
            Self::DepthReduce => "depth_reduce",
            Self::AdvanceQueues { .. } => "rounds",
            Self::SampleSetup(_) => "decide",
            Self::OrderSums => "order_sums",
            Self::OrderLimit => "order_limit",
            Self::OrderRanks => "order_ranks",
            Self::OrderCut => "order_cut",
            Self::RasterSmall(_) => "raster_small",
            Self::RasterPoints(_) => "raster_points",
            Self::Args => "args",
            Self::Clip => "clip",
            Self::TileLarge => "tile_large",
            Self::RasterMedium(_) => "raster_medium",
            Self::RasterLarge(_) => "raster_large",
            Self::BinMedium(_) | Self::BinLarge(_) => "bin_queued",
            Self::BinScan => "bin_scan",
            Self::RasterTiles => "raster_tiles",
            Self::DotsEnds => "dots_ends",
            Self::DotsCull => "dots_cull",
            Self::DotsArgs => "dots_args",
            Self::DotsDraw => "dots_draw",
            Self::DotsProbe => "dots_probe",
            Self::ListTiles => "list_tiles",
            Self::Resolve => "resolve",
            Self::Scale => "scale",
        }
    }

    /// The entry point in that file.
    pub const fn entry(self) -> &'static str {
        match self {
            Self::Args => "args_write",
            other => other.stem(),
        }
    }

    /// Is it one of those over dots?
    pub const fn is_of_dots(self) -> bool {
        matches!(self, Self::DotsEnds | Self::DotsCull | Self::DotsArgs | Self::DotsDraw | Self::DotsProbe)
    }

    pub const fn phase(self) -> Option<RasterPhase> {
        match self {
            Self::RasterSmall(phase) | Self::RasterPoints(phase) | Self::RasterMedium(phase) | Self::RasterLarge(phase) => Some(phase),
            Self::BinMedium(phase) | Self::BinLarge(phase) => Some(phase),
            Self::RasterTiles => Some(RasterPhase::Tiles),
            _ => None,
        }
    }

    /// Label for profilers and tables.
    pub fn label(self) -> String {
        match self {
            Self::SampleSetup(TriangleSource::ClippedTriangles) => return "decide pieces".into(),
            Self::Cull(CullPhase::Early) => return "cull seen".into(),
            Self::Cull(CullPhase::Late) => return "cull behind".into(),
            _ => {}
        }
        let stem = match self {
            Self::BinMedium(_) => "bin_medium",
            Self::BinLarge(_) => "bin_large",
            _ => self.stem(),
        };
        match self.phase() {
            Some(RasterPhase::BinCount) => format!("{stem} count tiles"),
            Some(RasterPhase::BinFill) => format!("{stem} list tiles"),
            Some(RasterPhase::Depth) => format!("{} depth", self.stem()),
            Some(RasterPhase::TriangleId) => format!("{} triangle id", self.stem()),
            Some(RasterPhase::Count) => format!("{} count", self.stem()),
            Some(RasterPhase::CountSamples) => format!("{} tally", self.stem()),
            Some(RasterPhase::BoundaryTriangle) => format!("{} straddle", self.stem()),
            Some(RasterPhase::Sum) => format!("{} sum", self.stem()),
            Some(RasterPhase::Race) => format!("{} race", self.stem()),
            Some(RasterPhase::Packed | RasterPhase::Packed32 | RasterPhase::Tiles) | None => self.stem().into(),
        }
    }
}
