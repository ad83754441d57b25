//! The window without a display: the whole app in a harness that sends pointer and key events, on
//! the adapter under test.

use std::{
    cell::Cell,
    iter,
    ops::{Deref, DerefMut},
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
    time::{Duration, Instant},
};

use egui::{
    Event, Key, Modifiers, Pos2, Rect, Role, TexturesDelta, ThemePreference, accesskit::Toggled,
    mutex::RwLock,
};
use egui_kittest::{
    Harness, Node, TestRenderer,
    kittest::{NodeT as _, Queryable as _},
};
use egui_wgpu::{RenderState, RendererOptions, ScreenDescriptor, WgpuConfiguration};
use rasterlab::{
    app::{App, Devices, Options, Painter, wgpu_setup},
    gpu::{Gpu, device::AdapterChoice},
    preset_file::Folders,
};

/// The app in a harness, and the device that draws it.
pub struct Lab {
    harness: Harness<'static, App>,
    window: RenderState,
}

impl Deref for Lab {
    type Target = Harness<'static, App>;

    fn deref(&self) -> &Self::Target {
        &self.harness
    }
}

impl DerefMut for Lab {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.harness
    }
}

/// Hands the app its device, and the device the textures of the app.
struct Window(RenderState);

impl TestRenderer for Window {
    fn setup_eframe(&self, cc: &mut eframe::CreationContext<'_>, frame: &mut eframe::Frame) {
        cc.wgpu_render_state = Some(self.0.clone());
        frame.wgpu_render_state = Some(self.0.clone());
    }

    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        let mut renderer = self.0.renderer.write();
        for (id, images) in delta.set.drain() {
            images.iter().for_each(|image| {
                renderer.update_texture(&self.0.device, &self.0.queue, id, image)
            });
        }
        delta.free.drain().for_each(|id| renderer.free_texture(&id));
    }
}

thread_local! {
    static PAINTER: Cell<Painter> = const { Cell::new(Painter::Plain) };
}

/// From here on the windows of this test show what the rasterizer draws. Those of other tests are
/// gray, at once.
pub fn draw_pictures() {
    PAINTER.set(Painter::Kernels);
}

/// The devices that all windows of this program share, with the pipelines that were compiled for
/// it: compiling them for each window would take most of the time of its test.
fn shared_devices(adapter: &AdapterChoice) -> (RenderState, Devices) {
    static SHARED: OnceLock<(RenderState, Devices)> = OnceLock::new();
    let (first, devices) = SHARED.get_or_init(|| {
        let window = device(adapter);
        let gpu = Gpu::adopt(&window.adapter, window.device.clone(), window.queue.clone());
        (window, Devices::of(gpu))
    });
    // Textures belong to one window.
    let renderer = egui_wgpu::Renderer::new(
        &first.device,
        first.target_format,
        RendererOptions::PREDICTABLE,
    );
    (
        RenderState {
            renderer: Arc::new(RwLock::new(renderer)),
            ..first.clone()
        },
        Devices {
            painter: PAINTER.get(),
            ..devices.clone()
        },
    )
}

/// A device without a surface, opened with the program's settings.
fn device(adapter: &AdapterChoice) -> RenderState {
    let setup = wgpu_setup(adapter);
    let instance = pollster::block_on(setup.new_instance());
    let configuration = WgpuConfiguration {
        wgpu_setup: setup,
        ..Default::default()
    };
    let state = RenderState::create(
        &configuration,
        &instance,
        None,
        RendererOptions::PREDICTABLE,
    );
    pollster::block_on(state).unwrap_or_else(|error| panic!("{error}"))
}

impl Lab {
    /// Hands the device what was written to it, as each frame of a window on a screen does.
    pub fn submit(&self) {
        self.window.queue.submit([]);
        self.window
            .device
            .poll(wgpu::PollType::Poll)
            .expect("the device is there");
    }

