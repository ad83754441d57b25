//! Picture sizes: empty pictures, one pixel, odd sides and the largest ones, resizing, and a lost
//! device.

use std::sync::Arc;

use pollster::FutureExt as _;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, equal},
    context::CaseContext,
    drawing::{pinned, stack},
    effects::only,
    scenes::{SimpleMesh, pixel_view, scene_of_meshes},
};
use crate::{
    effects::{Stack, hooks::Layers},
    gpu::RenderError,
    plan::AccuracyRequest,
    scene::Scene,
};

pub const CASES: &[Case] = &[
    Case {
        number: 20,
        name: "empty-pictures",
        about: "pictures of 0 x 0, 0 x 64 and 64 x 0 pixels: nothing is dispatched, and the next picture is complete",
        expectation: Expectation::Exact,
        run: empty_pictures,
    },
    Case {
        number: 20,
        name: "picture-too-large",
        about: "a picture one pixel wider than the adapter's largest texture",
        expectation: Expectation::Refused("the message names the size and the adapter's limit"),
        run: picture_too_large,
    },
    Case {
        number: 20,
        name: "xray-at-5k",
        about: "an x-ray picture of 5,120 x 2,880 pixels, whose sums need 24 bytes per pixel",
        expectation: Expectation::Exact,
        run: xray_at_5k,
    },
    Case {
        number: 20,
        name: "glass-at-4k",
        about: "32 layers of glass over 3,840 x 2,160 pixels, in as many bands as the bindings ask for",
        expectation: Expectation::Exact,
        run: glass_at_4k,
    },
    Case {
        number: 20,
        name: "binding-too-large",
        about: "an x-ray picture whose sums exceed the largest binding",
        expectation: Expectation::Refused(
            "the message names the buffer, its size and the adapter's limit",
        ),
        run: binding_too_large,
    },
    Case {
        number: 21,
        name: "resizing",
        about: "100 picture sizes in sequence: no pixel of an earlier picture remains",
        expectation: Expectation::Exact,
        run: resizing,
    },
];

fn empty_pictures(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let hall = context.scene("near")?;
    for size in [[0, 0], [0, 64], [64, 0]] {
        let what = format!("{size:?} pixels");
        let capture = context.captured(
            &hall,
            &context.view(&hall, size),
            &stack(&["lambert"]),
            &AccuracyRequest::default(),
            &what,
        )?;
        equal(&[capture.frame.width, capture.frame.height], &size, &what)?;
        check!(
            capture.frame.triangle_id.is_empty() && capture.frame.color.is_empty(),
            "{what}: it has pixels"
        );
        check!(
            context.renderer.texture_view().is_none(),
            "{what}: there is a picture"
        );
        context.exact(
            &hall,
            &context.view(&hall, [33, 17]),
            &stack(&["lambert"]),
            &AccuracyRequest::default(),
            "the next picture",
        )?;
        check!(
            context.renderer.texture_view().is_some(),
            "after {what} there is no picture"
        );
    }
    Ok(())
}

fn picture_too_large(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let most = context.renderer.gpu().caps.max_texture_side;
    let teapot = context.scene("teapot?tess=4")?;
    for size in [[most + 1, 6], [6, most + 1], [u32::MAX, u32::MAX]] {
        let view = pixel_view(size[0], size[1]);
        context.renderer.set_scene(&teapot).block_on()?;
        let what = format!("{} x {} pixels", size[0], size[1]);
        match context
            .renderer
            .draw(&view, &stack(&[]), &AccuracyRequest::default())
            .block_on()
        {
            Err(error @ RenderError::TooWide { .. }) => {
                let text = error.to_string();
                let says = text.contains(&format!("{} x {}", size[0], size[1]))
                    && text.contains(&most.to_string());
                check!(says && error.is_unsupported(), "{what}: {text}");
                context.refused(text);
            }
            Err(error) => return Err(EarlyEnd::Failed(format!("{what}: {error}"))),
            Ok(()) => {
                return Err(EarlyEnd::Failed(format!(
                    "{what} were drawn, although the limit is {most} along each side"
                )));
            }
        }
    }
    Ok(())
}

/// Two layers of different colors over the whole picture.
fn veils() -> SimpleMesh {
    let colors = [[1.0, 0.0, 0.25, 1.0], [0.0, 1.0, 0.25, 1.0]];
    veils_of(&colors)
}

/// A layer of each color over the whole picture, the nearest first.
fn veils_of(colors: &[[f32; 4]]) -> SimpleMesh {
    let corners = |depth: f32| {
        [
            [-16.0, -16.0, depth],
            [40_000.0, -16.0, depth],
            [-16.0, 40_000.0, depth],
        ]
    };
    SimpleMesh {
        positions: (0..colors.len())
            .flat_map(|layer| corners(0.5 / (layer + 1) as f32))
            .collect(),
        colors: colors.iter().flat_map(|color| [*color; 3]).collect(),
        ..SimpleMesh::default()
    }
}

