//! `explain`: the passes and buffers that a preset needs on this adapter, those that are omitted,
//! and why.

use pollster::FutureExt as _;
use serde_json::{Value, json};

use super::{
    args::{Common, Explain},
    backend::{Backend, scene_of},
    error::{CliError, Exit},
    open::{named, open_as},
    streams::{Streams, table},
};
use crate::{
    effects::{EnabledEffect, Stack},
    frame::Frame,
    gpu::{Capture, Explanation, SizesNote, frame_times::FrameTimes},
    measure::compare,
    oracle,
    plan::{Tolerance, predict::Prediction},
    scene::{Scene, parts::PartPattern, sizes::SizeClasses, view::View},
};

pub fn run(common: &Common, args: &Explain, streams: &mut Streams) -> Result<Exit, CliError> {
    let mut preset_file = open_as(common, &args.input, args.size, None, None)?;
    let scene = scene_of(common, &mut preset_file, streams)?;
    // Without an adapter there is no plan, but the preset can be described.
    let backend = match Backend::open(common, streams) {
        Ok(backend) => Some(backend),
        Err(error) if common.adapter_name().is_none() && error.exit == Exit::NoAdapter => {
            streams.note(&format!(
                "{}; passes and buffers are not planned",
                error.sentence()
            ));
            None
        }
        Err(error) => return Err(error),
    };
    let (mut check, mut particles, mut times) = (None, None, None);
    let (adapter, plan) = match backend {
        Some(Backend::Gpu(mut renderer, gpu)) => {
            renderer.set_scene(&scene).block_on()?;
            let preset = &preset_file.preset;
            let (view, stack) = (
                preset.view(&scene, preset.output.size),
                preset.stack_on(&scene, preset.output.size),
            );
            let capture = renderer
                .capture(&view, &stack, &preset.accuracy)
                .block_on()?;
            let factor = capture.geometry.scale;
            particles = ParticleErrors::of(&scene, &view, &stack, &capture)?;
            // Where particles have diverged, their pictures do not show the error of the options.
            if particles
                .as_ref()
                .is_none_or(|particles| particles.over_a_pixel == 0)
            {
                check = check_prediction(
                    &scene,
                    &view.scaled(factor),
                    &stack.scaled(factor),
                    &capture.frame,
                    &renderer.explain(),
                )?;
            }
            let plan = renderer.explain();
            if args.measure && view.pixels() > 0 {
                times = Some(
                    FrameTimes::of(&mut renderer, &view, &stack, &preset.accuracy).block_on()?,
                );
            }
            (
                Backend::Gpu(Box::new(crate::gpu::Renderer::new(gpu.clone())), gpu).json(),
                Some(plan),
            )
        }
        Some(Backend::Oracle) if args.measure => {
            return Err(CliError::usage(
                "--measure times an adapter; --adapter cpu, the built-in oracle, is not timed",
            ));
        }
        Some(backend) => (backend.json(), None),
        None => (Value::Null, None),
    };
    if streams.json {
        let result = json!({
            "scene": scene_json(&scene), "size": preset_file.preset.output.size,
            "effects": effects_json(&preset_file.preset.stack), "plan": plan, "check": check, "particles": particles,
            "times": times,
        });
        streams.object("explain", adapter, vec![named(&preset_file, result)])?;
    } else {
        streams.text(&text(
            &preset_file.id,
            &scene,
            &preset_file.preset.stack,
            plan.as_ref(),
            [
                times.as_ref().map(times_text),
                check.as_ref().map(check_text),
                particles.as_ref().map(particles_text),
            ],
        ))?;
    }
    Ok(Exit::failed_if(
        check.is_some_and(|check| !check.is_within_tolerance),
    ))
}

/// Particles compared with the oracle's.
#[derive(serde::Serialize)]
struct ParticleErrors {
    count: u64,
    /// Number of simulation steps.
    steps: u32,
    over_a_pixel: u64,
    max_px: f64,
    mean_m: f64,
}

impl ParticleErrors {
    /// None without particles.
    fn of(
        scene: &Scene,
        view: &View,
        stack: &Stack,
        capture: &Capture,
    ) -> Result<Option<Self>, CliError> {
        if capture.geometry.particle_readback.is_none() {
            return Ok(None);
        }
        let a = oracle::judge(scene, view, stack, &capture.picture())?.report;
        Ok(Some(Self {
            count: a.particles,
            steps: view
                .scene_state
                .particles
                .as_ref()
                .map_or(0, |particle_timeline| particle_timeline.frame),
            over_a_pixel: a.particles_diverged,
            max_px: a.max_divergence_px,
            mean_m: a.mean_divergence_m,
        }))
    }
}

