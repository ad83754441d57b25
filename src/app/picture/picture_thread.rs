//! The picture thread: owns a renderer, draws the newest picture that was asked for, compiles what
//! it needs for that, and hands the finished picture to the window. The window never waits for it,
//! and keeps the picture that it has.
//!
//! On a graphics card the thread draws on the window's own device: its texture is what the window
//! shows, and nothing is copied. A CPU adapter compiles a kernel when it is first submitted, and
//! runs all submissions of a device one after another, so a window on the same device can present
//! nothing until kernels are compiled and pictures are drawn (5 to 10 s with a new effect on
//! lavapipe). There the thread draws on a device of its own, and writes the finished bytes to a
//! texture of the window's device: the same memory, copied twice.

use std::{
    future::poll_fn,
    sync::{
        Arc, Condvar, Mutex, MutexGuard,
        atomic::{AtomicBool, AtomicU64, Ordering},
        mpsc,
    },
    task::{Poll, Waker},
    thread::JoinHandle,
    time::Duration,
};

use web_time::Instant;

use super::{
    inputs::Inputs,
    timings::{Sample, has_settled},
};
use crate::{
    accuracy::AccuracyOptions,
    app::{
        jobs::threads,
        shell::{
            device::{Devices, Painter},
            ending::EndingThreads,
        },
    },
    gpu::{
        CompileWatch, Explanation, Gpu, RenderError, Renderer, Report, preparations::Preparation,
    },
    plan::Plan,
};

/// Most redraws of the same inputs. A queue that overflowed has the right size after one or two.
const MAX_REDRAWS: u32 = 6;

/// A frame that takes longer is given up. A CPU adapter compiles many kernels in it.
const PATIENCE: Duration = Duration::from_secs(180);

/// What the thread has finished.
pub struct Finished {
    pub inputs: Inputs,
    pub outcome: Outcome,
}

pub enum Outcome {
    /// A picture, and when it was asked for.
    Drawn(Box<Drawn>, Instant),
    /// Why it could not be drawn, in a sentence for people.
    Refused(String),
    /// Times of the same picture, drawn again.
    Measured(Vec<Sample>),
}

/// A finished picture.
pub struct Drawn {
    /// On the window's device; none for a picture of 0 pixels.
    pub view: Option<wgpu::TextureView>,
    pub size: [u32; 2],
    pub report: Option<Report>,
    pub options: Option<AccuracyOptions>,
    pub plan: Option<Arc<Plan>>,
    pub explanation: Arc<Explanation>,
    /// Something was compiled for it.
    pub is_compiled: bool,
    /// More of it is to come: queues grow, or particles are still simulated.
    pub is_partial: bool,
}

enum Order {
    Draw(Inputs, Instant),
    Measure(Inputs),
}

#[derive(Default)]
struct Orders {
    next: Option<Order>,
    /// What is being drawn.
    current: Option<Inputs>,
    /// The shaders have changed.
    reloads: bool,
    /// The device is to be asked whether it is still there.
    checks: bool,
    ends: bool,
    /// Wakes the thread, which waits for an order.
    waker: Option<Waker>,
}

/// What the window and the thread share.
struct Shared {
    orders: Mutex<Orders>,
    ctx: egui::Context,
    is_compiling: AtomicBool,
    /// Frames dispatched so far.
    draws: AtomicU64,
    /// Tests hold the thread before it compiles.
    is_held: Mutex<bool>,
    released: Condvar,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner())
}

impl Shared {
    /// Changes the orders and wakes the thread.
    fn order(&self, change: impl FnOnce(&mut Orders)) {
        let mut orders = lock(&self.orders);
        change(&mut orders);
        let waker = orders.waker.take();
        drop(orders);
        waker.into_iter().for_each(Waker::wake);
    }

    /// Something is about to be compiled.
    fn begin_compiling(&self) {
        if !self.is_compiling.swap(true, Ordering::Relaxed) {
            self.ctx.request_repaint();
        }
        let mut is_held = lock(&self.is_held);
        while *is_held {
            is_held = self
                .released
                .wait(is_held)
                .unwrap_or_else(|poisoned| poisoned.into_inner());
        }
    }

    fn has_newer(&self) -> bool {
        let orders = lock(&self.orders);
        orders.next.is_some() || orders.reloads || orders.ends
    }

