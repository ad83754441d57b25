//! Changes of the preset that a panel can ask for.

use std::sync::Arc;

use glam::DVec3;

use crate::{
    effects::Effect,
    params::{Field, Value},
    preset::{ClipPlayback, Clock, settings::Setting},
    scene::{
        camera::Camera,
        parts::{Scope, ShownParts},
    },
};

/// A parameter of an effect.
pub type Parameter = (Arc<Effect>, Arc<Field>);

/// A change of the preset.
pub enum Edit {
    Setting(&'static Setting, Value),
    /// Sets a parameter; an animated one gets a keyframe at the time shown.
    Parameter(Parameter, Value),
    Enable(Arc<Effect>),
    Disable(Arc<Effect>),
    /// Limits an effect to parts of the scene.
    Scope(Arc<Effect>, Scope),
    /// Disables the first effect and enables the second.
    Replace(String, Arc<Effect>),
    /// Uses the second effect in place of the first, with the same values and keyframes.
    Rebind(Arc<Effect>, Arc<Effect>),
    /// Swaps two positions of the stack.
    Swap(usize, usize),
    /// Moves the effect at the first index of the stack in front of the one at the second; the
    /// length of the stack is its end.
    Move(usize, usize),
    /// Enables an effect in front of the one at this index of the stack.
    EnableAt(Arc<Effect>, usize),
    /// The parts of the scene that are shown.
    Parts(ShownParts),
    /// The same built-in scene with other parameters.
    BuiltinQuery(String),
    /// Removes the preset's camera and uses the scene camera of this name; empty = the first.
    SceneCamera(String),
    Play(ClipPlayback),
    Clock(Clock),
    /// The camera of the preset; none for the automatic one.
    Camera(Option<Camera>),
    /// Keeps the camera that is used as a bookmark.
    AddBookmark,
    /// Gives the first bookmark the second name.
    RenameBookmark(String, String),
    RemoveBookmark(String),
    /// Goes to the bookmark after the one where the camera stands.
    NextBookmark,
    FrameScene,
    LookAlong(DVec3),
    ToggleOrthographic,
}
