//! The kernels on a device: [`Renderer`] draws pictures, [`Capture`] is one with everything that
//! decided it. The folders are listed so that each uses only those above it, and so are the files in
//! each.

// One place opts out, with its reason: the option `trusted` of pipelines.rs.
#![deny(unsafe_code)]

mod layout;

pub mod device;

mod resources;

mod scene_data;

mod passes;

mod renderer;

mod baselines;

pub use baselines::{hardware, naive};
#[cfg(target_arch = "wasm32")]
pub use device::canvas;
pub use device::{
    Gpu, compile_watch::CompileWatch, completion::idle, device_memory, error::RenderError,
    preparations, timer,
};
pub use layout::{RecordLayout, RecordMember, ResourceId, queues::Capacities, records};
pub use passes::particles;
pub use renderer::{
    Capture, Explanation, Renderer, Report, SizesNote, frame_stats, frame_times, warm_up,
};
pub use resources::{
    buffers::{self, BufferNote},
    pipelines,
};

pub use rasterlab_kernels::plan::Note;

use rasterlab_kernels::{plan, shader};
use rasterlab_model::{accuracy, effects, frame, math, measure, scene};