    /// What the window shows.
    pub fn screenshot(&mut self) -> image::RgbaImage {
        let RenderState {
            device,
            queue,
            target_format,
            renderer,
            ..
        } = &self.window;
        let (context, output) = (&self.harness.ctx, self.harness.output());
        let scale = context.pixels_per_point();
        let [width, height] =
            <[f32; 2]>::from(context.content_rect().size() * scale).map(|side| side.round() as u32);
        let screen = ScreenDescriptor {
            size_in_pixels: [width, height],
            pixels_per_point: scale,
        };
        let meshes = context.tessellate(output.shapes.clone(), scale);
        let target = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("screenshot"),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: *target_format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let row = 4 * width;
        assert_eq!(
            row % wgpu::COPY_BYTES_PER_ROW_ALIGNMENT,
            0,
            "rows of {width} pixels would need padding"
        );
        let staging = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("screenshot"),
            size: u64::from(row * height),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });

        let mut renderer = renderer.write();
        let mut encoder = device.create_command_encoder(&Default::default());
        let before = renderer.update_buffers(device, queue, &mut encoder, &meshes, &screen);
        let view = target.create_view(&Default::default());
        let attachment = wgpu::RenderPassColorAttachment {
            view: &view,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Store,
            },
            depth_slice: None,
        };
        let pass = wgpu::RenderPassDescriptor {
            label: Some("screenshot"),
            color_attachments: &[Some(attachment)],
            ..Default::default()
        };
        renderer.render(
            &mut encoder.begin_render_pass(&pass).forget_lifetime(),
            &meshes,
            &screen,
        );
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(row),
            rows_per_image: None,
        };
        let to = wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout,
        };
        encoder.copy_texture_to_buffer(target.as_image_copy(), to, target.size());
        queue.submit(before.into_iter().chain(iter::once(encoder.finish())));

        staging.map_async(wgpu::MapMode::Read, .., |result| {
            result.expect("a screenshot is read")
        });
        let patience = wgpu::PollType::Wait {
            submission_index: None,
            timeout: Some(Duration::from_secs(60)),
        };
        device
            .poll(patience)
            .expect("a screenshot is drawn within a minute");
        let bytes = staging
            .get_mapped_range(..)
            .expect("a screenshot is read")
            .to_vec();
        image::RgbaImage::from_raw(width, height, bytes).expect("four bytes for each pixel")
    }
}

/// A window of 1280 x 800 that shows the preset `open`, with its first picture drawn; presets lie
/// in `presets_dir`. It keeps no settings.
pub fn lab_in(open: &str, presets_dir: Option<&Path>) -> Option<Lab> {
    lab_with(
        open,
        Folders {
            presets: presets_dir.map(Path::to_owned),
            ..Folders::default()
        },
    )
}

/// A window that shows the preset `open` and has these folders.
pub fn lab_with(open: &str, folders: Folders) -> Option<Lab> {
    let mut lab = created(Some(open), folders, None, SIZE)?;
    settle(&mut lab);
    Some(lab)
}

/// A window of 1280 x 800 as it is created, before its first frame; without `open` as the program
/// starts. It keeps no settings.
pub fn opened(open: Option<&str>, presets_dir: Option<&Path>) -> Option<Lab> {
    created(
        open,
        Folders {
            presets: presets_dir.map(Path::to_owned),
            ..Folders::default()
        },
        None,
        SIZE,
    )
}

/// Size of a window in points, unless a test says otherwise.
pub const SIZE: [f32; 2] = [1280.0, 800.0];

/// A window of `size` with these folders that keeps its settings and session in the folder
/// `config`, before its first frame.
pub fn created(
    open: Option<&str>,
    folders: Folders,
    config: Option<PathBuf>,
    size: [f32; 2],
) -> Option<Lab> {
    crate::common::gpu()?; // Fails with one sentence when there is none.
    let adapter =
        std::env::var("RASTERLAB_ADAPTER").map_or(AdapterChoice::Any, AdapterChoice::Named);
    let (window, devices) = shared_devices(&adapter);
    Some(built(
        open,
        folders,
        (config, size),
        None,
        adapter,
        (window, Some(devices)),
    ))
}

/// A window on devices for which nothing has been compiled yet, with its first picture drawn.
pub fn lab_on_new_devices(open: &str) -> Option<Lab> {
    crate::common::gpu()?;
    let adapter =
        std::env::var("RASTERLAB_ADAPTER").map_or(AdapterChoice::Any, AdapterChoice::Named);
    let window = device(&adapter);
    let mut lab = built(
        Some(open),
        Folders::default(),
        (None, SIZE),
        None,
        adapter,
        (window, None),
    );
    settle(&mut lab);
    Some(lab)
}

fn built(
    open: Option<&str>,
    folders: Folders,
    (config, size): (Option<PathBuf>, [f32; 2]),
    log: Option<Arc<std::fs::File>>,
    adapter: AdapterChoice,
    (window, devices): (RenderState, Option<Devices>),
) -> Lab {
    let options = Options {
        open: open.map(str::to_owned),
        adapter,
        devices,
        folders,
        config,
        log,
        ..Options::default()
    };
    let mut theme = ThemePreference::default();
    let harness = Harness::builder()
        .with_size(size)
        .renderer(Window(window.clone()))
        .build_eframe(|cc| {
            let app = App::new(cc, options).unwrap_or_else(|error| panic!("{error:#}"));
            theme = cc.egui_ctx.options(|options| options.theme_preference);
            app
        });
    harness.ctx.set_theme(theme); // The harness has put its own in place of the window's.
    Lab { harness, window }
}

