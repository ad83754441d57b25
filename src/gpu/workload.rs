//! The work of the last picture as the cost model counts it: from its plan, its layout and the text of its kernels, without reading
//! anything back.

use super::{
    dots::DotStore,
    error::RenderError,
    frame_layout::{Dispatch, FrameLayout},
    recording::Device,
    renderer::Renderer,
    view_resources::{PreparedFrame, ViewResources},
};
use crate::{
    effects::hooks::Shape,
    math::SMALL_EXTENT,
    plan::cost_model::{FrameWork, PassWork, Unit},
    scene::{
        needs::Needs,
        sizes::{PathWork, SizeWork},
    },
    shader::{key::KernelKey, link, pass::Pass, reflect, weight::Weight},
};

/// How often a loop over few items runs, as a rule: joints of a vertex, corners of a polygon, taps of a filter.
const TURNS: f64 = 4.0;

/// Side of a tile of the resolve where it visits listed tiles, pixels.
const TILE: u32 = 8;

impl Renderer {
    /// The work of the last picture, in the order in which its passes are timed.
    ///
    /// # Errors
    /// When nothing was drawn.
    pub fn work(&self) -> Result<FrameWork, RenderError> {
        let frame = self.picture.frame()?;
        let passes = frame.plan.key.frame();
        let deforming = passes.iter().take_while(|pass| matches!(pass, Pass::Particles | Pass::Skin)).count();
        let picture = self.passes_of(&self.picture, &passes, "")?;
        let mut work =
            vec![PassWork { label: "clear".into(), counts: vec![(Unit::Frame, 1.0), (Unit::ClearedByte, cleared_bytes(&frame.layout))] }];
        let (first, others) = picture.split_at(deforming.min(picture.len()));
        work.extend_from_slice(first);
        if let Some(shadow) = &self.shadow
            && let Ok(light) = shadow.resources.frame()
        {
            let mut passes = self.passes_of(&shadow.resources, &light.plan.key.light_frame(), "light ")?;
            if let Some(first) = passes.first_mut() {
                first.counts.push((Unit::ClearedByte, cleared_bytes(&light.layout)));
            }
            work.extend(passes);
        }
        work.extend_from_slice(others);
        Ok(FrameWork { passes: work })
    }

    fn passes_of(&self, view: &ViewResources, passes: &[Pass], prefix: &str) -> Result<Vec<PassWork>, RenderError> {
        let frame = view.frame()?;
        let scene = FrameCounts::new(frame, view.dots.as_ref().map(DotStore::radius));
        passes
            .iter()
            .map(|&pass| {
                let weight = weight_of(&self.device, &frame.plan.key, pass)?;
                let mut counts = scene.counts(pass, weight);
                counts.retain(|(_, count)| *count > 0.0);
                // An indirect dispatch of no workgroup costs next to nothing.
                let is_idle = counts.is_empty() && matches!(frame.layout.dispatch(&frame.plan.key, pass, None), Dispatch::Indirect { .. });
                counts.extend((!is_idle).then_some((Unit::Pass, 1.0)));
                Ok(PassWork { label: format!("{prefix}{}", pass.label()), counts })
            })
            .collect()
    }
}

/// The weight of the kernel of a pass.
fn weight_of(device: &Device, key: &KernelKey, pass: Pass) -> Result<Weight, RenderError> {
    let linked = link::link(device.pipelines.library(), &pass.path(), key, &key.variants(pass))?;
    let reflected = reflect::reflect(&linked, device.gpu.caps.int64_atomics)?;
    let constants: Vec<_> = key.constants(pass).iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    Ok(reflected.weight(pass.stem(), &constants).unwrap_or_default())
}

fn cleared_bytes(layout: &FrameLayout) -> f64 {
    layout.cleared(|_| true).map(|(_, bytes)| (bytes.end - bytes.start) as f64).sum()
}

/// What the passes of a frame have to do, in numbers.
struct FrameCounts<'a> {
    key: &'a KernelKey,
    layout: &'a FrameLayout,
    needs: &'a Needs,
    sizes: SizeWork,
    pixels: f64,
    /// Estimated fraction of the pixels that show a triangle.
    covered: f64,
    /// Estimated fraction of the pixels in tiles that a triangle touches.
    touched: f64,
    /// Pixels in the square about a corner's disc.
    disc: f64,
    /// Pixels in the square about a dot.
    dot: f64,
}

impl<'a> FrameCounts<'a> {
    fn new(frame: &'a PreparedFrame, dot_radius: Option<u32>) -> Self {
        let (key, layout, needs) = (&frame.plan.key, &frame.layout, &*frame.plan.needs);
        let large = f64::from(SMALL_EXTENT >> key.options.coverage.subpixel_bits());
        let sizes = needs.sizes.work(key.paths.max_small_samples, key.paths.max_small_side, large);
        let pixels = f64::from(layout.size[0]) * f64::from(layout.size[1]);
        let touched = needs.sizes.touched_fraction(layout.size, TILE);
        let drawn = (sizes.small.covered + sizes.medium.covered + sizes.large.covered) / pixels.max(1.0);
        let covered = touched.min(drawn);
        // The part of a square that lies in the picture.
        let square = |units: u32| layout.size.iter().map(|side| (f64::from(units) / 128.0).clamp(1.0, f64::from(*side).max(1.0))).product();
        let disc = square(frame.point_radius);
        let dot = dot_radius.map_or(0.0, |radius| square(radius + 128));
        Self { key, layout, needs, sizes, pixels, covered, touched, disc, dot }
    }

