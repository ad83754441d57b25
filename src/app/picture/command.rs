//! Commands to the picture: overlays, comparison, and clicks on the model.

use std::sync::Arc;

use glam::DVec3;

use super::{overlay::Overlay, screen::Inputs};
use crate::{
    app::{editing::preset_edit::Parameter, files::scene_loader::SceneKey},
    effects::Effect,
    scene::parts::PartKind,
};

/// What a click on the model sets.
#[derive(Clone, Debug, PartialEq)]
pub enum Picking {
    /// A point.
    Point(Parameter),
    /// A part of this kind that the effect changes.
    Part(Arc<Effect>, PartKind),
}

impl Picking {
    pub fn effect(&self) -> &Arc<Effect> {
        match self {
            Self::Point((effect, _)) | Self::Part(effect, _) => effect,
        }
    }
}

/// A place in a picture.
#[derive(Clone, Debug)]
pub struct Marker {
    /// The picture; in another one the place is not marked.
    pub of: Inputs,
    /// As a fraction of the picture's width and height.
    pub uv: [f32; 2],
    /// What is there.
    pub text: String,
}

/// Why a pixel shows what it shows, in words.
#[derive(Clone, Debug)]
pub struct Probed {
    /// The picture; in another one the words are not shown.
    pub of: Inputs,
    /// Column and row.
    pub pixel: [u32; 2],
    pub text: String,
}

/// Points of a scene between which a distance is measured.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The scene; in another one they are not shown.
    pub of: SceneKey,
    /// One or two, meters before the scene's spin.
    pub points: Vec<DVec3>,
}

pub enum ViewCommand {
    ToggleOverlays,
    ShowOverlay(Overlay, bool),
    /// Marks the next pixel that the overlays paint, or the previous one, and looks into it.
    NextPixel,
    PreviousPixel,
    OverlayGain(u8),
    CycleCompare,
    FlipCompare,
    /// What the next click on the model sets; none cancels.
    Pick(Option<Picking>),
    /// Tells why the pixel in this column and row of the judged picture shows what it shows.
    Probe([u32; 2]),
    /// Hides what a probe has told.
    EndProbe,
    /// A point of the scene, meters before its spin, that a distance is measured from or to; none
    /// ends measuring.
    Measure(Option<DVec3>),
    /// Marks a place in the picture; none removes the mark.
    Mark(Option<Box<Marker>>),
}
