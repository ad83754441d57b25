//! What the window opens, saves, watches and remembers on disk.

pub mod apply;
pub mod command;
pub mod completion;
pub mod deleted;
pub mod desktop_dialog;
pub mod favorites;
pub mod library;
pub mod live;
pub mod open;
pub mod opening;
pub mod plain_file;
pub mod recovery;
pub mod reload;
pub mod scene_loader;
pub mod state;
pub mod system_dialog;
pub mod system_watch;
#[cfg(target_arch = "wasm32")]
pub mod take_along;
pub mod watch;