fn glass_at_4k(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    if context.is_software() {
        return Err(EarlyEnd::Skipped(
            "a quarter of a thousand million layers take a CPU adapter minutes; \
             tests/picture/glass.rs draws a small picture with small bindings"
                .into(),
        ));
    }
    let colors: Vec<_> = (0..32)
        .map(|layer| [layer as f32 / 31.0, 0.5, 1.0 - layer as f32 / 31.0, 1.0])
        .collect();
    let scene = scene_of_meshes(&[veils_of(&colors)]);
    let frosted = only("glass", &[("frost", 0.25)])?;
    uniform(context, &scene, &frosted, [3840, 2160])
}

fn xray_at_5k(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let scene = scene_of_meshes(&[veils()]);
    let (stack, [width, height]) = (stack(&["xray"]), [5120u32, 2880]);
    let bytes = 24 * u64::from(width) * u64::from(height);
    let caps = &context.renderer.gpu().caps;
    let room = caps.max_storage_binding_bytes.min(caps.max_buffer_bytes);
    if room < bytes {
        return Err(EarlyEnd::Skipped(format!(
            "its sums need a binding of {bytes} bytes, and this adapter binds at most {room}"
        )));
    }
    uniform(context, &scene, &stack, [width, height])
}

/// Draws a large picture of layers that cover it whole. The oracle judges a small one; every pixel
/// of the large one must equal it.
fn uniform(
    context: &mut CaseContext,
    scene: &Arc<Scene>,
    stack: &Stack,
    [width, height]: [u32; 2],
) -> Result<(), EarlyEnd> {
    let accuracy = pinned(context.quick_option());
    let small_view = pixel_view(64, 36);
    let (small, _) = context.exact(scene, &small_view, stack, &accuracy, "64 x 36 pixels")?;
    let color = small.frame.color[0];
    let count = small.frame.layer_sums.first();
    check!(
        small.frame.color.iter().all(|c| *c == color),
        "the layers are not uniform"
    );
    let what = format!("{width} x {height} pixels");
    let large = context.captured(scene, &pixel_view(width, height), stack, &accuracy, &what)?;
    let odd_color = (large.frame.color.iter()).filter(|found| **found != color);
    let odd_count = (large.frame.layer_sums.iter()).filter(|found| Some(*found) != count);
    let odd = odd_color.count() + odd_count.count();
    equal(
        &odd,
        &0,
        &format!("{what}: pixels that show something else"),
    )?;
    equal(
        &large.frame.covered(),
        &(width as usize * height as usize),
        &format!("{what}: pixels covered"),
    )
}

fn binding_too_large(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let caps = &context.renderer.gpu().caps;
    let (room, most) = (
        caps.max_storage_binding_bytes.min(caps.max_buffer_bytes),
        caps.max_texture_side,
    );
    let (scene, stack) = (scene_of_meshes(&[veils()]), stack(&["xray"]));
    if room >= 24 * u64::from(most) * u64::from(most) {
        return Err(EarlyEnd::Skipped(format!(
            "this adapter binds {room} bytes, enough for any picture up to {most} x {most} pixels"
        )));
    }
    context.renderer.set_scene(&scene).block_on()?;
    match context
        .renderer
        .draw(&pixel_view(most, most), &stack, &AccuracyRequest::default())
        .block_on()
    {
        Err(error @ RenderError::TooLarge { .. }) => {
            let text = error.to_string();
            check!(
                error.is_unsupported() && text.contains(&room.to_string()),
                "{text}"
            );
            context.refused(text);
            // The renderer still works.
            context.renderer.set_scene(&scene).block_on()?;
            context.exact(
                &scene,
                &pixel_view(64, 36),
                &stack,
                &AccuracyRequest::default(),
                "the next picture",
            )?;
            check!(
                matches!(
                    context
                        .renderer
                        .key()
                        .and_then(|key| key.framebuffer.layers),
                    Some(Layers::Xray { .. })
                ),
                "the effect is gone"
            );
            Ok(())
        }
        Err(error) => Err(EarlyEnd::Failed(format!("{most} x {most} pixels: {error}"))),
        Ok(()) => Err(EarlyEnd::Failed(format!(
            "{most} x {most} pixels were drawn, although a binding has at most {room} bytes"
        ))),
    }
}

fn resizing(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    context.allow_any_depth_band();
    let mut rng = context.rng(21);
    let hall = context.scene("near")?;
    let stacks = [
        stack(&["lambert"]),
        stack(&["xray"]),
        stack(&["lambert", "outline"]),
        Stack::default(),
    ];
    let options = context.options();
    for picture in 0..100 {
        let size = [rng.between(1, 160), rng.between(1, 120)].map(|side| side as u32);
        let option = options[picture % options.len()];
        let what = format!("picture {picture} of {size:?} pixels on {}", option.name());
        context.exact(
            &hall,
            &context.view(&hall, size),
            &stacks[picture % stacks.len()],
            &pinned(option),
            &what,
        )?;
    }
    Ok(())
}
