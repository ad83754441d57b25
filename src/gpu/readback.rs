//! From the device back to plain data: the counters of every frame a little later, whole pictures on demand.

use std::sync::{
    Arc,
    atomic::{AtomicBool, Ordering},
};

use super::{
    Demand, Gpu, RenderError, Renderer, STORAGE, buffers,
    deforms::DEFORMED_BYTES,
    dots::first_dot_word,
    prepare::record_count,
    timer::{Detail, Timer, Times},
    uniforms::OrderRecord,
};
use crate::{
    accuracy::{Culling, DepthFormat, PositionFormat, VertexTransform, XraySums},
    effects::{Stack, hooks::Layers},
    frame::{AdapterPicture, ClippedTriangle, Counters, Exactness, Frame, Geometry, SnappedVertex},
    plan::AccuracyRequest,
    scene::view::View,
    shader::{
        key::{FramebufferLayout, KernelKey},
        pass::RasterPhase,
    },
};

/// Counters and stamps of a frame in flight.
pub struct Pending {
    staging: wgpu::Buffer,
    labels: Vec<String>,
    ready: Arc<AtomicBool>,
}

const COUNTER_BYTES: u64 = size_of::<Demand>() as u64;
const ORDER_BYTES: u64 = size_of::<OrderRecord>() as u64;
const FIGURE_BYTES: u64 = 2 * COUNTER_BYTES + ORDER_BYTES;

impl Pending {
    /// Records the copies that end a frame.
    pub fn stage(
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        [counters, light, order]: [Option<&wgpu::Buffer>; 3],
        timer: Option<&Timer>,
    ) -> Self {
        let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("stats"),
            size: FIGURE_BYTES + Timer::BYTES,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        if let Some(counters) = counters {
            encoder.copy_buffer_to_buffer(counters, 0, &staging, 0, COUNTER_BYTES);
        }
        if let Some(light) = light {
            encoder.copy_buffer_to_buffer(light, 0, &staging, COUNTER_BYTES, COUNTER_BYTES);
        }
        if let Some(order) = order {
            encoder.copy_buffer_to_buffer(order, 0, &staging, 2 * COUNTER_BYTES, ORDER_BYTES);
        }
        if let Some(timer) = timer {
            timer.end(encoder, &staging, FIGURE_BYTES);
        }
        Self { staging, labels: timer.map(Timer::labels).unwrap_or_default(), ready: Arc::default() }
    }

    /// After the submit: asks for the bytes.
    pub fn begin(self) -> Self {
        let ready = self.ready.clone();
        self.staging.map_async(wgpu::MapMode::Read, .., move |result| ready.store(result.is_ok(), Ordering::Release));
        self
    }

    pub fn is_ready(&self) -> bool {
        self.ready.load(Ordering::Acquire)
    }

    /// Demand of the picture and of its light. None when the device was lost under it.
    pub fn read(&self, timer: Option<&Timer>) -> Option<([Demand; 2], OrderRecord, Times)> {
        let bytes = self.staging.get_mapped_range(..).ok()?;
        let demand = [0, 1].map(|i| bytemuck::pod_read_unaligned(&bytes[i * COUNTER_BYTES as usize..][..size_of::<Demand>()]));
        let times = timer.map(|timer| timer.times(&bytes[FIGURE_BYTES as usize..], &self.labels)).unwrap_or_default();
        let order = bytemuck::pod_read_unaligned(&bytes[2 * COUNTER_BYTES as usize..FIGURE_BYTES as usize]);
        Some((demand, order, times))
    }
}

/// A picture with the integers that decided it.
#[derive(Clone, Debug)]
pub struct Capture {
    pub frame: Frame,
    pub geometry: Geometry,
    /// Layers per pixel, each covered sample counted before the depth test.
    pub layers: Option<Vec<u32>>,
    /// The picture before this one, where an effect reads it.
    pub previous: Option<Vec<[u8; 4]>>,
    /// The picture at the size that is shown, where it was drawn at another.
    pub shown: Option<Frame>,
}

