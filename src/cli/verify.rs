//! `verify`: each look on the adapter against the oracle, every buffer, on every visibility rung the adapter has.

use std::path::Path;

use serde_json::{Value, json};

use super::{
    args::{Common, Verify},
    fault::{Exit, Fault},
    files::{self, Names},
    looks,
    painter::{Painter, scene_of},
    streams::{Streams, number, table},
};
use crate::{
    frame::Frame,
    gpu::Capture,
    ladder::Skinning,
    measure::{
        Accuracy, Budget,
        compare::{difference_picture, owners, pictures},
    },
    oracle,
    preset::{self, Look},
    scene::{Scene, draw::draws},
    session::{Session, Test, Visibility},
};

/// One look on one rung.
struct Row {
    look: String,
    rung: &'static str,
    accuracy: Accuracy,
    /// Pixels with a colour channel beyond the look's budget.
    pixels_beyond: u64,
    frames: u32,
    /// What failed, one sentence each.
    failures: Vec<String>,
    /// Share of the volume that dual quaternions keep, by the linear blend: where joints hold a mesh.
    volume: Option<f64>,
}

pub fn run(common: &Common, args: &Verify, streams: &mut Streams) -> Result<Exit, Fault> {
    let looks = looks(common, &args.looks, streams)?;
    let mut painter = Painter::open(common, streams)?;
    if let Some(folder) = &args.output {
        std::fs::create_dir_all(folder).map_err(|e| Fault::from(e).during(format!("{} cannot be made", folder.display())))?;
    }
    let bar = streams.progress(looks.len() as u64);
    let mut rows = Vec::new();
    for look in &looks {
        bar.set_message(look.id.clone());
        rows.extend(verify(common, args, look, &mut painter).map_err(|fault| fault.during(format!("look {}", look.id)))?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    if streams.json {
        let results = rows.iter().map(|row| json_row(row, &painter)).collect();
        streams.object("verify", painter.json(), results)?;
    } else {
        streams.text(&text(&rows, painter.class()))?;
    }
    rows.iter().filter(|row| row.accuracy.race_pixels > 0).for_each(|row| {
        streams.note(&format!(
            "{} on {}: {} pixels were lost to the race, each to a triangle that covers it",
            row.look, row.rung, row.accuracy.race_pixels
        ));
    });
    rows.iter().filter(|row| row.accuracy.bent_vertices > 0).for_each(|row| {
        let a = &row.accuracy;
        streams.note(&format!(
            "{} on {}: {} bent vertices, at most {:.5} px and {:.1} ulp from the oracle's{}",
            row.look,
            row.rung,
            a.bent_vertices,
            a.max_bend_px,
            a.max_bend_ulp,
            row.volume
                .map_or_else(String::new, |share| format!("; linear skinning has {:.2} % of the volume that dual has", 100.0 * share))
        ));
    });
    rows.iter().filter(|row| row.accuracy.particles > 0).for_each(|row| {
        let a = &row.accuracy;
        streams.note(&format!(
            "{} on {}: {} particles, {} of them more than a pixel from their true flight, at most {:.5} px, on average {:.1e} m",
            row.look, row.rung, a.particles, a.particles_astray, a.max_astray_px, a.mean_astray_m
        ));
    });
    rows.iter().for_each(|row| row.failures.iter().for_each(|failure| streams.note(&format!("{} on {}: {failure}", row.look, row.rung))));
    Ok(Exit::failed_if(rows.iter().any(|row| !row.failures.is_empty())))
}

fn verify(common: &Common, args: &Verify, look: &Look, painter: &mut Painter) -> Result<Vec<Row>, Fault> {
    let mut session = look.session.clone();
    session.output.size = args.size.unwrap_or(session.output.size);
    let scene = scene_of(look)?;
    let (view, stack) = (session.view(&scene, session.output.size), session.posed_stack());
    let budget = session.test.clone().unwrap_or_default();
    let volume = volume_share(&session, &scene)?;
    let (mut rows, mut first): (Vec<Row>, Option<(&str, Frame)>) = (Vec::new(), None);
    for rung in painter.rungs(&session) {
        let mut pinned = session.clone();
        pinned.accuracy.pins = rung.map_or(session.accuracy.pins, |rung| session.accuracy.pins.with(rung));
        let name = rung.map_or("exact", Visibility::name);
        let capture = painter.capture(&pinned, &scene)?;
        let layers = capture.layers.as_deref();
        let previous = capture.previous.as_deref();
        let verdict = oracle::judge_after(&scene, &view, &stack, &capture.frame, &capture.geometry, layers, previous)?;
        // Where wrong owners have a budget, their colours are theirs: colour is held where the owner is right.
        let mut held = verdict.expected.color.clone();
        if budget.max_wrong_owner > 0 {
            let wrong = capture.frame.owner.iter().zip(&verdict.expected.owner).enumerate().filter(|(_, (a, b))| a != b);
            wrong.for_each(|(i, _)| held[i] = capture.frame.color[i]);
        }
        let pixels_beyond = pictures(&capture.frame.color, &held, budget.max_channel).pixels_beyond;
        let mut failures = failures(&verdict.accuracy, &budget, pixels_beyond);
        failures.extend(scaling_fault(&capture));
        let is_repeatable = session.stack.is_repeatable() && !session.accuracy.is_left_to_chance();
        for repeat in 1..args.frames {
            if is_repeatable && painter.capture(&pinned, &scene)?.frame != capture.frame {
                failures.push(format!("frame {} is not equal to the first, to the bit", repeat + 1));
                break;
            }
        }
        if let Some((other, frame)) = first.as_ref().filter(|_| is_repeatable) {
            let different = owners(&capture.frame.owner, &frame.owner).different;
            if different > u64::from(budget.max_wrong_owner) {
                failures.push(format!("{different} pixels have another owner than on {other}"));
            }
        }
        if let Some(folder) = &args.output {
            triptych(folder, &format!("{}-{name}", look.id), &verdict.expected, &capture.frame, common.force)?;
        }
        rows.push(Row {
            look: look.id.clone(),
            rung: name,
            accuracy: verdict.accuracy,
            pixels_beyond,
            frames: args.frames,
            failures,
            volume,
        });
        first.get_or_insert((name, capture.frame));
    }
    Ok(rows)
}

/// The pass from drawn to shown pixels, held against the oracle's.
fn scaling_fault(capture: &Capture) -> Option<String> {
    let shown = capture.shown.as_ref()?;
    let drawn = &capture.frame;
    let right = oracle::scaled(&drawn.color, [drawn.width, drawn.height], [shown.width, shown.height]);
    let delta = pictures(&shown.color, &right, 1);
    (delta.pixels_beyond > 0)
        .then(|| format!("{} shown pixels are off by up to {} of 255 from the drawn ones", delta.pixels_beyond, delta.max_delta))
}

/// Volume by the linear blend, as a share of that by dual quaternions; none where no joint holds anything.
fn volume_share(session: &Session, scene: &Scene) -> Result<Option<f64>, Fault> {
    if scene.rig.skins.is_empty() {
        return Ok(None);
    }
    let volume = |skinning: Skinning| -> Result<f64, Fault> {
        let accuracy = crate::session::Accuracy { pins: session.accuracy.pins.with(skinning), ..session.accuracy };
        let view = Session { accuracy, ..session.clone() }.view(scene, [64, 64]);
        Ok(oracle::volume(scene, &draws(scene, &view)?))
    };
    let (linear, dual) = (volume(Skinning::Linear)?, volume(Skinning::Dual)?);
    Ok((dual != 0.0).then_some(linear / dual))
}

/// Exact things have no budget unless the look asks for less; colour has the look's.
fn failures(accuracy: &Accuracy, test: &Test, pixels_beyond: u64) -> Vec<String> {
    let forgiven = pixels_beyond <= u64::from(test.max_pixels);
    let max_colour_delta = if forgiven { u8::MAX } else { test.max_channel };
    let budget = Budget { max_colour_delta, max_wrong_owner: test.max_wrong_owner.into(), ..Budget::default() };
    accuracy.within(&budget).err().map_or_else(Vec::new, |reasons| reasons.split("; ").map(str::to_owned).collect())
}

/// Expected, actual and difference side by side, with the owners that differ in magenta.
fn triptych(folder: &Path, name: &str, expected: &Frame, actual: &Frame, force: bool) -> Result<(), Fault> {
    let path = files::target(&folder.join("{preset}.png").to_string_lossy(), &Names { preset: name.into(), ..Names::default() }, force)?;
    let mut difference = difference_picture(&expected.color, &actual.color, 16);
    for (pixel, (a, b)) in difference.iter_mut().zip(expected.owner.iter().zip(&actual.owner)) {
        if a != b {
            *pixel = [255, 0, 255, 255];
        }
    }
    let width = expected.width.max(1) as usize;
    let sides = [&expected.color, &actual.color, &difference];
    let rows = (0..expected.height as usize).flat_map(|y| sides.map(|side| side[y * width..][..width].to_vec()));
    let picture: Vec<[u8; 4]> = rows.flatten().collect();
    files::write(&path, &preset::png_bytes(&picture, [expected.width * 3, expected.height])?)
}

fn text(rows: &[Row], class: &str) -> String {
    let head = ["LOOK", "RUNG", "CLASS", "OWNER", "SNAP", "HOLES", "DOUBLE", "ORPHANS", "OVERFLOW", "STEPS", "MAX", "RMS", "VERDICT"];
    let mut lines = vec![head.map(str::to_owned).to_vec()];
    lines.extend(rows.iter().map(|row| {
        let a = &row.accuracy;
        let counts = [
            a.owner_mismatch,
            a.explained_by_snap,
            a.holes,
            a.double_hits,
            a.orphans,
            a.overflow,
            a.step_band_pixels,
            a.max_colour_delta.into(),
        ];
        let mut line = vec![row.look.clone(), row.rung.into(), class.into()];
        line.extend(counts.map(|count| count.to_string()));
        line.extend([format!("{:.4}", a.rms_colour_delta), if row.failures.is_empty() { "ok" } else { "FAIL" }.into()]);
        line
    }));
    table(&lines)
}

/// The row with every figure of the judgement.
fn json_row(row: &Row, painter: &Painter) -> Value {
    let mut object = json!({
        "look": row.look, "rung": row.rung, "adapter": painter.name(), "class": painter.class(),
        "frames": row.frames, "pixels_beyond": row.pixels_beyond, "ok": row.failures.is_empty(), "failures": row.failures,
    });
    if let (Value::Object(object), Ok(Value::Object(figures))) = (&mut object, serde_json::to_value(&row.accuracy)) {
        object.extend(figures);
    }
    object["rms_colour_delta"] = number(row.accuracy.rms_colour_delta);
    object
}
