//! Promises of the window: its panels in a test harness, and the program as a window on a screen.
#![cfg(feature = "gui")]

#[path = "../common/mod.rs"]
mod common;

mod brought_code;
mod compare;
mod duplicates;
mod files;
mod first_use;
mod goldens;
mod harness;
mod inspector;
mod keys;
mod live;
mod numerics;
mod scopes;
mod sweep;
mod timeline;
mod timing;
mod verify;
mod viewport;
#[cfg(target_os = "linux")]
mod window;
