//! Preset files: TOML files that hold a whole [`Preset`](crate::preset::Preset), sparse, versioned
//! and keyed by name.
//!
//! Presence of `[effects.NAME]` enables an effect; `stack` is only order. Comments and unknown keys
//! are kept and written back. Every value is finite and inside its hard range after loading, or the
//! file is refused with a line.

mod apng;
mod atomic;
mod bookmarks;
mod edit;
mod effect_values;
mod error;
mod file;
mod formats;
mod frame_status;
mod gallery;
mod goldens;
mod hash;
#[cfg(target_arch = "wasm32")]
mod in_memory;
mod keyframes;
mod landing;
mod load;
mod look;
mod manage;
mod merge;
pub mod migrate;
mod order;
mod picture;
mod read;
mod reader;
mod rebind;
mod scene;
pub mod schema;
mod scope;
mod share;
pub mod surroundings;
pub mod sweep;
pub mod toml_value;
mod toward;
mod write;

pub use apng::{AnimatedPng, AnimationOptions};
pub use atomic::{AtomicFile, Existing, is_taken, write_atomically};
pub use edit::{set, unset};
pub use effect_values::{
    EffectValues, SavedValues, is_effect_text, load_values, save_values, saved_values,
};
pub use error::{Position, PresetError};
pub use file::{MAX_NAME, PresetFile, normalized, save, to_shared_toml, to_toml};
pub use formats::{MODEL_FORMATS, ModelFormat};
pub use frame_status::{FrameStatus, frame_status};
pub use gallery::{
    BUILTIN_DIR, Folders, GalleryEntry, Origin, PLAIN, gallery, open, plain, user_effects_folder,
    user_folder,
};
pub use goldens::{golden_folder, golden_paths};
pub use hash::{Fnv, hex, preset_hash, scene_hash};
pub use load::{load, load_with, parse, parse_file, parse_with};
pub use look::Look;
pub use manage::{duplicate, file_stem, rename};
pub use merge::{Merged, merge};
pub use picture::{
    Provenance, pixels_of_png, png_bytes, png_of_frame, png_pixels, png_with_preset,
    preset_from_png,
};
pub use scene::{SceneError, check_model, load_scene, load_scene_beside, scene_bounds};
pub use share::{from_line, is_look_text, is_preset_text, to_line};
