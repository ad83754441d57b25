//! `verify`: compares every buffer of each preset with the oracle, with every visibility option of
//! the adapter.

use std::{path::Path, sync::Arc};

use serde_json::{Value, json};

use super::{
    args::{Common, Verify},
    backend::{Backend, scene_of, tell},
    error::{CliError, Exit},
    files::{self, Names},
    open::presets,
    streams::{Streams, number, table},
};
use crate::{
    accuracy::{Skinning, Transparency},
    effect_files::{self, Crossing, Unsound},
    effects::Stack,
    frame::Frame,
    gpu::Capture,
    measure::{
        ErrorReport,
        compare::{difference_picture, pictures, triangle_ids},
    },
    oracle,
    preset::{GoldenTest, Preset, Visibility},
    preset_file::{self, PresetFile},
    scene::{Scene, draw::draws},
};

/// How a preset is verified.
#[derive(Clone, Debug, Default)]
pub struct Options<'a> {
    /// Number of frames beyond the first; all must be bit-identical.
    pub repeats: u32,
    /// Size in pixels instead of the preset's own.
    pub size: Option<[u32; 2]>,
    /// Folder for pictures of expected, actual and difference side by side.
    pub output: Option<&'a Path>,
    /// Any number of pixels may lie in a depth band or step band, where several answers are right.
    pub allows_any_band: bool,
}

/// One preset with one option.
pub struct Row {
    preset: String,
    /// Look and scene, where a look has landed on another scene.
    landed: Option<[String; 2]>,
    /// Effects that have no independent twin.
    judged_by_own_text: Vec<String>,
    pub option: &'static str,
    accuracy: ErrorReport,
    /// Pixels with a color channel over the preset's budget.
    pixels_over_tolerance: u64,
    frames: u32,
    /// An effect of a file on the finished picture, where colors differ.
    image_effect: Option<String>,
    /// What failed, one sentence each.
    pub failures: Vec<String>,
    /// What the preset allows to err without saying by how much: pinned options and the tier.
    pub without_budget: Vec<String>,
    /// What each effect makes that is no color, and where, one sentence each.
    unsound: Vec<String>,
    /// Volume with linear skinning, as a fraction of that with dual quaternions; none without
    /// skins.
    volume: Option<f64>,
}

