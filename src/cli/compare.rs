//! `compare`: two pictures, two looks, or one of each, in integers.

use serde_json::json;

use super::{
    args::{Common, Compare},
    fault::{Exit, Fault},
    files::{self, Names},
    open,
    painter::{Painter, scene_of},
    streams::{Streams, number},
};
use crate::{
    measure::compare::{difference_picture, owners, pictures},
    preset,
};

/// One side of a comparison.
struct Side {
    size: [u32; 2],
    color: Vec<[u8; 4]>,
    /// Only a look has owners.
    owner: Option<Vec<u32>>,
}

pub fn run(common: &Common, args: &Compare, streams: &mut Streams) -> Result<Exit, Fault> {
    let mut painter = None;
    let a = side(common, args, &args.a, &mut painter, streams)?;
    let b = side(common, args, &args.b, &mut painter, streams)?;
    if a.size != b.size {
        let [[aw, ah], [bw, bh]] = [a.size, b.size];
        return Err(Fault::usage(format!("{} is {aw}x{ah} pixels and {} is {bw}x{bh}; only pictures of one size compare", args.a, args.b)));
    }
    let delta = pictures(&a.color, &b.color, args.max_channel);
    let wrong_owner = a.owner.as_ref().zip(b.owner.as_ref()).map(|(a, b)| owners(a, b).different);
    let passes = delta.pixels_beyond <= args.max_pixels && wrong_owner.is_none_or(|wrong| wrong <= args.max_wrong_owner);
    if let Some(output) = &args.output {
        let path = files::target(output, &Names { preset: "diff".into(), ..Names::default() }, common.force)?;
        files::write(&path, &preset::png_bytes(&difference_picture(&a.color, &b.color, 16), a.size)?)?;
    }
    let places: Vec<_> = delta.offenders.iter().map(|o| (o.place(a.size[0]), o.a, o.b)).collect();
    if streams.json {
        let offenders: Vec<_> = places.iter().map(|(place, a, b)| json!({ "pixel": place, "a": a, "b": b })).collect();
        let result = json!({
            "a": args.a, "b": args.b, "max_colour_delta": delta.max_delta, "rms_colour_delta": number(delta.rms),
            "pixels_beyond": delta.pixels_beyond, "wrong_owner": wrong_owner, "ok": passes, "offenders": offenders,
        });
        streams.object("compare", painter.map_or(json!(null), |painter| painter.json()), vec![result])?;
    } else {
        let owner = wrong_owner.map_or_else(|| "not measured".into(), |wrong| wrong.to_string());
        streams.text(&format!(
            "largest difference {} of 255, rms {:.4}, pixels beyond {}: {}, wrong owners: {owner}: {}\n",
            delta.max_delta,
            delta.rms,
            args.max_channel,
            delta.pixels_beyond,
            if passes { "ok" } else { "FAIL" },
        ))?;
        places.iter().for_each(|([x, y], a, b)| streams.note(&format!("pixel {x},{y}: {a:?} against {b:?}")));
    }
    Ok(Exit::failed_if(!passes))
}

fn side(common: &Common, args: &Compare, what: &str, painter: &mut Option<Painter>, streams: &Streams) -> Result<Side, Fault> {
    if what.to_lowercase().ends_with(".png") {
        let (color, size) = preset::png_pixels(std::path::Path::new(what))?;
        return Ok(Side { size, color, owner: None });
    }
    let mut look = open(common, what)?;
    look.session.output.size = args.size.unwrap_or(look.session.output.size);
    let painter = match painter {
        Some(painter) => painter,
        None => painter.insert(Painter::open(common, streams)?),
    };
    let frame = painter.frame(&look.session, &scene_of(&look)?)?;
    Ok(Side { size: [frame.width, frame.height], color: frame.color, owner: Some(frame.owner) })
}