    /// True if another picture was asked for that `inputs` is no step towards: showing it would
    /// show what the user has taken back.
    fn is_outdated(&self, inputs: &Inputs) -> bool {
        matches!(&lock(&self.orders).next, Some(Order::Draw(next, _)) if !next.shares_kernels(inputs))
    }
}

/// The thread, as the window has it.
pub struct PictureThread {
    shared: Arc<Shared>,
    watch: Arc<CompileWatch>,
    sender: mpsc::Sender<Finished>,
    finished: mpsc::Receiver<Finished>,
    is_started: bool,
    handle: Option<JoinHandle<()>>,
    ending: Arc<EndingThreads>,
}

impl PictureThread {
    /// Starts a thread that draws on the devices of a window. When it is dropped, `ending` gets it.
    pub fn start(devices: Devices, ctx: egui::Context, ending: Arc<EndingThreads>) -> Self {
        let shared = Arc::new(Shared {
            orders: Mutex::default(),
            ctx,
            is_compiling: AtomicBool::new(false),
            draws: AtomicU64::new(0),
            is_held: Mutex::new(false),
            released: Condvar::new(),
        });
        let watched = shared.clone();
        let watch = Arc::new(CompileWatch::new(move || watched.begin_compiling()));
        let (sender, finished) = mpsc::channel();
        let Devices {
            picture: gpu,
            window,
            painter,
        } = devices;
        let (own, watching) = (shared.clone(), watch.clone());
        let worker = Worker {
            shared: own,
            watch: watching,
            sender: sender.clone(),
            gpu,
            window,
            painter,
            texture: None,
            renderer: None,
        };
        let started = threads::start("picture", move || worker.run());
        Self {
            shared,
            watch,
            sender,
            finished,
            is_started: started.is_ok(),
            handle: started.ok().flatten(),
            ending,
        }
    }

    /// Draws this picture, which was asked for at `asked_at`, instead of any that was asked for and
    /// is not begun.
    pub fn draw(&self, inputs: Inputs, asked_at: Instant) {
        if !self.is_started {
            let outcome = Outcome::Refused(
                "no thread could be started for the picture; the system has no room for one".into(),
            );
            // The receiver lives as long as `self`.
            return drop(self.sender.send(Finished { inputs, outcome }));
        }
        self.shared.order(|orders| {
            let current = orders.current.as_ref();
            if current.is_some_and(|current| !current.shares_kernels(&inputs)) {
                self.watch.stop();
            }
            orders.next = Some(Order::Draw(inputs, asked_at));
        });
    }

    /// Draws the newest picture again, as often as it takes to know its cost, unless another is
    /// asked for.
    pub fn measure(&self, inputs: Inputs) {
        self.shared.order(|orders| {
            orders.next.get_or_insert(Order::Measure(inputs));
        });
    }

    /// Draws the next picture with the shaders as they are now.
    pub fn reload_shaders(&self) {
        self.shared.order(|orders| {
            orders.reloads = true;
            self.watch.stop();
        });
    }

    /// Asks the device whether it is still there, if the thread has nothing else to do.
    pub fn check_device(&self) {
        self.shared.order(|orders| orders.checks = true);
    }

    pub fn next(&self) -> Option<Finished> {
        self.finished.try_recv().ok()
    }

    /// True while something is compiled for the next picture.
    pub fn is_compiling(&self) -> bool {
        self.shared.is_compiling.load(Ordering::Relaxed)
    }

    /// Number of frames dispatched so far.
    pub fn draws(&self) -> u64 {
        self.shared.draws.load(Ordering::Relaxed)
    }

    /// Holds the thread when it is next about to compile, or lets it go on.
    pub fn hold_compiling(&self, is_held: bool) {
        *lock(&self.shared.is_held) = is_held;
        self.shared.released.notify_all();
    }
}

impl Drop for PictureThread {
    fn drop(&mut self) {
        self.shared.order(|orders| {
            orders.ends = true;
            self.watch.stop();
        });
        self.hold_compiling(false);
        if let Some(handle) = self.handle.take() {
            self.ending.add(handle);
        }
    }
}

/// The thread's own side.
struct Worker {
    shared: Arc<Shared>,
    watch: Arc<CompileWatch>,
    sender: mpsc::Sender<Finished>,
    /// Draws.
    gpu: Arc<Gpu>,
    /// Shows.
    window: Arc<Gpu>,
    painter: Painter,
    /// What the window shows, where it is on another device.
    texture: Option<(wgpu::Texture, wgpu::TextureView)>,
    renderer: Option<Renderer>,
}

