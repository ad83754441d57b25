//! A draw order over more samples than 32 bits can count.

use std::sync::Arc;

use pollster::FutureExt as _;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, equal},
    context::CaseContext,
    scenes::{pixel_view, scene_of_meshes, triangle_soup_in_units},
};
use crate::{
    effects::{Effect, Stack, draw_order},
    gpu::RenderError,
    plan::AccuracyRequest,
    scene::{Scene, view::View},
};

pub const CASES: &[Case] = &[
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
