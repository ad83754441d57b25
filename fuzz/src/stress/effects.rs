//! Effects at their limits: vast numbers of layers, fills next to 0 and 1, draw limits at both
//! ends.

use std::sync::Arc;

use pollster::FutureExt as _;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, equal, layers},
    context::CaseContext,
    drawing::pinned,
    scenes::{SimpleMesh, pixel_view, scene_of_meshes, triangle_soup_in_units},
};
use crate::{
    effects::{Effect, Stack, dissolve::Mode, draw_order, hooks::Layers},
    gpu::RenderError,
    math::srgb_byte,
    plan::AccuracyRequest,
    scene::{Scene, view::View},
};

pub const CASES: &[Case] = &[
    Case {
        number: 16,
        name: "layers-on-one-pixel",
        about: "257 to 1,048,833 layers on a pixel: the average is correct, with fewer bits per channel where sums would overflow",
        expectation: Expectation::Exact,
        run: layers_on_one_pixel,
    },
    Case {
        number: 25,
        name: "fill",
        about: "fills of 0, 2^-24, 1/2, 1 - 2^-24 and 1 of large and sub-pixel triangles: exact sets, each a subset of the next",
        expectation: Expectation::Exact,
        run: fill,
    },
    Case {
        number: 26,
        name: "draw-limit",
        about: "draw limits of 0, 1, all but one, all, all and one, and 2^32 - 1 samples, in both orders",
        expectation: Expectation::Exact,
        run: draw_limit,
    },
    Case {
        number: 26,
        name: "draw-order-over-32-bits",
        about: "a draw order over more samples than 32 bits can count",
        expectation: Expectation::Exact,
        run: draw_order_over_32_bits,
    },
    Case {
        number: 26,
        name: "scheduler-order-over-32-bits",
        about: "the scheduler's order over more samples than 32 bits can count",
        expectation: Expectation::Refused("the message names the number of samples and the limit"),
        run: scheduler_order_over_32_bits,
    },
];

/// Enables an effect and sets one of its fields.
fn set(stack: &mut Stack, effect: &str, field: &str, value: f64) -> Result<(), EarlyEnd> {
    let effect = Effect::find(effect)
        .ok_or_else(|| EarlyEnd::Failed(format!("there is no effect {effect}")))?;
    let about = effect
        .field(field)
        .ok_or_else(|| EarlyEnd::Failed(format!("{} has no field {field}", effect.name)))?;
    about
        .set(&mut stack.enable(effect).words, &[value])
        .map_err(|error| EarlyEnd::Failed(format!("{}.{}: {error}", effect.name, about.name)))
}

/// A stack of one effect with some fields set.
pub(super) fn only(effect: &str, fields: &[(&str, f64)]) -> Result<Stack, EarlyEnd> {
    let mut stack = Stack::default();
    fields
        .iter()
        .try_for_each(|(field, value)| set(&mut stack, effect, field, *value))?;
    Ok(stack)
}

/// `count` layers that cover every pixel, half of them in each of two colors, from six vertices.
fn pile(count: u32) -> Arc<Scene> {
    let corners = |depth: f32| {
        [
            [-4.0, -4.0, depth],
            [40.0, -4.0, depth],
            [-4.0, 40.0, depth],
        ]
    };
    let colors = [[1.0, 0.0, 0.25, 1.0], [0.0, 1.0, 0.25, 1.0]];
    scene_of_meshes(&[SimpleMesh {
        positions: [corners(0.5), corners(0.25)].concat(),
        colors: colors.iter().flat_map(|color| [*color; 3]).collect(),
        indices: (0..count)
            .flat_map(|layer| [0, 1, 2].map(|corner| 3 * (layer % 2) + corner))
            .collect(),
        ..SimpleMesh::default()
    }])
}