/// Waits until the device has finished the newest frame; none after a long time, or as soon as it
/// `is_wanted` no more.
///
/// The device may be the window's, and a wait inside of it would hold the window's submissions up.
pub async fn wait_for_frame(
    renderer: &mut Renderer,
    is_wanted: impl Fn() -> bool,
) -> Result<Option<Report>, RenderError> {
    let begun = Instant::now();
    while renderer.is_pending() {
        match renderer.report() {
            Some(report) if !renderer.is_pending() => return Ok(Some(report)),
            _ if renderer.gpu().is_lost() => return Err(RenderError::Lost),
            _ if begun.elapsed() > PATIENCE || !is_wanted() => return Ok(None),
            _ => {
                let is_young = begun.elapsed() < Duration::from_millis(20);
                threads::pause(Duration::from_micros(if is_young { 250 } else { 1000 })).await;
            }
        }
    }
    Ok(None)
}

impl Worker {
    async fn run(mut self) {
        while let Some(order) = self.wait_for_order().await {
            let (Order::Draw(inputs, _) | Order::Measure(inputs)) = &order;
            let inputs = inputs.clone();
            let work = async {
                match order {
                    Order::Draw(inputs, asked_at) => self.draw(&inputs, asked_at).await,
                    Order::Measure(inputs) => self.measure(&inputs).await,
                }
            };
            // A panic becomes an error, so that the window does not wait for a picture that never
            // comes.
            if threads::caught(work).await.is_err() {
                self.renderer = None;
                let text =
                    "drawing the picture failed because of a bug; see the terminal for details";
                self.finish(&inputs, Outcome::Refused(text.into()));
            }
            self.shared.is_compiling.store(false, Ordering::Relaxed);
        }
    }

    /// The next thing to do; none when the window closes.
    async fn wait_for_order(&mut self) -> Option<Order> {
        let shared = self.shared.clone();
        lock(&shared.orders).current = None;
        poll_fn(|context| {
            let mut orders = lock(&shared.orders);
            if orders.ends {
                return Poll::Ready(None);
            }
            if std::mem::take(&mut orders.reloads) {
                self.renderer = None;
            }
            if let Some(order) = orders.next.take() {
                let (Order::Draw(inputs, _) | Order::Measure(inputs)) = &order;
                orders.current = Some(inputs.clone());
                self.watch.allow();
                return Poll::Ready(Some(order));
            }
            if std::mem::take(&mut orders.checks) {
                let _ = self.gpu.device.poll(wgpu::PollType::Poll);
                if self.gpu.is_lost() {
                    shared.ctx.request_repaint();
                }
            }
            orders.waker = Some(context.waker().clone());
            Poll::Pending
        })
        .await
    }

    /// Hands something to the window. The window may be closed by now; then it is dropped.
    fn finish(&self, inputs: &Inputs, outcome: Outcome) {
        self.shared.is_compiling.store(false, Ordering::Relaxed);
        if self
            .sender
            .send(Finished {
                inputs: inputs.clone(),
                outcome,
            })
            .is_ok()
        {
            self.shared.ctx.request_repaint();
        }
    }

    /// Draws a picture, and again if a queue had overflowed and has grown, or while its particles
    /// lag behind.
    async fn draw(&mut self, inputs: &Inputs, asked_at: Instant) {
        for redraws in 0.. {
            let drawn = match self.picture(inputs).await {
                Ok(drawn) => drawn,
                Err(RenderError::Stopped) => return,
                Err(error) => return self.finish(inputs, Outcome::Refused(error.to_string())),
            };
            let Some(mut drawn) = drawn else { return };
            let is_pending = drawn
                .report
                .as_ref()
                .is_some_and(|report| report.simulation_pending);
            let is_incomplete =
                drawn.report.as_ref().is_some_and(|report| report.redraw) && redraws < MAX_REDRAWS;
            drawn.is_partial = is_pending || is_incomplete;
            let is_partial = drawn.is_partial;
            self.finish(inputs, Outcome::Drawn(drawn.into(), asked_at));
            if !is_partial || self.shared.has_newer() {
                return;
            }
        }
    }

