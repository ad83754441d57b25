//! Promise: a look is the same at every size of the picture, and shows something on every model.
//! Pictures of the oracle.

use rasterlab::{
    accuracy::RenderScale,
    math::linear_light,
    oracle,
    preset::{Preset, SceneSource},
    preset_file::{self, Folders, PresetFile},
    scene::Scene,
};
use rayon::prelude::*;

/// Cells of a picture that are compared, across and down.
const CELLS: [u32; 2] = [16, 12];

/// Most that the mean of a cell's channel may differ from that of the preset's own size, as the eye
/// sees it, on average over the cells, of 255.
const MEAN_BOUND: f64 = 2.0;

/// Presets that are not the same at every size, with the bound that they keep.
const EXCEPTIONS: &[(&str, f64, &str)] = &[
    ("dots", 8.0, DOTS),
    ("hero-night", 3.5, DOTS),
    ("hatch", 5.5, THIN),
    ("engraving", 4.0, THIN),
    ("hero-etching", 5.0, THIN),
    ("leaves", 6.0, THIN),
    ("hero-onebit", 4.5, "a cell of one pixel has no half"),
    (
        "particles",
        3.0,
        "discs smaller than a pixel miss most samples",
    ),
    (
        "bloom",
        3.0,
        "what is bright is chosen by pixel, and small pixels mix less",
    ),
    ("grain", 3.0, "every pixel has a grain of its own"),
    ("crt", 3.5, CELL),
    ("halftone", 3.5, CELL),
    ("pixelate", 4.0, CELL),
    (
        "glow_edges",
        11.5,
        "a tube is one pixel wide at every size and covers twice as much of half a picture",
    ),
    (
        "survey",
        5.0,
        "a point is at least the pixel in which it lies, which covers more of a smaller picture",
    ),
];
const CELL: &str = "cells and lines are whole pixels, or have a rim of one";
const DOTS: &str = "a dot has a soft rim of one pixel, and where dots overlap the brightest shows";
const THIN: &str = "a line of one pixel cannot become thinner";

fn gallery() -> Vec<PresetFile> {
    let entries = preset_file::gallery(&Folders::default());
    let opened = entries
        .into_iter()
        .filter_map(|entry| entry.preset_file.ok());
    opened.collect()
}

fn color(preset: &Preset, scene: &Scene, size: [u32; 2]) -> Vec<[u8; 4]> {
    let factor = preset.accuracy.scale().factor();
    oracle::render_scaled(scene, &preset.moments(scene, size), factor)
        .unwrap_or_else(|error| panic!("{}: {error}", preset.name))
        .color
}

/// The means of the cells of a picture, in linear light.
fn cells(color: &[[u8; 4]], [width, height]: [u32; 2]) -> Vec<[f64; 3]> {
    let of_byte: Vec<f64> = (0..=255u8)
        .map(|byte| linear_light(f64::from(byte) / 255.0))
        .collect();
    let mut sums = vec![([0.0; 3], 0.0); (CELLS[0] * CELLS[1]) as usize];
    for (index, pixel) in color.iter().enumerate() {
        let [x, y] = [index as u32 % width, index as u32 / width];
        let cell = y * CELLS[1] / height * CELLS[0] + x * CELLS[0] / width;
        let (sum, count) = &mut sums[cell as usize];
        (0..3).for_each(|c| sum[c] += of_byte[usize::from(pixel[c])]);
        *count += 1.0;
    }
    sums.into_iter()
        .map(|(sum, count)| sum.map(|light| light / count))
        .collect()
}

/// Mean difference of two pictures by their cells, of 255.
fn difference(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    let seen = |light: f64| 255.0 * light.sqrt();
    let each = a.as_flattened().iter().zip(b.as_flattened());
    each.map(|(a, b)| (seen(*a) - seen(*b)).abs()).sum::<f64>() / (3 * a.len()) as f64
}

