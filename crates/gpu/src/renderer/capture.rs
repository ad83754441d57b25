//! Captures: whole pictures with all that decided them, for a judge.

use super::{
    drawing::{Renderer, shared},
    readback::{Readback, count_layers, shadow_map},
};
use crate::{
    accuracy::{Culling, Visibility},
    device::{error::RenderError, timer::Detail},
    effects::{Stack, hooks::Layers},
    frame::{AdapterPicture, Counters, Frame, Geometry},
    layout::{
        BufferId, ClearedBy, frame_layout::Target, queues::recorded_capacities,
        records::CounterRecord,
    },
    passes::{
        particles::Wait,
        recording::Timing,
        view_resources::{Request, ViewResources},
    },
    plan::AccuracyRequest,
    resources::buffers,
    scene::view::View,
    shader::KernelKey,
};

/// How often a picture is drawn again because a queue overflowed.
const MOST_REDRAWS: usize = 11;

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
        AdapterPicture {
            frame: &self.frame,
            geometry: &self.geometry,
            layers,
            previous,
        }
    }

    /// The picture as it is shown.
    pub fn into_shown(self) -> Frame {
        self.shown.unwrap_or(self.frame)
    }
}

impl Renderer {
    /// The last of `moments`, drawn after those before it, as it is shown. A judge asks for more:
    /// [`Self::capture`].
    ///
    /// # Panics
    /// Without a moment.
    pub async fn draw_last(
        &mut self,
        moments: &[(View, Stack)],
        accuracy: &AccuracyRequest,
    ) -> Result<Frame, RenderError> {
        let (view, _) = moments.last().expect("a picture shows a moment");
        let mut counters = Counters::default();
        self.clear_history();
        for (view, stack) in moments {
            counters = self.draw_complete(view, stack, accuracy).await?;
        }
        let (frame, shown) = self.read_picture(view, counters).await?;
        Ok(shown.unwrap_or(frame))
    }

    /// The last of `moments`, drawn after those before it, as [`Self::capture`] does.
    ///
    /// # Panics
    /// Without a moment.
    pub async fn capture_last(
        &mut self,
        moments: &[(View, Stack)],
        accuracy: &AccuracyRequest,
    ) -> Result<Capture, RenderError> {
        let ((view, stack), before) = moments.split_last().expect("a picture shows a moment");
        self.clear_history();
        for (view, stack) in before {
            self.draw_complete(view, stack, accuracy).await?;
        }
        self.capture_next(view, stack, accuracy).await
    }

    /// Draws a picture with no history, draws it again with larger queues while one overflows, and
    /// reads everything back.
    pub async fn capture(
        &mut self,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
    ) -> Result<Capture, RenderError> {
        self.clear_history();
        self.capture_next(view, stack, accuracy).await
    }

    /// The same of a picture that comes after the last one.
    pub async fn capture_next(
        &mut self,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
    ) -> Result<Capture, RenderError> {
        for _ in 0..MOST_REDRAWS {
            if let Some(capture) = self.capture_once(view, stack, accuracy).await? {
                return Ok(capture);
            }
        }
        Err(RenderError::Overflow(0))
    }