/// A window with the program's own presets.
pub fn lab(open: &str) -> Option<Lab> {
    lab_in(open, None)
}

/// Steps until `is_so`. The window's own clock moves by a quarter of a second with each step,
/// however long that takes; this asks for the real time only to end a test that waits for what
/// never comes, and so that threads which the window waits for get the processors.
pub fn wait_until(lab: &mut Lab, what: &str, mut is_so: impl FnMut(&Lab) -> bool) {
    // A window that is compiling shares two processors with the other tests.
    let patience = Instant::now() + Duration::from_secs(300);
    loop {
        let start = Instant::now();
        lab.step();
        if is_so(lab) {
            break;
        }
        assert!(
            Instant::now() < patience,
            "waited in vain until {what}\n{}",
            lab.state().log_text()
        );
        let pause = start.elapsed();
        std::thread::sleep(pause.clamp(Duration::from_millis(2), Duration::from_millis(50)));
    }
}

/// Steps until pictures, reports and thumbnails have arrived, and then until every undo step is
/// closed.
pub fn settle(lab: &mut Lab) {
    wait_until(lab, "the window comes to rest", |lab| lab.state().is_idle());
    lab.run_steps(3);
    lab.check_accessibility();
}

/// Drags from one position to another in several moves.
pub fn drag(lab: &mut Lab, from: Pos2, to: Pos2) {
    lab.hover_at(from);
    lab.step();
    lab.drag_at(from);
    lab.step();
    for i in 1..=8 {
        lab.hover_at(from + (to - from) * (i as f32 / 8.0));
        lab.step();
    }
    lab.drop_at(to);
    lab.step();
    settle(lab);
}

/// Is a box ticked, or an entry of a list selected?
pub fn is_on(node: &Node<'_>) -> bool {
    node.accesskit_node().toggled() == Some(Toggled::True)
}

pub fn slider<'a>(lab: &'a Lab, path: &'a str) -> Node<'a> {
    lab.get_by_role_and_label(Role::Slider, path)
}

pub fn has_slider(lab: &Lab, path: &str) -> bool {
    lab.query_by_role_and_label(Role::Slider, path).is_some()
}

pub fn press(lab: &mut Lab, modifiers: Modifiers, key: Key) {
    lab.key_press_modifiers(modifiers, key);
    lab.run_steps(4);
    settle(lab);
}

pub fn undo(lab: &mut Lab) {
    press(lab, Modifiers::COMMAND, Key::Z);
}

pub fn click(lab: &mut Lab, role: Role, label: &str) {
    // A long panel shows it only after scrolling.
    lab.get_by_role_and_label(role, label).scroll_to_me();
    lab.run_steps(3);
    lab.get_by_role_and_label(role, label).click();
    lab.run_steps(3);
    settle(lab);
}

/// Chooses `entry` of the menu of this name.
pub fn choose(lab: &mut Lab, menu: &str, entry: &str) {
    click(lab, Role::ComboBox, menu);
    click(lab, Role::Button, entry);
}

pub fn type_text(lab: &mut Lab, text: &str) {
    lab.event(Event::Text(text.into()));
    lab.run_steps(3);
}

pub fn paste(lab: &mut Lab, text: &str) {
    lab.event(Event::Paste(text.into()));
    lab.run_steps(3);
    settle(lab);
}

