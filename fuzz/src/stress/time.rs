//! Repetition: the same picture many times, and the same triangles in another order.

use std::sync::Arc;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, same},
    context::CaseContext,
    drawing::{WorkDistribution, pinned, stack},
};
use crate::{frame::NO_TRIANGLE, gpu::Capture, scene::Scene};

pub const CASES: &[Case] = &[
    Case {
        number: 22,
        name: "hundred-equal-frames",
        about: "the same picture 100 times: every buffer is equal bit by bit",
        expectation: Expectation::Exact,
        run: hundred_equal_frames,
    },
    Case {
        number: 22,
        name: "shuffled-triangles",
        about: "triangles in another order, with ids mapped back: the same picture bit by bit",
        expectation: Expectation::Exact,
        run: shuffled_triangles,
    },
];

fn hundred_equal_frames(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let hall = context.scene("near")?;
    let view = context.view(&hall, [80, 60]);
    context.renderer.set_tuning(WorkDistribution::Card.tuning());
    if context.is_slow() {
        context.note("one stack of effects for each option, since this adapter is slow".into());
    }
    for (i, option) in context.options().into_iter().enumerate() {
        let stacks = [stack(&["facet", "lambert"]), stack(&["lambert", "xray"])];
        let chosen = if context.is_slow() {
            &stacks[i % 2..=i % 2]
        } else {
            &stacks
        };
        for stack in chosen {
            let mut first: Option<Capture> = None;
            for frame in 1..=100 {
                let what = format!("frame {frame} on {}", option.name());
                let capture = context.captured(&hall, &view, stack, &pinned(option), &what)?;
                let Some(first) = &first else {
                    check!(
                        !capture.geometry.clipped_triangles.is_empty(),
                        "nothing was clipped"
                    );
                    first = Some(capture);
                    continue;
                };
                same(&capture, first, &what)?;
                check!(
                    capture.frame == first.frame && capture.geometry == first.geometry,
                    "{what} differs from the first"
                );
            }
        }
    }
    Ok(())
}

/// The same triangles in another order; `order` gives the previous index of each.
fn shuffled(scene: &Scene, order: &[u32]) -> Arc<Scene> {
    let mut scene = scene.clone();
    let triangles: Vec<[u8; 12]> = scene.index_bytes.as_chunks().0.to_vec();
    scene.index_bytes = order.iter().flat_map(|&t| triangles[t as usize]).collect();
    Arc::new(scene)
}

fn shuffled_triangles(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    context.renderer.set_tuning(WorkDistribution::Card.tuning());
    for query in [
        "sphere?triangles=5000",
        "knot?tess=6",
        "grid?cell=1",
        "sizes",
    ] {
        let still = context.scene(query)?;
        let is_one_list = still.instances.len() == 1
            && still.primitives[0]
                .indices
                .is_some_and(|i| i.stride == 4 && i.offset == 0);
        check!(is_one_list, "{query}: it is not one list of 32-bit indices");
        let view = context.view(&still, [192, 144]);
        for option in context.options() {
            let what = format!("{query} on {}", option.name());
            let (before, _) = context.exact(&still, &view, &stack(&[]), &pinned(option), &what)?;
            for round in 1..=3 {
                let what = format!("{what}, shuffle {round}");
                let mut order: Vec<u32> = (0..still.triangle_count() as u32).collect();
                context.rng(round).shuffle(&mut order);
                let mut after = context.captured(
                    &shuffled(&still, &order),
                    &view,
                    &stack(&[]),
                    &pinned(option),
                    &what,
                )?;
                for triangle_id in after
                    .frame
                    .triangle_id
                    .iter_mut()
                    .filter(|triangle_id| **triangle_id != NO_TRIANGLE)
                {
                    *triangle_id = order[*triangle_id as usize];
                }
                same(&after, &before, &what)?;
                check!(
                    after.frame.color == before.frame.color,
                    "{what}: colors differ"
                );
            }
        }
    }
    Ok(())
}
