//! The lab's window: presets and scenes on the left, the picture in the middle, every parameter on
//! the right, the timeline and the log below. All of it edits one preset, and only that decides
//! what is drawn.
//!
//! A panel owns its own state, reads `state::State` and sends closures on `App`, which are run after
//! the panel was shown. Slow work runs in `jobs` and ends with such a closure; the window never waits
//! for a thread or a device.
//!
//! The folders stand in order: panels and the window name only those before them. Below, `shell` is
//! still named upward, for messages, `State` and `Commands`.

mod widgets;

mod settings;

mod editing;

mod files;

mod picture;

mod trade;

mod jobs;

mod shell;

mod palette;

mod panels;

mod window;

pub use files::recovery::{FIRST_PRESET, config_folder};
pub use shell::device::{Devices, Painter, adopt, wgpu_setup};
pub use window::app::{App, Options};
#[cfg(not(target_arch = "wasm32"))]
pub use window::run::{DeviceLost, run};
#[cfg(target_arch = "wasm32")]
pub use {
    jobs::worker::{answer, heed},
    shell::page::{open_given, refuse, reopen, start},
};
