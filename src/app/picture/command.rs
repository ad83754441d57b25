//! What is marked in the picture, and what clicks on the model set.

use std::sync::Arc;

use glam::DVec3;

use super::screen::Inputs;
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
