//! Errors of drawing, each one sentence.

use crate::{
    accuracy::RenderScale,
    layout::glass::MOST_BANDS,
    plan::{MOST_CARD_GLASS_LAYERS, PlanError},
    scene::{draw::DrawError, view::View},
    shader::{link::LinkError, reflect::ShaderError},
};

/// Why a picture could not be drawn.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    #[error(transparent)]
    Draw(#[from] DrawError),
    #[error(transparent)]
    Plan(#[from] PlanError),
    #[error(
        "the buffer {buffer} would take {bytes} bytes; this adapter binds at most {limit}; take another adapter, or fewer triangles or pixels"
    )]
    TooLarge {
        buffer: &'static str,
        bytes: u64,
        limit: u64,
    },
    #[error(
        "the picture is {width} x {height}; this adapter's textures end at {limit} pixels a side"
    )]
    TooWide { width: u32, height: u32, limit: u32 },
    #[error(
        "no memory for the buffer {buffer} of {bytes} bytes; take another adapter, or a smaller picture or scene"
    )]
    OutOfMemory { buffer: &'static str, bytes: u64 },
    #[error("scale {} draws {}x{} pixels for a picture of {}x{}, and {why}; take a smaller scale", option.name(), drawn[0], drawn[1], shown[0], shown[1])]
    Scaled {
        option: RenderScale,
        shown: [u32; 2],
        drawn: [u32; 2],
        why: Box<RenderError>,
    },
    #[error(
        "checks trusted is for the shaders inside this program, not for those of a folder; use checked"
    )]
    Untrusted,
    #[error("a pass binds {name}, which this frame does not have; this is a fault of rasterlab")]
    NoResource { name: &'static str },
    #[error("the device was lost")]
    Lost,
    #[error("the adapter has written no timestamps, so nothing can be timed")]
    NoTimestamps,
    #[error("no scene has been set")]
    NoScene,
    #[error("compiling was stopped, because another picture was asked for")]
    Stopped,
    #[error(transparent)]
    Link(#[from] LinkError),
    #[error(transparent)]
    Shader(#[from] ShaderError),
    #[error("the pipeline {label} was refused: {reason}")]
    Pipeline { label: String, reason: String },
    #[error("the queues still overflow after growing ten times; {0} entries were lost")]
    Overflow(u32),
    #[error(
        "draw_order in the hardware's order counts in one word, at most 4294967295 samples, and this picture has {0}; take \
         mode = \"submission\", or a smaller picture"
    )]
    Tickets(u64),
    #[error(
        "{0} pixels have more layers than the x-ray's sums hold even with 8 bits a channel; narrow its window, give all layers equal \
         weight, show fewer, or take sums four32"
    )]
    FullSums(u32),
    #[error(
        "{pixels} pixels have more than {most} layers of glass, the most that this adapter sorts (a graphics card {card}); show fewer",
        card = MOST_CARD_GLASS_LAYERS
    )]
    DeepGlass { pixels: u32, most: u32 },
    #[error(
        "the layers of glass do not fit in memory even in {bands} bands of pixels: one has {0}; draw a larger picture of fewer triangles, or show fewer layers",
        bands = MOST_BANDS
    )]
    ManyLayers(u32),
}

impl RenderError {
    /// With the reason why so much was asked for.
    pub(crate) fn at_scale(self, option: RenderScale, shown: &View, drawn: &View) -> Self {
        let [shown, drawn] = [shown, drawn].map(|view| [view.width, view.height]);
        match self {
            Self::TooLarge { .. } | Self::TooWide { .. } | Self::OutOfMemory { .. } => {
                Self::Scaled {
                    option,
                    shown,
                    drawn,
                    why: Box::new(self),
                }
            }
            other => other,
        }
    }

    /// A pinned option that this preset or adapter lacks, or a size.
    pub fn is_unsupported(&self) -> bool {
        self.depends_on_adapter()
            || matches!(self, Self::Plan(error) if !matches!(error, PlanError::Conflict(_)))
            || matches!(self, Self::Untrusted | Self::Tickets(_))
            || matches!(self, Self::DeepGlass { .. } | Self::ManyLayers(_))
    }

    /// Another adapter may draw it: one with the option or the size. What no adapter could draw is
    /// wrong usage.
    pub fn depends_on_adapter(&self) -> bool {
        matches!(self, Self::Plan(PlanError::NoInt64Atomics))
            || matches!(
                self,
                Self::Scaled { .. }
                    | Self::TooLarge { .. }
                    | Self::TooWide { .. }
                    | Self::OutOfMemory { .. }
            )
    }

    /// Is it a fault of the program, which no preset should be able to cause?
    pub fn is_fault(&self) -> bool {
        matches!(
            self,
            Self::NoResource { .. } | Self::NoScene | Self::Overflow(_)
        ) || matches!(
            self,
            Self::Link(_) | Self::Shader(_) | Self::Pipeline { .. }
        )
    }

    pub fn is_lost(&self) -> bool {
        matches!(self, Self::Lost)
    }
}
