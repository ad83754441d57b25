//! `probe`: why a pixel shows what it shows. Every triangle whose box holds one of its samples, with
//! the integers that decide; the color after each effect, beside the oracle's; what other options
//! of the accuracy axes decide there.

use std::sync::Arc;

use clap::Args;
use serde_json::{Value, json};

use super::{
    args::Common,
    backend::{Backend, scene_of},
    error::{CliError, Exit},
    open::{named, open_as},
    streams::{Streams, table},
    values::size,
};
use crate::{
    accuracy::{AXES, AccuracyOptions},
    effects::{EnabledEffect, hooks::Slot},
    frame::{Geometry, NO_TRIANGLE},
    gpu::Capture,
    oracle::{self, ProbedSample, ProbedTriangle},
    preset::Preset,
    scene::Scene,
};

#[derive(Args, Debug)]
pub struct Probe {
    #[arg(value_name = "PRESET")]
    pub input: String,
    /// Column and row of the pixel, 0,0 at the top left
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    pub pixel: [u32; 2],
    /// Also draw the picture with every option of every accuracy axis, and tell what each decides
    /// at the pixel
    #[arg(long)]
    pub options: bool,
    /// Size in pixels instead of the preset's own
    #[arg(long, value_name = "WxH|NAME", value_parser = size)]
    pub size: Option<[u32; 2]>,
}

fn pixel(text: &str) -> Result<[u32; 2], String> {
    let place = |text: &str| text.trim().parse().ok();
    text.split_once(',')
        .and_then(|(x, y)| Some([place(x)?, place(y)?]))
        .ok_or_else(|| {
            format!("{text:?} is no pixel; write its column and row, for instance 320,200")
        })
}

pub fn run(common: &Common, args: &Probe, streams: &mut Streams) -> Result<Exit, CliError> {
    let mut preset_file = open_as(common, &args.input, args.size, None, None)?;
    let (size, pixel) = (preset_file.preset.output.size, args.pixel);
    if pixel[0] >= size[0] || pixel[1] >= size[1] {
        return Err(CliError::usage(format!(
            "--pixel {},{}: {} has {} x {} pixels, so columns go from 0 to {} and rows from 0 to {}",
            pixel[0],
            pixel[1],
            preset_file.id,
            size[0],
            size[1],
            size[0].saturating_sub(1),
            size[1].saturating_sub(1)
        )));
    }
    let scene = scene_of(common, &mut preset_file, streams)?;
    let mut backend = Backend::open(common, streams)?;
    let preset = &preset_file.preset;
    let capture = backend.capture(preset, &scene, false)?;
    let planned = match &backend {
        Backend::Gpu(renderer, _) => renderer.plan().map(|plan| plan.key.options),
        Backend::Oracle => None,
    };
    let samples = samples(preset, &scene, &capture.geometry, pixel)?;
    let steps = steps(preset, &scene, &mut backend, pixel)?;
    let options = if args.options {
        options(preset, &scene, &mut backend, pixel, planned, streams)?
    } else {
        Vec::new()
    };
    let drawn: Vec<u32> = samples
        .iter()
        .map(|sample| capture.frame.triangle_id[index(&capture, sample.pixel)])
        .collect();
    if streams.json {
        let result = json!({
            "pixel": pixel,
            "samples": samples.iter().zip(&drawn)
                .map(|(sample, id)| sample_json(sample, *id, &capture.geometry)).collect::<Vec<_>>(),
            "steps": steps.iter().map(step_json).collect::<Vec<_>>(),
            "options": options.iter().map(option_json).collect::<Vec<_>>(),
        });
        streams.object("probe", backend.json(), vec![named(&preset_file, result)])?;
    } else {
        let mut text = String::new();
        for (sample, id) in samples.iter().zip(&drawn) {
            text += &sample.text(capture.geometry.subpixel_bits);
            if *id != sample.decided.triangle_id {
                text += &format!("the adapter drew triangle {}\n", id_word(*id));
            }
        }
        text += &format!("\n{}", steps_text(&steps, &backend));
        if !options.is_empty() {
            text += &format!("\n{}", options_text(&options));
        }
        streams.text(&text)?;
    }
    Ok(Exit::Done)
}

