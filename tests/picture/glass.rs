//! Promise: glass is composed in true depth order per pixel, whatever the order of triangles, and in
//! bounded memory; what cannot be drawn with it is refused in words. Needs an adapter but for the
//! refusals.

use std::sync::Arc;

use pollster::FutureExt as _;
use rasterlab::{
    accuracy::{AxisOption as _, DepthFormat, Transparency, VertexTransform},
    effects::Stack,
    gpu::{Capture, RenderError, Renderer},
    math::srgb_byte,
    oracle,
    plan::{AccuracyRequest, Tuning},
    preset_file,
    scene::{Scene, view::View},
};

use crate::common::*;

/// The color of the opaque triangle of a soup.
const WALL: [f32; 4] = [0.9, 0.6, 0.2, 1.0];

/// Corners and colors of translucent triangles. Depths are distinct.
fn soup_triangles(count: usize) -> Vec<([[f32; 3]; 3], [f32; 4])> {
    const SIDE: i32 = 32;
    let mut rng = Rng(7);
    (0..count)
        .map(|_| {
            let corner = |rng: &mut Rng| {
                let at = [0, 1].map(|_| rng.between(-1000, 256 * SIDE + 1000) as f32 / 256.0);
                [at[0], at[1], rng.real(0.1, 0.9) as f32]
            };
            let corners = [corner(&mut rng), corner(&mut rng), corner(&mut rng)];
            let mut channel = || rng.real(0.05, 0.95) as f32;
            (corners, [channel(), channel(), channel(), channel()])
        })
        .collect()
}

