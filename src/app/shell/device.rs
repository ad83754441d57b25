//! The devices of the window: how they are opened, and how the window presents.

use std::sync::{Arc, Mutex, PoisonError};

use anyhow::Context as _;
use pollster::FutureExt as _;

use crate::gpu::{
    Gpu,
    device::{self, AdapterChoice, OpenError},
};

/// How the window and its tests open their device: the chosen adapter, the features and limits that
/// the kernels need, and back ends that run compute.
pub fn wgpu_setup(adapter: &AdapterChoice) -> egui_wgpu::WgpuSetup {
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.instance_descriptor.backends &= device::BACKENDS;
    setup.device_descriptor = Arc::new(Gpu::descriptor);
    let choice = adapter.clone();
    setup.native_adapter_selector = Some(Arc::new(move |adapters, surface| {
        select(adapters, surface, &choice)
    }));
    egui_wgpu::WgpuSetup::CreateNew(setup)
}

fn select(
    adapters: &[wgpu::Adapter],
    surface: Option<&wgpu::Surface<'_>>,
    choice: &AdapterChoice,
) -> Result<wgpu::Adapter, String> {
    let mut suitable: Vec<&wgpu::Adapter> = adapters
        .iter()
        .filter(|a| surface.is_none_or(|s| a.is_surface_supported(s)))
        .collect();
    suitable.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    let names: Vec<String> = suitable
        .iter()
        .map(|adapter| adapter.get_info().name)
        .collect();
    device::choose(choice, &names)
        .map(|index| suitable[index].clone())
        .map_err(|error| {
            let sentence = error.to_string();
            *REFUSED.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
            sentence
        })
}

/// Why no adapter was chosen, which eframe passes on as a text alone.
pub static REFUSED: Mutex<Option<OpenError>> = Mutex::new(None);

/// The window's devices, for the kernels; `devices` if they are known from another window on the
/// same device.
///
/// # Errors
/// If the window has no wgpu device.
pub fn adopt(
    cc: &eframe::CreationContext<'_>,
    devices: Option<Devices>,
) -> anyhow::Result<(egui_wgpu::RenderState, Devices)> {
    let window = cc
        .wgpu_render_state
        .clone()
        .context("the window has no wgpu device")?;
    let adopted = || {
        let gpu = Gpu::adopt(&window.adapter, window.device.clone(), window.queue.clone());
        #[cfg(target_arch = "wasm32")]
        let gpu = named(gpu);
        gpu
    };
    let devices = devices.unwrap_or_else(|| Devices::of(adopted()));
    Ok((window, devices))
}

/// The device with the name that the page knows, where wgpu knows none.
#[cfg(target_arch = "wasm32")]
fn named(mut gpu: Arc<Gpu>) -> Arc<Gpu> {
    if let Some(new) = Arc::get_mut(&mut gpu)
        && new.summary.name.is_empty()
    {
        new.summary.name = super::page::adapter_name().unwrap_or_else(|| "WebGPU".into());
    }
    gpu
}

/// The device that shows pictures, and the one that draws them.
#[derive(Clone)]
pub struct Devices {
    /// egui's, too.
    pub window: Arc<Gpu>,
    /// The same on a graphics card. On a CPU adapter it is a second one, because compiling and
    /// drawing keep everything waiting that is submitted to the same device, the window's own
    /// frames included.
    pub picture: Arc<Gpu>,
    pub painter: Painter,
}

/// What paints the picture of a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Painter {
    /// The rasterizer.
    Kernels,
    /// Nothing: every picture is gray, at once. For tests of what lies round the picture.
    Plain,
}

impl Devices {
    /// The devices for a window on `window`. Without a second device the first draws, too.
    pub fn of(window: Arc<Gpu>) -> Self {
        let choice = AdapterChoice::Named(window.summary.name.clone());
        let opened = || Gpu::open(&choice).block_on().ok();
        let second = if window.summary.software && cfg!(not(target_arch = "wasm32")) {
            opened()
        } else {
            None
        };
        Self {
            picture: second.unwrap_or_else(|| window.clone()),
            window,
            painter: Painter::Kernels,
        }
    }
}

/// Presents without waiting for the display on a software adapter, which is slower than any
/// display. Waiting would also start a thread in the driver that takes X11 events away from the
/// window, which then does not react to them (seen with lavapipe of Mesa 22.3).
pub fn tune(frame: &mut eframe::Frame, gpu: &Gpu) {
    if gpu.summary.software
        && let Some(config) = frame.wgpu_surface_config()
    {
        frame.set_wgpu_surface_config(egui_wgpu::SurfaceConfig {
            present_mode: wgpu::PresentMode::AutoNoVsync,
            ..config
        });
    }
}
