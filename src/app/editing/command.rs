//! Changes of keyframes.

use super::key_id::KeyId;
use crate::preset::{Preset, animation::Easing};

/// A change of the keyframes of an animated parameter.
pub enum KeyframeEdit {
    Move(KeyId, f64),
    Ease(KeyId, Easing),
    Remove(KeyId),
    /// The preset begins its clock as this one and ends it as it is.
    From(Box<Preset>),
}