/// A soup of translucent triangles before an opaque one, in this order.
fn soup(order: &[usize]) -> Arc<Scene> {
    let triangles = soup_triangles(order.len());
    let sorted = || order.iter().map(|&at| &triangles[at]);
    let glass = SimpleMesh {
        positions: sorted().flat_map(|(corners, _)| *corners).collect(),
        colors: sorted().flat_map(|(_, color)| [*color; 3]).collect(),
        ..SimpleMesh::default()
    };
    let wall = SimpleMesh {
        positions: vec![[-8.0, -8.0, 0.2], [60.0, -8.0, 0.5], [-8.0, 60.0, 0.8]],
        colors: vec![WALL; 3],
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

fn every_exact_option_composes_crossing_layers_as_the_oracle_does(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let (scene, view) = (soup(&(0..40).collect::<Vec<_>>()), soup_view());
    let mut first = None;
    for option in reach.of(2, options(&renderer)) {
        let (capture, verdict) = renderer.exact(
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
fn tinted_layers_cover_a_translucent_background_as_far_as_they_dim_it() {
    let Some(mut renderer) = loan() else { return };
    let (scene, mut view) = (soup(&(0..40).collect::<Vec<_>>()), soup_view());
    view.background = [0.2, 0.5, 0.8, 0.25].into();
    let mut stack = stack(&["glass"]);
    let glass = stack.get_mut("glass").expect("just enabled");
    let tint = glass.effect.field("tint").expect("glass has it");
    tint.set(&mut glass.words, &[0.9, 0.4, 0.1, 1.0])
        .expect("a color");
    let accuracy = AccuracyRequest::default();
    let (capture, _) = renderer.exact(&scene, &view, &stack, &accuracy, "tinted");
    let is_between = |color: &[u8; 4]| color[3] > 64 && color[3] < 255;
    assert!(
        capture
            .frame
            .color
            .iter()
            .filter(|color| is_between(color))
            .count()
            > 20
    );
}

fn no_order_of_triangles_shows(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    for &transparency in reach.of(1, Transparency::ALL) {
        let mut strict = on(transparency);
        strict.pins = strict
            .pins
            .with(VertexTransform::Strict)
            .with(DepthFormat::Integer);
        let mut order: Vec<usize> = (0..40).collect();
        let mut pictures = Vec::new();
        for round in 0..3 {
            let (scene, view) = (soup(&order), soup_view());
            let stack = Stack::default();
            pictures.push(
                renderer
                    .captured(&scene, &view, &stack, &strict)
                    .frame
                    .color,
            );
            order.reverse();
            order.rotate_left(7 + round);
        }
        assert!(
            pictures.iter().all(|picture| *picture == pictures[0]),
            "{}",
            transparency.name()
        );
    }
}

fn on(transparency: Transparency) -> AccuracyRequest {
    let mut request = AccuracyRequest::default();
    transparency.pin(&mut request.pins);
    request
}

#[test]
fn fewer_layers_and_no_order_err_in_color_alone_and_only_where_layers_lie_behind_one_another() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("panes?sheets=9");
    let (view, stack) = (view(&scene, [96, 72]), stack(&["lambert"]));
    let mut drawn = |option| renderer.judged(&scene, &view, &stack, &on(option));
    let (exact, _) = drawn(Transparency::Exact);
    let counts = exact.frame.glass.counts();
    for (option, most_exact) in [
        (Transparency::Opaque, 0),
        (Transparency::Weighted, 1),
        (Transparency::Nearest4, 4),
    ] {
        let (capture, verdict) = drawn(option);
        let (frame, report) = (&capture.frame, verdict.report);
        assert_eq!(
            (&frame.triangle_id, &frame.depth_key),
            (&exact.frame.triangle_id, &exact.frame.depth_key),
            "{}",
            option.name()
        );
        let faults = [report.wrong_triangles, report.layer_counts_wrong];
        assert_eq!(faults, [0; 2], "{}: {report:?}", option.name());
        assert!(report.max_color_delta > 8, "{}: {report:?}", option.name());
        let differs = |pixel: &usize| frame.color[*pixel] != exact.frame.color[*pixel];
        let is_shallow = |pixel: &usize| counts[*pixel] <= most_exact;
        let (shallow, deep): (Vec<usize>, Vec<usize>) = (0..counts.len()).partition(is_shallow);
        assert!(!shallow.iter().any(differs), "{}", option.name());
        assert!(deep.iter().filter(|pixel| differs(pixel)).count() > 100);
    }
}

#[test]
fn what_is_drawn_as_if_opaque_is_what_does_not_blend() {
    let Some(mut renderer) = loan() else { return };
    let blended = scene("panes");
    let view = view(&blended, [96, 72]);
    let mut opaque = (*blended).clone();
    for material in &mut opaque.materials {
        (material.is_blended, material.base_color[3]) = (false, 1.0);
    }
    let opaque = Arc::new(opaque);
    let stack = stack(&["lambert", "outline"]);
    let mut drawn = |scene, option| renderer.captured(scene, &view, &stack, &on(option)).frame;
    let (seen, without) = (
        drawn(&blended, Transparency::Opaque),
        drawn(&opaque, Transparency::Exact),
    );
    assert_eq!(
        (&seen.triangle_id, &seen.depth_key, &seen.color),
        (&without.triangle_id, &without.depth_key, &without.color)
    );
}

/// What layers, nearest first, each a depth and a color, do to the light of the wall, in f64.
fn composed(option: Transparency, layers: &[(f64, [f64; 4])]) -> [u8; 3] {
    let most = option
        .most_layers()
        .map_or(layers.len(), |most| layers.len().min(most as usize));
    let steps = |depth: f64| ((depth / layers[0].0).powi(3) * 256.0).max(1.0).round();
    [0, 1, 2].map(|channel| {
        let wall = f64::from(WALL[channel]);
        let seen = if option == Transparency::Weighted && !layers.is_empty() {
            let (mut light, mut covered, mut passed) = (0.0, 0.0, 1.0);
            for (depth, color) in layers {
                light += steps(*depth) * color[3] * color[channel];
                covered += steps(*depth) * color[3];
                passed *= 1.0 - color[3];
            }
            light / covered * (1.0 - passed) + wall * passed
        } else {
            let over = |behind: f64, (_, color): &(f64, [f64; 4])| {
                behind + (color[channel] - behind) * color[3]
            };
            layers[..most].iter().rev().fold(wall, over)
        };
        srgb_byte(seen)
    })
}

/// Pixels of the soup before the wall whose color is not what their layers, which `exact` lists,
/// compose to, and those with another nearest triangle.
fn wrongly_composed(renderer: &mut Renderer, option: Transparency, exact: &Capture) -> usize {
    let count = 40;
    let triangles = soup_triangles(count);
    let scene = soup(&(0..count).collect::<Vec<_>>());
    let view = soup_view();
    let frame = renderer
        .captured(&scene, &view, &Stack::default(), &on(option))
        .frame;
    let lists = &exact.frame.glass;
    let is_wrong = |pixel: &usize| {
        if lists.behind[*pixel] != count as u32 {
            return false;
        }
        let layer = |hit: &rasterlab::frame::GlassHit| {
            let color = triangles[hit.triangle_id as usize].1.map(f64::from);
            (f64::from(f32::from_bits(hit.depth_key)), color)
        };
        let layers: Vec<_> = lists.at(*pixel).iter().map(layer).collect();
        let right = composed(option, &layers);
        (0..3).any(|channel| frame.color[*pixel][channel].abs_diff(right[channel]) > 1)
            || frame.triangle_id[*pixel] != exact.frame.triangle_id[*pixel]
    };
    (0..frame.color.len()).filter(is_wrong).count()
}

fn every_option_composes_as_it_says_and_mistakes_in_it_are_caught(reach: Reach) {
    let Some(mut healthy) = loan() else { return };
    let (scene, view) = (soup(&(0..40).collect::<Vec<_>>()), soup_view());
    let exact = healthy.captured(&scene, &view, &Stack::default(), &unpinned());
    for option in [
        Transparency::Weighted,
        Transparency::Nearest4,
        Transparency::Exact,
    ] {
        let wrong = wrongly_composed(&mut healthy, option, &exact);
        assert_eq!(wrong, 0, "{}", option.name());
    }
    let (nearest4, weighted) = (Transparency::Nearest4, Transparency::Weighted);
    let mut missed = Vec::new();
    let mistakes = [
        (
            nearest4,
            "a layer too many",
            "count < GLASS_COMPOSED_LAYERS",
            "count <= GLASS_COMPOSED_LAYERS",
        ),
        (
            weighted,
            "weights fall with the square",
            "nearness * nearness * nearness",
            "nearness * nearness",
        ),
        (
            weighted,
            "the mean is not covered",
            "color * (1.0 - passed)",
            "color",
        ),
        (
            weighted,
            "only the last layer fades",
            "min(faded + fades,",
            "min(fades,",
        ),
        (
            weighted,
            "light is not weighed",
            "vec3u(layer.added * GLASS_STEPS + 0.5) * weight",
            "vec3u(layer.added * GLASS_STEPS + 0.5)",
        ),
        (
            weighted,
            "any layer is the nearest",
            "if first == 0u || glass_is_before(link, first)",
            "if first == 0u || !glass_is_before(link, first)",
        ),
    ];
    for (option, what, from, to) in reach.of(2, mistakes) {
        let library = mutated(from, to);
        let mut wrong = Renderer::with_library(healthy.gpu().clone(), library.shaders());
        if wrongly_composed(&mut wrong, option, &exact) == 0 {
            missed.push(what);
        }
    }
    assert!(missed.is_empty(), "not caught: {}", missed.join("; "));
}

#[test]
fn bands_of_pixels_draw_the_same_picture_in_less_memory() {
    let Some(mut renderer) = loan() else { return };
    let (scene, stack) = (soup(&(0..40).collect::<Vec<_>>()), Stack::default());
    // Rows of other lengths than bands, so that bands begin and end inside rows.
    let view = pixel_view(32, 32);
    let usual = renderer.gpu().caps.tuning();
    let whole = renderer.captured(&scene, &view, &stack, &unpinned());
    let layers = whole.frame.glass.layers.len() as u32;
    let mut banded = Renderer::new(renderer.gpu().clone());
    for part in [3, 11] {
        banded.set_tuning(Tuning {
            glass_layers: layers / part,
            ..usual
        });
        let (capture, _) = banded.exact(&scene, &view, &stack, &unpinned(), "bands");
        let bands = banded.key().map_or(0, |key| key.framebuffer.glass_bands);
        assert!(bands > part / 2, "{bands} bands for a {part}th of the room");
        assert_eq!(capture.frame.color, whole.frame.color, "{bands} bands");
        assert_eq!(capture.frame.triangle_id, whole.frame.triangle_id);
    }
    for option in [Transparency::Weighted, Transparency::Nearest4] {
        let [at_once, in_bands] = [&mut renderer, &mut banded].map(|renderer| {
            renderer
                .captured(&scene, &view, &stack, &on(option))
                .frame
                .color
        });
        assert_eq!(at_once, in_bands, "{}", option.name());
    }
    // One pixel has more layers than there is room for.
    banded.set_tuning(Tuning {
        glass_layers: 2,
        ..usual
    });
    let error = banded.draw_complete(&view, &stack, &unpinned()).block_on();
    assert!(
        matches!(error, Err(RenderError::ManyLayers(_))),
        "{error:?}"
    );
}

fn mistakes_in_order_count_band_and_blend_are_caught(reach: Reach) {
    let Some(mut healthy) = loan() else { return };
    let (scene, view, stack) = (
        soup(&(0..40).collect::<Vec<_>>()),
        soup_view(),
        Stack::default(),
    );
    let accuracy = split32();
    let usual = healthy.gpu().caps.tuning();
    healthy.exact(&scene, &view, &stack, &accuracy, "healthy");
    let layers = healthy
        .captured(&scene, &view, &stack, &accuracy)
        .frame
        .glass
        .layers
        .len() as u32;
    let mut missed = Vec::new();
    let mistakes = [
        (
            "farther layers come first",
            "return (keys > vec4u(key)) |",
            "return (keys < vec4u(key)) |",
        ),
        (
            "keys are compared without their last bits",
            "let key = glass_key(rest);",
            "let key = glass_key(rest) & 0xffff0000u;",
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
            "return GLASS_BANDS == 1u || pixel - first < glass_band_length();",
            "return GLASS_BANDS == 1u || pixel - first + 1u < glass_band_length();",
        ),
        (
            "opaque triangles hide nothing and are hidden",
            "return (draws[t.draw].flags & DRAW_GLASS) == 0u;",
            "return true;",
        ),
    ];
    for (what, from, to) in reach.of(3, mistakes) {
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
        // A list that never ends counts as too deep, and is refused.
        let drawn = wrong
            .set_scene(&scene)
            .block_on()
            .and_then(|()| wrong.capture(&view, &stack, &accuracy).block_on());
        let capture = match drawn {
            Err(RenderError::DeepGlass { .. }) => continue,
            drawn => drawn.unwrap_or_else(|error| panic!("{what}: {error}")),
        };
        let verdict = verdict(&scene, &view, &stack, &capture);
        if exactness(&verdict.report).is_ok() {
            missed.push(what);
        }
    }
    assert!(missed.is_empty(), "not caught: {}", missed.join("; "));
}

fn glass_meets_other_effects(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let (still, panes) = (scene("still-life?tess=1"), scene("panes"));
    let look = |text: &str| {
        preset_file::parse(&format!("schema = 2\n{text}"), "look")
            .unwrap_or_else(|error| panic!("{error}"))
            .preset
            .stack
    };
    let bottle = "[effects.glass]\non = [\"node:bottle\", \"node:jug\"]\n";
    for (scene, text) in reach.of(
        2,
        [
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
        ],
    ) {
        let view = view(scene, [72, 54]);
        renderer.exact(scene, &view, &look(&text), &unpinned(), &text);
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

#[test]
fn small_bindings_divide_the_lists_of_pixels_too() {
    let (Some(mut renderer), Some(mut own)) = (loan(), own_gpu()) else {
        return;
    };
    let (scene, stack) = (scene("panes?sheets=9"), stack(&["lambert"]));
    let (view, request) = (view(&scene, [128, 54]), AccuracyRequest::default());
    let whole = renderer.captured(&scene, &view, &stack, &request).frame;
    // Sixteen bytes for every pixel and four for every tile of 8 x 8, as the picture takes with
    // what its layers compose to. Depths, ids and heads of all pixels leave no layer any room.
    let most = 16 * 128 * 54 + 4 * 16 * 7;
    let gpu = Arc::get_mut(&mut own).expect("one device of its own");
    gpu.caps.max_storage_binding_bytes = most;
    let mut bound = Renderer::new(own);
    bound.set_scene(&scene).block_on().expect("it fits");
    let frame = bound
        .capture(&view, &stack, &request)
        .block_on()
        .unwrap_or_else(|error| panic!("{error}"))
        .frame;
    assert_eq!(frame.color, whole.color);
    assert_eq!(frame.triangle_id, whole.triangle_id);
    let explained = bound.explain();
    let largest = explained.buffers.iter().map(|buffer| buffer.bytes).max();
    assert!(largest <= Some(most), "{largest:?} of {most} bytes");
    let bands = bound.key().map_or(0, |key| key.framebuffer.glass_bands);
    let says = |note: &rasterlab::plan::Note| note.why.contains(&format!("in {bands} bands"));
    assert!(bands > 8 && explained.reasons.iter().any(says), "{bands}");
}

#[test]
fn layers_make_do_with_the_memory_that_is_left() {
    let Some(gpu) = own_gpu() else {
        return;
    };
    let (scene, stack) = (scene("panes?sheets=9"), stack(&["lambert"]));
    let (view, request) = (view(&scene, [320, 240]), AccuracyRequest::default());
    let drawn = |allowed: u64| {
        let mut renderer = Renderer::new(gpu.clone());
        renderer.set_scene(&scene).block_on().expect("it fits");
        gpu.memory.allow(allowed);
        renderer
            .draw_complete(&view, &stack, &request)
            .block_on()
            .unwrap_or_else(|error| panic!("{error}"));
        let used = gpu.memory.used();
        let bands = renderer.key().map_or(0, |key| key.framebuffer.glass_bands);
        // Reading it back takes memory of its own.
        gpu.memory.allow(u64::MAX);
        let capture = renderer.capture(&view, &stack, &request).block_on();
        (capture.expect("it fits").frame.color, bands, used)
    };
    let (whole, one, all) = drawn(u64::MAX);
    // Of the layers, 65,536 of 24 bytes, a quarter fits.
    let (divided, bands, less) = drawn(all - 1_000_000);
    assert_eq!(divided, whole);
    assert!(
        one == 1 && bands > 1 && less < all,
        "{bands} bands, {less} of {all} bytes"
    );
}

few_and_all!(
    every_exact_option_composes_crossing_layers_as_the_oracle_does,
    no_order_of_triangles_shows,
    every_option_composes_as_it_says_and_mistakes_in_it_are_caught,
    mistakes_in_order_count_band_and_blend_are_caught,
    glass_meets_other_effects,
);
