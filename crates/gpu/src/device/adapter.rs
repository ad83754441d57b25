//! Adapters and devices: what is there, what it can do, and one way to open it for window, command
//! line and tests.

use std::{
    cell::RefCell,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
};

use super::{memory::DeviceMemory, pipeline_store::PipelineStore, preparations::Preparations};
pub use crate::plan::Caps;

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
    /// `vulkan`, `metal`, `dx12`, `webgpu`.
    pub backend: String,
    pub driver: String,
    /// Runs on the CPU: pictures are right, times say nothing about a graphics card.
    pub software: bool,
}

/// Why no device could be had.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[cfg_attr(target_arch = "wasm32", error("the browser offers no graphics device"))]
    #[cfg_attr(
        not(target_arch = "wasm32"),
        error(
            "no GPU adapter was found; install a Vulkan driver (Debian: mesa-vulkan-drivers) or use --adapter cpu"
        )
    )]
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
    /// What its renderers compiled.
    pub(crate) pipelines: PipelineStore,
    /// What its renderers prepared.
    pub prepared: Preparations,
    /// What its renderers' buffers and textures take.
    pub memory: DeviceMemory,
    lost: Arc<AtomicBool>,
    /// First error that no scope caught.
    error: Arc<Mutex<Option<String>>>,
}

/// The back ends that run our compute shaders.
pub const BACKENDS: wgpu::Backends = wgpu::Backends::VULKAN
    .union(wgpu::Backends::METAL)
    .union(wgpu::Backends::DX12)
    .union(wgpu::Backends::BROWSER_WEBGPU);

fn instance() -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    descriptor.backends &= BACKENDS;
    // Checked indirect dispatches cost a dispatch and two barriers each. Ours are folded and
    // clamped by the kernel that writes them (`shaders/stages/geometry/dispatch_args.wgsl`),
    // and tested past 65,535 workgroups.
    descriptor
        .flags
        .remove(wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL);
    wgpu::Instance::new(descriptor)
}

async fn adapters() -> Vec<wgpu::Adapter> {
    let mut adapters = instance().enumerate_adapters(BACKENDS).await;
    adapters.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    adapters
}

/// Every adapter with what it can do, best first.
pub async fn list() -> Vec<(AdapterSummary, Caps)> {
    adapters()
        .await
        .iter()
        .map(|adapter| (summary(adapter), caps(adapter)))
        .collect()
}

/// Index in `names` (best first) of the adapter that `choice` means.
pub fn choose(choice: &AdapterChoice, names: &[String]) -> Result<usize, OpenError> {
    let there = || names.join(", ");
    let AdapterChoice::Named(wanted) = choice else {
        return if names.is_empty() {
            Err(OpenError::None)
        } else {
            Ok(0)
        };
    };
    let needle = wanted.to_lowercase();
    let matching: Vec<usize> = (0..names.len())
        .filter(|&i| names[i].to_lowercase().contains(&needle))
        .collect();
    match matching[..] {
        [] if names.is_empty() => Err(OpenError::None),
        [] => Err(OpenError::NoMatch {
            wanted: wanted.clone(),
            there: there(),
        }),
        [one] => Ok(one),
        [first, ..] if names[first].to_lowercase() == needle => Ok(first),
        _ => Err(OpenError::Ambiguous {
            wanted: wanted.clone(),
            there: there(),
        }),
    }
}

/// An adapter as shown to people.
pub fn summary(adapter: &wgpu::Adapter) -> AdapterSummary {
    let info = adapter.get_info();
    AdapterSummary {
        name: info.name,
        backend: info.backend.to_string(),
        driver: [info.driver, info.driver_info]
            .into_iter()
            .filter(|s| !s.is_empty())
            .collect::<Vec<_>>()
            .join(" "),
        software: info.device_type == wgpu::DeviceType::Cpu,
    }
}

fn wanted_features(adapter: &wgpu::Adapter) -> wgpu::Features {
    // The smaller of the two 64-bit sets is enough; additions save x-rays time.
    let int64 = wgpu::Features::SHADER_INT64 | wgpu::Features::SHADER_INT64_ATOMIC_MIN_MAX;
    let there = adapter.features();
    let additions = there & wgpu::Features::SHADER_INT64_ATOMIC_ALL_OPS;
    let int64 = if there.contains(int64) {
        int64 | additions
    } else {
        wgpu::Features::empty()
    };
    int64 | (there & wgpu::Features::TIMESTAMP_QUERY)
}

