//! `render`: one picture of each look.

use serde_json::json;

use super::{
    args::{Common, Render},
    fault::{Exit, Fault},
    files::{self, Names},
    open,
    painter::{Painter, scene_of},
    streams::Streams,
};
use crate::preset::{self, Look};

pub fn run(common: &Common, args: &Render, streams: &mut Streams) -> Result<Exit, Fault> {
    let to_stdout = args.output == "-";
    if to_stdout && (streams.json || args.looks.len() > 1) {
        return Err(Fault::usage("-o - writes one PNG and nothing else to stdout; leave out --json and further looks"));
    }
    if args.looks.len() > 1 && !(files::has_preset(&args.output)? || files::has_number(&args.output)?) {
        return Err(Fault::usage(format!("{}: several looks need {{preset}} or {{n}} in the name", args.output)));
    }
    let looks = args.looks.iter().map(|what| look(common, args, what)).collect::<Result<Vec<_>, _>>()?;
    looks.iter().flat_map(|look| &look.warnings).for_each(|warning| streams.note(warning));
    let mut painter = Painter::open(common, streams)?;
    if !to_stdout {
        // A name that is taken is better said before the work than after it.
        looks.iter().try_for_each(|look| files::target(&args.output, &names(look, &painter), common.force).map(drop))?;
    }
    let bar = streams.progress(looks.len() as u64);
    let mut results = Vec::new();
    for look in &looks {
        bar.set_message(look.id.clone());
        let scene = scene_of(look)?;
        scene.notes.iter().for_each(|note| streams.note(note));
        let frame = painter.frame(&look.session, &scene)?;
        let png = if args.bare {
            preset::png_bytes(&frame.color, [frame.width, frame.height])?
        } else {
            preset::png_with_look(&frame, look, &painter.provenance())?
        };
        bar.inc(1);
        if to_stdout {
            streams.bytes(&png)?;
            continue;
        }
        let path = files::target(&args.output, &names(look, &painter), common.force)?;
        files::write(&path, &png)?;
        results.push(json!({
            "look": look.id, "file": path.to_string_lossy(), "size": [frame.width, frame.height],
            "covered": frame.covered(), "counters": frame.counters,
        }));
        if !streams.json {
            streams.text(&format!("{}\n", path.display()))?;
        }
    }
    bar.finish_and_clear();
    if streams.json {
        streams.object("render", painter.json(), results)?;
    }
    Ok(Exit::Done)
}

/// The look with `--size`, `--time` and `--tier`, which are short for `--set`.
fn look(common: &Common, args: &Render, what: &str) -> Result<Look, Fault> {
    let mut look = open(common, what)?;
    if let Some(size) = args.size {
        look.session.output.size = size;
    }
    if let Some(time) = args.time {
        preset::set(&mut look, "clock.time_s", &format!("{time:?}"))?;
    }
    if let Some(tier) = &args.tier {
        preset::set(&mut look, "accuracy.tier", tier)?;
    }
    Ok(look)
}

pub fn names(look: &Look, painter: &Painter) -> Names {
    let effects: Vec<_> = look.session.stack.0.iter().map(|enabled| enabled.effect.name).collect();
    Names {
        preset: look.id.clone(),
        effect: if effects.is_empty() { "plain".into() } else { effects.join("+") },
        adapter: painter.name().into(),
        tier: look.session.accuracy.tier.name().into(),
        frame: None,
    }
}
