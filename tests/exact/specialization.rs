//! Promise: what the planner leaves out does not show, is not allocated and is not compiled again.
//! Needs an adapter.

use std::{collections::BTreeSet, path::Path, sync::Arc};

use pollster::FutureExt as _;
use rasterlab::{
    accuracy::{DotCulling, PinnedOptions, Visibility},
    effects::{EFFECTS, Stack, hooks::Shape},
    frame::{AdapterPicture, Frame},
    gpu::{Explanation, Renderer, ResourceId},
    measure::compare,
    oracle,
    plan::Tuning,
    preset_file,
    scene::{Scene, view::View},
    shader::{Fetch, key::AttributeFormat},
};

use crate::common::*;

type Picture = (String, Arc<Scene>, View, Stack, Visibility);

/// Every built-in scene, each on the next option in turn.
fn pictures_of_scenes(options: &[Visibility]) -> Vec<Picture> {
    let picture = |(turn, query): (usize, &&str)| {
        let scene = scene(query);
        let view = view(&scene, [200, 150]);
        let stack = stack(&["depth", "lambert"]);
        let option = options[turn % options.len()];
        ((*query).to_owned(), scene, view, stack, option)
    };
    SCENES.iter().enumerate().map(picture).collect()
}

/// A preset for every effect on one option: the resolve of its effects hardly knows the option.
fn pictures_of_effects(options: &[Visibility]) -> Vec<Picture> {
    let mut pictures = Vec::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets");
    let entries = std::fs::read_dir(folder).expect("presets/ can be read");
    let mut preset_files: Vec<_> = entries
        .map(|entry| entry.expect("presets/ can be read").path())
        .collect();
    preset_files.sort();
    let mut met = BTreeSet::new();
    for path in preset_files {
        if path.extension().is_some_and(|e| e == "toml") {
            let preset_file = preset_file::load(&path).unwrap_or_else(|error| panic!("{error}"));
            let scene = preset_file::load_scene(&preset_file.preset, preset_file.path.as_deref())
                .unwrap_or_else(|error| panic!("{}: {error}", preset_file.id));
            let view = preset_file
                .preset
                .view(&scene, preset_file.preset.output.size.map(|side| side / 2));
            let brings_new = preset_file
                .preset
                .stack
                .0
                .iter()
                .filter(|enabled| met.insert(enabled.effect.name.clone()))
                .count()
                > 0;
            if brings_new && preset_file.preset.stack.is_repeatable() {
                pictures.push((
                    preset_file.id.clone(),
                    scene,
                    view,
                    preset_file.preset.evaluated_stack(),
                    options[0],
                ));
            }
        }
    }
    pictures
}

fn assert_same(a: &Frame, b: &Frame, band: &[bool], what: &str) {
    for (image, a, b) in [
        ("triangle_ids", &a.triangle_id, &b.triangle_id),
        ("keys", &a.depth_key, &b.depth_key),
    ] {
        let delta = compare::triangle_ids(a, b);
        assert_eq!(
            delta.different,
            0,
            "{what}: {image} differ, first {:?}",
            delta.mismatches.first()
        );
    }
    // What decides is equal to the bit. Shading may round otherwise where a guard or a wide product
    // is left out. At a step of color that may show; there the judge says which pixels have two
    // right answers.
    let held: Vec<[u8; 4]> = b
        .color
        .iter()
        .enumerate()
        .map(|(i, &color)| {
            if band.get(i) == Some(&true) {
                a.color[i]
            } else {
                color
            }
        })
        .collect();
    let colors = compare::pictures(&a.color, &held, 1);
    assert_eq!(
        colors.pixels_over_tolerance,
        0,
        "{what}: colors differ by more than a step, first {:?}",
        colors.mismatches.first()
    );
}

fn the_planned_kernel_and_the_one_that_leaves_nothing_out_draw_the_same_scenes(reach: Reach) {
    planned_as_everything(reach, pictures_of_scenes);
}

