//! Promise: an effect with a scope changes the parts that it names and no others, on every hook, in
//! the picture, in its shadows and in every layer, as the oracle says; several instances of one
//! effect act on parts of their own. Needs an adapter.

use std::sync::Arc;

use rasterlab::{
    accuracy::Parameters,
    effects::{Effect, Stack},
    frame::NO_TRIANGLE,
    gpu::{Capture, Renderer},
    plan::AccuracyRequest,
    preset::{ClipPlayback, Clock, PinnedOptions, Preset},
    scene::{
        Scene,
        parts::{PartPattern, Scope, scope_masks},
        view::View,
    },
};

use crate::common::*;

fn scope(patterns: &[&str]) -> Scope {
    Scope::new(patterns.iter().map(|text| {
        text.parse::<PartPattern>()
            .unwrap_or_else(|error| panic!("{error}"))
    }))
}

fn enable(stack: &mut Stack, effect: &Arc<Effect>, patterns: &[&str], fields: &[(&str, f64)]) {
    let enabled = stack.enable(effect);
    enabled.on = scope(patterns);
    for (name, value) in fields {
        let field = effect
            .field(name)
            .unwrap_or_else(|| panic!("no field {}.{name}", effect.name));
        field
            .set(
                &mut enabled.words,
                &vec![*value; field.value_type.components()],
            )
            .unwrap_or_else(|error| panic!("{error}"));
    }
}

fn effect(name: &str) -> &'static Arc<Effect> {
    Effect::find(name).unwrap_or_else(|| panic!("no effect {name}"))
}

/// A stack of one effect on some parts, under diffuse light.
fn only(name: &str, patterns: &[&str], fields: &[(&str, f64)]) -> Stack {
    let mut stack = Stack::default();
    enable(&mut stack, effect("lambert"), &[], &[]);
    enable(&mut stack, effect(name), patterns, fields);
    stack
}

const OTHERS: [&str; 3] = ["material:coral", "node:cube 1?", "node:cube 7*"];

/// For every pixel: does it show a part of the scope?
fn inside(scene: &Scene, patterns: &[&str], capture: &Capture) -> Vec<Option<bool>> {
    let masks = scope_masks(scene, &[scope(patterns)]);
    let mut of_triangle = Vec::new();
    for (instance, mask) in scene.instances.iter().zip(&masks) {
        of_triangle.resize(
            of_triangle.len() + scene.primitives[instance.primitive].triangle_count() as usize,
            *mask == 1,
        );
    }
    capture
        .frame
        .triangle_id
        .iter()
        .map(|&id| (id != NO_TRIANGLE).then(|| of_triangle[id as usize]))
        .collect()
}

fn wall() -> (Arc<Scene>, View) {
    let scene = scene("cube-wall");
    let view = view(&scene, [160, 120]);
    (scene, view)
}

fn drawn(
    renderer: &mut Renderer,
    (scene, view): &(Arc<Scene>, View),
    stack: &Stack,
    accuracy: &AccuracyRequest,
) -> Capture {
    renderer
        .exact(scene, view, stack, accuracy, &format!("{stack:?}"))
        .0
}

fn a_surface_effect_colors_its_parts_as_if_it_were_everywhere_and_leaves_all_others_as_they_were(
    reach: Reach,
) {
    let Some(mut renderer) = loan() else { return };
    let picture = wall();
    for visibility in reach.options(&renderer) {
        let accuracy = request(PinnedOptions::of(visibility));
        let mut draw = |stack: &Stack| drawn(&mut renderer, &picture, stack, &accuracy);
        let (none, all) = (
            draw(&only("lambert", &[], &[])),
            draw(&only("toon", &[], &[])),
        );
        for patterns in [
            &OTHERS[..],
            &["mesh:*"],
            &["mesh:nothing"],
            &["material:amber", "material:teal"],
        ] {
            let some = draw(&only("toon", patterns, &[]));
            let inside = inside(&picture.0, patterns, &some);
            let expected = |pixel: usize| {
                if inside[pixel] == Some(true) {
                    all.frame.color[pixel]
                } else {
                    none.frame.color[pixel]
                }
            };
            let wrong = (0..inside.len())
                .filter(|&pixel| some.frame.color[pixel] != expected(pixel))
                .count();
            assert_eq!(wrong, 0, "{} {patterns:?}", visibility.name());
            let counts = [true, false]
                .map(|side| inside.iter().filter(|pixel| **pixel == Some(side)).count());
            let has_both = !patterns[0].starts_with("mesh");
            assert!(
                !has_both || counts.iter().all(|&count| count > 500),
                "{counts:?}"
            );
        }
        assert_ne!(none.frame.color, all.frame.color);
    }
}

