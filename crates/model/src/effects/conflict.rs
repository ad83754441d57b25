//! What stacks cannot have together.

use super::stack::MAX_IMAGE_PASSES;
use crate::scene::parts::MAX_SCOPES;

/// Effects that a stack cannot have together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Conflict {
    #[error(
        "{first} and {second} both take the {slot} slot of the rasterizer; switch one of them off"
    )]
    Slot {
        slot: &'static str,
        first: String,
        second: String,
    },
    #[error(
        "{count} effects are limited to parts of the scene, but at most {MAX_SCOPES} can be; remove on from {last} or another of them"
    )]
    Scopes { count: usize, last: String },
    #[error(
        "up to {last} the effects have more than {MAX_IMAGE_PASSES} passes over the picture; switch {last} or another of them off"
    )]
    Passes { last: String },
    #[error(
        "{first} and {second} both remember earlier frames, and a stack has room for one of them; switch the other off"
    )]
    EarlierFrames { first: String, second: String },
    #[error(
        "{order} counts the samples of opaque surfaces, so {glass} cannot be drawn with it; switch one of them off"
    )]
    GlassInOrder { order: String, glass: String },
}

impl Conflict {
    /// The later of the effects.
    pub fn effect(&self) -> &str {
        match self {
            Self::Slot { second, .. } | Self::EarlierFrames { second, .. } => second,
            Self::Scopes { last, .. } | Self::Passes { last } => last,
            Self::GlassInOrder { glass, .. } => glass,
        }
    }
}
