//! Judges triangle ids, depth keys and counted layers, sample by sample, from the adapter's own
//! geometry.

use super::{
    super::{
        arithmetic::depth_key::key_fits,
        bounds::{
            coverage::{BoundedCoverage, BoundedSample},
            layers::LayerBounds,
        },
        render::resolve::bytes,
    },
    freedom::Freedom,
};
use crate::{
    frame::{AdapterPicture, NO_TRIANGLE},
    measure::ErrorReport,
};

/// Numbers of times that a sample was drawn, and that it should have been.
#[derive(Clone, Copy, Debug)]
pub struct Hits {
    pub drawn: u32,
    pub expected: u32,
}

impl Hits {
    /// At a pixel; if the adapter does not count layers, whether a triangle was drawn at all.
    pub fn at(picture: &AdapterPicture, pixel: usize, sample: &BoundedSample) -> Self {
        let layers = sample.nearest.layers;
        match picture.layers {
            Some(counted) => Self {
                drawn: counted[pixel],
                expected: layers,
            },
            None => Self {
                drawn: u32::from(picture.frame.triangle_id[pixel] != NO_TRIANGLE),
                expected: layers.min(1),
            },
        }
    }
}

/// Compares every sample with `coverage`.
pub fn judge_samples(
    report: &mut ErrorReport,
    coverage: &BoundedCoverage,
    picture: &AdapterPicture,
    freedom: Freedom,
) {
    let frame = picture.frame;
    for (pixel, sample) in coverage.samples.iter().enumerate() {
        let (triangle_id, key) = (frame.triangle_id[pixel], frame.depth_key[pixel]);
        report.depth_without_id += u64::from(triangle_id == NO_TRIANGLE && key != 0);
        let is_wrong = freedom.is_wrong(sample, triangle_id);
        report.wrong_triangles += u64::from(is_wrong);
        // In a race the key may be that of another triangle.
        let has_key = !freedom.is_contested(sample) && !frame.depth_keys_are_approximate;
        report.key_outside_bound += u64::from(
            has_key
                && sample
                    .claimed
                    .is_some_and(|bound| !key_fits(key, &frame.depth_rounding, bound)),
        );
        if freedom.is_scheduled() {
            let drawn = picture.layers.map_or(0, |layers| layers[pixel]);
            report.double_hits += u64::from(drawn.saturating_sub(sample.nearest.layers));
            continue;
        }
        let Hits { drawn, expected } = Hits::at(picture, pixel, sample);
        report.holes += u64::from(expected.saturating_sub(drawn));
        report.double_hits += u64::from(drawn.saturating_sub(expected));
        report.depth_band_pixels += u64::from(sample.is_band());
        report.race_pixels +=
            u64::from(freedom.is_contested(sample) && !sample.allows(triangle_id));
        report.wrong_nearest += u64::from(is_wrong && sample.claimed.is_some());
    }
    if let (Freedom::Scheduled { limit }, Some(layers)) = (freedom, picture.layers) {
        let drawn: u64 = layers.iter().map(|&count| u64::from(count)).sum();
        report.holes += drawn.abs_diff(limit);
    }
}

/// Compares the counts of a picture of layers with their bounds.
///
/// # Panics
/// If the counts have another size.
pub fn judge_layers(report: &mut ErrorReport, bounds: &LayerBounds, picture: &AdapterPicture) {
    let counted = &picture.frame.layer_sums;
    assert_eq!(
        counted.len(),
        bounds.counted.len(),
        "the counts of layers have another size"
    );
    let is_wrong = |(count, [least, most]): &(&u32, &[u64; 2])| {
        !(*least..=*most).contains(&u64::from(**count))
    };
    report.layer_counts_wrong = counted.iter().zip(&bounds.counted).filter(is_wrong).count() as u64;
    report.overflow += u64::from(picture.frame.counters.full_pixels);
    report.ambiguous_layer_pixels = bounds
        .colors
        .iter()
        .filter(|ends| bytes(ends[0]) != bytes(ends[1]))
        .count() as u64;
}

/// Judges the counts of a picture whose layers the scheduler chooses: none holds more than all
/// layers, and where each layer counts 1, all together are as many as are drawn.
///
/// # Panics
/// If the counts have another size.
pub fn judge_scheduled_layers(
    report: &mut ErrorReport,
    bounds: &LayerBounds,
    picture: &AdapterPicture,
    coverage: &BoundedCoverage,
    limit: u64,
) {
    let counted = &picture.frame.layer_sums;
    assert_eq!(
        counted.len(),
        bounds.counted.len(),
        "the counts of layers have another size"
    );
    report.layer_counts_wrong = counted
        .iter()
        .zip(&bounds.counted)
        .filter(|(count, [_, most])| u64::from(**count) > *most)
        .count() as u64;
    report.overflow += u64::from(picture.frame.counters.full_pixels);
    let counts_each = bounds
        .counted
        .iter()
        .zip(&coverage.samples)
        .all(|(counts, sample)| *counts == [u64::from(sample.nearest.layers); 2]);
    if counts_each {
        let all: u64 = counted.iter().map(|&count| u64::from(count)).sum();
        report.holes += all.abs_diff(limit);
    }
}