/// The prediction compared with the picture.
#[derive(serde::Serialize)]
struct Check {
    predicted: Prediction,
    tolerance: Tolerance,
    /// Pixels with another triangle than in the oracle's picture, per million.
    wrong_ppm: f64,
    /// As many more are no error: their triangle may depend on the last bit of a corner's
    /// position.
    snap_ppm: f64,
    /// The picture stays within the tolerance.
    is_within_tolerance: bool,
    /// The picture stays within the prediction.
    prediction_holds: bool,
}

/// Measures the predicted error; none for a picture without pixels or one that differs from frame
/// to frame.
fn check_prediction(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    frame: &Frame,
    plan: &Explanation,
) -> Result<Option<Check>, CliError> {
    let (Some(predicted), Some(tolerance)) = (plan.prediction, plan.tolerance) else {
        return Ok(None);
    };
    if view.pixels() == 0 || !stack.is_repeatable() {
        return Ok(None);
    }
    let reference = oracle::render(scene, view, stack)?;
    let wrong_ppm =
        compare::triangle_ids(&frame.triangle_id, &reference.triangle_id).different as f64 * 1e6
            / view.pixels() as f64;
    // Where f32 and f64 round differently, corners snap one unit apart; no option prevents that.
    let snap_ppm = SNAP_PPM.max(4e6 / view.pixels() as f64);
    let is_within = |limit: f64| wrong_ppm <= limit + snap_ppm;
    Ok(Some(Check {
        predicted,
        tolerance,
        wrong_ppm,
        snap_ppm,
        is_within_tolerance: is_within(tolerance.wrong_ppm.max(predicted.wrong_ppm)),
        prediction_holds: is_within(predicted.wrong_ppm),
    }))
}

/// Pixels per million whose triangle may depend on the last bit of a corner's position.
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
    let on = |enabled: &EnabledEffect| {
        enabled
            .on
            .patterns()
            .iter()
            .map(PartPattern::to_string)
            .collect::<Vec<_>>()
    };
    let effect = |enabled: &EnabledEffect| json!({ "effect": enabled.effect.name, "hook": enabled.effect.hooks.names(), "on": on(enabled) });
    stack.0.iter().map(effect).collect()
}

fn text(
    id: &str,
    scene: &Scene,
    stack: &Stack,
    plan: Option<&Explanation>,
    [times, check, particles]: [Option<String>; 3],
) -> String {
    let preset = preset_text(id, scene, stack);
    let Some(plan) = plan else { return preset };
    let sizes = plan.sizes.as_ref().map_or_else(String::new, chart);
    let [times, check, particles] = [times, check, particles].map(Option::unwrap_or_default);
    format!(
        "{preset}kernel     {}\n{particles}{check}{times}{sizes}{}",
        plan.key,
        plan_text(plan)
    )
}

fn preset_text(id: &str, scene: &Scene, stack: &Stack) -> String {
    let effect = |enabled: &EnabledEffect| {
        let on = if enabled.on.is_whole_scene() {
            String::new()
        } else {
            format!(" on {}", enabled.on)
        };
        format!(
            "{} ({}){on}",
            enabled.effect.name,
            enabled.effect.hooks.names()
        )
    };
    let effects: Vec<_> = stack.0.iter().map(effect).collect();
    format!(
        "preset     {id}\nscene      {}: {} triangles, {} vertices, {} instances\nbounds     {}\neffects    {}\n",
        scene.name,
        scene.triangle_count(),
        scene.vertex_count(),
        scene.instances.len(),
        corners(scene).map_or_else(
            || "empty".into(),
            |[min, max]| format!("{min:.3?} to {max:.3?} m")
        ),
        if effects.is_empty() {
            "none".into()
        } else {
            effects.join(", ")
        },
    )
}

fn particles_text(particles: &ParticleErrors) -> String {
    let ParticleErrors {
        count,
        steps,
        over_a_pixel,
        max_px,
        mean_m,
    } = particles;
    format!(
        "particles  {count} after {steps} steps: {over_a_pixel} more than a pixel from the oracle's, at most {max_px:.5} px, on average \
         {mean_m:.1e} m\n"
    )
}

