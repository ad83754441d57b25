//! The renderer, what it reads back, and how long its frames take.

mod explain;
pub mod frame_stats;

mod drawing;

mod glass;
mod readback;

mod capture;
mod still;
pub mod warm_up;

pub mod frame_times;

pub use capture::Capture;
pub use drawing::{Renderer, Report};
pub use explain::{Explanation, SizesNote};
