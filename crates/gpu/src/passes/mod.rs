//! A view of a scene: its passes, recorded, and what they need from one frame to the next.

pub mod recording;

mod dot_choice;
pub mod dots;
pub mod layer_sums;
pub mod particles;

pub mod view_resources;

pub mod history;
pub mod pass_purpose;
pub mod shadow_pass;

pub mod hardware_ids;