fn the_planned_kernel_and_the_one_that_leaves_nothing_out_draw_the_same_effects(reach: Reach) {
    planned_as_everything(reach, pictures_of_effects);
}

/// Draws the pictures both ways.
fn planned_as_everything(reach: Reach, pictures: fn(&[Visibility]) -> Vec<Picture>) {
    let Some(mut renderer) = loan() else { return };
    let usual = renderer.gpu().caps.tuning();
    // Thresholds of a GPU, so that medium triangles occur.
    let planned_tuning = Tuning {
        max_small_samples: 64,
        max_small_side: 32,
        ..usual
    };
    let mut spared = 0;
    for (what, scene, view, stack, option) in reach.of(3, pictures(&reach.options(&renderer))) {
        let [(planned, key), (maximal, everything)] = [true, false].map(|specialized| {
            renderer.set_tuning(Tuning {
                specialized,
                ..planned_tuning
            });
            let capture = renderer.captured(&scene, &view, &stack, &pinned(option));
            (
                capture,
                renderer.key().expect("something was drawn").clone(),
            )
        });
        let k = &everything;
        // Discs about corners need no path for large triangles, in any scene.
        let has_paths = k.paths.has_clipping && k.paths.has_medium && k.paths.has_large
            || k.samples.shape == Shape::Points;
        assert!(
            has_paths && k.surface.has_planes && k.vertices.has_colors,
            "{k}"
        );
        let vertices = &k.vertices;
        assert!(
            !vertices.is_single_draw
                && !vertices.only_triangle_lists
                && vertices.fetch != Fetch::IndexedU32,
            "{k:?}"
        );
        assert_eq!(
            [vertices.positions, vertices.normals],
            [AttributeFormat::Any; 2],
            "{k:?}"
        );
        assert_ne!(key, everything, "{what}: the planner spares nothing");
        spared += u32::from(!key.has_queues());
        let band = if stack.has_steps() || !scene.images.is_empty() {
            let verdict = oracle::judge(
                &scene,
                &view,
                &stack,
                &AdapterPicture {
                    previous: None,
                    ..planned.picture()
                },
            );
            verdict
                .unwrap_or_else(|error| panic!("{what}: {error}"))
                .step_band
        } else {
            Vec::new()
        };
        assert_same(
            &planned.frame,
            &maximal.frame,
            &band,
            &format!("{what} {}", option.name()),
        );
        assert_eq!(planned.layers, maximal.layers, "{what}: layers");
        assert_eq!(planned.geometry, maximal.geometry, "{what}: geometry");
        assert_eq!(
            planned.frame.counters, maximal.frame.counters,
            "{what}: counters"
        );
    }
    assert!(spared > 0, "no picture does without queues");
}

/// How a new renderer explains one picture.
fn explained(
    query: &str,
    size: [u32; 2],
    option: Visibility,
    tuning: Tuning,
) -> Option<(Explanation, Arc<Scene>, View)> {
    let mut renderer = Renderer::new(gpu()?);
    renderer.set_tuning(tuning);
    let scene = scene(query);
    let view = view(&scene, size);
    renderer
        .set_scene(&scene)
        .block_on()
        .expect("a builtin fits");
    renderer
        .draw_complete(&view, &stack(&["lambert"]), &pinned(option))
        .block_on()
        .expect("a builtin is drawn");
    Some((renderer.explain(), scene, view))
}

fn names(explanation: &Explanation) -> (Vec<&str>, Vec<&str>) {
    let passes = explanation
        .passes
        .iter()
        .map(|pass| pass.name.as_str())
        .collect();
    let buffers = explanation
        .buffers
        .iter()
        .map(|buffer| buffer.name.as_str())
        .collect();
    (passes, buffers)
}