/// Index of a drawn pixel in the images of a capture.
fn index(capture: &Capture, [x, y]: [u32; 2]) -> usize {
    y as usize * capture.frame.width as usize + x as usize
}

/// The drawn pixels that a shown one is made of: several where it is anti-aliased, one that others
/// share where fewer are drawn.
fn drawn_pixels([x, y]: [u32; 2], scale: f64) -> Vec<[u32; 2]> {
    if scale < 1.0 {
        return vec![[x, y].map(|place| (f64::from(place) * scale) as u32)];
    }
    let side = scale as u32;
    (0..side * side)
        .map(|k| [x * side + k % side, y * side + k / side])
        .collect()
}

fn samples(
    preset: &Preset,
    scene: &Scene,
    geometry: &Geometry,
    pixel: [u32; 2],
) -> Result<Vec<ProbedSample>, CliError> {
    let size = preset.output.size;
    let (view, stack) = (preset.view(scene, size), preset.stack_on(scene, size));
    let pixels = drawn_pixels(pixel, geometry.scale);
    Ok(oracle::probe(scene, &view, &stack, geometry, &pixels)?)
}

/// The color of the pixel after an effect.
struct Step {
    effect: String,
    oracle: [u8; 4],
    adapter: [u8; 4],
}

/// The pixel after each effect that colors: pictures of the preset without the effects behind it.
fn steps(
    preset: &Preset,
    scene: &Arc<Scene>,
    backend: &mut Backend,
    pixel: [u32; 2],
) -> Result<Vec<Step>, CliError> {
    let effects = &preset.stack.0;
    let coloring = (0..effects.len()).filter(|&i| colors(&effects[i]));
    let mut steps = Vec::new();
    for last in [None].into_iter().chain(coloring.map(Some)) {
        let mut shown = preset.clone();
        let mut place = 0..;
        shown.stack.0.retain(|enabled| {
            let i = place.next().expect("it has no end");
            !colors(enabled) || last.is_some_and(|last| i <= last)
        });
        let oracle = Backend::Oracle.pixel(&shown, scene, pixel)?;
        let adapter = match backend {
            Backend::Oracle => oracle,
            Backend::Gpu(..) => backend.pixel(&shown, scene, pixel)?,
        };
        steps.push(Step {
            effect: last.map_or_else(
                || "the material".to_owned(),
                |i| effects[i].effect.name.clone(),
            ),
            oracle,
            adapter,
        });
    }
    Ok(steps)
}

/// Does the effect change colors, and not only where something is or whether it is drawn?
fn colors(enabled: &EnabledEffect) -> bool {
    let hooks = &enabled.effect.hooks;
    hooks.surface.is_some()
        || hooks.image.is_some()
        || hooks.has_lines
        || hooks.slot == Some(Slot::Visibility)
}

/// What an option of an accuracy axis decides at the pixel.
struct Decided {
    option: String,
    is_planned: bool,
    /// Triangle id, depth key and color of the first sample, or why it cannot be drawn.
    at_sample: Result<(u32, u32, [u8; 4]), String>,
}

