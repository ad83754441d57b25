//! Promise: points and lines are drawn and judged as triangles are: with every visibility option, on
//! parts, moved by effects, as layers, from inside, in any number of buffers, and by the effect that
//! draws corners. Needs an adapter.

use std::sync::Arc;

use pollster::FutureExt as _;
use rasterlab::{
    gpu::{Gpu, Renderer},
    preset::Preset,
    scene::{Scene, memory::MemoryBudget, mesh_files::load_obj, parts::Scope, pick::pick_instance},
};

use crate::common::*;

/// Points, segments in all directions from short to as long as the model, and a face, each a part.
fn points_and_lines() -> Arc<Scene> {
    let mut rng = Rng(7);
    let mut text = String::from("v -1 -1 -0.2\nv 1 -1 -0.2\nv 0 1 0.2\no face\nf 1 2 3\n");
    for kind in ["p", "l"] {
        text += &format!("o {kind}\n");
        for at in 0..150u32 {
            let mut place = || rng.real(-1.0, 1.0);
            let [x, y, z] = [place(), place(), place()];
            let size = if kind == "p" || at % 3 == 0 { 2.0 } else { 0.1 };
            let [dx, dy, dz] = [place(), place(), place()].map(|d| d * size);
            let colors = "0.9 0.3 0.1";
            text += &format!("v {x} {y} {z} {colors}\n");
            text += &format!("v {} {} {} 0.1 0.5 0.9\n", x + dx, y + dy, z + dz);
            text += match kind {
                "p" => "p -2 -1\n",
                _ => "l -2 -1\n",
            };
        }
    }
    let scene = load_obj(&text.as_bytes(), MemoryBudget::LEAST, &mut |_, _| {
        unreachable!("no other file")
    });
    Arc::new(scene.expect("a model"))
}

fn points_and_lines_are_judged_as_triangles(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = points_and_lines();
    let view = view(&scene, [128, 96]);
    let mut limited = stack(&["dissolve", "lambert"]);
    let on = Scope::of_texts(&["node:l".to_owned()]).expect("a pattern");
    limited.0[0].on = on;
    for (what, stack) in [
        ("lit", stack(&["lambert"])),
        ("on the lines", limited),
        ("layers", stack(&["xray"])),
        ("moved", stack(&["wobble", "lambert"])),
        ("corners", stack(&["points"])),
        ("apart", stack(&["explode", "lambert"])),
        ("boxes", stack(&["boxes"])),
    ] {
        for option in reach.options(&renderer) {
            let name = format!("{what}, {}", option.name());
            let (capture, _) = renderer.exact(&scene, &view, &stack, &pinned(option), &name);
            assert!(capture.frame.covered() > 1000, "{name}");
        }
    }
    let picked = |x: usize, y: usize| {
        let at = glam::DVec2::new((x as f64 + 0.5) / 128.0, (y as f64 + 0.5) / 96.0);
        pick_instance(&scene, &view, at)
    };
    let capture = renderer.captured(&scene, &view, &stack(&["lambert"]), &unpinned());
    let draws = rasterlab::scene::draw::draws(&scene, &view).expect("draws");
    let of_triangle = |id: u32| draws.iter().rposition(|draw| draw.first_triangle <= id);
    let ids = &capture.frame.triangle_id;
    let shown = ids
        .iter()
        .enumerate()
        .filter(|(_, id)| **id != rasterlab::frame::NO_TRIANGLE);
    let (hit, all) = shown.fold((0, 0), |(hit, all), (pixel, &id)| {
        let is_hit = picked(pixel % 128, pixel / 128) == of_triangle(id);
        (hit + u32::from(is_hit), all + 1)
    });
    // A ray takes what is a pixel away, too.
    assert!(hit * 10 > all * 8, "{hit} of {all}");
}

few_and_all!(points_and_lines_are_judged_as_triangles);

/// A cloud of several blocks as a camera sees it from outside, from inside, and at the picture's edge.
fn clouds_are_judged_from_everywhere(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("nebula?points=6000");
    let cameras = [
        ([-3.0, 4.0, 8.0], [0.0, 0.0, 0.0]),
        ([0.4, 0.1, 0.3], [1.0, 0.0, 1.0]),
        ([0.0, 0.5, 4.0], [3.5, 0.0, 0.0]),
    ];
    let stacks = [
        &["lambert"][..],
        &["xray"],
        &["dissolve"],
        &["wobble"],
        &["draw_order"],
    ];
    for tuning in [renderer.gpu().caps.tuning(), GRAPHICS_CARD] {
        renderer.set_tuning(tuning);
        for (at, (eye, target)) in cameras.into_iter().enumerate() {
            let mut preset = Preset::of_sphere(&scene, [96, 72]);
            let camera = preset.camera.as_mut().expect("it frames the scene");
            (camera.eye, camera.target) = (eye.into(), target.into());
            let view = preset.view(&scene, [96, 72]);
            for effects in reach.of(2, stacks) {
                for option in reach.options(&renderer) {
                    let name = format!("camera {at}, {effects:?}, {}", option.name());
                    let (capture, _) =
                        renderer.exact(&scene, &view, &stack(effects), &pinned(option), &name);
                    assert!(capture.frame.covered() > 300, "{name}");
                }
            }
        }
    }
}

/// Attributes that are more than a binding holds go on in a second one.
#[test]
fn attributes_of_a_large_cloud_have_two_buffers() {
    let Some(mut gpu) = own_gpu().and_then(Arc::into_inner) else {
        return;
    };
    let scene = scene("nebula?points=60000");
    let moments = [(view(&scene, [96, 72]), stack(&["lambert"]))];
    let request = unpinned();
    let picture = |gpu: Gpu| {
        let mut renderer = Renderer::new(Arc::new(gpu));
        renderer.set_scene(&scene).block_on().expect("it fits");
        let drawn = renderer.draw_last(&moments, &request);
        let frame = drawn.block_on().expect("it fits");
        assert_eq!(
            renderer.key().expect("a picture").vertices.split.is_some(),
            renderer.gpu().caps.max_storage_binding_bytes == 1 << 20
        );
        frame
    };
    let whole = picture(own_gpu().and_then(Arc::into_inner).expect("an adapter"));
    gpu.caps.max_storage_binding_bytes = 1 << 20;
    assert_same(&picture(gpu), &whole, "two buffers");
}

few_and_all!(clouds_are_judged_from_everywhere);