fn an_effect_that_is_switched_off_again_leaves_no_pass_and_no_buffer(reach: Reach) {
    let Some(gpu) = gpu() else { return };
    let (mut renderer, scene) = (Renderer::new(gpu), scene("teapot?tess=4"));
    let view = view(&scene, [64, 48]);
    let mut explained = |names: &[&str]| {
        renderer.captured(&scene, &view, &stack(names), &split32());
        renderer.explain()
    };
    let bare = explained(&[]);
    let mut has_own = 0;
    // In reverse, x-ray and wireframe come first.
    let effects = EFFECTS.iter().rev();
    for effect in reach.of(6, effects.filter(|effect| effect.name != "particles")) {
        let on = explained(&[effect.name.as_str()]);
        let off = explained(&[]);
        assert_eq!(names(&off), names(&bare), "{}", effect.name);
        has_own += usize::from(names(&on) != names(&bare));
    }
    assert!(
        has_own > usize::from(reach == Reach::All) * 5,
        "{has_own} effects have passes or buffers of their own"
    );
    assert!(
        !names(&bare).1.contains(&"particle_states")
            && bare.omitted.iter().any(|note| note.name == "particles")
    );
}

fn a_scene_of_small_triangles_has_no_queues_arguments_or_clipped_triangles(reach: Reach) {
    let tuning = Tuning {
        max_small_samples: 64,
        max_small_side: 32,
        group_size: 256,
        listed_tiles: false,
        early_load: false,
        exchanges_maximum: false,
        queue_groups: 0,
        dot_groups: 1024,
        interleaves_triangles: false,
        clears_in_passes: false,
        hides_blocks: false,
        stored_uniforms: false,
        wide_loads: false,
        buffered_shadow_map: false,
        glass_layers: rasterlab::plan::MOST_GLASS_LAYERS,
        specialized: true,
    };
    let explained = |query, tuning| explained(query, [320, 240], Visibility::Split32, tuning);
    let Some((small, ..)) = explained("sphere?triangles=20000", tuning) else {
        return;
    };
    let (passes, buffers) = names(&small);
    assert_eq!(
        passes,
        [
            "project",
            "raster_small depth",
            "raster_small triangle id",
            "resolve"
        ]
    );
    for spared in [
        "queues",
        "args",
        "clipped_triangles",
        "tile_mask",
        "background",
        "layers",
        "depth_and_id",
        "deforms",
        "joints",
        "morph_targets",
        "meshlets",
        "instances",
    ] {
        assert!(
            ResourceId::of_binding(spared).is_some(),
            "no buffer is ever called {spared}"
        );
        assert!(!buffers.contains(&spared), "{spared} exists: {buffers:?}");
    }
    for (part, why) in [
        ("clip", "near plane"),
        ("raster_medium", "px"),
        ("tile_large, raster_large", "px"),
    ] {
        let note = small
            .omitted
            .iter()
            .find(|note| note.name == part)
            .unwrap_or_else(|| panic!("{part} is not listed as left out"));
        assert!(note.why.contains(why), "{part}: {}", note.why);
    }

    // The same scene with nothing spared, and the hall, which needs everything.
    let whole = [
        (
            "sphere?triangles=20000",
            Tuning {
                specialized: false,
                ..tuning
            },
        ),
        ("near", tuning),
    ];
    for (query, tuning) in reach.of(1, whole.into_iter().rev()) {
        let (all, ..) = explained(query, tuning).expect("there was an adapter");
        let (passes, buffers) = names(&all);
        for pass in [
            "clip",
            "dispatch_args",
            "tile_large",
            "raster_medium depth",
            "raster_large triangle id",
        ] {
            assert!(passes.contains(&pass), "{query}: no {pass} in {passes:?}");
        }
        for buffer in ["queues", "args", "clipped_triangles"] {
            assert!(
                buffers.contains(&buffer),
                "{query}: no {buffer} in {buffers:?}"
            );
        }
    }

    let (listed, ..) = explained(
        "sphere?triangles=20000",
        Tuning {
            listed_tiles: true,
            ..tuning
        },
    )
    .expect("there was an adapter");
    let (passes, buffers) = names(&listed);
    assert!(
        passes.contains(&"list_tiles")
            && buffers.contains(&"tile_mask")
            && buffers.contains(&"args")
            && !buffers.contains(&"queues")
    );
}