    /// The same; none where a queue overflowed only when layers were counted, and has grown.
    async fn capture_once(
        &mut self,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
    ) -> Result<Option<Capture>, RenderError> {
        let mut counters = self.draw_complete(view, stack, accuracy).await?;
        if view.pixels() == 0 {
            let (frame, shown) = self.read_picture(view, counters).await?;
            return Ok(Some(Capture {
                frame,
                geometry: Geometry::default(),
                layers: Some(Vec::new()),
                previous: None,
                shown,
            }));
        }
        let key = self.picture.frame()?.plan.key.clone();
        let mut judge = if key.culls() || key.work.projects_points {
            Some(
                self.redraw_unculled(view, stack, accuracy, &mut counters)
                    .await?,
            )
        } else {
            None
        };
        let scene = self.scene.as_ref().ok_or(RenderError::NoScene)?;
        let gpu = &self.device.gpu;
        let picture = Readback {
            gpu,
            scene,
            view: &self.picture,
        };
        // The judge asks for all triangles, culled ones too.
        let all = Readback {
            view: judge.as_ref().unwrap_or(&self.picture),
            ..picture
        };
        let (frame, shown) = self.read_picture(view, counters).await?;
        let previous = if key.reads_previous() {
            let size = [frame.width, frame.height];
            Some(picture.picture(BufferId::Previous, size).await?)
        } else {
            None
        };
        let mut geometry = all.geometry(Some(&self.particles)).await?;
        if let Some(shadow) = &self.shadow {
            geometry.shadow_map = Some(shadow_map(gpu, scene, shadow).await?.into());
        }
        let is_counted = key.framebuffer.layers == Some(Layers::Overdraw);
        let mut layers = if is_counted {
            Some(all.layer_sums().await?)
        } else {
            None
        };
        let others = shared(scene, &self.particles, self.shadow.as_ref());
        if let Some(dots) = &self.picture.dots {
            geometry.dots = dots
                .read(&mut self.device, &key, &mut self.picture.buffers, &others)
                .await?;
        }
        if layers.is_none() {
            layers = count_layers(
                &mut self.device,
                judge.as_mut().unwrap_or(&mut self.picture),
                &others,
            )
            .await?;
            if layers.is_none() {
                if let Some(judge) = judge {
                    self.picture.capacities = judge.capacities;
                }
                return Ok(None);
            }
        }
        Ok(Some(Capture {
            frame,
            geometry,
            layers,
            previous,
            shown,
        }))
    }

    /// The picture that was drawn last, of this view, and that at the size that is shown, where it was
    /// drawn at another.
    async fn read_picture(
        &self,
        view: &View,
        counters: Counters,
    ) -> Result<(Frame, Option<Frame>), RenderError> {
        let [width, height] = [view.width, view.height];
        if view.pixels() == 0 {
            let frame = Frame {
                width,
                height,
                ..Frame::default()
            };
            return Ok((frame, None));
        }
        let prepared = self.picture.frame()?;
        let picture = Readback {
            gpu: &self.device.gpu,
            scene: self.scene.as_ref().ok_or(RenderError::NoScene)?,
            view: &self.picture,
        };
        let key = &prepared.plan.key;
        let frame = read_frame(&picture, key, prepared.layout.size, counters).await?;
        if !key.is_scaled() {
            return Ok((frame, None));
        }
        let scaled = picture
            .picture(BufferId::ScaledColor, [width, height])
            .await?;
        let shown = frame.shown([width, height], scaled);
        Ok((frame, Some(shown)))
    }