fn layers_on_one_pixel(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let view = pixel_view(2, 2);
    // Layers, the bits field (auto, 16, 12, 10, 8), and the resulting bits.
    for (count, choice, taken) in [
        (257, 0, 16),
        (258, 0, 16),
        (258, 4, 8),
        (65_537, 0, 16),
        (65_537, 1, 16),
        (65_538, 0, 12),
        (65_538, 1, 12),
        (65_538, 3, 10),
        (1_000_000, 0, 12),
        (1_000_000, 1, 12),
        (1_048_833, 0, 10),
    ] {
        // Both choices for a million layers use the same kernel, and the last number has more of
        // them.
        if count == 1_000_000 && context.is_slow() {
            context.note(format!(
                "{count} layers are skipped, since this adapter is slow"
            ));
            continue;
        }
        let (scene, stack) = (pile(count), only("xray", &[("bits", f64::from(choice))])?);
        let options = if count < if context.is_slow() { 65_000 } else { 1_000_000 } {
            context.options()
        } else {
            let option = context.quick_option();
            context.note(format!(
                "{count} layers are drawn on {} only: they wait for one another",
                option.name()
            ));
            vec![option]
        };
        for option in options {
            let what = format!("{count} layers in {taken} bits on {}", option.name());
            let (capture, _) = context.exact(&scene, &view, &stack, &pinned(option), &what)?;
            let found = context
                .renderer
                .key()
                .and_then(|key| key.framebuffer.layers);
            equal(
                &found,
                &Some(Layers::Xray { bits: taken }),
                &format!("{what}: kernel"),
            )?;
            equal(
                &capture.frame.layer_sums,
                &vec![count; 4],
                &format!("{what}: layers of each pixel"),
            )?;
            equal(
                &capture.frame.counters.full_pixels,
                &0,
                &format!("{what}: pixels that overflowed"),
            )?;
            let red = f64::from(count.div_ceil(2)) / f64::from(count);
            let expected = [srgb_byte(red), srgb_byte(1.0 - red), srgb_byte(0.25), 255];
            let is_near =
                |color: &[u8; 4]| color.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1);
            // Eight bits in linear light are coarser than sRGB bytes.
            check!(
                taken == 8 || capture.frame.color.iter().all(is_near),
                "{what}: found {:?}, expected {expected:?}",
                capture.frame.color
            );
        }
    }
    Ok(())
}

fn fill(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    context.allow_any_depth_band();
    if context.is_slow() {
        context.note(
            "only the first mode is drawn with every option, since this adapter is slow".into(),
        );
    }
    let least = f64::from(f32::from_bits(0x3380_0000)); // 2^-24
    let fills = [0.0, least, 0.5, 1.0 - least, 1.0];
    for query in [
        "sphere?triangles=200",
        "grid?cell=0.4&width=48&height=48",
        "near",
    ] {
        let scene = context.scene(query)?;
        let view = context.view(&scene, [64, 48]);
        let (whole, _) = context.exact(
            &scene,
            &view,
            &Stack::default(),
            &AccuracyRequest::default(),
            query,
        )?;
        for mode in [
            Mode::Edge,
            Mode::Corner,
            Mode::Centroid,
            Mode::Scanline,
            Mode::Hash,
        ] {
            let mut before: Option<Vec<u32>> = None;
            for (i, fill) in fills.into_iter().enumerate() {
                let stack = only(
                    "dissolve",
                    &[("mode", f64::from(mode as u32)), ("fill", fill)],
                )?;
                let what = format!("{query} filled to {fill} by {mode:?}");
                let capture = if i == 2 && (mode == Mode::Edge || !context.is_slow()) {
                    context.exact_on_all_with(&scene, &view, &stack, &what)?
                } else {
                    context
                        .exact(&scene, &view, &stack, &AccuracyRequest::default(), &what)?
                        .0
                };
                let now = layers(&capture).to_vec();
                if let Some(before) = &before {
                    check!(
                        before.iter().zip(&now).all(|(a, b)| a <= b),
                        "{what}: a sample of a smaller fill is missing"
                    );
                }
                before = Some(now);
                check!(
                    fill > 0.0 || capture.frame.covered() == 0,
                    "{what}: {} pixels are drawn",
                    capture.frame.covered()
                );
                check!(
                    fill < 1.0 || layers(&capture) == layers(&whole),
                    "{what}: not all samples are drawn"
                );
            }
        }
    }
    Ok(())
}

fn sum(layers: &[u32]) -> u64 {
    layers.iter().map(|&count| u64::from(count)).sum()
}

