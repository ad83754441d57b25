//! The lab's window: presets and scenes on the left, the picture in the middle, every parameter on the right, the timeline
//! and the log below. All of it edits one preset, and only that decides what is drawn.
//!
//! A panel owns its own state, reads `state::State` and sends `command::Command`s; `apply` carries them out after the
//! panel was shown. Slow work runs in `jobs`; the window never waits for a thread or a device.

mod action;
mod anti_aliasing;
mod apply;
mod background;
mod blit;
mod cells;
mod command;
mod completion;
mod computing;
mod deleted;
mod desktop_dialog;
mod device;
mod edit;
mod effect_picture;
mod ending;
mod escape;
mod favorites;
mod fields;
mod film;
mod findings;
mod finished;
mod frame_notes;
mod fuzzy;
mod golden_check;
mod history;
mod icons;
mod input;
mod inputs;
mod jobs;
mod keep;
mod key_id;
mod keyframes;
mod library;
mod live;
mod log;
mod loss;
mod measured;
mod memory;
mod new_effect;
mod numbers;
mod observed;
mod open;
mod opening;
mod orbit;
mod overlay;
#[cfg(target_arch = "wasm32")]
mod page;
mod palette;
mod panel;
mod panels;
mod particle_trail;
mod picture_thread;
mod plain_file;
mod playback;
mod pointer_frames;
mod precision;
mod preset_edit;
mod randomize;
mod recovery;
mod reload;
mod reveal;
#[cfg(not(target_arch = "wasm32"))]
mod run;
mod scene_loader;
mod screen;
mod session;
mod settings;
mod stack_drag;
mod state;
mod system_dialog;
mod system_watch;
mod text;
mod theme;
mod tier_times;
mod timings;
mod trade;
mod trust;
mod typing;
mod ui_frames;
mod verification;
mod watch;
mod window;

pub use device::{Devices, Painter, adopt, wgpu_setup};
#[cfg(target_arch = "wasm32")]
pub use page::start;
pub use recovery::{FIRST_PRESET, config_folder};
#[cfg(not(target_arch = "wasm32"))]
pub use run::{DeviceLost, run};
pub use window::{App, Options};