impl Capture {
    /// The picture with what a judge compares.
    pub fn picture(&self) -> AdapterPicture<'_> {
        let (layers, previous) = (self.layers.as_deref(), self.previous.as_deref());
        AdapterPicture { frame: &self.frame, geometry: &self.geometry, layers, previous }
    }

    /// The picture as it is shown.
    pub fn into_shown(self) -> Frame {
        self.shown.unwrap_or(self.frame)
    }
}

impl Renderer {
    /// The last of `moments`, drawn after those before it, as [`Self::capture`] does.
    ///
    /// # Panics
    /// Without a moment.
    pub fn capture_last(&mut self, moments: &[(View, Stack)], accuracy: &AccuracyRequest) -> Result<Capture, RenderError> {
        let ((view, stack), before) = moments.split_last().expect("a picture shows a moment");
        self.clear_history();
        for (view, stack) in before {
            self.draw_complete(view, stack, accuracy)?;
        }
        self.capture_next(view, stack, accuracy)
    }

    /// Draws a picture that stands after none, waits, draws again with larger queues while one overflows, and reads
    /// everything back.
    pub fn capture(&mut self, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<Capture, RenderError> {
        self.clear_history();
        self.capture_next(view, stack, accuracy)
    }

    /// The same of a picture that stands after the last one.
    pub fn capture_next(&mut self, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<Capture, RenderError> {
        let counters = self.draw_complete(view, stack, accuracy)?;
        if view.pixels() == 0 {
            let frame = Frame { width: view.width, height: view.height, ..Frame::default() };
            return Ok(Capture { frame, geometry: Geometry::default(), layers: Some(Vec::new()), previous: None, shown: None });
        }
        let key = self.last.as_ref().ok_or(RenderError::NoScene)?.key.clone();
        let shown = [view.width, view.height];
        let (asked, view) = (view, &view.scaled(key.options.render_scale.factor()));
        let (triangle_id, depth) = self.read_visibility(&key, view)?;
        let color = self.read_color(view)?;
        let (dot_places, dots) = (self.read_dots(&key)?, self.read_strengths(&key, view)?);
        let light = self.shadow_pass.as_ref().map(|shadow_pass| shadow_pass.read()).transpose()?.map(Box::new);
        let counted = self.read_counted(&key, view)?;
        let previous = if key.reads_previous() {
            Some(buffers::read_picture(&self.gpu, self.buffers.get("previous"), [view.width, view.height])?)
        } else {
            None
        };
        let picture = match key.is_scaled() {
            true => Some(buffers::read_picture(&self.gpu, self.buffers.get("shown"), shown)?),
            false => None,
        };
        let (key, counters) = if key.culls() { self.draw_unculled(asked, stack, accuracy, counters)? } else { (key, counters) };
        let mut geometry = self.read_geometry(&key)?;
        (geometry.dots, geometry.shadow_map) = (dot_places, light);
        let layers =
            if key.framebuffer.layers == Some(Layers::Overdraw) { self.read_counted(&key, view)? } else { self.count_layers(&key, view)? };
        let depth_keys_are_approximate =
            !key.options.visibility.is_exact() || !matches!(key.options.depth, DepthFormat::Reversed | DepthFormat::Integer);
        let frame = Frame {
            width: view.width,
            height: view.height,
            triangle_id,
            depth_key: depth,
            color,
            counted,
            dots,
            counters,
            depth_keys_are_approximate,
        };
        let shown = picture.map(|picture| frame.shown(shown, picture));
        Ok(Capture { frame, geometry, layers: Some(layers), previous, shown })
    }

    /// Draws a culled picture once more for the judge, who wants the vertices, pieces and layers of all triangles and the
    /// counts of those that were refused. Neither what is known of the picture nor what the next one starts from changes.
    fn draw_unculled(
        &mut self,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
        drawn: Counters,
    ) -> Result<(KernelKey, Counters), RenderError> {
        let last = self.last.take();
        self.is_judged = true;
        let whole = self.draw_complete(view, stack, &AccuracyRequest { pins: accuracy.pins.with(Culling::None), ..*accuracy });
        self.is_judged = false;
        let unculled = std::mem::replace(&mut self.last, last).ok_or(RenderError::NoScene)?;
        let Counters { overflow, depth_without_id, full_pixels, .. } = drawn;
        Ok((unculled.key, Counters { overflow, depth_without_id, full_pixels, ..whole? }))
    }

    /// Draws until no queue overflows and no sum of layers.
    pub fn draw_complete(&mut self, view: &View, stack: &Stack, accuracy: &AccuracyRequest) -> Result<Counters, RenderError> {
        let mut lost = 0;
        for _ in 0..11 {
            self.draw_timed(view, stack, accuracy, Detail::Passes, true)?;
            if view.pixels() == 0 {
                return Ok(Counters::default());
            }
            let report = self.finish()?;
            if !report.redraw && report.counters.full_pixels > 0 {
                return Err(RenderError::FullSums(report.counters.full_pixels));
            }
            if let Some(order) = report.order.filter(|order| !report.redraw && order.exceeds_sample_counter()) {
                return Err(RenderError::Tickets(order.covered));
            }
            if !report.redraw {
                return Ok(report.counters);
            }
            lost = report.counters.overflow;
        }
        Err(RenderError::Overflow(lost))
    }

    pub(super) fn words(&self, name: &str, count: u64) -> Result<Vec<u32>, RenderError> {
        let bytes = buffers::read(&self.gpu, self.buffers.get(name), 4 * count)?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }

    /// Triangle id and key images.
    fn read_visibility(&self, key: &KernelKey, view: &View) -> Result<(Vec<u32>, Vec<u32>), RenderError> {
        let pixels = view.pixels() as u64;
        Ok(match key.framebuffer_layout() {
            FramebufferLayout::Split32 => {
                let triangle_ids = self.words("triangle_ids", pixels)?;
                (triangle_ids.iter().map(|word| !word).collect(), self.words("depth_keys", pixels)?)
            }
            FramebufferLayout::Packed32 => self.words("packed", pixels)?.iter().map(|&word| key.unpack(word)).unzip(),
            FramebufferLayout::Packed64 => {
                let words = self.words("depth_and_id", 2 * pixels)?;
                words.chunks_exact(2).map(|pair| (!pair[0], pair[1])).unzip()
            }
        })
    }

    /// Weights or layers per pixel, as the effect in the visibility slot has them.
    fn read_counted(&self, key: &KernelKey, view: &View) -> Result<Vec<u32>, RenderError> {
        let pixels = view.pixels() as u64;
        let (buffer, first) = match (key.framebuffer.layers, key.framebuffer_layout()) {
            (Some(Layers::Xray { .. }), FramebufferLayout::Split32) => ("depth_keys", pixels),
            (Some(Layers::Xray { .. }), FramebufferLayout::Packed32) => ("packed", pixels),
            (Some(Layers::Xray { .. }), FramebufferLayout::Packed64) => ("depth_and_id", 2 * pixels),
            (Some(Layers::Overdraw), _) => return self.words("layers", pixels),
            (Some(Layers::Race) | None, _) => return Ok(Vec::new()),
        };
        let (sums, all) = (key.options.xray_sums, key.options.xray_sums.words() as usize);
        let words = self.words(buffer, first + all as u64 * pixels)?;
        let weight = |words: &[u32]| match sums {
            XraySums::Packed16 => words[1] >> 16,
            XraySums::Three8 => words[0] >> 20,
            XraySums::Four32 => words[3],
        };
        Ok(words[first as usize..].chunks_exact(all).map(weight).collect())
    }

    /// Strength of the strongest dot per pixel.
    fn read_strengths(&self, key: &KernelKey, view: &View) -> Result<Vec<u32>, RenderError> {
        if key.effects.dots.is_none() {
            return Ok(Vec::new());
        }
        let first = first_dot_word(view);
        Ok(self.words("color", first + view.pixels() as u64)?.split_off(first as usize))
    }

    fn read_color(&self, view: &View) -> Result<Vec<[u8; 4]>, RenderError> {
        buffers::read_picture(&self.gpu, self.buffers.get("color"), [view.width, view.height])
    }

    pub(super) fn read_geometry(&self, key: &KernelKey) -> Result<Geometry, RenderError> {
        let scene = self.scene.as_ref().ok_or(RenderError::NoScene)?;
        let (vertices, triangles) = (record_count(key, self.totals), self.totals[1] as usize);
        let mut pieces = Vec::new();
        if key.paths.has_clipping {
            let count = self.words("counters", 16)?[4].min(self.capacities.pieces);
            let words = self.words("pieces", 16 * u64::from(count))?;
            pieces = words.chunks_exact(16).enumerate().map(|(slot, words)| (slot, words[14], piece(words))).collect();
            // ClippedTriangles land in the order of the scheduler; parent and place in the fan put them in ours.
            pieces.sort_by_key(|(_, place, piece): &(usize, u32, ClippedTriangle)| (piece.parent, *place));
        }
        let deciding = key.sample_setups() as usize;
        let entries = if deciding > 0 { triangles + pieces.len() } else { 0 };
        let words = self.words("vertices", 4 * (vertices + (deciding * entries) as u64))?;
        let (records, decided) = words.split_at(4 * vertices as usize);
        let of_entry = |entry: usize| &decided[4 * deciding * entry..4 * deciding * (entry + 1)];
        let order = (0..triangles).chain(pieces.iter().map(|(slot, _, _)| triangles + slot)).take(entries);
        Ok(Geometry {
            vertices: records.chunks_exact(4).map(vertex).collect(),
            sample_setups: order.flat_map(|entry| of_entry(entry).chunks_exact(4).map(|w| [w[0], w[1], w[2], w[3]])).collect(),
            clipped_triangles: pieces.into_iter().map(|(_, _, piece)| piece).collect(),
            has_unshared_vertices: key.unshares_vertices(),
            subpixel_bits: key.options.coverage.subpixel_bits(),
            scale: key.options.render_scale.factor(),
            is_relative: key.options.position_format == PositionFormat::Relative,
            has_approximate_positions: key.options.position_format.packed_bits().is_some(),
            dots: Vec::new(),
            exact: Exactness {
                vertices: key.options.vertex_transform == VertexTransform::Strict,
                keys: key.options.depth == DepthFormat::Integer,
            },
            particle_readback: self.read_particles(key)?,
            particle_discs: scene.particle_disc_ids(),
            deformed: self.read_deformed(scene.vertex_bytes.len() as u64)?,
            shadow_map: None,
        })
    }

    /// What the skin pass kept behind the file's bytes.
    fn read_deformed(&self, first: u64) -> Result<Vec<[f32; 6]>, RenderError> {
        let Some(end) = self.deformed.last().map(|range| range.end) else { return Ok(Vec::new()) };
        let bytes = buffers::read(&self.gpu, self.buffers.get("vertex_bytes"), first + u64::from(DEFORMED_BYTES * end))?;
        let all: Vec<[f32; 6]> = bytemuck::pod_collect_to_vec(&bytes[first as usize..]);
        Ok(self.deformed.iter().flat_map(|range| &all[range.start as usize..range.end as usize]).copied().collect())
    }

    /// Runs the raster passes once more into a counter per pixel.
    fn count_layers(&mut self, key: &KernelKey, view: &View) -> Result<Vec<u32>, RenderError> {
        let pixels = view.pixels() as u64;
        self.buffers.ensure(&self.gpu, "layers", 4 * pixels, STORAGE, "layers per pixel, only while verifying")?;
        let mut encoder = self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("count") });
        self.clear(&mut encoder, &["counters", "layers", "sample_counts", "boundary_samples"]);
        let timer = self.timer.take();
        let recorded = self.record(&mut encoder, key, &key.passes(&[key.order_phases(), &[RasterPhase::Count]].concat()), view, true);
        self.timer = timer;
        recorded?;
        self.gpu.queue.submit([encoder.finish()]);
        let layers = self.words("layers", pixels);
        self.buffers.keep(|name| name != "layers");
        layers
    }
}

fn piece(words: &[u32]) -> ClippedTriangle {
    let corners = [&words[0..4], &words[4..8], &words[8..12]].map(vertex);
    ClippedTriangle { parent: words[12], corners, outline: words[15] }
}

pub(super) fn vertex(words: &[u32]) -> SnappedVertex {
    SnappedVertex {
        x: words[0] as i32 >> 8,
        y: words[1] as i32 >> 8,
        depth: f32::from_bits(words[2]),
        inv_w: f32::from_bits(words[3]),
        flags: words[0] & 255,
    }
}