#[test]
fn only_a_deformed_scene_has_the_skin_pass_and_only_the_buffers_that_it_needs() {
    let Some(gpu) = gpu() else { return };
    let tuning = gpu.caps.tuning();
    let explained = |query| {
        explained(query, [160, 120], Visibility::Split32, tuning)
            .expect("there is an adapter")
            .0
    };
    let still = explained("teapot?tess=4");
    let (passes, buffers) = names(&still);
    assert!(
        ["deforms", "joints", "morph_targets"]
            .iter()
            .all(|name| ResourceId::of_binding(name).is_some())
    );
    assert!(
        !passes.contains(&"deform")
            && !["deforms", "joints", "morph_targets"]
                .iter()
                .any(|name| buffers.contains(name)),
        "{passes:?} {buffers:?}"
    );
    assert!(
        still.omitted.iter().any(|note| note.name == "deform"
            && note.why.contains("no mesh has joints or morph targets"))
    );
    let bytes = |explanation: &Explanation| {
        explanation
            .buffers
            .iter()
            .find(|buffer| buffer.name == "vertex_bytes")
            .map_or(0, |b| b.bytes)
    };
    assert!(
        bytes(&still) < scene("teapot?tess=4").vertex_bytes.len() as u64 + 16,
        "a rigid mesh has no room for bent vertices"
    );

    // At rest its shape has no weight, so nothing is mixed.
    let deformed = explained("tentacle?tess=2");
    let (passes, buffers) = names(&deformed);
    assert_eq!(passes[..2], ["deform", "project"]);
    assert!(
        buffers.contains(&"deforms")
            && buffers.contains(&"joints")
            && !buffers.contains(&"morph_targets"),
        "{buffers:?}"
    );
    assert!(
        deformed
            .reasons
            .iter()
            .any(|note| note.name == "skinning" && note.why.starts_with("linear: "))
    );
}

fn only_a_stack_with_dots_has_their_passes_and_only_their_way_s_buffers(reach: Reach) {
    let Some(gpu) = gpu() else { return };
    let (scene, dots) = (scene("teapot?tess=4"), stack(&["dots"]));
    let view = view(&scene, [160, 120]);
    let explained = |stack: &Stack, way: DotCulling| {
        let mut renderer = Renderer::new(gpu.clone());
        renderer.captured(&scene, &view, stack, &request(PinnedOptions::of(way)));
        renderer.explain()
    };
    let bare = explained(&stack(&["lambert"]), DotCulling::Gpu);
    let (passes, buffers) = names(&bare);
    assert!(
        passes
            .iter()
            .chain(&buffers)
            .all(|name| !name.contains("dot")),
        "{passes:?} {buffers:?}"
    );
    assert!(
        bare.omitted
            .iter()
            .any(|note| note.name == "dots" && note.why.contains("no effect draws dots"))
    );
    assert!(
        bare.reasons
            .iter()
            .all(|note| !["dots", "dot_culling"].contains(&note.name.as_str()))
    );
    let ways: [(DotCulling, &[&str], &[&str]); 3] = [
        (
            DotCulling::Brute,
            &["dots_ends", "dots_draw"],
            &["dot_ends", "dot_frame", "dot_runs", "dot_segments"],
        ),
        (
            DotCulling::Cpu,
            &["dots_ends", "dots_draw"],
            &[
                "dot_count",
                "dot_ends",
                "dot_frame",
                "dot_list",
                "dot_runs",
                "dot_segments",
            ],
        ),
        (
            DotCulling::Gpu,
            &["dots_ends", "dots_cull", "dots_args", "dots_draw"],
            &[
                "dot_args",
                "dot_count",
                "dot_ends",
                "dot_frame",
                "dot_list",
                "dot_runs",
                "dot_segments",
            ],
        ),
    ];
    for (way, its_passes, its_buffers) in reach.of(1, ways.into_iter().rev()) {
        let all = explained(&dots, way);
        let (passes, buffers) = names(&all);
        assert_eq!(
            passes
                .iter()
                .filter(|name| name.contains("dot"))
                .copied()
                .collect::<Vec<_>>(),
            its_passes,
            "{}",
            way.name()
        );
        assert_eq!(
            buffers
                .iter()
                .filter(|name| name.contains("dot"))
                .copied()
                .collect::<Vec<_>>(),
            its_buffers,
            "{}",
            way.name()
        );
        assert!(
            all.reasons
                .iter()
                .any(|note| note.name == "dot_culling" && note.why.contains(way.name())),
            "{}",
            way.name()
        );
    }
}