fn caps(adapter: &wgpu::Adapter) -> Caps {
    let (features, limits, info) = (
        wanted_features(adapter),
        wanted_limits(adapter),
        adapter.get_info(),
    );
    Caps {
        int64_atomics: features.contains(wgpu::Features::SHADER_INT64_ATOMIC_MIN_MAX),
        int64_additions: features.contains(wgpu::Features::SHADER_INT64_ATOMIC_ALL_OPS),
        timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
        // Kernels count bytes in 32 bits.
        max_storage_binding_bytes: limits
            .max_storage_buffer_binding_size
            .min(u64::from(u32::MAX)),
        max_buffer_bytes: limits.max_buffer_size,
        max_texture_side: limits.max_texture_dimension_2d,
        max_storage_buffers: limits.max_storage_buffers_per_shader_stage,
        software: info.device_type == wgpu::DeviceType::Cpu,
        slow_atomic_maximum: info.driver.starts_with("SwiftShader"),
    }
}

fn wanted_limits(adapter: &wgpu::Adapter) -> wgpu::Limits {
    let there = adapter.limits();
    wgpu::Limits {
        max_storage_buffer_binding_size: there.max_storage_buffer_binding_size,
        max_buffer_size: there.max_buffer_size,
        max_texture_dimension_2d: there.max_texture_dimension_2d.min(16_384),
        max_storage_buffers_per_shader_stage: there.max_storage_buffers_per_shader_stage.min(16),
        ..wgpu::Limits::default()
    }
}

/// Is called with each device that is opened.
type Watcher = Box<dyn Fn(&wgpu::Device)>;

thread_local! {
    /// Who is told of devices that the thread opens.
    static OPENED: RefCell<Option<Watcher>> = const { RefCell::new(None) };
}

impl Gpu {
    /// Opens an adapter without a window.
    pub async fn open(choice: &AdapterChoice) -> Result<Arc<Self>, OpenError> {
        let adapters = adapters().await;
        let names: Vec<String> = adapters
            .iter()
            .map(|adapter| adapter.get_info().name)
            .collect();
        let adapter = &adapters[choose(choice, &names)?];
        let (device, queue) = adapter
            .request_device(&Self::descriptor(adapter))
            .await
            .map_err(|error| OpenError::Device {
                adapter: adapter.get_info().name,
                reason: error.to_string(),
            })?;
        OPENED.with_borrow(|seen| seen.iter().for_each(|seen| seen(&device)));
        Ok(Self::adopt(adapter, device, queue))
    }

    /// Calls `seen` with every device that this thread opens from now on. Tests lose devices of
    /// commands with it.
    pub fn watch_opened(seen: impl Fn(&wgpu::Device) + 'static) {
        OPENED.set(Some(Box::new(seen)));
    }

    /// What we ask of an adapter: all that helps of what it has, and no more.
    pub fn descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
        wgpu::DeviceDescriptor {
            label: Some("rasterlab"),
            required_features: wanted_features(adapter),
            required_limits: wanted_limits(adapter),
            ..Default::default()
        }
    }

    /// Takes over a device made from [`Self::descriptor`], for instance the window's.
    pub fn adopt(adapter: &wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue) -> Arc<Self> {
        let lost = Arc::new(AtomicBool::new(false));
        let error = Arc::new(Mutex::new(None));
        let flag = lost.clone();
        device.set_device_lost_callback(move |_, _| flag.store(true, Ordering::Relaxed));
        let slot = error.clone();
        device.on_uncaptured_error(Arc::new(move |e: wgpu::Error| {
            slot.lock()
                .unwrap_or_else(|p| p.into_inner())
                .get_or_insert(e.to_string());
        }));
        Arc::new(Self {
            device,
            queue,
            summary: summary(adapter),
            caps: caps(adapter),
            pipelines: PipelineStore::default(),
            prepared: Preparations::default(),
            memory: DeviceMemory::default(),
            lost,
            error,
        })
    }

    /// Has the device been lost? Then everything made from it is dead.
    pub fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }

    /// The first uncaught error since the last call; it means that rasterlab made a mistake.
    pub fn take_error(&self) -> Option<String> {
        self.error.lock().unwrap_or_else(|p| p.into_inner()).take()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choosing_by_name_is_exact_about_what_is_there() {
        let names = [
            "NVIDIA H200".to_owned(),
            "llvmpipe (LLVM 15)".to_owned(),
            "llvmpipe".to_owned(),
        ];
        let named = |n: &str| choose(&AdapterChoice::Named(n.into()), &names);
        assert_eq!(named("h200").unwrap(), 0);
        assert!(matches!(named("pipe"), Err(OpenError::Ambiguous { .. })));
        assert!(matches!(named("swift"), Err(OpenError::NoMatch { .. })));
        assert!(matches!(
            choose(&AdapterChoice::Any, &[]),
            Err(OpenError::None)
        ));
    }
}
