//! Changes of the open preset: the session, its history, and every edit.

pub mod apply;
pub mod command;
pub mod edit;
pub mod first_values;
pub mod history;
pub mod key_id;
pub mod keyframes;
pub mod new_effect;
pub mod particle_trail;
pub mod playback;
pub mod preset_edit;
pub mod randomize;
pub mod session;
pub mod stack_drag;
pub mod trust;