fn a_sample_effect_leaves_out_samples_of_its_parts_alone(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let picture = wall();
    for (name, fields) in [
        ("stipple", &[("opacity", 0.3)][..]),
        ("dissolve", &[("fill", 0.4)]),
        ("wireframe", &[("hidden", 0.0)]),
    ] {
        for visibility in reach.options(&renderer) {
            let accuracy = request(PinnedOptions::of(visibility));
            let mut draw = |stack: &Stack| drawn(&mut renderer, &picture, stack, &accuracy);
            let (none, all, some) = (
                draw(&only("lambert", &[], &[])),
                draw(&only(name, &[], fields)),
                draw(&only(name, &OTHERS, fields)),
            );
            let (before, after) = (
                inside(&picture.0, &OTHERS, &none),
                inside(&picture.0, &OTHERS, &some),
            );
            let ids = |capture: &Capture| capture.frame.triangle_id.clone();
            // What is in front and outside the scope stays.
            let kept = (0..before.len()).filter(|&pixel| before[pixel] == Some(false));
            assert!(
                kept.into_iter()
                    .all(|pixel| ids(&some)[pixel] == ids(&none)[pixel]),
                "{name}"
            );
            let covered = |inside: &[Option<bool>]| {
                inside.iter().filter(|pixel| **pixel == Some(true)).count()
            };
            assert!(
                covered(&after) < covered(&before) * 4 / 5,
                "{name}: {} of {}",
                covered(&after),
                covered(&before)
            );
            assert_ne!(ids(&some), ids(&all), "{name}");
        }
    }
}

fn a_vertex_effect_moves_its_parts_and_their_shadows_alone(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let picture = wall();
    for (name, fields) in reach.of(
        1,
        [
            ("inflate", &[("amount_m", 0.1)][..]),
            ("wobble", &[]),
            ("explode", &[("amount_m", 0.6)]),
        ],
    ) {
        let mut draw = |stack: &Stack| drawn(&mut renderer, &picture, stack, &unpinned());
        let with_shadow = |patterns: &[&str]| {
            let mut stack = only(name, patterns, fields);
            enable(&mut stack, effect("shadow"), &[], &[]);
            stack
        };
        let (none, all, some) = (
            draw(&with_shadow(&["mesh:nothing"])),
            draw(&with_shadow(&[])),
            draw(&with_shadow(&OTHERS)),
        );
        assert_ne!(some.frame.triangle_id, all.frame.triangle_id, "{name}");
        assert_ne!(some.frame.triangle_id, none.frame.triangle_id, "{name}");
        let map = |capture: &Capture| {
            capture
                .geometry
                .shadow_map
                .as_ref()
                .expect("a light")
                .depth_keys
                .clone()
        };
        assert!(
            map(&some) != map(&all) && map(&some) != map(&none),
            "{name}: shadows"
        );
        // Records of vertices outside the scope keep their bits.
        let unmoved = scope_masks(&picture.0, &[scope(&OTHERS)]);
        let per_instance = some.geometry.vertices.len() / picture.0.instances.len();
        for (instance, mask) in unmoved.iter().enumerate() {
            let records = instance * per_instance..(instance + 1) * per_instance;
            assert_eq!(
                some.geometry.vertices[records.clone()] == none.geometry.vertices[records],
                *mask == 0,
                "{name} on instance {instance}"
            );
        }
    }
}

#[test]
fn instances_of_one_effect_act_on_parts_of_their_own() {
    let Some(mut renderer) = loan() else { return };
    let picture = wall();
    let [skin, coat] =
        ["skin", "coat"].map(|name| Arc::new(Effect::instance(name, effect("toon"))));
    let mut stack = only("fog", &["material:ink", "material:chalk"], &[]);
    enable(&mut stack, &skin, &["material:amber"], &[("steps", 2.0)]);
    enable(
        &mut stack,
        &coat,
        &["material:coral", "material:amber"],
        &[("steps", 4.0)],
    );
    let mut swapped = stack.clone();
    let [a, b] = [2, 3].map(|index| stack.0[index].on.clone());
    (swapped.0[2].on, swapped.0[3].on) = (b, a);
    let baked = request(PinnedOptions::of(Parameters::Baked));
    let first = drawn(&mut renderer, &picture, &stack, &unpinned());
    let second = drawn(&mut renderer, &picture, &swapped, &unpinned());
    // The scopes of the stack change while the view and the kernel stay.
    assert_ne!(first.frame.color, second.frame.color);
    assert_eq!(
        drawn(&mut renderer, &picture, &stack, &baked).frame.color,
        first.frame.color
    );
}