pub fn run(common: &Common, args: &Verify, streams: &mut Streams) -> Result<Exit, CliError> {
    let mut preset_files = presets(common, &args.inputs, streams)?;
    let mut backend = Backend::open(common, streams)?;
    if let Some(folder) = &args.output {
        std::fs::create_dir_all(folder).map_err(|e| {
            CliError::from(e).during(format!("{} cannot be created", folder.display()))
        })?;
    }
    let options = Options {
        repeats: args.frames - 1,
        size: args.size,
        output: args.output.as_deref(),
        allows_any_band: false,
    };
    let bar = streams.progress(preset_files.len() as u64);
    let mut rows = Vec::new();
    for preset_file in &mut preset_files {
        bar.set_message(preset_file.id.clone());
        let verified = scene_of(common, preset_file, streams).and_then(|scene| {
            tell(&preset_file.preset, &scene, streams);
            let checked = check(common, &options, preset_file, &scene, &mut backend);
            checked.map_err(|error| error.during(format!("preset {}", preset_file.id)))
        });
        match (verified, &preset_file.preset.test) {
            (Err(error), Some(test)) if test.expects_refusal(&error.sentence()) => {
                streams.note(&format!(
                    "{}: refused as its test asks: {}",
                    preset_file.id,
                    error.sentence()
                ));
            }
            (verified, _) => rows.extend(verified?),
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if matches!(backend, Backend::Oracle) {
        streams.note("the oracle is the reference: its picture is compared with itself, and nothing can differ");
    }
    if streams.json {
        let results = rows.iter().map(|row| json_row(row, &backend)).collect();
        streams.object("verify", backend.json(), results)?;
    } else {
        streams.text(&text(&rows, backend.class()))?;
    }
    tell_notes(&preset_files, &rows, streams);
    Ok(Exit::failed_if(
        rows.iter().any(|row| !row.failures.is_empty()),
    ))
}

/// Says of each row what its figures do not.
fn tell_notes(preset_files: &[PresetFile], rows: &[Row], streams: &mut Streams) {
    for preset_file in preset_files {
        let names = judged_by_own_text(&preset_file.preset).join(", ");
        if !names.is_empty() {
            streams.note(&format!(
                "{}: {names} judged by its own text in f64, the rasterizer by an independent twin",
                preset_file.id
            ));
        }
    }
    for (row, unsound) in rows
        .iter()
        .flat_map(|row| row.unsound.iter().map(move |u| (row, u)))
    {
        streams.note(&format!("{} with {}: {unsound}", row.preset, row.option));
    }
    rows.iter().filter(|row| row.accuracy.race_pixels > 0).for_each(|row| {
        streams.note(&format!(
            "{} with {}: {} pixels show the wrong one of the triangles that cover them, because of the race",
            row.preset, row.option, row.accuracy.race_pixels
        ));
    });
    rows.iter()
        .filter(|row| row.accuracy.deformed_vertices > 0)
        .for_each(|row| {
            let a = &row.accuracy;
            streams.note(&format!(
            "{} with {}: {} deformed vertices, at most {:.5} px and {:.1} ulp from the oracle's{}",
            row.preset,
            row.option,
            a.deformed_vertices,
            a.max_deform_px,
            a.max_deform_ulp,
            row.volume.map_or_else(String::new, |fraction| format!(
                "; linear skinning keeps {:.2} % of the volume with dual quaternions",
                100.0 * fraction
            ))
        ));
        });
    rows.iter().filter(|row| row.accuracy.particles > 0).for_each(|row| {
        let a = &row.accuracy;
        streams.note(&format!(
            "{} with {}: {} particles, {} of them more than a pixel from the oracle's, at most {:.5} px, on average {:.1e} m",
            row.preset, row.option, a.particles, a.particles_diverged, a.max_divergence_px, a.mean_divergence_m
        ));
    });
    for row in rows.iter().filter(|row| !row.without_budget.is_empty()) {
        streams.note(&format!(
            "{} with {}: {} may err by design, and the preset states no budget for it; add [test] with max_wrong_triangles, max_channel or \
             max_pixels, and why",
            row.preset,
            row.option,
            row.without_budget.join(" and ")
        ));
    }
    rows.iter().for_each(|row| {
        row.failures.iter().for_each(|failure| {
            streams.note(&format!("{} with {}: {failure}", row.preset, row.option))
        });
        if let (false, Some(effect)) = (row.failures.is_empty(), &row.image_effect) {
            streams.note(&format!(
                "{} with {}: where the colors of {effect} lie on steps, and that is meant, let them: [test] max_pixels = {} and why; --output DIR shows which pixels differ",
                row.preset, row.option, row.pixels_over_tolerance
            ));
        }
    });
}

/// The effects of a preset that have no independent twin: the oracle evaluates their own text in
/// f64.
fn judged_by_own_text(preset: &Preset) -> Vec<String> {
    preset
        .stack
        .0
        .iter()
        .map(|enabled| &enabled.effect)
        .filter(|effect| effect.is_of_file())
        .map(|effect| effect.name.clone())
        .collect()
}

/// Compares a preset with the oracle, with every visibility option that it allows.
pub fn check(
    common: &Common,
    options: &Options<'_>,
    preset_file: &PresetFile,
    scene: &Arc<Scene>,
    backend: &mut Backend,
) -> Result<Vec<Row>, CliError> {
    let mut preset = preset_file.preset.clone();
    if let Some(size) = options.size {
        preset.output.resize(size);
    }
    let (view, stack) = (
        preset.view(scene, preset.output.size),
        preset.stack_on(scene, preset.output.size),
    );
    let budget = preset.test.clone().unwrap_or_default();
    if let Backend::Gpu(..) = backend {
        // Before anything is drawn.
        oracle::can_judge(scene, &view, &stack, preset.accuracy.scale().factor())?;
    }
    let image_effect = preset.stack.0.iter().find_map(|enabled| {
        let effect = &enabled.effect;
        let is_image = effect.hooks.passes.is_some() || effect.hooks.image.is_some();
        (effect.is_of_file() && is_image).then(|| effect.name.clone())
    });
    let volume = volume_fraction(&preset, scene)?;
    let (mut rows, mut first): (Vec<Row>, Option<(&str, Frame)>) = (Vec::new(), None);
    for option in backend.options(&preset) {
        let mut pinned = preset.clone();
        pinned.accuracy.pins = option.map_or(preset.accuracy.pins, |option| {
            preset.accuracy.pins.with(option)
        });
        let name = option.map_or("exact", Visibility::name);
        let capture = backend.capture(&pinned, scene, false)?;
        // Built-in effects are held by tests; those of files are watched while they are judged.
        let is_watched = !judged_by_own_text(&preset).is_empty();
        let judge = |stack: &Stack| {
            if is_watched && matches!(backend, Backend::Oracle) {
                // It compares nothing, so it draws for what watches.
                oracle::render(scene, &view, stack)?;
            }
            backend.judged(scene, &view, stack, &capture)
        };
        let (verdict, crossings, overreaching) = if is_watched {
            let (judged, overreaching) =
                effect_files::overreaching(&stack, |stack| effect_files::crossings(stack, judge));
            let (verdict, crossings) = judged.map_err(CliError::usage)?;
            (verdict, crossings, overreaching)
        } else {
            (judge(&stack), Vec::new(), Vec::new())
        };
        let verdict = verdict?;
        let pixels_over_tolerance = budget.pixels_over_tolerance(&verdict, &capture.frame);
        let mut failures = budget.faults(
            &verdict.report,
            pixels_over_tolerance,
            options.allows_any_band,
        );
        failures.extend(scaling_failure(&capture));
        let most = pinned.accuracy.pins.option();
        if let Some(most) = most.and_then(Transparency::most_layers) {
            let mut nearest = capture.clone();
            nearest.frame.glass = capture.frame.glass.nearest(most as usize);
            let off = backend.judged(scene, &view, &stack, &nearest)?;
            let off = off.report.max_color_delta;
            if off > 1 {
                failures.push(format!("{off} of 255 off {most} nearest layers"));
            }
        }
        failures.extend(overreaching.iter().map(|(effect, factor)| {
            format!(
                "{} would move a vertex {factor:.2} times as far as its parameters with @unit(m) add up to, or its @reach says, and is held there; let it move less, or state more",
                effect.name
            )
        }));
        failures.extend(budget.count_faults(&capture.frame, capture.layers.as_deref()));
        if !budget.refused.is_empty() {
            failures.push(format!(
                "it was drawn but must be refused: {}",
                budget.refused
            ));
        }
        let is_repeatable = preset.stack.is_repeatable() && !preset.accuracy.is_left_to_chance();
        for repeat in 1..=options.repeats {
            if is_repeatable && backend.capture(&pinned, scene, true)?.frame != capture.frame {
                failures.push(format!(
                    "frame {} is not bit-identical to the first",
                    repeat + 1
                ));
                break;
            }
        }
        if let Some((other, frame)) = first.as_ref().filter(|_| is_repeatable) {
            let different = triangle_ids(&capture.frame.triangle_id, &frame.triangle_id).different;
            if different > u64::from(budget.max_wrong_triangles) {
                failures.push(format!(
                    "{different} pixels have another triangle than with {other}"
                ));
            }
        }
        if let Some(folder) = options.output {
            triptych(
                folder,
                &format!("{}-{name}", preset_file.id),
                &verdict.expected,
                &capture.frame,
                common.force,
            )?;
        }
        rows.push(Row {
            preset: preset_file.id.clone(),
            landed: preset_file
                .look
                .as_ref()
                .map(|look| [look.id.clone(), preset_file.scene_name()]),
            judged_by_own_text: judged_by_own_text(&preset),
            unsound: unsound(&crossings),
            option: name,
            accuracy: verdict.report,
            pixels_over_tolerance,
            image_effect: image_effect.clone().filter(|_| pixels_over_tolerance > 0),
            frames: 1 + options.repeats,
            without_budget: if failures.is_empty() {
                Vec::new()
            } else {
                without_budget(&preset, pixels_over_tolerance)
            },
            failures,
            volume,
        });
        first.get_or_insert((name, capture.frame));
    }
    Ok(rows)
}

/// What a preset allows to err although its budget allows no wrong triangle and no wider difference
/// of color. A number of pixels alone is a budget where these are so few.
fn without_budget(preset: &Preset, pixels_over_tolerance: u64) -> Vec<String> {
    let (budget, default) = (
        preset.test.clone().unwrap_or_default(),
        GoldenTest::default(),
    );
    let has_pixels = budget.max_pixels > 0 && pixels_over_tolerance > u64::from(budget.max_pixels);
    if has_pixels || budget.max_wrong_triangles > 0 || budget.max_channel > default.max_channel {
        return Vec::new();
    }
    let accuracy = &preset.accuracy;
    let tier =
        (accuracy.tolerance().wrong_ppm > 0.0).then(|| format!("tier={}", accuracy.tier.name()));
    accuracy.inexact_pins().chain(tier).collect()
}

/// Compares the scaling from drawn to shown pixels with the oracle's.
fn scaling_failure(capture: &Capture) -> Option<String> {
    let shown = capture.shown.as_ref()?;
    let drawn = &capture.frame;
    let right = oracle::resampled(
        &drawn.color,
        [drawn.width, drawn.height],
        [shown.width, shown.height],
    );
    let delta = pictures(&shown.color, &right, 1);
    (delta.pixels_over_tolerance > 0).then(|| {
        format!(
            "{} scaled pixels differ from the oracle's by up to {} of 255",
            delta.pixels_over_tolerance, delta.max_delta
        )
    })
}

/// Volume with linear skinning, as a fraction of that with dual quaternions; none without skins.
fn volume_fraction(preset: &Preset, scene: &Scene) -> Result<Option<f64>, CliError> {
    if scene.rig.skins.is_empty() {
        return Ok(None);
    }
    let volume = |skinning: Skinning| -> Result<f64, CliError> {
        let accuracy = crate::preset::AccuracyRequest {
            pins: preset.accuracy.pins.with(skinning),
            ..preset.accuracy
        };
        let view = Preset {
            accuracy,
            ..preset.clone()
        }
        .view(scene, [64, 64]);
        Ok(oracle::volume(scene, &draws(scene, &view)?))
    };
    let (linear, dual) = (volume(Skinning::Linear)?, volume(Skinning::Dual)?);
    Ok((dual != 0.0).then_some(linear / dual))
}

/// Writes expected, actual and difference side by side; pixels with another triangle are magenta.
fn triptych(
    folder: &Path,
    name: &str,
    expected: &Frame,
    actual: &Frame,
    force: bool,
) -> Result<(), CliError> {
    let mut difference = difference_picture(&expected.color, &actual.color, 16);
    for (pixel, (a, b)) in difference
        .iter_mut()
        .zip(expected.triangle_id.iter().zip(&actual.triangle_id))
    {
        if a != b {
            *pixel = [255, 0, 255, 255];
        }
    }
    let width = expected.width.max(1) as usize;
    let sides = [&expected.color, &actual.color, &difference];
    let rows = (0..expected.height as usize)
        .flat_map(|y| sides.map(|side| side[y * width..][..width].to_vec()));
    let picture: Vec<[u8; 4]> = rows.flatten().collect();
    let (template, names) = (
        folder.join("{preset}.png"),
        Names {
            preset: name.into(),
            ..Names::default()
        },
    );
    let png = preset_file::png_bytes(&picture, [expected.width * 3, expected.height])?;
    files::create(&template.to_string_lossy(), &names, force, &png).map(drop)
}

fn text(rows: &[Row], class: &str) -> String {
    let head = [
        "PRESET",
        "OPTION",
        "CLASS",
        "WRONG",
        "BY ROUNDING",
        "HOLES",
        "DOUBLE",
        "NO ID",
        "OVERFLOW",
        "STEPS",
        "MAX",
        "RMS",
        "VERDICT",
    ];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    lines.extend(rows.iter().map(|row| {
        let a = &row.accuracy;
        let counts = [
            a.wrong_triangles,
            a.explained_by_snap,
            a.holes,
            a.double_hits,
            a.depth_without_id,
            a.overflow,
            a.step_band_pixels,
            a.max_color_delta.into(),
        ];
        let mut line = vec![row.preset.clone(), row.option.into(), class.into()];
        line.extend(counts.map(|count| count.to_string()));
        let verdict = match (row.failures.is_empty(), row.without_budget.is_empty()) {
            (true, _) => "ok",
            (false, false) => "no budget",
            (false, true) => "FAIL",
        };
        line.extend([format!("{:.4}", a.rms_color_delta), verdict.into()]);
        line
    }));
    table(&lines)
}

/// The row with every number of the error report.
fn json_row(row: &Row, backend: &Backend) -> Value {
    let mut object = json!({
        "preset": row.preset, "option": row.option, "adapter": backend.name(), "class": backend.class(),
        "frames": row.frames, "pixels_over_tolerance": row.pixels_over_tolerance, "ok": row.failures.is_empty(), "failures": row.failures,
        "judged_by_own_text": row.judged_by_own_text, "without_budget": row.without_budget,
    });
    if let (Value::Object(object), Ok(Value::Object(stats))) =
        (&mut object, serde_json::to_value(&row.accuracy))
    {
        object.extend(stats);
    }
    if let Some([look, model]) = &row.landed {
        (object["look"], object["model"]) = (json!(look), json!(model));
    }
    object["rms_color_delta"] = number(row.accuracy.rms_color_delta);
    object
}

/// A sentence for each effect that makes what is not finite.
fn unsound(crossings: &[Crossing]) -> Vec<String> {
    let is_not_finite = |crossing: &&Crossing| crossing.made != Unsound::Negative;
    let mut of_effects: Vec<(&Crossing, u64)> = Vec::new();
    for crossing in crossings.iter().filter(is_not_finite) {
        let known = of_effects
            .iter_mut()
            .find(|(first, _)| first.effect == crossing.effect);
        match known {
            Some((_, count)) => *count += 1,
            None => of_effects.push((crossing, 1)),
        }
    }
    let sentence = |(first, count): (&Crossing, u64)| {
        let ([x, y], effect, made) = (first.pixel, &first.effect.name, first.made.word());
        format!("{effect} makes {made} at {count} pixels, the first at {x}, {y}")
    };
    of_effects.into_iter().map(sentence).collect()
}