fn check_text(check: &Check) -> String {
    let verdict = match (check.is_within_tolerance, check.prediction_holds) {
        (true, true) => "the prediction holds",
        (true, false) => "that is more than predicted",
        (false, _) => "that is OVER THE TOLERANCE",
    };
    format!(
        "error      of a million pixels {:.0} show another triangle than the oracle's picture; at most {:.0} were predicted, and {:.0} are \
         allowed, with up to {:.0} more where corners are rounded: {verdict}\n",
        check.wrong_ppm, check.predicted.wrong_ppm, check.tolerance.wrong_ppm, check.snap_ppm
    )
}

/// Measured milliseconds of the frame and of every pass.
fn times_text(
    FrameTimes {
        whole_ms,
        passes,
        frames,
    }: &FrameTimes,
) -> String {
    let mut rows = vec![["PASS", "MS"].map(str::to_owned).to_vec()];
    rows.extend(
        passes
            .iter()
            .map(|(label, ms)| vec![label.clone(), format!("{ms:.4}")]),
    );
    let passes = if passes.is_empty() {
        String::new()
    } else {
        format!("\n{}", table(&rows))
    };
    format!("time       {whole_ms:.4} ms, measured in {frames} frames\n{passes}")
}

fn plan_text(plan: &Explanation) -> String {
    let rows = |head: [&str; 3], rows: Vec<Vec<String>>| {
        let all: Vec<_> = std::iter::once(head.map(str::to_owned).to_vec())
            .chain(rows)
            .collect();
        if all.len() > 1 {
            format!("\n{}", table(&all))
        } else {
            String::new()
        }
    };
    let notes = |notes: &[crate::gpu::Note]| {
        notes
            .iter()
            .map(|n| vec![n.name.clone(), String::new(), n.why.clone()])
            .collect()
    };
    let buffers: Vec<_> = plan
        .buffers
        .iter()
        .map(|b| vec![b.name.clone(), b.bytes.to_string(), b.why.clone()])
        .collect();
    let total: u64 = plan.buffers.iter().map(|b| b.bytes).sum();
    let mut text = rows(["CHOICE", "", "WHY"], notes(&plan.reasons));
    text += &rows(["PASS", "", "WHY"], notes(&plan.passes));
    text += &rows(["BUFFER", "BYTES", "WHY"], buffers);
    text += &format!("{total} bytes in all\n");
    text + &rows(["OMITTED", "", "WHY"], notes(&plan.omitted))
}

/// A histogram of the triangles' sizes, a bar for every power of two.
fn chart(sizes: &SizesNote) -> String {
    const WIDEST: f64 = 40.0;
    let SizesNote {
        triangles,
        sampled,
        seen,
        cut,
        ..
    } = sizes;
    let mut text = format!(
        "\nTRIANGLES BY SIZE  {seen} visible of {sampled} sampled, of {triangles} in all; {cut} cross the near plane\n"
    );
    let most = sizes
        .bins
        .iter()
        .map(|(_, count)| *count)
        .max()
        .unwrap_or(0)
        .max(1);
    for (up_to, count) in &sizes.bins {
        let up_to = if *up_to < 1.0 {
            format!("1/{}", 1.0 / up_to)
        } else {
            up_to.to_string()
        };
        let bar = "#".repeat((WIDEST * f64::from(*count) / f64::from(most)).ceil() as usize);
        text += &format!(
            "  up to {up_to:>6} px  {:>5.1} %  {bar}\n",
            100.0 * f64::from(*count) / f64::from((*seen).max(1))
        );
    }
    if let Some(SizeClasses {
        small,
        medium,
        large,
        error_bound,
    }) = sizes.predicted
    {
        text += &format!(
            "  the plan predicted {small:.0} small triangles, {medium:.0} medium and {large:.0} large ones, each ± {error_bound:.0}"
        );
        if let Some([medium, large]) = sizes.counted {
            text += &format!("; the queues counted {medium} medium and {large} large ones");
        }
        text += match sizes.prediction_holds {
            Some(true) => ": the prediction holds\n",
            Some(false) => ": NOT AS PREDICTED\n",
            None => "\n",
        };
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_told_in_a_sentence() {
        let check = Check {
            predicted: Prediction {
                wrong_ppm: 3.0,
                ..Prediction::default()
            },
            tolerance: Tolerance {
                wrong_ppm: 0.0,
                channel: 0,
            },
            wrong_ppm: 2.0,
            snap_ppm: 100.0,
            is_within_tolerance: true,
            prediction_holds: true,
        };
        let text = check_text(&check);
        assert!(
            text.contains("of a million pixels 2 show another triangle")
                && text.contains("at most 3 were predicted"),
            "{text}"
        );
    }
}
