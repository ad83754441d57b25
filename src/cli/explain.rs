//! `explain`: which passes and buffers a preset needs on this adapter, which it does without, and why.

use serde_json::{Value, json};

use super::{
    args::{Common, Explain},
    fault::{Exit, Fault},
    open,
    painter::{Painter, scene_of},
    streams::{Streams, table},
};
use crate::{
    effects::Stack,
    frame::Frame,
    gpu::{Capture, Explanation, SizesNote},
    measure::compare,
    oracle,
    plan::{Tolerance, predict::Prediction},
    scene::{Scene, sizes::SizeClasses, view::View},
};

pub fn run(common: &Common, args: &Explain, streams: &mut Streams) -> Result<Exit, Fault> {
    let mut preset_file = open(common, &args.preset_file)?;
    preset_file.preset.output.size = args.size.unwrap_or(preset_file.preset.output.size);
    let scene = scene_of(&preset_file)?;
    // Without an adapter the plan cannot be made, but the preset can still be told.
    let painter = match Painter::open(common, streams) {
        Ok(painter) => Some(painter),
        Err(fault) if common.adapter_name().is_none() && fault.exit == Exit::NoAdapter => {
            streams.note(&format!("{}; passes and buffers are not planned", fault.sentence()));
            None
        }
        Err(fault) => return Err(fault),
    };
    let (mut check, mut flight) = (None, None);
    let (adapter, plan) = match painter {
        Some(Painter::Gpu(mut renderer, gpu)) => {
            renderer.set_scene(&scene)?;
            let preset = &preset_file.preset;
            let (view, stack) = (preset.view(&scene, preset.output.size), preset.evaluated_stack());
            let capture = renderer.capture(&view, &stack, &preset.accuracy)?;
            let factor = capture.geometry.scale;
            flight = ParticleState::of(&scene, &view, &stack, &capture)?;
            // Once chaos has parted them, two pictures of particles tell nothing of the options.
            if flight.as_ref().is_none_or(|flight| flight.beyond_a_pixel == 0) {
                check = checked(&scene, &view.scaled(factor), &stack.scaled(factor), &capture.frame, &renderer.explain())?;
            }
            (Painter::Gpu(Box::new(crate::gpu::Renderer::new(gpu.clone())), gpu).json(), Some(renderer.explain()))
        }
        Some(painter) => (painter.json(), None),
        None => (Value::Null, None),
    };
    if streams.json {
        let result = json!({
            "preset": preset_file.id, "scene": scene_json(&scene), "size": preset_file.preset.output.size,
            "effects": effects_json(&preset_file.preset.stack), "plan": plan, "check": check, "flight": flight,
        });
        streams.object("explain", adapter, vec![result])?;
    } else {
        streams.text(&text(&preset_file.id, &scene, &preset_file.preset.stack, plan.as_ref(), check.as_ref(), flight.as_ref()))?;
    }
    Ok(Exit::failed_if(check.is_some_and(|check| !check.is_kept)))
}

/// Particles held against their true flight.
#[derive(serde::Serialize)]
struct ParticleState {
    particles: u64,
    /// Steps since the beginning.
    steps: u32,
    beyond_a_pixel: u64,
    max_px: f64,
    mean_m: f64,
}

impl ParticleState {
    /// None without particles.
    fn of(scene: &Scene, view: &View, stack: &Stack, capture: &Capture) -> Result<Option<Self>, Fault> {
        if capture.geometry.particle_readback.is_none() {
            return Ok(None);
        }
        let (layers, previous) = (capture.layers.as_deref(), capture.previous.as_deref());
        let a = oracle::judge_after(scene, view, stack, &capture.frame, &capture.geometry, layers, previous)?.accuracy;
        Ok(Some(Self {
            particles: a.particles,
            steps: view.particle_timeline.as_ref().map_or(0, |particle_timeline| particle_timeline.frame),
            beyond_a_pixel: a.particles_diverged,
            max_px: a.max_divergence_px,
            mean_m: a.mean_divergence_m,
        }))
    }
}

/// The prediction held against the picture.
#[derive(serde::Serialize)]
struct Check {
    predicted: Prediction,
    tolerance: Tolerance,
    /// Pixels with another triangle id than in the oracle's picture, per million, without those that only the snap explains.
    wrong_ppm: f64,
    /// The picture stays within the tolerance.
    is_kept: bool,
    /// And within what was predicted.
    prediction_holds: bool,
}

/// Measures what the plan predicted; none for a picture without pixels or one that chance makes.
fn checked(scene: &Scene, view: &View, stack: &Stack, frame: &Frame, plan: &Explanation) -> Result<Option<Check>, Fault> {
    let (Some(predicted), Some(tolerance)) = (plan.prediction, plan.tolerance) else { return Ok(None) };
    if view.pixels() == 0 || !stack.is_repeatable() {
        return Ok(None);
    }
    let reference = oracle::render(scene, view, stack)?;
    let wrong_ppm = compare::triangle_ids(&frame.triangle_id, &reference.triangle_id).different as f64 * 1e6 / view.pixels() as f64;
    // Corners snap one unit apart where f32 and f64 round differently: that much no option promises.
    let snap_ppm = SNAP_PPM.max(4e6 / view.pixels() as f64);
    let is_within = |limit: f64| wrong_ppm <= limit + snap_ppm;
    Ok(Some(Check {
        predicted,
        tolerance,
        wrong_ppm,
        is_kept: is_within(tolerance.wrong_ppm.max(predicted.wrong_ppm)),
        prediction_holds: is_within(predicted.wrong_ppm),
    }))
}

