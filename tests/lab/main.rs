//! Promises of the window: its panels in a test harness, and the program as a window on a screen.
#![cfg(feature = "gui")]

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod anti_aliasing;
mod bookmarks;
mod brought_code;
mod code;
mod compare;
mod dialogs;
mod duplicates;
mod effect_browser;
mod files;
mod films;
mod first_use;
mod goldens;
mod guides;
mod handles;
mod harness;
mod inspector;
mod keys;
mod landing;
mod layout;
mod live;
mod memory;
mod numerics;
mod outside;
mod palette;
mod preparing;
mod preset_browser;
mod probe;
#[cfg(target_os = "linux")]
#[path = "../common/process.rs"]
mod process;
#[cfg(target_os = "linux")]
mod random_edits;
mod review;
#[path = "../common/rounds.rs"]
mod rounds;
mod scopes;
mod settings;
mod sweep;
mod timeline;
mod timing;
mod trade;
mod verify;
mod viewport;
#[cfg(target_os = "linux")]
mod window;