#[test]
#[ignore = "slow: .ci/full"]
fn every_preset_is_the_same_picture_at_half_and_at_two_and_three_times_its_size() {
    let failures: Vec<String> = gallery()
        .par_iter()
        .flat_map_iter(|file| {
            let scene = preset_file::load_scene(&file.preset, None).expect("its scene");
            let own = file.preset.output.size;
            let at = |times: f64| {
                let size = own.map(|side| (f64::from(side) * times) as u32);
                cells(&color(&file.preset, &scene, size), size)
            };
            let reference = at(1.0);
            let known = EXCEPTIONS.iter().find(|(id, ..)| *id == file.id);
            let bound = known.map_or(MEAN_BOUND, |(_, bound, _)| *bound);
            [0.5, 2.0, 3.0]
                .into_iter()
                .map(|times| (times, difference(&reference, &at(times))))
                .filter(move |(_, mean)| *mean > bound)
                .map(|(times, mean)| format!("{} at {times}: {mean:.2}", file.id))
                .collect::<Vec<_>>()
        })
        .collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Models that looks land on.
const MODELS: [&str; 10] = [
    "teapot?tess=4",
    "knot?tess=6",
    "sphere?triangles=800",
    "walker?tess=1",
    "tentacle?tess=2",
    "town?houses=12",
    "still-life?tess=2",
    "cube-wall?columns=6&rows=4",
    "stack",
    "leaves",
];

/// The least part of the pixels that differ from the background.
const LEAST_SHOWN: f64 = 0.005;
/// The least standard deviation of the pixels' channels, of 255.
const LEAST_CONTRAST: f64 = 4.0;
const SIZE: [u32; 2] = [96, 72];

fn shown_part(preset: &Preset, color: &[[u8; 4]]) -> f64 {
    let rows = preset.output.backdrop().rows(SIZE[1]);
    let differs = |(index, pixel): (usize, &[u8; 4])| {
        let behind = rows[index / SIZE[0] as usize];
        (0..3).any(|c| pixel[c].abs_diff(behind[c]) > 6)
    };
    color.iter().enumerate().filter(|at| differs(*at)).count() as f64 / color.len() as f64
}

fn contrast(color: &[[u8; 4]]) -> f64 {
    let deviation = |c: usize| {
        let values = || color.iter().map(|pixel| f64::from(pixel[c]));
        let mean = values().sum::<f64>() / color.len() as f64;
        (values().map(|v| (v - mean).powi(2)).sum::<f64>() / color.len() as f64).sqrt()
    };
    (0..3).map(deviation).fold(0.0, f64::max)
}

#[test]
#[ignore = "slow: .ci/full"]
fn every_look_shows_something_on_every_model() {
    let looks = gallery();
    let mut failures = Vec::new();
    for query in MODELS {
        let own = preset_file::open(&format!("builtin:{query}"), &Folders::default())
            .expect("a built-in scene");
        let bare = preset_file::load_scene(
            &Preset {
                ground: None,
                ..own.preset.clone()
            },
            None,
        )
        .expect("a scene");
        let failed = looks.par_iter().filter_map(|look| {
            let from = preset_file::scene_bounds(&look.preset.scene, look.preset.parts.up, None)
                .expect("a box");
            let fit = look.fit_to(&own, [&from, &bare.bounds()], Some(&bare));
            let mut landed = look.landed_on(&own, fit.as_ref());
            landed.map_missing_parts(&bare);
            landed.preset.accuracy.pins = landed.preset.accuracy.pins.with(RenderScale::Full);
            assert_eq!(landed.preset.scene, SceneSource::Builtin(query.into()));
            let scene = preset_file::load_scene(&landed.preset, None).expect("a scene");
            let color = color(&landed.preset, &scene, SIZE);
            let (shown, contrast) = (shown_part(&landed.preset, &color), contrast(&color));
            (shown < LEAST_SHOWN || contrast < LEAST_CONTRAST).then(|| {
                format!(
                    "{} on {query}: {:.1} % shown, contrast {contrast:.1}",
                    look.id,
                    100.0 * shown
                )
            })
        });
        failures.extend(failed.collect::<Vec<_>>());
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
