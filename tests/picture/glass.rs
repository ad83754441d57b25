//! Promise: glass is composed in true depth order per pixel, whatever the order of triangles, and in
//! bounded memory; what cannot be drawn with it is refused in words. Needs an adapter but for the
//! refusals.

use std::sync::Arc;

use pollster::FutureExt as _;
use rasterlab::{
    accuracy::{DepthFormat, VertexTransform, Visibility},
    effects::Stack,
    gpu::{RenderError, Renderer},
    oracle,
    plan::{AccuracyRequest, Tuning},
    preset_file,
    scene::{Scene, view::View},
};

use crate::common::*;

/// A soup of translucent triangles before an opaque one, in this order. Depths are distinct.
fn soup(order: &[usize]) -> Arc<Scene> {
    const SIDE: i32 = 32;
    let mut rng = Rng(7);
    let triangles: Vec<([[f32; 3]; 3], [f32; 4])> = (0..order.len())
        .map(|_| {
            let corner = |rng: &mut Rng| {
                let at = [0, 1].map(|_| rng.between(-1000, 256 * SIDE + 1000) as f32 / 256.0);
                [at[0], at[1], rng.real(0.1, 0.9) as f32]
            };
            let corners = [corner(&mut rng), corner(&mut rng), corner(&mut rng)];
            let mut channel = || rng.real(0.05, 0.95) as f32;
            (corners, [channel(), channel(), channel(), channel()])
        })
        .collect();
    let sorted = || order.iter().map(|&at| &triangles[at]);
    let glass = SimpleMesh {
        positions: sorted().flat_map(|(corners, _)| *corners).collect(),
        colors: sorted().flat_map(|(_, color)| [*color; 3]).collect(),
        ..SimpleMesh::default()
    };
    let wall = SimpleMesh {
        positions: vec![[-8.0, -8.0, 0.2], [60.0, -8.0, 0.5], [-8.0, 60.0, 0.8]],
        colors: vec![[0.9, 0.6, 0.2, 1.0]; 3],
        ..SimpleMesh::default()
    };
    let mut scene = (*scene_of_meshes(&[glass, wall])).clone();
    let mut blended = scene.materials[scene.primitives[0].material].clone();
    blended.is_blended = true;
    scene.materials.push(blended);
    scene.primitives[0].material = scene.materials.len() - 1;
    Arc::new(scene)
}

fn soup_view() -> View {
    pixel_view(32, 32)
}

#[test]
fn every_exact_option_composes_crossing_layers_as_the_oracle_does() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let (scene, view) = (soup(&(0..40).collect::<Vec<_>>()), soup_view());
    let mut first = None;
    for option in options(&renderer) {
        let (capture, verdict) = exact(
            &mut renderer,
            &scene,
            &view,
            &Stack::default(),
            &pinned(option),
            option.name(),
        );
        let deepest = capture.frame.glass.counts().into_iter().max();
        assert!(
            deepest > Some(6),
            "{deepest:?} layers are too few to tell orders apart"
        );
        assert_eq!(verdict.report.layer_counts_wrong, 0);
        let first = first.get_or_insert(capture.frame.clone());
        assert_eq!(
            (&capture.frame.color, &capture.frame.glass),
            (&first.color, &first.glass),
            "{}",
            option.name()
        );
    }
}

#[test]
fn no_order_of_triangles_shows() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let strict = AccuracyRequest {
        pins: AccuracyRequest::default()
            .pins
            .with(VertexTransform::Strict)
            .with(DepthFormat::Integer),
        ..AccuracyRequest::default()
    };
    let mut order: Vec<usize> = (0..40).collect();
    let mut pictures = Vec::new();
    for round in 0..3 {
        let (scene, view) = (soup(&order), soup_view());
        let stack = Stack::default();
        pictures.push(
            captured(&mut renderer, &scene, &view, &stack, &strict)
                .frame
                .color,
        );
        order.reverse();
        order.rotate_left(7 + round);
    }
    assert!(pictures.iter().all(|picture| *picture == pictures[0]));
}

#[test]
fn bands_of_pixels_draw_the_same_picture_in_less_memory() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let (scene, stack) = (soup(&(0..40).collect::<Vec<_>>()), Stack::default());
    // Rows of other lengths than bands, so that bands begin and end inside rows.
    let view = pixel_view(32, 32);
    let usual = renderer.gpu().caps.tuning();
    let whole = captured(
        &mut renderer,
        &scene,
        &view,
        &stack,
        &AccuracyRequest::default(),
    );
    let layers = whole.frame.glass.layers.len() as u32;
    let mut banded = Renderer::new(renderer.gpu().clone());
    for part in [3, 11] {
        banded.set_tuning(Tuning {
            glass_layers: layers / part,
            ..usual
        });
        let (capture, _) = exact(
            &mut banded,
            &scene,
            &view,
            &stack,
            &AccuracyRequest::default(),
            "bands",
        );
        let bands = banded.key().map_or(0, |key| key.framebuffer.glass_bands);
        assert!(bands > part / 2, "{bands} bands for a {part}th of the room");
        assert_eq!(capture.frame.color, whole.frame.color, "{bands} bands");
        assert_eq!(capture.frame.triangle_id, whole.frame.triangle_id);
    }
    // One pixel has more layers than there is room for.
    banded.set_tuning(Tuning {
        glass_layers: 2,
        ..usual
    });
    let error = banded
        .draw_complete(&view, &stack, &AccuracyRequest::default())
        .block_on();
    assert!(
        matches!(error, Err(RenderError::ManyLayers(_))),
        "{error:?}"
    );
}