fn options(
    preset: &Preset,
    scene: &Arc<Scene>,
    backend: &mut Backend,
    pixel: [u32; 2],
    planned: Option<AccuracyOptions>,
    streams: &Streams,
) -> Result<Vec<Decided>, CliError> {
    let Some(planned) = planned else {
        return Err(CliError::usage(
            "--options needs a GPU adapter; the oracle has one way to draw a picture",
        ));
    };
    let bar = streams.progress(AXES.iter().map(|axis| axis.words.len() as u64).sum());
    let mut decided = Vec::new();
    for axis in AXES {
        for (index, word) in axis.words.iter().enumerate() {
            bar.set_message(format!("{}={word}", axis.name));
            let mut pinned = preset.clone();
            pinned.accuracy.pins.set(axis, Some(index));
            let at_sample = backend.capture(&pinned, scene, false).map(|capture| {
                let first = drawn_pixels(pixel, capture.geometry.scale)[0];
                let at = self::index(&capture, first);
                let frame = &capture.frame;
                (frame.triangle_id[at], frame.depth_key[at], frame.color[at])
            });
            decided.push(Decided {
                option: format!("{}={word}", axis.name),
                is_planned: planned.get(axis) == index,
                at_sample: at_sample.map_err(|error| error.sentence()),
            });
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    Ok(decided)
}

fn id_word(id: u32) -> String {
    if id == NO_TRIANGLE {
        "none".into()
    } else {
        id.to_string()
    }
}

fn color_word([r, g, b, a]: [u8; 4]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}{a:02x}")
}

/// The largest difference of a channel, of 255.
fn difference(a: [u8; 4], b: [u8; 4]) -> u8 {
    (0..4).map(|k| a[k].abs_diff(b[k])).max().unwrap_or(0)
}

fn steps_text(steps: &[Step], backend: &Backend) -> String {
    let heads = ["COLOR AFTER", "ORACLE", "ADAPTER", "DIFFERENCE OF 255"];
    let mut rows = vec![heads.map(str::to_owned).to_vec()];
    if matches!(backend, Backend::Oracle) {
        rows[0].truncate(2);
    }
    let columns = rows[0].len();
    rows.extend(steps.iter().map(|step| {
        let mut row = vec![
            step.effect.clone(),
            color_word(step.oracle),
            color_word(step.adapter),
            difference(step.oracle, step.adapter).to_string(),
        ];
        row.truncate(columns);
        row
    }));
    table(&rows)
}

fn options_text(options: &[Decided]) -> String {
    let heads = ["OPTION", "TRIANGLE", "DEPTH KEY", "COLOR", ""];
    let mut rows = vec![heads.map(str::to_owned).to_vec()];
    rows.extend(options.iter().map(|decided| {
        let planned = if decided.is_planned { "planned" } else { "" };
        match &decided.at_sample {
            Ok((id, key, color)) => vec![
                decided.option.clone(),
                id_word(*id),
                format!("{key:#010x}"),
                color_word(*color),
                planned.into(),
            ],
            Err(why) => vec![
                decided.option.clone(),
                "-".into(),
                "-".into(),
                "-".into(),
                why.clone(),
            ],
        }
    }));
    table(&rows)
}

fn sample_json(sample: &ProbedSample, drawn: u32, geometry: &Geometry) -> Value {
    let decided = &sample.decided;
    let triangle = |triangle: &ProbedTriangle| {
        json!({
            "id": triangle.id, "part": triangle.primitive, "is_clipped": triangle.is_clipped,
            "outcome": triangle.outcome.to_string(), "depth_key": triangle.depth_key,
            "edges": triangle.edges.map(|edge| json!({ "value": edge.value, "along": edge.along, "is_inside": edge.is_inside() })),
            "corners": triangle.corners.map(|corner| json!({ "x": corner.x, "y": corner.y, "depth": corner.depth })),
        })
    };
    json!({
        "drawn_pixel": sample.pixel, "subpixel_bits": geometry.subpixel_bits,
        "triangle": decided.triangle_id, "depth_key": decided.depth_key, "layers": decided.layers,
        "adapter_triangle": drawn, "triangles": sample.triangles.iter().map(triangle).collect::<Vec<_>>(),
    })
}

fn step_json(step: &Step) -> Value {
    json!({
        "after": step.effect, "oracle": step.oracle, "adapter": step.adapter,
        "difference": difference(step.oracle, step.adapter),
    })
}

fn option_json(decided: &Decided) -> Value {
    match &decided.at_sample {
        Ok((id, key, color)) => {
            json!({ "option": decided.option, "is_planned": decided.is_planned, "triangle": id, "depth_key": key, "color": color })
        }
        Err(why) => {
            json!({ "option": decided.option, "is_planned": decided.is_planned, "error": why })
        }
    }
}
