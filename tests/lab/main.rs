//! Promises of the window: its panels in a test harness, and the program as a window on a screen.
#![cfg(feature = "gui")]

#[path = "../common/mod.rs"]
mod common;

mod harness;
mod panels;
#[cfg(target_os = "linux")]
mod window;