#[test]
fn mistakes_in_order_count_band_and_blend_are_caught() {
    let Some(mut healthy) = renderer() else {
        return;
    };
    let (scene, view, stack) = (
        soup(&(0..40).collect::<Vec<_>>()),
        soup_view(),
        Stack::default(),
    );
    let accuracy = pinned(Visibility::Split32);
    let usual = healthy.gpu().caps.tuning();
    exact(&mut healthy, &scene, &view, &stack, &accuracy, "healthy");
    let layers = captured(&mut healthy, &scene, &view, &stack, &accuracy)
        .frame
        .glass
        .layers
        .len() as u32;
    let mut missed = Vec::new();
    for (what, from, to) in [
        (
            "farther layers come first",
            "return key_a > key_b ||",
            "return key_a < key_b ||",
        ),
        (
            "keys are compared without their last bits",
            "let key_a = glass_key(a);",
            "let key_a = glass_key(a) & 0xffff0000u;",
        ),
        (
            "the nearest layer is left out",
            "let first = glass_sorted(head);",
            "let first = max(glass_next(glass_sorted(head)), head);",
        ),
        (
            "back and front are exchanged",
            "front.passed * back.added + front.added",
            "back.passed * front.added + back.added",
        ),
        (
            "color is not premultiplied",
            "clamp(s.color.rgb, vec3f(0.0), vec3f(1.0)) * alpha)",
            "clamp(s.color.rgb, vec3f(0.0), vec3f(1.0)))",
        ),
        (
            "a band ends a pixel early",
            "return GLASS_BANDS == 1u || pixel / glass_band_length()",
            "return GLASS_BANDS == 1u || (pixel + 1u) / glass_band_length()",
        ),
        (
            "opaque triangles hide nothing and are hidden",
            "return (draws[t.draw].flags & DRAW_GLASS) == 0u;",
            "return true;",
        ),
    ] {
        let library = mutated(from, to);
        let mut wrong = Renderer::with_library(healthy.gpu().clone(), library.shaders());
        wrong.set_tuning(Tuning {
            glass_layers: if what.contains("band") {
                layers / 3
            } else {
                usual.glass_layers
            },
            ..usual
        });
        let (_, verdict) = judged(&mut wrong, &scene, &view, &stack, &accuracy);
        if exactness(&verdict.report).is_ok() {
            missed.push(what);
        }
    }
    assert!(missed.is_empty(), "not caught: {}", missed.join("; "));
}

#[test]
fn glass_meets_other_effects() {
    let Some(mut renderer) = renderer() else {
        return;
    };
    let (still, panes) = (scene("still-life?tess=1"), scene("panes"));
    let look = |text: &str| {
        preset_file::parse(&format!("schema = 2\n{text}"), "look")
            .unwrap_or_else(|error| panic!("{error}"))
            .preset
            .stack
    };
    let bottle = "[effects.glass]\non = [\"node:bottle\", \"node:jug\"]\n";
    for (scene, text) in [
        (
            &still,
            format!("{bottle}[effects.lambert]\n[effects.outline]\n[effects.dissolve]\n"),
        ),
        (
            &still,
            format!("{bottle}[effects.shadow]\n[effects.explode]\n[effects.facet]\n"),
        ),
        (
            &panes,
            "[effects.stipple]\n[effects.lambert]\n[effects.fog]\n".into(),
        ),
        (
            &panes,
            "[effects.glass]\n[effects.dots]\n[effects.wobble]\n".into(),
        ),
        (&panes, "[effects.xray]\n".into()),
    ] {
        let view = view(scene, [72, 54]);
        exact(
            &mut renderer,
            scene,
            &view,
            &look(&text),
            &AccuracyRequest::default(),
            &text,
        );
    }
}

#[test]
fn what_glass_cannot_be_drawn_with_is_refused_in_a_sentence() {
    for (other, sentence) in [
        (
            "draw_order",
            "draw_order counts the samples of opaque surfaces, so glass cannot be drawn with it; switch one of them off",
        ),
        (
            "race",
            "glass and race both take the visibility slot of the rasterizer; switch one of them off",
        ),
    ] {
        let text = format!("schema = 2\n[effects.{other}]\n[effects.glass]\n");
        let error = preset_file::parse(&text, "both")
            .expect_err("a conflict")
            .to_string();
        assert!(error.ends_with(sentence), "{error}");
    }
}

#[test]
fn light_passes_through_glass() {
    let scene = scene("panes");
    let view = view(&scene, [48, 36]);
    let mut opaque = (*scene).clone();
    opaque
        .materials
        .iter_mut()
        .for_each(|material| material.is_blended = false);
    let lit = |scene: &Scene| {
        let frame = oracle::render(scene, &view, &stack(&["shadow"])).expect("it fits");
        let floor: Vec<[u8; 4]> = frame.color;
        floor.iter().map(|color| u64::from(color[0])).sum::<u64>()
    };
    assert!(lit(&scene) > lit(&opaque));
}
