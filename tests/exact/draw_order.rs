//! Promise: the draw order is exact beyond 2^32 samples: how many there are, how many are drawn,
//! where drawing stops, and which share of them comes before each triangle. Needs an adapter.

use std::sync::Arc;

use pollster::FutureExt as _;
use rasterlab::{
    effects::{Effect, Stack, draw_order::Unit},
    frame::NO_TRIANGLE,
    gpu::{Gpu, Renderer},
    plan::AccuracyRequest,
    scene::Scene,
};

use crate::common::*;

/// What the counting pass adds for each sample, in place of 1: a picture of 1,024 pixels counts as
/// 6 million of them, and its 2,048 sheets as 2.9 times 2^32 samples.
const FACTOR: u64 = 6001;
const SIDE: u32 = 32;
const PIXELS: u64 = (SIDE * SIDE) as u64;
const SHEETS: u64 = 2048;
const SAMPLES_OF_SHEET: u64 = PIXELS * FACTOR;
const TOTAL: u64 = SHEETS * SAMPLES_OF_SHEET;

fn heavy() -> Mutated {
    mutated("found_samples += 1u;", "found_samples += 6001u;")
}

/// Triangles over the whole picture, each nearer than the one before it.
fn sheets() -> Arc<Scene> {
    let corners = [
        [0, 0],
        [256 * 3 * SIDE as i32, 0],
        [0, 256 * 3 * SIDE as i32],
    ];
    let sheet = |i: u64| (corners, (i + 1) as f32 / (SHEETS + 1) as f32);
    scene_of_meshes(&[triangle_soup_in_units(
        &(0..SHEETS).map(sheet).collect::<Vec<_>>(),
    )])
}

/// The draw order up to a limit, black at the first sample and white at the last.
fn limited(unit: Unit, amount: f64) -> Stack {
    let effect = Effect::find("draw_order").expect("it is there");
    let mut stack = Stack::default();
    let enabled = stack.enable(effect);
    let (field, unit) = (
        if unit == Unit::Count {
            "limit"
        } else {
            "fraction"
        },
        f64::from(unit as u32),
    );
    for (name, values) in [
        ("unit", &[unit][..]),
        (field, &[amount]),
        ("first", &[0.0, 0.0, 0.0, 1.0]),
        ("last", &[1.0; 4]),
    ] {
        effect
            .field(name)
            .expect("it is there")
            .set(&mut enabled.words, values)
            .expect("it is in range");
    }
    stack
}

/// Draws shares of all samples on heavy shaders; the first difference from what whole numbers say,
/// and from the colors of ordinary shaders that stop at the same sample.
fn compared(gpu: &Arc<Gpu>, heavy: &Mutated) -> Result<(), String> {
    let (scene, view) = (sheets(), pixel_view(SIDE, SIDE));
    let [mut ordinary, mut counting] = [
        Renderer::new(gpu.clone()),
        Renderer::with_library(gpu.clone(), heavy.shaders()),
    ];
    let accuracy = AccuracyRequest::default();
    for sheet in [3, 698, 700, 1023, 1024, 1500, SHEETS - 1] {
        // The fraction of whole sheets, and the next one that 24 bits know, which stops within the
        // next sheet.
        for beyond in [0, 1] {
            let word = sheet * (1 << 24) / SHEETS + beyond;
            let limit = ((u128::from(TOTAL) * u128::from(word) + (1 << 23)) >> 24) as u64;
            let rest = limit - sheet * SAMPLES_OF_SHEET;
            assert!(
                rest < PIXELS && (rest > 0) == (beyond > 0),
                "{rest} samples of sheet {sheet}"
            );
            let what = format!("{sheet} sheets and {rest} samples");

            let stack = limited(Unit::Fraction, word as f64 / f64::from(1 << 24));
            counting
                .set_scene(&scene)
                .block_on()
                .map_err(|error| error.to_string())?;
            counting
                .draw_complete(&view, &stack, &accuracy)
                .block_on()
                .map_err(|error| error.to_string())?;
            counting
                .draw(&view, &stack, &accuracy)
                .block_on()
                .map_err(|error| error.to_string())?;
            let order = counting
                .finish()
                .block_on()
                .map_err(|error| error.to_string())?
                .order
                .unwrap_or_default();
            let (found, expected) = (
                [order.covered, order.limit, order.drawn],
                [TOTAL, limit, limit],
            );
            if found != expected {
                return Err(format!(
                    "{what}: {found:?} samples are covered, asked for and drawn, not {expected:?}"
                ));
            }

            let drawn = counting.captured(&scene, &view, &stack, &accuracy).frame;
            let shown = |pixel: u64| {
                if pixel < rest {
                    sheet as u32
                } else {
                    (sheet as u32).checked_sub(1).unwrap_or(NO_TRIANGLE)
                }
            };
            if let Some(pixel) =
                (0..PIXELS).find(|&pixel| drawn.triangle_id[pixel as usize] != shown(pixel))
            {
                return Err(format!(
                    "{what}: pixel {pixel} shows triangle {}",
                    drawn.triangle_id[pixel as usize]
                ));
            }
            let stack = limited(Unit::Count, (sheet * PIXELS + rest) as f64);
            let reference = ordinary.captured(&scene, &view, &stack, &accuracy).frame;
            let is_far =
                |(a, b): (&[u8; 4], &[u8; 4])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 1);
            if let Some(pixel) = drawn.color.iter().zip(&reference.color).position(is_far) {
                return Err(format!(
                    "{what}: pixel {pixel} is {:?}, not {:?}",
                    drawn.color[pixel], reference.color[pixel]
                ));
            }
        }
    }
    Ok(())
}

#[test]
fn more_samples_than_32_bits_count_are_counted_limited_and_ranked() {
    let Some(gpu) = gpu() else { return };
    // Enough samples in all, and of a block of triangles.
    const { assert!(TOTAL > 2 << 32 && TOTAL / 2 > 1 << 32) };
    compared(&gpu, &heavy()).unwrap_or_else(|why| panic!("{why}"));
}

fn a_lost_high_half_is_seen_wherever_it_is_lost(reach: Reach) {
    let Some(gpu) = gpu() else { return };
    let mut blind = Vec::new();
    let mistakes = [
        (
            "vec2u(partial[0].hi, partial[0].lo)",
            "vec2u(0u, partial[0].lo)",
        ),
        ("order.total_hi = total.hi;", "order.total_hi = 0u;"),
        (
            "fixed_add(Wide(order.before_hi, order.before_lo), Wide(0u, rest))",
            "fixed_add(Wide(0u, order.before_lo), Wide(0u, rest))",
        ),
        (
            "fixed_to_f32(Wide(order.total_hi, order.total_lo))",
            "fixed_to_f32(Wide(0u, order.total_lo))",
        ),
    ];
    for (from, to) in reach.of(1, mistakes) {
        match compared(&gpu, &heavy().and(from, to)) {
            Ok(()) => blind.push(to),
            Err(why) => eprintln!("{to}: {why}"),
        }
    }
    assert!(blind.is_empty(), "{}", blind.join("\n"));
}

few_and_all!(a_lost_high_half_is_seen_wherever_it_is_lost,);
