//! Commands that change keyframes and the time that is shown.

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

/// A change of the time that is shown. Seconds.
pub enum TimeCommand {
    Show(f64),
    /// Goes to `clock.time_s`.
    ShowOwn,
    /// Writes the shown time to `clock.time_s`.
    Keep,
    PlayOrPause,
    Pause,
    /// Frames to step by, negative for back.
    Step(f64),
    Rewind,
    /// True while the pointer holds the playhead: playing does not advance the time.
    Hold(bool),
}
