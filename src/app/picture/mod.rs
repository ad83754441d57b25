//! The picture in the window: what it is drawn from, the thread that draws it, what it cost, and
//! how far it is off the oracle's.

pub mod anti_aliasing;
pub mod apply;
pub mod blit;
pub mod cells;
pub mod command;
pub mod effect_picture;
pub mod findings;
pub mod golden_check;
pub mod inputs;
pub mod measured;
pub mod overlay;
pub mod picture_thread;
pub mod precision;
pub mod review;
pub mod screen;
#[cfg(target_arch = "wasm32")]
pub mod sent;
pub mod state;
pub mod tier_times;
pub mod timings;
pub mod verification;
