//! Promise: what is told of a pixel is what decided it: the probe names the triangle, the key and
//! the layers of every picture, and the edge near which an inexact option went wrong.

use rasterlab::{
    accuracy::{Coverage, PinnedOptions},
    effects::Stack,
    frame::NO_TRIANGLE,
    math::hash,
    oracle::{self, Outcome, ProbedTriangle},
    preset_file::{self, Folders},
};

use crate::common::*;

/// As many pixels of a small picture, spread by a hash.
fn pixels(seed: u32, size: [u32; 2], count: u32) -> Vec<[u32; 2]> {
    (0..count)
        .map(|i| {
            [
                hash(seed ^ (2 * i)) % size[0],
                hash(seed ^ (2 * i + 1)) % size[1],
            ]
        })
        .collect()
}

fn the_probe_decides_as_the_picture_does(reach: Reach) {
    let mut probed = 0;
    let gallery = preset_file::gallery(&Folders::default());
    let every = if reach == Reach::Few { 6 } else { 1 };
    for entry in gallery.iter().step_by(every) {
        let file = preset_file::open(&entry.id, &Folders::default()).expect("a preset");
        let scene = preset_file::load_scene(&file.preset, None).expect("its scene");
        let size = [96, 60];
        let (view, stack) = (
            file.preset.view(&scene, size),
            file.preset.stack_on(&scene, size),
        );
        let (frame, geometry) =
            oracle::render_with_geometry(&scene, &view, &stack, None).expect("it draws");
        let pixels = pixels(hash(probed), size, 200);
        let samples = oracle::probe(&scene, &view, &stack, &geometry, &pixels).expect("it draws");
        for sample in samples {
            let at = (sample.pixel[1] * size[0] + sample.pixel[0]) as usize;
            let decided = &sample.decided;
            let what = format!("{} at {:?}", entry.id, sample.pixel);
            assert_eq!(decided.triangle_id, frame.triangle_id[at], "{what}");
            assert_eq!(decided.depth_key, frame.depth_key[at], "{what}");
            let shown = |t: &&ProbedTriangle| t.outcome == Outcome::Shown;
            let ids: Vec<u32> = sample
                .triangles
                .iter()
                .filter(shown)
                .map(|t| t.id)
                .collect();
            let expected: Vec<u32> = (decided.triangle_id != NO_TRIANGLE)
                .then_some(decided.triangle_id)
                .into_iter()
                .collect();
            assert_eq!(ids, expected, "{what}");
            assert!(sample.triangles.is_sorted_by_key(|t| t.id), "{what}");
            probed += 1;
        }
    }
    assert!(probed >= 2_000, "{probed} pixels");
}

#[test]
fn a_row_alone_is_that_of_the_whole_picture() {
    // Plain, after pictures before it, behind glass, and under passes that read other rows.
    for id in ["facet", "smear", "glass", "bloom"] {
        let file = preset_file::open(id, &Folders::default()).expect("a preset");
        let scene = preset_file::load_scene(&file.preset, None).expect("its scene");
        let size = [36, 24];
        let moments = file.preset.moments(&scene, size);
        for factor in [0.5, 1.0, 2.0] {
            let whole = oracle::render_scaled(&scene, &moments, factor).expect("it draws");
            for row in [0, 11, 23] {
                let alone = oracle::render_scaled_row(&scene, &moments, factor, row);
                let at = (row * size[0]) as usize;
                assert_eq!(
                    alone.expect("it draws"),
                    whole.color[at..at + size[0] as usize],
                    "{id}, {factor}, row {row}"
                );
            }
            let below = oracle::render_scaled_row(&scene, &moments, factor, size[1]);
            assert!(below.expect("it draws").is_empty());
        }
    }
}

/// The distance of the sample from the nearest line through an edge of the triangle, pixels.
fn nearest_edge_px(triangle: &ProbedTriangle, unit: f64) -> f64 {
    triangle
        .edges
        .iter()
        .map(|edge| (edge.distance() / unit).abs())
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn every_pixel_that_float_edges_get_wrong_lies_at_an_edge_of_what_was_drawn() {
    let Some(mut renderer) = loan() else { return };
    // Corners on 1/2 px: every other sample lies on an edge.
    let scene = scene("grid?cell=4&lattice=2&width=256&height=256");
    let size = [256, 256];
    let (view, stack) = (view(&scene, size), Stack::default());
    let accuracy = request(PinnedOptions::of(Coverage::Float));
    let capture = renderer.captured(&scene, &view, &stack, &accuracy);
    let wrong = {
        let expected = verdict(&scene, &view, &stack, &capture).expected;
        let drawn = &capture.frame.triangle_id;
        let is_wrong = |i: &usize| drawn[*i] != expected.triangle_id[*i];
        (0..drawn.len())
            .filter(is_wrong)
            .map(|i| [i as u32 % size[0], i as u32 / size[0]])
            .collect::<Vec<_>>()
    };
    assert!(!wrong.is_empty(), "float edges get some pixels wrong");
    let samples =
        oracle::probe(&scene, &view, &stack, &capture.geometry, &wrong).expect("it draws");
    let unit = f64::from(1u32 << capture.geometry.subpixel_bits);
    for sample in samples {
        let at = (sample.pixel[1] * size[0] + sample.pixel[0]) as usize;
        let of_id = |id: u32| sample.triangles.iter().find(move |t| t.id == id);
        let drawn = of_id(capture.frame.triangle_id[at]);
        let right = of_id(sample.decided.triangle_id);
        let nearest = [drawn, right]
            .into_iter()
            .flatten()
            .map(|triangle| nearest_edge_px(triangle, unit))
            .fold(f64::INFINITY, f64::min);
        assert!(
            nearest < 0.02,
            "{:?}: {nearest} px from an edge",
            sample.pixel
        );
    }
}

few_and_all!(the_probe_decides_as_the_picture_does,);
