//! The kernels on a device: [`Renderer`] draws pictures, [`Capture`] is one with everything that
//! decided it. The modules are listed so that each uses only those above it.

// One place opts out, with its reason: the option `trusted` of pipelines.rs.
#![deny(unsafe_code)]

mod glass;

pub mod error;
mod gpu_record;
pub mod records;
mod resource_id;

mod compile_watch;
mod pipeline_store;
pub mod preparations;

pub mod device;
pub mod device_memory;

mod completion;

#[cfg(target_arch = "wasm32")]
pub mod canvas;

pub mod buffers;
mod textures;
pub mod timer;

mod packing;

mod attributes;
mod layer_sums;
mod queues;

mod frame_layout;
pub mod frame_stats;
mod image_files;
mod material_atlas;
pub mod pipelines;

mod deforms;
mod meshlets;

mod draw_records;
mod draws;
mod scene_resources;

mod recording;

mod dot_tree;
mod dots;
pub mod particles;
mod view_resources;

mod history;
mod pass_purpose;
mod shadow_pass;

mod explain;
mod hardware_deform;
mod hardware_geometry;
mod hardware_materials;
mod hardware_pipeline;
mod readback;

mod hardware_ids;
mod renderer;
pub mod warm_up;

mod capture;
pub mod hardware;
pub mod naive;
mod still;

pub mod frame_times;

pub use buffers::BufferNote;
pub use capture::Capture;
pub use compile_watch::CompileWatch;
pub use completion::idle;
pub use device::Gpu;
pub use error::RenderError;
pub use explain::{Explanation, SizesNote};
pub use gpu_record::{RecordLayout, RecordMember};
pub use queues::Capacities;
pub use renderer::{Renderer, Report};
pub use resource_id::ResourceId;

pub use rasterlab_kernels::plan::Note;

use rasterlab_kernels::{plan, shader};
use rasterlab_model::{accuracy, effects, frame, math, measure, scene};