/// Steps until `reached`, and then until everything is at rest.
pub fn wait_for(lab: &mut Lab, what: &str, reached: impl Fn(&Lab) -> bool) {
    let patience = Instant::now() + Duration::from_secs(60);
    while !reached(lab) {
        lab.step();
        assert!(
            Instant::now() < patience,
            "{what}: it did not happen\n{}",
            lab.state().log_text()
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    settle(lab);
}

/// Adds an effect with the dialog *Add effect*, without waiting for its picture.
pub fn begin_adding(lab: &mut Lab, effect: &str) {
    lab.key_press_modifiers(Modifiers::SHIFT, Key::A);
    lab.run_steps(3);
    lab.event(Event::Text(effect.into()));
    lab.run_steps(2);
    lab.key_press_modifiers(Modifiers::NONE, Key::Enter);
    lab.run_steps(2);
}

/// Adds an effect with the dialog *Add effect*.
pub fn add_effect(lab: &mut Lab, effect: &str) {
    begin_adding(lab, effect);
    settle(lab);
}

/// A parameter of an enabled effect.
pub fn value(lab: &Lab, effect: &str, field: &str) -> Vec<f64> {
    let enabled = lab
        .state()
        .preset_file()
        .preset
        .stack
        .get(effect)
        .unwrap_or_else(|| panic!("{effect} is not enabled"));
    enabled
        .effect
        .field(field)
        .expect("a field of the effect")
        .get(&enabled.words)
}

/// The lab with `text` as its preset.
pub fn lab_of(folder: &Path, text: &str) -> Option<Lab> {
    let path = folder.join("mine.toml");
    std::fs::write(&path, text).expect("a file");
    lab(&path.to_string_lossy())
}

/// A preset whose facets rise and fall, and jump.
pub const MOVING: &str = "schema = 2\n[scene]\nbuiltin = \"knot?tess=4\"\n[effects.facet]\n[effects.lambert]\n[animation.facet]\n\
    amount = [{ time_s = 0.0, value = 0.0 }, { time_s = 1.0, value = 1.0 }, { time_s = 3.0, value = 0.25 }]\n\
    pattern = [{ time_s = 0.5, value = \"sweep\" }, { time_s = 2.0, value = \"uniform\" }]\n\
    [animation.lambert]\nsun = [{ time_s = 0.0, value = [1, 1, 1, 1] }, { time_s = 4.0, value = [1, 0, 0, 1] }]\n";

/// A parameter of an enabled effect, at the time that is shown.
pub fn shown(lab: &Lab, effect: &str, field: &str) -> Vec<f64> {
    let stack = lab
        .state()
        .preset_file()
        .preset
        .stack_at(lab.state().shown_time_s());
    let enabled = stack
        .get(effect)
        .unwrap_or_else(|| panic!("{effect} is not enabled"));
    enabled
        .effect
        .field(field)
        .expect("a field of the effect")
        .get(&enabled.words)
}

pub fn key_times(lab: &Lab, effect: &str, field: &str) -> Vec<f64> {
    let track = lab
        .state()
        .preset_file()
        .preset
        .animation
        .get(effect, field);
    track.map_or(Vec::new(), |track| {
        track.keys().iter().map(|key| key.time_s).collect()
    })
}

/// Drags the playhead from one fraction of the ruler to another.
pub fn scrub(lab: &mut Lab, from: f32, to: f32) {
    let ruler = lab.get_by_role_and_label(Role::Slider, "Timeline").rect();
    let at = |t: f32| Pos2::new(ruler.left() + t * ruler.width(), ruler.center().y);
    drag(lab, at(from), at(to));
}

/// The pixels of the view, as the window shows them.
pub fn picture(lab: &mut Lab) -> image::RgbaImage {
    let Rect { min, max } = lab.get_by_label("Picture").rect();
    let window = lab.screenshot();
    let [x, y, width, height] =
        [min.x, min.y, max.x - min.x, max.y - min.y].map(|v| v.round() as u32);
    image::imageops::crop_imm(&window, x, y, width, height).to_image()
}

pub fn error_lines(lab: &Lab) -> Vec<String> {
    lab.state()
        .log_text()
        .lines()
        .filter(|line| line.starts_with("error"))
        .map(str::to_owned)
        .collect()
}

/// Steps until no toast lies over the picture.
pub fn wait_for_toasts(lab: &mut Lab) {
    while lab.state().shows_toasts() {
        lab.step();
    }
}

/// Is this pixel of the picture clear of the buttons over its top and of the ball in its corner
/// that turns the light?
pub fn is_clear(picture: &image::RgbaImage, x: u32, y: u32) -> bool {
    y >= 48 && (x + 96 < picture.width() || y + 96 < picture.height())
}

/// The middle of the picture, clear of everything that lies over its borders.
pub fn middle(lab: &mut Lab) -> image::RgbaImage {
    lab.remove_cursor();
    wait_for_toasts(lab);
    lab.run_steps(2);
    let whole = picture(lab);
    image::imageops::crop_imm(&whole, 0, 48, whole.width(), whole.height() - 208).to_image()
}

/// Removes what a test has deleted in `folder` from the trash of the system, where that can be
/// listed.
#[cfg(any(windows, target_os = "linux"))]
pub fn remove_from_trash(folder: &Path) {
    let folder = folder.canonicalize().expect("a folder");
    let own: Vec<_> = trash::os_limited::list()
        .expect("a trash")
        .into_iter()
        .filter(|item| item.original_parent == folder)
        .collect();
    assert!(!own.is_empty(), "what was deleted is in the trash");
    trash::os_limited::purge_all(own).expect("a trash");
}

#[cfg(not(any(windows, target_os = "linux")))]
pub fn remove_from_trash(_folder: &Path) {}
