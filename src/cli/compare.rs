//! `compare`: two pictures, two presets, or one of each, in integers.

use serde_json::json;

use super::{
    args::{Common, Compare},
    backend::{Backend, scene_of},
    error::{CliError, Exit},
    files::{self, Names},
    open::open_as,
    streams::{Streams, number},
};
use crate::{
    measure::compare::{difference_picture, pictures, triangle_ids},
    preset_file,
};

/// One side of a comparison.
struct Side {
    size: [u32; 2],
    color: Vec<[u8; 4]>,
    /// Only a preset has triangle ids.
    triangle_id: Option<Vec<u32>>,
}

pub fn run(common: &Common, args: &Compare, streams: &mut Streams) -> Result<Exit, CliError> {
    let mut backend = None;
    let a = side(common, args, &args.a, &mut backend, streams)?;
    let b = side(common, args, &args.b, &mut backend, streams)?;
    if a.size != b.size {
        let [[aw, ah], [bw, bh]] = [a.size, b.size];
        return Err(CliError::usage(format!(
            "{} has {aw}x{ah} pixels and {} has {bw}x{bh}; compare pictures of the same size",
            args.a, args.b
        )));
    }
    let delta = pictures(&a.color, &b.color, args.max_channel);
    let wrong_triangles = a
        .triangle_id
        .as_ref()
        .zip(b.triangle_id.as_ref())
        .map(|(a, b)| triangle_ids(a, b).different);
    let passes = delta.pixels_over_tolerance <= args.max_pixels
        && wrong_triangles.is_none_or(|wrong| wrong <= args.max_wrong_triangles);
    if let Some(output) = &args.output {
        files::check_picture_name(output)?;
        let png = preset_file::png_bytes(&difference_picture(&a.color, &b.color, 16), a.size)?;
        files::create(
            output,
            &Names {
                preset: "diff".into(),
                ..Names::default()
            },
            common.force,
            &png,
        )?;
    }
    let pixels: Vec<_> = delta
        .mismatches
        .iter()
        .map(|o| (o.pixel(a.size[0]), o.a, o.b))
        .collect();
    if streams.json {
        let mismatches: Vec<_> = pixels
            .iter()
            .map(|(pixel, a, b)| json!({ "pixel": pixel, "a": a, "b": b }))
            .collect();
        let result = json!({
            "a": args.a, "b": args.b, "look": common.preset, "max_color_delta": delta.max_delta, "rms_color_delta": number(delta.rms),
            "pixels_over_tolerance": delta.pixels_over_tolerance, "wrong_triangles": wrong_triangles, "ok": passes, "mismatches": mismatches,
        });
        streams.object(
            "compare",
            backend.map_or(json!(null), |backend| backend.json()),
            vec![result],
        )?;
    } else {
        let wrong =
            wrong_triangles.map_or_else(|| "not measured".into(), |wrong| wrong.to_string());
        streams.text(&format!(
            "largest difference {} of 255, RMS {:.4}, pixels that differ by more than {}: {}, pixels with another triangle: {wrong}: {}\n",
            delta.max_delta,
            delta.rms,
            args.max_channel,
            delta.pixels_over_tolerance,
            if passes { "ok" } else { "FAIL" },
        ))?;
        pixels
            .iter()
            .for_each(|([x, y], a, b)| streams.note(&format!("pixel {x},{y}: {a:?} and {b:?}")));
    }
    Ok(Exit::failed_if(!passes))
}

fn side(
    common: &Common,
    args: &Compare,
    what: &str,
    backend: &mut Option<Backend>,
    streams: &Streams,
) -> Result<Side, CliError> {
    if what.to_lowercase().ends_with(".png") {
        let (color, size) = preset_file::png_pixels(std::path::Path::new(what))?;
        return Ok(Side {
            size,
            color,
            triangle_id: None,
        });
    }
    let mut preset_file = open_as(common, what, args.size, None, None)?;
    let backend = match backend {
        Some(backend) => backend,
        None => backend.insert(Backend::open(common, streams)?),
    };
    let scene = scene_of(common, &mut preset_file, streams)?;
    let frame = backend.frame(&preset_file.preset, &scene)?;
    Ok(Side {
        size: [frame.width, frame.height],
        color: frame.color,
        triangle_id: Some(frame.triangle_id),
    })
}
