//! Promise: effects that people port from elsewhere, with noise and pictures of their own, are read
//! as they are written, and drawn by the adapter as by the oracle; faulty ones are refused with a
//! sentence that says what to do.

use std::path::{Path, PathBuf};

use rasterlab::{
    effect_files::{read_beside, stem},
    effects::{
        Effect, Stack,
        given::{Moment, words_of_view},
    },
    measure::Budget,
};

use super::common::{self, Draws as _, Reach, few_and_all};

/// Most lines of an effect.
const MOST_LINES: usize = 60;
/// Effects that are there: ten of images, five with noise, five with a picture, five that move with
/// the clock.
const COUNT: usize = 25;

/// The effects of the folder.
fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/picture/ported");
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("it is listed").path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "wgsl")
        })
        .collect();
    files.sort();
    files
}

fn every_ported_effect_is_drawn_as_the_oracle_draws_it(reach: Reach) {
    let Some(mut renderer) = common::loan() else {
        return;
    };
    let files = files();
    assert_eq!(files.len(), COUNT);
    let scene = common::scene("knot?tess=6");
    let view = common::view(&scene, [64, 48]);
    let budget = Budget {
        max_color_delta: 1,
        max_step_band_fraction: 0.2,
        max_rounding_fraction: 0.05,
        ..Budget::default()
    };
    let accuracy = Default::default();
    let lambert = Effect::find("lambert").expect("it is built in");
    let mut plain = Stack::default();
    plain.enable(lambert);
    let before = renderer.captured(&scene, &view, &plain, &accuracy);
    let mut faults = Vec::new();
    for path in reach.of(
        3,
        files
            .into_iter()
            .step_by(if reach == Reach::Few { 7 } else { 1 }),
    ) {
        let text = std::fs::read_to_string(&path).expect("it is text");
        let name = stem(&path);
        assert!(text.lines().count() <= MOST_LINES, "{name} is long");
        let read = read_beside(&format!("{name}.wgsl"), &name, &text, path.parent());
        let effect = read.unwrap_or_else(|error| panic!("{error}"));
        let mut stack = plain.clone();
        stack.enable(&effect);
        let at = |time_s: f64| {
            let moment = Moment {
                time_s,
                range_s: [0.0, 4.0],
            };
            let then = stack.clone().with_given(|given| moment.words(given));
            then.with_given(|given| words_of_view(given, [64, 48], view.eye, view.forward))
        };
        if effect.is_given_time() && at(1.3) == at(2.6) {
            faults.push(format!("{name} does not move"));
        }
        let stack = at(1.3);
        let (capture, verdict) = renderer.judged(&scene, &view, &stack, &accuracy);
        if let Err(fault) = verdict.report.within(&budget) {
            faults.push(format!("{name}: {fault}"));
        }
        let pairs = capture.frame.color.iter().zip(&before.frame.color);
        let changed = pairs.filter(|(now, then)| now != then).count();
        if changed < 64 {
            faults.push(format!("{name} changes {changed} pixels"));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Faulty effects, each with how its refusal ends.
const FAULTY: [(&str, &str); 5] = [
    (
        "struct Ink { @range(0, 1, 0.5) amount: f32 }
fn ink(at: ImageAt, p: Ink) -> vec4f { return textureSample(picture, smooth_sampler, vec2f(0.5)); }",
        "textureSample: an effect has no textures; it is a pure function of its arguments",
    ),
    (
        "struct Ink { @image(\"../grain.png\") sheet: u32 }
fn ink(at: ImageAt, p: Ink) -> vec4f { return image_file_texel(p.sheet, at.x, at.y); }",
        "the picture sheet lies outside of the folder of the effect; put the PNG beside the file and write its name alone",
    ),
    (
        "struct Ink { @image(\"grain.png\") sheet: u32, @range(0, 1, 0.1) @unit(m) height: f32 }
fn ink(v: Vertex, p: Ink) -> Vertex { return v; }",
        "sheet is a picture, which vertices and samples cannot read; put their hooks into a file of their own",
    ),
    (
        "struct Ink { @range(0, 1, 0.5) amount: f32 }
fn ink(surface: Surface, p: Ink) -> Surface {
    var s = surface;
    s.color = vec4f(noise_value(s.position, 1u));
    return s;
}",
        "lib/noise declares it: add the line //@ use lib/noise",
    ),
    (
        "struct Ink { @range(0, 1, 0.5) amount: f32 }
@pass(half)
fn ink(at: ImageAt, p: Ink) -> vec4f { return image_color(at.x, at.y); }",
        "ink is the last pass and writes the picture, which has its full size; remove @pass, or write another pass after it",
    ),
];

#[test]
fn faulty_effects_are_refused_with_what_to_do() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/picture/ported");
    for (text, sentence) in FAULTY {
        let error = read_beside("ink.wgsl", "ink", text, Some(&folder)).expect_err(sentence);
        assert!(error.message.ends_with(sentence), "{error}\n{sentence}");
        assert!(error.place.is_some(), "{error}");
    }
}

few_and_all!(every_ported_effect_is_drawn_as_the_oracle_draws_it,);