#[test]
fn layers_are_shaded_with_the_scope_of_their_own_draw() {
    let Some(mut renderer) = loan() else { return };
    let picture = wall();
    let stack = |patterns: &[&str]| {
        let mut stack = only("toon", patterns, &[]);
        enable(&mut stack, effect("xray"), &[], &[]);
        stack
    };
    let mut draw = |patterns: &[&str]| {
        drawn(&mut renderer, &picture, &stack(patterns), &unpinned())
            .frame
            .color
    };
    let [some, all, none] = [&OTHERS[..], &[], &["mesh:nothing"]].map(&mut draw);
    assert!(some != all && some != none && all != none);
}

fn skinned_animals_in_a_room_are_told_apart(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = Arc::new((*scene("walker?tess=1&instances=3")).clone().in_room(1.2));
    let preset = Preset {
        playback: ClipPlayback {
            clip: "Walk".into(),
            ..ClipPlayback::default()
        },
        clock: Clock {
            time_s: 0.3,
            ..Clock::default()
        },
        ..Preset::default()
    };
    let view = preset.view(&scene, [160, 120]);
    let mut stack = only("hatch", &["node:room"], &[]);
    enable(
        &mut stack,
        effect("explode"),
        &["node:walker 1"],
        &[("amount_m", 0.1)],
    );
    enable(&mut stack, effect("toon"), &["node:walker ?"], &[]);
    enable(
        &mut stack,
        effect("dissolve"),
        &["node:walker 2"],
        &[("fill", 0.6)],
    );
    enable(&mut stack, effect("shadow"), &[], &[]);
    for visibility in reach.options(&renderer) {
        let accuracy = request(PinnedOptions::of(visibility));
        renderer.exact(&scene, &view, &stack, &accuracy, visibility.name());
    }
}

#[test]
fn clipped_triangles_and_a_single_draw_know_their_scopes() {
    let Some(mut renderer) = loan() else { return };
    // Rings and walls across the near plane and the guard band; one draw, whose record is a
    // uniform.
    for query in ["near", "sphere?triangles=200", "panels"] {
        let scene = scene(query);
        let view = view(&scene, [96, 72]);
        let name = scene.materials[scene.primitives[0].material].name.clone();
        for patterns in [
            &[format!("material:{name}")][..],
            &["mesh:nothing".to_owned()],
        ] {
            let patterns: Vec<&str> = patterns.iter().map(String::as_str).collect();
            let mut stack = only("stipple", &patterns, &[("opacity", 0.5)]);
            enable(&mut stack, effect("wobble"), &patterns, &[]);
            enable(&mut stack, effect("fog"), &patterns, &[]);
            renderer.exact(
                &scene,
                &view,
                &stack,
                &unpinned(),
                &format!("{query} on {patterns:?}"),
            );
        }
    }
}

/// What the kernels take for the draw of a surface, a sample or a corner is its own draw.
#[test]
fn the_scope_of_another_draw_is_found() {
    let Some(gpu) = gpu() else { return };
    let (scene, view) = wall();
    let mistakes = [
        (
            "shade_surface(pixel), shaded.draw).color",
            "shade_surface(pixel), 0u).color",
            only("toon", &OTHERS, &[]),
        ),
        (
            "vec4u()), t.draw,",
            "vec4u()), 0u,",
            only("stipple", &OTHERS, &[("opacity", 0.3)]),
        ),
    ];
    for (from, to, stack) in mistakes {
        let shaders = mutated(from, to);
        let mut renderer = Renderer::with_library(gpu.clone(), shaders.shaders());
        let (_, verdict) = renderer.judged(&scene, &view, &stack, &unpinned());
        assert!(
            exactness(&verdict.report).is_err(),
            "{from} became {to}, and nothing was found"
        );
    }
}

few_and_all!(
    a_surface_effect_colors_its_parts_as_if_it_were_everywhere_and_leaves_all_others_as_they_were,
    a_sample_effect_leaves_out_samples_of_its_parts_alone,
    a_vertex_effect_moves_its_parts_and_their_shadows_alone,
    skinned_animals_in_a_room_are_told_apart,
);