    /// One frame, as the window shows it; none if the user has taken it back.
    async fn picture(&mut self, inputs: &Inputs) -> Result<Option<Drawn>, RenderError> {
        let (report, is_compiled) = self.frame(inputs).await?;
        self.drawn(inputs, report, is_compiled).await
    }

    /// Draws a picture again until its time has settled.
    async fn measure(&mut self, inputs: &Inputs) {
        let mut samples = Vec::new();
        while !has_settled(&samples) {
            if self.shared.has_newer() {
                return;
            }
            match self.frame(inputs).await {
                Ok((report, _)) => match report.as_ref().and_then(Sample::of) {
                    Some(sample) => samples.push(sample),
                    None => break,
                },
                Err(_) => break,
            }
        }
        self.finish(inputs, Outcome::Measured(samples));
    }

    /// Dispatches one frame and waits until the device has finished it; true if something was
    /// compiled for it.
    async fn frame(
        &mut self,
        Inputs {
            scene,
            view,
            stack,
            accuracy,
        }: &Inputs,
    ) -> Result<(Option<Report>, bool), RenderError> {
        if self.painter == Painter::Plain {
            self.shared.draws.fetch_add(1, Ordering::Relaxed);
            return Ok((None, false));
        }
        let (gpu, watch) = (&self.gpu, &self.watch);
        let renderer = self.renderer.get_or_insert_with(|| {
            let mut renderer = Renderer::new(gpu.clone());
            renderer.watch_compiling(watch.clone());
            renderer
        });
        let compiled = renderer.compiled();
        renderer.set_scene(scene).await?;
        renderer.draw(view, stack, accuracy).await?;
        self.shared.draws.fetch_add(1, Ordering::Relaxed);
        let is_compiled = renderer.compiled() > compiled;
        Ok((wait_for_frame(renderer, || true).await?, is_compiled))
    }

    /// The picture of the newest frame, for the window; none if the user has taken it back.
    async fn drawn(
        &mut self,
        inputs: &Inputs,
        report: Option<Report>,
        is_compiled: bool,
    ) -> Result<Option<Drawn>, RenderError> {
        if self.shared.is_outdated(inputs) {
            return Ok(None);
        }
        let size = [inputs.view.width, inputs.view.height];
        if self.painter == Painter::Plain {
            let view = (inputs.view.pixels() > 0)
                .then(|| self.upload(&vec![[90, 90, 90, 255]; inputs.view.pixels()], size));
            let explanation = Arc::default();
            return Ok(Some(Drawn {
                view,
                size,
                report,
                options: None,
                plan: None,
                explanation,
                is_compiled,
                is_partial: false,
            }));
        }
        let Some(renderer) = &mut self.renderer else {
            return Err(RenderError::NoScene);
        };
        let (options, plan, explanation) = (
            renderer.key().map(|key| key.options),
            renderer.plan().cloned(),
            renderer.explained(),
        );
        let view = if Arc::ptr_eq(&self.gpu, &self.window) {
            renderer.texture_view().cloned()
        } else {
            let shown = renderer.read_shown().await?;
            shown.map(|pixels| self.upload(&pixels, size))
        };
        Ok(Some(Drawn {
            view,
            size,
            report,
            options,
            plan,
            explanation,
            is_compiled,
            is_partial: false,
        }))
    }

    /// Writes pixels to a texture of the window's device.
    fn upload(&mut self, pixels: &[[u8; 4]], [width, height]: [u32; 2]) -> wgpu::TextureView {
        let size = wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers: 1,
        };
        let (device, drawing) = (&self.window.device, &self.gpu);
        let (texture, view) = self
            .texture
            .take()
            .filter(|(texture, _)| texture.size() == size)
            .unwrap_or_else(|| {
                drawing.prepared.count(Preparation::Texture);
                let texture = device.create_texture(&wgpu::TextureDescriptor {
                    label: Some("picture"),
                    size,
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format: wgpu::TextureFormat::Rgba8Unorm,
                    usage: wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::TEXTURE_BINDING,
                    view_formats: &[],
                });
                let view = texture.create_view(&Default::default());
                (texture, view)
            });
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: None,
        };
        self.window.queue.write_texture(
            texture.as_image_copy(),
            bytemuck::cast_slice(pixels),
            layout,
            size,
        );
        self.texture = Some((texture, view.clone()));
        view
    }
}