    /// Draws a picture that was culled, or whose points no pass projected, once more as another view,
    /// for the judge, who asks for the vertices,
    /// clipped triangles and layers of all triangles and for the counts of those that were
    /// rejected. Neither the picture nor what the next one starts from changes.
    async fn redraw_unculled(
        &mut self,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
        counters: &mut Counters,
    ) -> Result<ViewResources, RenderError> {
        let (shown, factor) = ([view.width, view.height], accuracy.scale().factor());
        let (view, stack) = (view.scaled(factor), stack.scaled(factor));
        let accuracy = AccuracyRequest {
            pins: accuracy.pins.with(Culling::None),
            ..*accuracy
        };
        let request = Request {
            view: &view,
            stack: &stack,
            accuracy: &accuracy,
            shown,
            room: self.history.room_for_layers(&view, &stack),
        };
        let Self {
            device,
            scene,
            picture,
            shadow,
            particles,
            ..
        } = self;
        let scene = scene.as_mut().ok_or(RenderError::NoScene)?;
        let mut judge = ViewResources::new(Target::Judge, None);
        (judge.capacities, judge.force_all_paths) = (picture.capacities, picture.force_all_paths);
        let mut lost = 0;
        for _ in 0..MOST_REDRAWS {
            judge.prepare(device, scene, &request).await?;
            let key = &judge.frame()?.plan.key;
            let (room, passes) = (
                recorded_capacities(key, &judge.capacities),
                key.judge_frame(),
            );
            judge
                .prepare_passes(device, passes, &shared(scene, particles, shadow.as_ref()))
                .await?;
            let mut encoder =
                device
                    .gpu
                    .device
                    .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                        label: Some("judge"),
                    });
            judge.clear(&mut encoder, |occasion| occasion != ClearedBy::History)?;
            judge.record(
                judge.passes(),
                &mut encoder,
                Timing {
                    timer: None,
                    ends_frame: true,
                },
            )?;
            device.gpu.queue.submit([encoder.finish()]);
            let bytes = buffers::read(
                &device.gpu,
                judge.buffers.get(BufferId::Counters)?,
                size_of::<CounterRecord>() as u64,
            )
            .await?;
            let record: CounterRecord = bytemuck::pod_read_unaligned(&bytes);
            let all = record.counters(&room);
            if all.overflow == 0 {
                let Counters {
                    overflow,
                    depth_without_id,
                    full_pixels,
                    ..
                } = *counters;
                *counters = Counters {
                    overflow,
                    depth_without_id,
                    full_pixels,
                    ..all
                };
                return Ok(judge);
            }
            lost = all.overflow;
            judge.grow_queues(&record);
        }
        Err(RenderError::Overflow(lost))
    }

    /// Draws until neither a queue nor a sum of layers overflows.
    pub async fn draw_complete(
        &mut self,
        view: &View,
        stack: &Stack,
        accuracy: &AccuracyRequest,
    ) -> Result<Counters, RenderError> {
        let mut lost = 0;
        for _ in 0..MOST_REDRAWS {
            self.draw_timed(view, stack, accuracy, Detail::Passes, Wait::Simulation)
                .await?;
            if view.pixels() == 0 {
                return Ok(Counters::default());
            }
            let report = self.finish().await?;
            if !report.redraw && report.counters.full_pixels > 0 {
                let pixels = report.counters.full_pixels;
                let key = &self.picture.frame()?.plan.key;
                return Err(if key.has_glass() {
                    let most = key.work.deepest_glass;
                    RenderError::DeepGlass { pixels, most }
                } else {
                    RenderError::FullSums(pixels)
                });
            }
            if let Some(layers) = report.lost_layers {
                return Err(RenderError::ManyLayers(layers));
            }
            if let Some(order) = report
                .order
                .filter(|order| !report.redraw && order.exceeds_sample_counter())
            {
                return Err(RenderError::Tickets(order.covered));
            }
            if !report.redraw {
                return Ok(report.counters);
            }
            lost = report.counters.overflow;
        }
        Err(RenderError::Overflow(lost))
    }
}

/// All that a picture of `size` pixels shows, read back from the buffers of its view.
async fn read_frame(
    picture: &Readback<'_>,
    key: &KernelKey,
    size: [u32; 2],
    counters: Counters,
) -> Result<Frame, RenderError> {
    let (triangle_id, stored_keys) = picture.visibility().await?;
    let depth_keys = stored_keys
        .into_iter()
        .map(|stored| key.depth_bits(stored))
        .collect();
    let resolved = picture.picture(BufferId::Color, size).await?;
    let (color, resolved) = if key.has_passes() {
        let finished = picture.picture(BufferId::Finished, size).await?;
        (finished, Some(resolved))
    } else {
        (resolved, None)
    };
    let kept = match key.kept_pass() {
        Some(pass) => Some(picture.kept(pass.size(size)).await?),
        None => None,
    };
    Ok(Frame {
        width: size[0],
        height: size[1],
        triangle_id,
        depth_key: depth_keys,
        color,
        resolved,
        kept,
        layer_sums: picture.layer_sums().await?,
        glass: picture.glass().await?,
        dots: picture.dot_strengths().await?,
        counters,
        depth_rounding: key.depth_rounding(),
        depth_keys_are_approximate: key.options.visibility == Visibility::Race,
    })
}