fn draw_limit(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    context.allow_any_depth_band();
    let count = f64::from(draw_order::Unit::Count as u32);
    for query in ["sphere?triangles=200", "near", "stack?layers=5"] {
        let scene = context.scene(query)?;
        let view = context.view(&scene, [48, 40]);
        let (whole, _) = context.exact(
            &scene,
            &view,
            &Stack::default(),
            &AccuracyRequest::default(),
            query,
        )?;
        let total = sum(layers(&whole));
        let limits = [
            0,
            1,
            total / 2,
            total / 2 + 1,
            total - 1,
            total,
            total + 1,
            u64::from(u32::MAX),
        ];
        for option in context.options() {
            let mut before: Option<Vec<u32>> = None;
            for limit in limits {
                for mode in [draw_order::Mode::Submission, draw_order::Mode::Scheduler] {
                    let stack = only(
                        "draw_order",
                        &[
                            ("mode", f64::from(mode as u32)),
                            ("unit", count),
                            ("limit", limit as f64),
                        ],
                    )?;
                    let what = format!(
                        "{query}: {limit} of {total} samples by {mode:?} on {}",
                        option.name()
                    );
                    let (capture, _) =
                        context.exact(&scene, &view, &stack, &pinned(option), &what)?;
                    equal(
                        &sum(layers(&capture)),
                        &limit.min(total),
                        &format!("{what}: samples drawn"),
                    )?;
                    if mode == draw_order::Mode::Submission {
                        context
                            .renderer
                            .draw(&view, &stack, &pinned(option))
                            .block_on()?;
                        let order = context
                            .renderer
                            .finish()
                            .block_on()?
                            .order
                            .unwrap_or_default();
                        let drawn = limit.min(total);
                        equal(
                            &[order.covered, order.limit, order.drawn],
                            &[total, drawn, drawn],
                            &format!("{what}: samples counted"),
                        )?;
                        let now = layers(&capture).to_vec();
                        let grows = before
                            .is_none_or(|before| before.iter().zip(&now).all(|(a, b)| a <= b));
                        check!(grows, "{what}: a sample of a smaller limit is missing");
                        before = Some(now);
                    }
                }
            }
        }
    }
    Ok(())
}

/// Layers over a whole picture with more than 2^32 samples, and their number.
fn sheets_of_a_word(context: &CaseContext) -> Result<(Arc<Scene>, View, u64), EarlyEnd> {
    if context.is_software() {
        return Err(EarlyEnd::Skipped(
            "2^32 samples take minutes on a software adapter".into(),
        ));
    }
    let (side, times) = (4096u32, 260);
    let total = u64::from(side) * u64::from(side) * times;
    check!(total > u64::from(u32::MAX), "{total} samples are too few");
    let far = 8_388_607;
    let scene = scene_of_meshes(&[triangle_soup_in_units(
        &(0..times)
            .map(|i| ([[0, 0], [far, 0], [0, far]], 1e-3 * (i + 1) as f32))
            .collect::<Vec<_>>(),
    )]);
    Ok((scene, pixel_view(side, side), total))
}

fn scheduler_order_over_32_bits(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let (scene, view, total) = sheets_of_a_word(context)?;
    let by_chance = f64::from(draw_order::Mode::Scheduler as u32);
    for (what, unit, amount) in [("a count", "limit", 1e6), ("a fraction", "fraction", 0.5)] {
        let kind = if unit == "limit" {
            draw_order::Unit::Count
        } else {
            draw_order::Unit::Fraction
        };
        let stack = only(
            "draw_order",
            &[
                ("mode", by_chance),
                ("unit", f64::from(kind as u32)),
                (unit, amount),
            ],
        )?;
        context.step(&scene, &view, what)?;
        context.renderer.set_scene(&scene).block_on()?;
        match context
            .renderer
            .draw_complete(&view, &stack, &AccuracyRequest::default())
            .block_on()
        {
            Err(error @ RenderError::Tickets(_)) => {
                let text = error.to_string();
                check!(
                    error.is_unsupported() && text.contains(&total.to_string()),
                    "{what}: {text}"
                );
                context.refused(text);
            }
            Err(error) => return Err(EarlyEnd::Failed(format!("{what}: {error}"))),
            Ok(_) => {
                return Err(EarlyEnd::Failed(format!(
                    "{what}: {total} samples were drawn although 32 bits cannot count them"
                )));
            }
        }
    }
    Ok(())
}

fn draw_order_over_32_bits(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let (scene, view, total) = sheets_of_a_word(context)?;
    let fraction = f64::from(draw_order::Unit::Fraction as u32);
    // The limit itself also exceeds 32 bits.
    for (what, fields, limit) in [
        ("a count", vec![("unit", 1.0), ("limit", 1e6)], 1_000_000),
        (
            "2^32 - 1",
            vec![("unit", 1.0), ("limit", f64::from(u32::MAX))],
            u64::from(u32::MAX),
        ),
        ("all", vec![("unit", fraction), ("fraction", 1.0)], total),
    ] {
        let stack = only("draw_order", &fields)?;
        context.step(&scene, &view, what)?;
        context.renderer.set_scene(&scene).block_on()?;
        context
            .renderer
            .draw_complete(&view, &stack, &AccuracyRequest::default())
            .block_on()?;
        context
            .renderer
            .draw(&view, &stack, &AccuracyRequest::default())
            .block_on()?;
        let order = context
            .renderer
            .finish()
            .block_on()?
            .order
            .unwrap_or_default();
        equal(
            &[order.covered, order.limit, order.drawn],
            &[total, limit, limit],
            &format!("{what}: samples covered, asked for, drawn"),
        )?;
    }
    Ok(())
}