#[test]
fn vertices_and_pixels_take_sixteen_bytes_at_most() {
    let Some(gpu) = gpu() else { return };
    for option in Visibility::EXACT
        .into_iter()
        .filter(|option| option.is_supported(gpu.caps.int64_atomics))
    {
        let (explanation, scene, view) = explained(
            "sphere?triangles=20000",
            [1280, 720],
            option,
            gpu.caps.tuning(),
        )
        .expect("there is an adapter");
        let bytes = |name: &str| {
            explanation
                .buffers
                .iter()
                .find(|buffer| buffer.name == name)
                .map_or(0, |buffer| buffer.bytes)
        };
        let per_vertex = bytes("vertices") as f64 / scene.vertex_count() as f64;
        assert!(
            (12.0..=16.01).contains(&per_vertex),
            "{per_vertex} bytes per projected vertex"
        );
        let picture: u64 = ["depth_keys", "triangle_ids", "depth_and_id", "color"]
            .map(bytes)
            .iter()
            .sum();
        let per_pixel = picture as f64 / view.pixels() as f64;
        assert!(
            (12.0..=16.0).contains(&per_pixel),
            "{per_pixel} bytes per pixel on {}",
            option.name()
        );
        assert!(
            explanation
                .buffers
                .iter()
                .all(|buffer| !buffer.why.is_empty())
                && explanation.passes.iter().all(|pass| !pass.why.is_empty())
        );
    }
}

fn a_known_key_compiles_nothing(reach: Reach) {
    // Renderers on one device share their pipelines.
    let Some(gpu) = own_gpu() else { return };
    let mut renderer = Renderer::new(gpu);
    let scenes = [scene("teapot?tess=4"), scene("near"), scene("cube-wall")];
    let stacks = [
        stack(&[]),
        stack(&["lambert"]),
        stack(&["facet", "normals"]),
    ];
    let round = |renderer: &mut Renderer| {
        for scene in &scenes {
            for stack in &stacks {
                for option in reach.options(renderer) {
                    renderer.captured(scene, &view(scene, [64, 48]), stack, &pinned(option));
                }
            }
        }
        renderer.compiled()
    };
    let first = round(&mut renderer);
    assert!(first > 0);
    assert_eq!(round(&mut renderer), first, "pipelines were compiled again");

    // A slider touches bytes alone; another size, too.
    let mut turned = stack(&["lambert"]);
    let effect = turned.get_mut("lambert").expect("just enabled");
    let field = effect
        .effect
        .field("headlight")
        .expect("lambert has a headlight");
    field
        .set(&mut effect.words, &[0.5])
        .expect("within its range");
    renderer.captured(&scenes[0], &view(&scenes[0], [64, 48]), &turned, &split32());
    renderer.captured(&scenes[0], &view(&scenes[0], [80, 61]), &turned, &split32());
    assert_eq!(
        renderer.compiled(),
        first,
        "a slider or a size compiled something"
    );
}

few_and_all!(
    only_a_stack_with_dots_has_their_passes_and_only_their_way_s_buffers,
    a_scene_of_small_triangles_has_no_queues_arguments_or_clipped_triangles,
    the_planned_kernel_and_the_one_that_leaves_nothing_out_draw_the_same_scenes,
    the_planned_kernel_and_the_one_that_leaves_nothing_out_draw_the_same_effects,
    an_effect_that_is_switched_off_again_leaves_no_pass_and_no_buffer,
    a_known_key_compiles_nothing,
);