    fn triangles(&self) -> f64 {
        self.layout.scene.triangles as f64
    }

    /// Invocations of a pass that is dispatched over a known number; none for one whose number a pass before it decides.
    fn invocations(&self, pass: Pass) -> Option<f64> {
        match self.layout.dispatch(self.key, pass, None) {
            Dispatch::Direct { groups: [x, y] } => Some(f64::from(x) * f64::from(y) * f64::from(self.key.work.group_size)),
            Dispatch::Indirect { .. } => None,
        }
    }

    fn counts(&self, pass: Pass, weight: Weight) -> Vec<(Unit, f64)> {
        let Weight { once, looped } = weight;
        let few_turns = once + TURNS * looped;
        let sizes = &self.sizes;
        // A workgroup visits squares of 64 pixels that a triangle touches: those inside, and those along its edges.
        let queued = |path: PathWork, once: f64, looped: f64| {
            let visited = path.covered + 16.0 * (path.candidates * path.triangles).sqrt() + 64.0 * path.triangles;
            vec![(Unit::QueuedOperation, path.triangles * once), (Unit::QueuedSampleOperation, visited * looped)]
        };
        match pass {
            Pass::Particles => vec![(Unit::ParticleOperation, f64::from(self.layout.scene.particles) * few_turns)],
            Pass::Skin => vec![(Unit::DeformOperation, f64::from(self.layout.scene.deformable) * few_turns)],
            Pass::Project | Pass::Cull(_) | Pass::ProjectMeshlets => {
                let vertices = self.invocations(pass).unwrap_or(0.5 * self.layout.scene.vertices as f64);
                vec![(Unit::VertexOperation, vertices * few_turns)]
            }
            Pass::SampleSetup(_) => vec![(Unit::SetupOperation, self.invocations(pass).unwrap_or(2.0 * sizes.cut) * few_turns)],
            Pass::Clip => vec![(Unit::CutOperation, sizes.cut * few_turns)],
            Pass::TileLarge => vec![(Unit::QueuedOperation, sizes.large.triangles * few_turns)],
            Pass::RasterSmall(_) => {
                let triangles = self.invocations(pass).unwrap_or(0.5 * self.triangles());
                vec![(Unit::TriangleOperation, triangles * once), (Unit::SampleOperation, sizes.small.candidates * looped)]
            }
            // Its text holds the code of three paths, each about as long as the others.
            Pass::RasterAll(_) => {
                let (once, looped) = (once / 3.0, looped / 3.0);
                let mut counts =
                    vec![(Unit::TriangleOperation, self.triangles() * once), (Unit::SampleOperation, sizes.small.candidates * looped)];
                counts.extend(queued(sizes.medium, once, looped));
                counts.extend(queued(sizes.large, once, looped));
                counts
            }
            Pass::RasterPoints(_) => {
                let triangles = self.invocations(pass).unwrap_or_else(|| self.triangles());
                let seen = f64::from(self.needs.sizes.visible()) / f64::from(self.needs.sizes.sampled.max(1));
                vec![(Unit::TriangleOperation, triangles * once), (Unit::DiscOperation, 3.0 * seen * self.triangles() * self.disc * looped)]
            }
            Pass::RasterMedium(_) => queued(sizes.medium, once, looped),
            Pass::RasterLarge(_) => queued(sizes.large, once, looped),
            Pass::OrderSums | Pass::OrderRanks => vec![(Unit::OrderedTriangle, self.triangles())],
            Pass::DotsEnds => vec![(Unit::LineOperation, self.layout.dots.map_or(0.0, |dots| dots.segments.into()) * few_turns)],
            Pass::DotsCull => vec![(Unit::LineOperation, self.layout.dots.map_or(0.0, |dots| dots.runs.into()) * few_turns)],
            Pass::DotsDraw | Pass::DotsProbe => {
                let dots = self.layout.dots.map_or(0.0, |dots| f64::from(if dots.chosen > 0 { dots.chosen } else { dots.dots }));
                // Where dots would crowd, most have faded.
                let shown = dots.min(0.25 * self.pixels);
                vec![(Unit::LineOperation, dots * 0.1 * once), (Unit::DotOperation, shown * self.dot * looped)]
            }
            Pass::Resolve => self.resolve(weight),
            Pass::Scale => {
                let shown = f64::from(self.layout.shown[0]) * f64::from(self.layout.shown[1]);
                let taps = (self.pixels / shown.max(1.0)).max(1.0);
                vec![(Unit::PixelOperation, shown * once), (Unit::PixelLoopOperation, shown * taps * looped)]
            }
            Pass::DepthReduce | Pass::ListTiles => vec![(Unit::PixelVisited, self.pixels / 16.0)],
            Pass::AdvanceQueues { .. } | Pass::Args | Pass::OrderLimit | Pass::OrderCut | Pass::DotsArgs => Vec::new(),
        }
    }

    fn resolve(&self, weight: Weight) -> Vec<(Unit, f64)> {
        let visited = if self.key.work.listed_tiles { self.touched } else { 1.0 };
        // Without listed tiles an invocation branches; with them it shades empty pixels too.
        let is_other = self.key.samples.shape != Shape::Triangles || self.key.finishes_pixels() || self.key.moves();
        let shaded = match self.key.work.listed_tiles {
            true => self.touched,
            false if is_other => self.touched.max(self.covered),
            false => self.covered,
        };
        vec![
            (Unit::PixelVisited, visited * self.pixels),
            (Unit::PixelOperation, shaded * self.pixels * weight.once),
            (Unit::PixelLoopOperation, shaded * self.pixels * weight.looped),
        ]
    }
}
