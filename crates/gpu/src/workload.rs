//! The work of the last picture as the cost model counts it: from its plan, its layout and the text of its kernels, from what its queues held,
//! and from a sample of its triangles.

use super::{
    dots::DotStore,
    error::RenderError,
    frame_counts::FrameCounts,
    frame_layout::{Dispatch, FrameLayout},
    recording::Device,
    renderer::Renderer,
    resource_id::ClearedBy,
    view_resources::{PreparedFrame, ViewResources},
};
use crate::{
    effects::Stack,
    plan::cost_model::{FrameWork, PassWork, Unit},
    scene::{Scene, draw::DrawError, sizes::TriangleSizes, view::View},
    shader::{key::KernelKey, link, pass::Pass, reflect, weight::Weight},
};

/// Samples the triangles of a scene as a view sees them where the effects of a stack have moved them.
pub type MovedSizes = fn(&Scene, &View, &Stack) -> Result<TriangleSizes, DrawError>;

/// Operations outside loops and in them beyond which most lie in branches that are seldom taken: on a card more of them count by the root alone.
/// A CPU adapter runs both sides of a branch.
const FEW_ONCE: f64 = 3000.0;
const FEW_LOOPED: f64 = 2000.0;

impl Renderer {
    /// The work of the last picture, which showed `stack`, in the order in which its passes are timed.
    ///
    /// # Errors
    /// When nothing was drawn.
    pub fn work(&self, stack: &Stack, moved_sizes: MovedSizes) -> Result<FrameWork, RenderError> {
        let frame = self.picture.frame()?;
        let scene = self.scene.as_ref().ok_or(RenderError::NoScene)?.scene();
        let sizes = |view: &View, stack: &Stack, prepared: &PreparedFrame| {
            let stays = || prepared.plan.needs.sizes.clone();
            // Where particles are drawn only the adapter knows.
            let moves = prepared.plan.classes.is_none() && scene.particle_discs.is_none();
            if moves { moved_sizes(scene, view, stack).unwrap_or_else(|_| stays()) } else { stays() }
        };
        let passes = frame.plan.key.frame();
        let deforming = passes.iter().take_while(|pass| matches!(pass, Pass::Particles | Pass::Skin)).count();
        let picture = self.passes_of(&self.picture, &passes, "", &sizes(&frame.view, stack, frame), stack)?;
        let mut begin = clears(&frame.layout);
        begin.push((Unit::Frame, 1.0));
        let mut light = Vec::new();
        if let Some(shadow) = &self.shadow
            && let Ok(prepared) = shadow.resources.frame()
        {
            let passes = prepared.plan.key.light_frame();
            let casters = stack.shadow_casters();
            light = self.passes_of(&shadow.resources, &passes, "light ", &sizes(&shadow.view, &casters, prepared), &casters)?;
            if let Some(first) = light.first_mut() {
                first.counts.extend(clears(&prepared.layout));
            }
        }
        let (first, others) = picture.split_at(deforming.min(picture.len()));
        let clear = PassWork { label: "clear".into(), counts: begin };
        Ok(FrameWork { passes: [std::slice::from_ref(&clear), first, &light, others].concat() })
    }

    fn passes_of(
        &self,
        view: &ViewResources,
        passes: &[Pass],
        prefix: &str,
        sizes: &TriangleSizes,
        stack: &Stack,
    ) -> Result<Vec<PassWork>, RenderError> {
        let frame = view.frame()?;
        let mut scene = FrameCounts::new(frame, sizes, view.demand.as_ref(), view.dots.as_ref().map(DotStore::radius));
        scene.shows_materials = stack.shows_materials();
        if self.shadow.is_some() {
            scene.turns = scene.turns.max(f64::from(frame.plan.needs.shadow.taps).powi(2));
        }
        passes
            .iter()
            .map(|&pass| {
                let weight = weight_of(&self.device, &frame.plan.key, pass)?;
                let mut counts = scene.counts(pass, weight);
                counts.retain(|(_, count)| *count > 0.0);
                let is_indirect = || matches!(frame.layout.dispatch(&frame.plan.key, pass, None), Dispatch::Indirect { .. });
                if !counts.is_empty() {
                    counts.push((Unit::Pass, 1.0));
                } else if !is_indirect() {
                    // An indirect dispatch of no workgroup costs next to nothing.
                    counts.push((Unit::IdlePass, 1.0));
                }
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
    let Weight { once, looped } = reflected.weight(pass.stem(), &constants).unwrap_or_default();
    let is_software = device.gpu.caps.software;
    let usual = |operations: f64, few: f64| if operations > few && !is_software { (few * operations).sqrt() } else { operations };
    Ok(Weight { once: usual(once, FEW_ONCE), looped: usual(looped, FEW_LOOPED) })
}

/// Bytes of a region that a card fills in little time: on an H100 about 1 µs up to here, and 6 beyond.
const SHORT_FILL: u64 = 4096;

fn clears(layout: &FrameLayout) -> Vec<(Unit, f64)> {
    let bytes = || layout.cleared(|occasion| occasion != ClearedBy::History).map(|(_, bytes)| bytes.end - bytes.start);
    let (short, long): (Vec<u64>, Vec<u64>) = bytes().partition(|bytes| *bytes <= SHORT_FILL);
    let cleared = bytes().sum::<u64>() as f64;
    vec![(Unit::Fill, long.len() as f64), (Unit::ShortFill, short.len() as f64), (Unit::ClearedByte, cleared)]
}
