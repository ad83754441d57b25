//! Promise: where the memory of the adapter ends, whichever buffer or texture finds none, the
//! picture is refused in one sentence; the renderer goes on, draws what fits, draws the picture as
//! before once there is room, and frees what it took. Needs an adapter.

use std::process::Command;

use pollster::FutureExt as _;
use rasterlab::{
    effects::Stack,
    gpu::{RenderError, Renderer},
    plan::AccuracyRequest,
    scene::view::View,
};

use crate::common::{Reach, few_and_all, gpu, own_gpu, scene, stack, view};

/// What takes memory of every kind: images and their atlas, a shadow map, particles, layers, dots,
/// the picture before this one.
const PICTURES: &[(&str, &[&str])] = &[
    ("leaves?n=40", &["lambert", "shadow"]),
    ("knot?tess=6", &["xray", "lambert"]),
    ("tentacle?tess=3", &["dots", "smear", "lambert"]),
    ("cube-wall", &["draw_order", "overdraw"]),
];

/// Steps between no memory and all that a picture takes.
const STEPS: u64 = 24;

fn a_picture_without_memory_is_refused_in_a_sentence_and_drawn_once_there_is_room(reach: Reach) {
    let Some(gpu) = own_gpu() else { return };
    let request = AccuracyRequest::default();
    for &(query, effects) in &reach.of(1, PICTURES.iter().copied()) {
        let (scene, stack) = (scene(query), stack(effects));
        let view = view(&scene, [160, 120]);
        let pixels = |renderer: &mut Renderer, view: &View, stack: &Stack| {
            renderer
                .capture(view, stack, &request)
                .block_on()
                .map(|capture| capture.frame.color)
        };

        let mut renderer = Renderer::new(gpu.clone());
        renderer.set_scene(&scene).block_on().expect("it fits");
        let expected = pixels(&mut renderer, &view, &stack).expect("it fits");
        let all = gpu.memory.used();
        drop(renderer);
        assert_eq!(gpu.memory.used(), 0, "{query}: bytes that were not freed");

        let (mut refused, mut buffers) = (0, std::collections::BTreeSet::new());
        for step in (0..STEPS).step_by(if reach == Reach::Few { 3 } else { 1 }) {
            let what = format!("{query}, {step} of {STEPS} parts of {all} bytes");
            let mut renderer = Renderer::new(gpu.clone());
            gpu.memory.allow(all * step / STEPS);
            match renderer
                .set_scene(&scene)
                .block_on()
                .and_then(|()| pixels(&mut renderer, &view, &stack))
            {
                Ok(drawn) => assert!(drawn == expected, "{what}: another picture"),
                Err(error @ RenderError::OutOfMemory { buffer, .. }) => {
                    let text = error.to_string();
                    assert!(
                        text.starts_with(&format!("no memory for the buffer {buffer} of "))
                            && !text.contains('\n'),
                        "{what}: {text}"
                    );
                    assert!(
                        error.depends_on_adapter() && !error.is_fault() && !error.is_lost(),
                        "{what}: {error:?}"
                    );
                    (refused, _) = (refused + 1, buffers.insert(buffer));
                }
                Err(error) => panic!("{what}: {error}"),
            }
            gpu.memory.allow(u64::MAX);
            renderer
                .set_scene(&scene)
                .block_on()
                .expect("there is room");
            let again = pixels(&mut renderer, &view, &stack)
                .unwrap_or_else(|error| panic!("{what}: then {error}"));
            assert!(again == expected, "{what}: another picture than before");
            assert!(
                !gpu.is_lost() && gpu.take_error().is_none(),
                "{what}: the device has an error"
            );
        }
        assert!(
            refused > STEPS / 12 && buffers.len() > 2,
            "{query}: {refused} of {STEPS} were refused, for {buffers:?}"
        );
        assert_eq!(gpu.memory.used(), 0, "{query}: bytes that were not freed");
    }
}

#[test]
fn a_picture_too_large_for_the_memory_leaves_the_smaller_one() {
    let Some(gpu) = own_gpu() else { return };
    let request = AccuracyRequest::default();
    let (scene, stack) = (scene("teapot?tess=4"), stack(&["xray"]));
    let [small, large] = [[64, 48], [640, 480]].map(|size| view(&scene, size));
    let mut renderer = Renderer::new(gpu.clone());
    renderer.set_scene(&scene).block_on().expect("it fits");
    let expected = renderer
        .capture(&small, &stack, &request)
        .block_on()
        .expect("it fits")
        .frame;
    gpu.memory.allow(gpu.memory.used() + (1 << 18));
    for _ in 0..3 {
        let refused = renderer
            .draw(&large, &stack, &request)
            .block_on()
            .expect_err("pixels of 7 megabytes in 256 kilobytes");
        assert!(
            matches!(refused, RenderError::OutOfMemory { .. }),
            "{refused}"
        );
        assert!(
            renderer
                .capture(&small, &stack, &request)
                .block_on()
                .expect("it fits")
                .frame
                == expected,
            "another picture than before"
        );
    }
}

#[test]
fn the_command_names_the_buffer_and_ends_with_3() {
    let Some(gpu) = gpu() else { return };
    let folder = tempfile::tempdir().unwrap();
    let run = |limit: &str| {
        let args = [
            "render",
            "facet",
            "--size",
            "640x480",
            "-o",
            "a.png",
            "--device-memory",
            limit,
            "--adapter",
            &gpu.summary.name,
        ];
        let presets = concat!(env!("CARGO_MANIFEST_DIR"), "/presets");
        Command::new(env!("CARGO_BIN_EXE_rasterlab"))
            .args(args)
            .args(["--presets", presets])
            .current_dir(&folder)
            .output()
            .expect("it runs")
    };
    let refused = run("2MiB");
    let text = String::from_utf8(refused.stderr).expect("text");
    // A driver may write lines of its own before ours.
    let error = text
        .lines()
        .rfind(|line| line.starts_with("error: "))
        .unwrap_or_else(|| panic!("no error in {text}"));
    assert!(
        error.contains("no memory for the buffer ")
            && error.ends_with("take another adapter, or a smaller picture or scene"),
        "{error}"
    );
    assert_eq!(
        (refused.status.code(), folder.path().join("a.png").exists()),
        (Some(3), false),
        "{text}"
    );
    let drawn = run("1GiB");
    assert!(
        drawn.status.success() && folder.path().join("a.png").exists(),
        "{}",
        String::from_utf8_lossy(&drawn.stderr)
    );
    let wrong = run("much");
    let text = String::from_utf8(wrong.stderr).expect("text");
    assert!(
        wrong.status.code() == Some(2)
            && text.contains("it must be a number with a unit, for instance 8GiB or 1500MiB"),
        "{text}"
    );
}

few_and_all!(a_picture_without_memory_is_refused_in_a_sentence_and_drawn_once_there_is_room,);
