//! Start and end of the window: the device it runs on, the preset it opens with, and what happens when the device is lost.

use std::{
    path::{Path, PathBuf},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use anyhow::Context as _;
use eframe::{egui, egui_wgpu, wgpu};

use super::{
    App,
    log::{Level, Log},
};
use crate::{
    gpu::{
        Gpu,
        device::{self, AdapterChoice},
    },
    preset::SceneSource,
    preset_file::{self, PresetFile},
};

/// What the window is started with.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// A preset's id or file, a model, a picture of ours, or `builtin:QUERY`.
    pub open: Option<String>,
    pub adapter: AdapterChoice,
    pub presets_dir: Option<PathBuf>,
}

/// The preset of a window that was asked for nothing.
const FIRST_PRESET: &str = "teapot";

/// Lost devices after which nobody tries again.
const MAX_LOSSES: u32 = 2;

/// How a window came to its end, as far as [`run`] must know.
#[derive(Clone, Debug, Default)]
pub(super) struct Ending(Arc<AtomicBool>);

impl Ending {
    pub fn lose(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    pub fn is_lost(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Opens the window and returns when it is closed. A lost device closes it too; then it opens once more on a new
/// device, with the preset as it was.
pub fn run(options: Options) -> anyhow::Result<()> {
    let mut options = options;
    for losses in 0..=MAX_LOSSES {
        let ending = Ending::default();
        let (theirs, opened) = (ending.clone(), options.clone());
        let create = move |cc: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, Box<dyn std::error::Error + Send + Sync>> {
            let mut app = App::with_ending(cc, opened, theirs)?;
            if losses > 0 {
                app.log.tell(Level::Warning, "The graphics device was lost. The window started again, with your preset as it was.", 0.0);
            }
            Ok(Box::new(app))
        };
        let closed = eframe::run_native("rasterlab", native_options(&options.adapter), Box::new(create));
        if !ending.is_lost() {
            return closed.map_err(|error| anyhow::anyhow!("{error}")).context("the window could not be opened");
        }
        options.open = recovery_path().filter(|path| path.exists()).map(|path| path.to_string_lossy().into_owned());
    }
    let place = recovery_path().map_or_else(String::new, |path| format!("; the preset is in {}", path.display()));
    Err(DeviceLost { times: MAX_LOSSES + 1, place }.into())
}

/// The end of a window whose device was lost again and again (exit status 4 of the command line).
#[derive(Debug, thiserror::Error)]
#[error("the graphics device was lost {times} times, so the window stays closed{place}")]
pub struct DeviceLost {
    times: u32,
    place: String,
}

fn native_options(adapter: &AdapterChoice) -> eframe::NativeOptions {
    eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("rasterlab")
            .with_app_id("rasterlab")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([900.0, 600.0])
            .with_drag_and_drop(true),
        wgpu_options: egui_wgpu::WgpuConfiguration { wgpu_setup: wgpu_setup(adapter), ..Default::default() },
        // Dithering would change the bytes that the kernels made.
        dithering: false,
        ..Default::default()
    }
}

/// The device of the window and of its tests: our adapter choice, our features and limits, back ends that run compute.
pub fn wgpu_setup(adapter: &AdapterChoice) -> egui_wgpu::WgpuSetup {
    let mut setup = egui_wgpu::WgpuSetupCreateNew::without_display_handle();
    setup.instance_descriptor.backends &= device::BACKENDS;
    setup.device_descriptor = Arc::new(Gpu::descriptor);
    let choice = adapter.clone();
    setup.native_adapter_selector = Some(Arc::new(move |adapters, surface| select(adapters, surface, &choice)));
    egui_wgpu::WgpuSetup::CreateNew(setup)
}

fn select(adapters: &[wgpu::Adapter], surface: Option<&wgpu::Surface<'_>>, choice: &AdapterChoice) -> Result<wgpu::Adapter, String> {
    let mut fit: Vec<&wgpu::Adapter> = adapters.iter().filter(|a| surface.is_none_or(|s| a.is_surface_supported(s))).collect();
    fit.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    let names: Vec<String> = fit.iter().map(|adapter| adapter.get_info().name).collect();
    device::choose(choice, &names).map(|index| fit[index].clone()).map_err(|error| error.to_string())
}

/// The window's device as ours.
pub fn adopt(cc: &eframe::CreationContext<'_>) -> anyhow::Result<(egui_wgpu::RenderState, Arc<Gpu>)> {
    let window = cc.wgpu_render_state.clone().context("the window has no wgpu device")?;
    let gpu = Gpu::adopt(&window.adapter, window.device.clone(), window.queue.clone());
    Ok((window, gpu))
}

/// Presents without waiting for the display on a software adapter: it is slower than any display. Waiting would also
/// start a thread in the driver that reads X11 events away from the window, which then sleeps through them (seen with
/// lavapipe of Mesa 22.3: a window that no hand could wake).
pub(super) fn tune(frame: &mut eframe::Frame, gpu: &Gpu) {
    if gpu.summary.software
        && let Some(config) = frame.wgpu_surface_config()
    {
        frame.set_wgpu_surface_config(egui_wgpu::SurfaceConfig { present_mode: wgpu::PresentMode::AutoNoVsync, ..config });
    }
}

/// The preset to begin with. One that cannot be opened is reported, and the teapot stands in.
pub(super) fn first_preset(options: &Options, log: &mut Log) -> PresetFile {
    let folder = options.presets_dir.as_deref();
    let wanted = options.open.as_deref().unwrap_or(FIRST_PRESET);
    match preset_file::open(wanted, folder) {
        Ok(mut preset_file) => {
            preset_file.warnings.iter().for_each(|warning| log.add(Level::Warning, warning.clone()));
            // A rescued look belongs somewhere else: Save asks where.
            preset_file.read_only |= preset_file.path.is_some() && preset_file.path == recovery_path();
            preset_file
        }
        Err(error) => {
            if options.open.is_some() {
                log.tell(Level::Error, error.to_string(), 0.0);
            }
            PresetFile::of_scene("teapot", SceneSource::Builtin("teapot".into()))
        }
    }
}

/// Where a preset is kept when the device is lost.
fn recovery_path() -> Option<PathBuf> {
    Some(preset_file::user_folder()?.parent()?.join("recovery.toml"))
}

/// Writes the preset for the next start; says in words what came of it.
pub(super) fn write_recovery(preset_file: &PresetFile) -> String {
    let written = || -> anyhow::Result<PathBuf> {
        let path = recovery_path().context("there is no folder for it")?;
        std::fs::create_dir_all(path.parent().unwrap_or(Path::new(".")))?;
        preset_file::save(&mut preset_file.clone(), &path)?;
        Ok(path)
    };
    match written() {
        Ok(path) => format!("the preset is in {}", path.display()),
        Err(error) => format!("the preset could not be kept: {error:#}"),
    }
}
