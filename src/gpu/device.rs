//! Adapters and devices: what is there, what it can do, and one function that opens it for window, command line and tests.

use std::sync::{Arc, atomic::{AtomicBool, Ordering}};

/// Which adapter a person asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum AdapterChoice {
    /// The best there is: discrete before integrated before software.
    #[default]
    Any,
    /// A case-insensitive part of its name.
    Named(String),
}

/// An adapter as shown to people.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct AdapterSummary {
    pub name: String,
    /// `vulkan`, `metal`, `dx12`.
    pub backend: String,
    pub driver: String,
    /// Runs on the CPU: pictures are right, times say nothing about a graphics card.
    pub software: bool,
}

/// What an adapter can do for us.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Caps {
    /// 64-bit atomic maximum on storage buffers: the `packed64` rung.
    pub int64_atomics: bool,
    /// GPU timestamps.
    pub timestamps: bool,
    pub max_storage_binding_bytes: u64,
    pub max_buffer_bytes: u64,
    pub max_texture_side: u32,
    pub software: bool,
}

impl Caps {
    /// `native-int64` or `portable`.
    pub fn class(&self) -> &'static str {
        if self.int64_atomics { "native-int64" } else { "portable" }
    }
}

/// Why no device could be had.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error("no GPU adapter was found; install a Vulkan driver (Debian: mesa-vulkan-drivers) or use --adapter cpu")]
    None,
    #[error("no adapter is called {wanted:?}; there are: {there}")]
    NoMatch { wanted: String, there: String },
    #[error("{wanted:?} names several adapters: {there}")]
    Ambiguous { wanted: String, there: String },
    #[error("{adapter} gave no device: {reason}")]
    Device { adapter: String, reason: String },
}

/// An open device with its queue.
pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub summary: AdapterSummary,
    pub caps: Caps,
    lost: Arc<AtomicBool>,
}

impl Gpu {
    /// Has the device been lost? Then everything made from it is dead.
    pub fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }
}

/// Every adapter with what it can do (STUB).
pub fn list() -> Vec<(AdapterSummary, Caps)> { vec![] }
impl Gpu {
    pub fn open(_choice: &AdapterChoice) -> Result<Arc<Gpu>, OpenError> { Err(OpenError::None) }
    pub fn descriptor(_adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> { wgpu::DeviceDescriptor::default() }
    pub fn adopt(_adapter: &wgpu::Adapter, _device: wgpu::Device, _queue: wgpu::Queue) -> Arc<Gpu> { unimplemented!() }
}