/// Pixels per million whose triangle id the last bit of a corner's place may decide.
const SNAP_PPM: f64 = 100.0;

/// Lowest and highest corner of the scene's box; none when it is empty.
fn corners(scene: &Scene) -> Option<[[f64; 3]; 2]> {
    let bounds = scene.bounds();
    (!bounds.is_empty()).then(|| [bounds.min.to_array(), bounds.max.to_array()])
}

fn scene_json(scene: &Scene) -> Value {
    json!({
        "name": scene.name, "triangles": scene.triangle_count(), "vertices": scene.vertex_count(),
        "instances": scene.instances.len(), "box_m": corners(scene), "notes": scene.notes,
    })
}

fn effects_json(stack: &Stack) -> Vec<Value> {
    stack.0.iter().map(|enabled| json!({ "effect": enabled.effect.name, "hook": enabled.effect.hooks.names() })).collect()
}

fn text(
    id: &str,
    scene: &Scene,
    stack: &Stack,
    plan: Option<&Explanation>,
    check: Option<&Check>,
    flight: Option<&ParticleState>,
) -> String {
    let effects: Vec<_> = stack.0.iter().map(|enabled| format!("{} ({})", enabled.effect.name, enabled.effect.hooks.names())).collect();
    let mut text = format!(
        "look     {id}\nscene    {}: {} triangles, {} vertices, {} instances\nbox      {}\neffects  {}\n",
        scene.name,
        scene.triangle_count(),
        scene.vertex_count(),
        scene.instances.len(),
        corners(scene).map_or_else(|| "empty".into(), |[min, max]| format!("{min:.3?} to {max:.3?} m")),
        if effects.is_empty() { "none".into() } else { effects.join(", ") },
    );
    let Some(plan) = plan else { return text };
    text += &format!("key      {}\n", plan.key);
    let rows = |head: [&str; 3], rows: Vec<Vec<String>>| {
        let all: Vec<_> = std::iter::once(head.map(str::to_owned).to_vec()).chain(rows).collect();
        if all.len() > 1 { format!("\n{}", table(&all)) } else { String::new() }
    };
    let notes = |notes: &[crate::gpu::Note]| notes.iter().map(|n| vec![n.name.clone(), String::new(), n.why.clone()]).collect();
    let buffers: Vec<_> = plan.buffers.iter().map(|b| vec![b.name.clone(), b.bytes.to_string(), b.why.clone()]).collect();
    let total: u64 = plan.buffers.iter().map(|b| b.bytes).sum();
    if let Some(ParticleState { particles, steps, beyond_a_pixel, max_px, mean_m }) = flight {
        text += &format!(
            "flight   {particles} particles after {steps} steps: {beyond_a_pixel} beyond a pixel from their true flight, at most {max_px:.5} px, \
             on average {mean_m:.1e} m\n"
        );
    }
    if let Some(check) = check {
        let verdict = match (check.is_kept, check.prediction_holds) {
            (true, true) => "as foreseen",
            (true, false) => "more than predicted",
            (false, _) => "BEYOND THE TOLERANCE",
        };
        text += &format!(
            "error    predicted at most {:.0} ppm of the triangle ids, measured {:.0}, allowed {:.0}: {verdict}\n",
            check.predicted.wrong_ppm, check.wrong_ppm, check.tolerance.wrong_ppm
        );
    }
    text += &plan.sizes.as_ref().map_or_else(String::new, chart);
    text += &rows(["CHOICE", "", "WHY"], notes(&plan.reasons));
    text += &rows(["PASS", "", "WHY"], notes(&plan.passes));
    text += &rows(["BUFFER", "BYTES", "WHY"], buffers);
    text += &format!("{total} bytes in all\n");
    text + &rows(["OMITTED", "", "WHY"], notes(&plan.omitted))
}

/// Triangles by their size, a bar for every power of two.
fn chart(sizes: &SizesNote) -> String {
    const WIDEST: f64 = 40.0;
    let SizesNote { triangles, sampled, seen, cut, .. } = sizes;
    let mut text = format!("\nTRIANGLES BY SIZE  {seen} seen of {sampled} looked at, of {triangles}; {cut} reach before the near plane\n");
    let most = sizes.bins.iter().map(|(_, count)| *count).max().unwrap_or(0).max(1);
    for (up_to, count) in &sizes.bins {
        let up_to = if *up_to < 1.0 { format!("1/{}", 1.0 / up_to) } else { up_to.to_string() };
        let bar = "#".repeat((WIDEST * f64::from(*count) / f64::from(most)).ceil() as usize);
        text += &format!("  up to {up_to:>6} px  {:>5.1} %  {bar}\n", 100.0 * f64::from(*count) / f64::from((*seen).max(1)));
    }
    if let Some(SizeClasses { small, medium, large, error_bound }) = sizes.predicted {
        text += &format!("  predicted {small:.0} small, {medium:.0} medium, {large:.0} large, each give or take {error_bound:.0}");
        if let Some([medium, large]) = sizes.counted {
            text += &format!("; the queues counted {medium} medium, {large} large");
        }
        text += match sizes.prediction_holds {
            Some(true) => ": as foreseen\n",
            Some(false) => ": NOT AS FORESEEN\n",
            None => "\n",
        };
    }
    text
}
