//! Promise: skins, morph targets and clips deform meshes as in glTF and the oracle, with both
//! options of skinning, and mistakes in the pass are found. The second half needs an adapter.

use std::sync::Arc;

use glam::{DMat4, DQuat, DVec3};
use rasterlab::{
    accuracy::{Skinning, Visibility},
    effects::Stack,
    gpu::Renderer,
    math::rounded_columns,
    measure::Budget,
    oracle,
    preset::{ClipPlayback, Clock, MissingInScene, PinnedOptions, Preset},
    scene::{
        Accessor, ComponentType, Scene,
        draw::draws,
        pose::{Deform, Motion, Pose},
        rig::{LocalTransform, Node, Trs},
        view::View,
    },
};

use crate::common::*;

/// The default view of a scene at a time of one or two clips.
fn moment(
    scene: &Scene,
    clips: [&str; 2],
    time_s: f64,
    skinning: Skinning,
    size: [u32; 2],
) -> View {
    let [clip, other] = clips.map(str::to_owned);
    let blend = if other.is_empty() { 0.0 } else { 0.5 };
    Preset {
        playback: ClipPlayback {
            clip,
            second_clip: other,
            blend,
            ..ClipPlayback::default()
        },
        clock: Clock {
            time_s,
            ..Clock::default()
        },
        accuracy: request(PinnedOptions::of(skinning)),
        ..Preset::default()
    }
    .view(scene, size)
}

/// Every vertex of all draws as the oracle deforms it, rounded to f32: position and normal.
fn deformed(scene: &Scene, view: &View) -> Vec<[f32; 6]> {
    oracle::project(&oracle::Shot::new(
        scene,
        &draws(scene, view).expect("a builtin fits"),
        view,
        &Stack::default(),
    ))
    .expect("nobody cancels it")
    .deformed
}

fn place(deformed: &[f32; 6]) -> DVec3 {
    DVec3::new(deformed[0].into(), deformed[1].into(), deformed[2].into())
}

fn normal(deformed: &[f32; 6]) -> DVec3 {
    DVec3::new(deformed[3].into(), deformed[4].into(), deformed[5].into())
}

// -------- the oracle alone

#[test]
fn a_skeleton_that_stands_as_it_was_bound_leaves_every_bit() {
    // Of nine joints, all positions are sums of quarters, so that no matrix rounds.
    for influences in [1, 4, 8] {
        let scene = scene(&format!("tentacle?joints=9&tess=3&influences={influences}"));
        for skinning in Skinning::ALL {
            let view = moment(&scene, ["", ""], 0.0, *skinning, [64, 64]);
            for (vertex, deformed) in deformed(&scene, &view).iter().enumerate() {
                let stored = scene.primitives[0].position(&scene, vertex as u32);
                assert_eq!(deformed[..3], stored, "{} {vertex}", skinning.name());
            }
        }
    }
}

/// The scene with all its nodes below a new root node with the transform `place`.
fn carried(scene: &Scene, place: DMat4) -> Scene {
    let mut scene = scene.clone();
    for node in &mut scene.rig.nodes {
        node.parent = Some(node.parent.map_or(0, |parent| parent + 1));
    }
    scene.rig.nodes.insert(
        0,
        Node {
            name: "carrier".into(),
            parent: None,
            rest: LocalTransform::Matrix(place),
            weights: Vec::new(),
        },
    );
    scene
        .rig
        .skins
        .iter_mut()
        .flat_map(|skin| &mut skin.joints)
        .for_each(|joint| *joint += 1);
    scene
        .rig
        .clips
        .iter_mut()
        .flat_map(|clip| &mut clip.channels)
        .for_each(|channel| channel.node += 1);
    scene
        .instances
        .iter_mut()
        .for_each(|instance| instance.node = instance.node.map(|node| node + 1));
    scene
}

#[test]
fn joints_that_all_move_alike_move_the_mesh_as_a_whole() {
    let still = scene("tentacle?tess=3");
    let rigid = DMat4::from_rotation_translation(
        DQuat::from_axis_angle(DVec3::new(2.0, -1.0, 2.0) / 3.0, 1.9),
        DVec3::new(3.0, -4.0, 5.0),
    );
    let moved = carried(&still, rigid);
    for skinning in Skinning::ALL {
        // At rest, and deformed as far as possible.
        for clips in [["", ""], ["Curl", "Breathe"]] {
            let [a, b] = [&*still, &moved]
                .map(|scene| deformed(scene, &moment(scene, clips, 1.5, *skinning, [64, 64])));
            for (a, b) in a.iter().zip(&b) {
                // Matrices and both vertices are rounded to f32, at some 8 m from the origin.
                assert!(
                    rigid.transform_point3(place(a)).distance(place(b)) < 4e-6,
                    "{}: {a:?} {b:?}",
                    skinning.name()
                );
                assert!(
                    rigid.transform_vector3(normal(a)).distance(normal(b)) < 4e-6,
                    "{}: {a:?} {b:?}",
                    skinning.name()
                );
            }
        }
    }
}

#[test]
fn the_order_in_which_joints_are_named_does_not_matter() {
    let scene = scene("tentacle?tess=3&influences=8");
    let mut turned = (*scene).clone();
    for set in scene.primitives[0].deformation.influences.clone() {
        for vertex in 0..set.joints.count {
            let swap = |bytes: &mut [u8], accessor: &Accessor| {
                let size = accessor.component_type.bytes() as usize;
                let at = accessor.offset as usize + vertex as usize * accessor.stride as usize;
                bytes[at..at + 4 * size].rotate_left((1 + vertex as usize % 3) * size);
            };
            swap(&mut turned.vertex_bytes, &set.joints);
            swap(&mut turned.vertex_bytes, &set.weights);
        }
    }
    for skinning in Skinning::ALL {
        let [a, b] = [&*scene, &turned].map(|scene| {
            deformed(
                scene,
                &moment(scene, ["Sway", "Curl"], 1.1, *skinning, [64, 64]),
            )
        });
        let furthest = a
            .iter()
            .zip(&b)
            .map(|(a, b)| place(a).distance(place(b)))
            .fold(0.0, f64::max);
        assert!(furthest < 5e-7, "{}: {furthest}", skinning.name());
    }
}

#[test]
fn dual_quaternions_keep_lengths_under_a_twist_where_the_linear_blend_does_not() {
    let scene = scene("tentacle?joints=6&tess=6");
    let away = |skinning| {
        let view = moment(&scene, ["Twist", ""], 1.0, skinning, [64, 64]);
        let shrunk = |(vertex, deformed): (usize, &[f32; 6])| {
            let [x, y, z] = scene.primitives[0]
                .position(&scene, vertex as u32)
                .map(f64::from);
            // A twist turns every vertex about the axis: its distance from there stays, and its
            // height.
            let lost = x.hypot(z) - place(deformed).x.hypot(place(deformed).z);
            (lost / x.hypot(z).max(1e-3), (place(deformed).y - y).abs())
        };
        let all: Vec<(f64, f64)> = deformed(&scene, &view)
            .iter()
            .enumerate()
            .map(shrunk)
            .collect();
        let largest = |pick: fn(&(f64, f64)) -> f64| all.iter().map(pick).fold(0.0, f64::max);
        (
            largest(|(lost, _)| lost.abs()),
            largest(|(_, risen)| *risen),
        )
    };
    let (dual, linear) = (away(Skinning::Dual), away(Skinning::Linear));
    assert!(dual.0 < 1e-6 && dual.1 < 1e-6, "{dual:?}");
    assert!(linear.0 > 0.1, "{linear:?}");
}

#[test]
fn the_linear_blend_loses_volume_and_dual_quaternions_hardly_any() {
    let scene = scene("tentacle?joints=6&tess=6");
    let volume = |clip, skinning| {
        let view = moment(&scene, [clip, ""], 1.0, skinning, [64, 64]);
        oracle::volume(&scene, &draws(&scene, &view).expect("it fits"))
    };
    let rest = volume("", Skinning::Linear);
    let [linear, dual] =
        [Skinning::Linear, Skinning::Dual].map(|skinning| volume("Twist", skinning) / rest);
    assert!(
        rest > 0.1 && (dual - 1.0).abs() < 0.01 && linear < 0.93,
        "rest {rest} m³, dual {dual}, linear {linear}"
    );
}

#[test]
fn a_deformed_mesh_stays_in_its_box() {
    for query in [
        "tentacle?tess=3",
        "tentacle?tess=2&influences=8&joints=20",
        "tentacle?tess=1&instances=5",
    ] {
        let scene = scene(query);
        for (clip, skinning) in ["Sway", "Curl", "Twist", "Breathe"]
            .into_iter()
            .flat_map(|clip| Skinning::ALL.iter().map(move |s| (clip, *s)))
        {
            for step in 0..7 {
                let view = moment(
                    &scene,
                    [clip, ""],
                    0.6 * f64::from(step),
                    skinning,
                    [64, 64],
                );
                let bounds = view
                    .scene_state
                    .pose
                    .as_ref()
                    .expect("it has a rig")
                    .bounds(&scene);
                for deformed in deformed(&scene, &view) {
                    let p = place(&deformed);
                    assert!(
                        p.cmpge(bounds.min - 1e-6).all() && p.cmple(bounds.max + 1e-6).all(),
                        "{query} {clip} {p} {bounds:?}"
                    );
                }
            }
        }
    }
}

/// [`Deform::position`], which picking uses, agrees with the oracle.
#[test]
fn a_click_lands_on_the_deformed_mesh() {
    let scene = scene("tentacle?tess=4&influences=8");
    let view = moment(&scene, ["Curl", "Breathe"], 1.4, Skinning::Linear, [64, 48]);
    let deform: &Deform = view
        .scene_state
        .pose
        .as_ref()
        .and_then(|pose| pose.deform(0))
        .expect("it bends");
    for (vertex, deformed) in deformed(&scene, &view).iter().enumerate() {
        assert!(
            deform
                .position(&scene, &scene.primitives[0], vertex as u32)
                .distance(place(deformed))
                < 3e-7
        );
    }
    let frame = oracle::render(&scene, &view, &Stack::default()).expect("it fits");
    let covered = frame
        .triangle_id
        .iter()
        .position(|triangle_id| *triangle_id != rasterlab::frame::NO_TRIANGLE)
        .expect("something shows");
    let screen = glam::DVec2::new((covered % 64) as f64 + 0.5, (covered / 64) as f64 + 0.5)
        / glam::DVec2::new(64.0, 48.0);
    assert!(rasterlab::scene::pick::pick(&scene, &view, screen).is_some());
}

#[test]
fn a_preset_names_its_clips_and_an_unknown_clip_lists_those_there_are() {
    let scene = scene("tentacle?tess=1");
    let play = |clip: &str, other: &str| ClipPlayback {
        clip: clip.into(),
        second_clip: other.into(),
        ..ClipPlayback::default()
    };
    assert_eq!(play("Sway", "#2").check(&scene), Ok(()));
    let known = "; it has \"Sway\", \"Curl\", \"Twist\", \"Breathe\"".to_owned();
    assert_eq!(
        play("Sway", "sway").check(&scene),
        Err(MissingInScene {
            key: "scene.second_clip",
            what: "clip",
            name: "sway".into(),
            known
        })
    );
    assert_eq!(
        play("Walk", "")
            .check(&crate::common::scene("teapot?tess=1"))
            .unwrap_err()
            .to_string(),
        "scene.clip: the scene has no clip \"Walk\"; it has no clips"
    );
    let at = |play: ClipPlayback, time_s: f64| Preset {
        playback: play,
        clock: Clock {
            time_s,
            ..Clock::default()
        },
        ..Preset::default()
    };
    let moving = at(play("Sway", ""), 1.0);
    assert!(moving.is_moving() && moving.pose(&scene) != at(play("Sway", ""), 2.0).pose(&scene));
    let held = |time_s| {
        at(
            ClipPlayback {
                clip_time_s: Some(0.5),
                ..play("Sway", "")
            },
            time_s,
        )
    };
    assert!(!held(1.0).is_moving() && held(1.0).pose(&scene) == held(2.0).pose(&scene));
    assert_eq!(
        at(
            ClipPlayback {
                speed: 0.5,
                ..play("Sway", "")
            },
            1.0
        )
        .pose(&scene),
        held(0.0).pose(&scene)
    );
    assert_eq!(
        at(play("Sway", ""), 1.0).pose(&scene),
        at(play("Sway", ""), 4e6 + 1.0).pose(&scene),
        "a clip loops forever"
    );
    assert_eq!(
        Preset::default().pose(&crate::common::scene("teapot?tess=1")),
        None
    );
}

#[test]
fn nodes_that_a_clip_moves_are_placed_again() {
    // A cube wall whose first cube hangs on a node.
    let mut scene = (*scene("cube-wall?columns=2&rows=1")).clone();
    let tower = (*crate::common::scene("tentacle?tess=1&joints=2")).clone();
    scene.rig = tower.rig;
    scene.instances[0].node = Some(1);
    let view = |time_s| {
        let motion = Motion {
            clip: scene.rig.clip("Sway"),
            time_s,
            ..Motion::default()
        };
        let mut view = camera_view(
            &scene,
            &rasterlab::scene::camera::Camera::default(),
            [64, 48],
        );
        view.scene_state.pose = Some(Arc::new(Pose::at(&scene, &motion)));
        view
    };
    let [a, b] = [0.0, 1.0].map(|time_s| draws(&scene, &view(time_s)).expect("it fits"));
    assert_ne!(a[0].world_from_object, b[0].world_from_object);
    assert_eq!(a[1], b[1], "an instance without a node does not move");
    let upper = scene.rig.nodes[0].rest.matrix();
    assert_eq!(
        rounded_columns(&upper),
        rounded_columns(&LocalTransform::Trs(Trs::default()).matrix())
    );
}

// -------- on the adapter

/// Checks every picture of this file.
fn insist(
    renderer: &mut Renderer,
    scene: &Arc<Scene>,
    view: &View,
    stack: &Stack,
    option: Visibility,
    what: &str,
) -> f64 {
    let (_, verdict) = renderer.exact(scene, view, stack, &pinned(option), what);
    let a = &verdict.report;
    assert!(
        a.deformed_vertices > 0 && a.max_deform_px < 0.01 && a.max_deform_ulp < 100.0,
        "{what}: {a:?}"
    );
    a.max_deform_ulp
}

fn every_option_deforms_as_the_oracle_does(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let stack = stack(&["lambert", "depth"]);
    let mut largest: f64 = 0.0;
    for query in reach.of(
        1,
        [
            "tentacle?tess=4",
            "tentacle?tess=3&influences=8&joints=16",
            "tentacle?tess=2&influences=1&instances=7",
        ],
    ) {
        let scene = scene(query);
        for (clips, time_s) in [
            (["", ""], 0.0),
            (["Sway", ""], 0.9),
            (["Curl", "Breathe"], 1.4),
            (["Twist", ""], 1.0),
            (["Breathe", ""], 2.0),
        ] {
            for (skinning, option) in Skinning::ALL
                .iter()
                .zip(reach.options(&renderer).into_iter().cycle())
            {
                let view = moment(&scene, clips, time_s, *skinning, [160, 120]);
                let what = format!("{query} {clips:?} {} {}", skinning.name(), option.name());
                largest = largest.max(insist(&mut renderer, &scene, &view, &stack, option, &what));
            }
        }
    }
    eprintln!("largest error of a bent vertex: {largest} ulp");
}

fn effects_work_on_deformed_meshes(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("tentacle?tess=4");
    for skinning in Skinning::ALL {
        let view = moment(&scene, ["Curl", "Breathe"], 1.3, *skinning, [160, 120]);
        for effects in reach.of(
            1,
            [
                &["explode", "facet"][..],
                &["wobble", "lambert"],
                &["inflate", "normals"],
                &["dissolve", "lambert"],
                &["xray"],
                &["points"],
            ],
        ) {
            let what = format!("{effects:?} {}", skinning.name());
            insist(
                &mut renderer,
                &scene,
                &view,
                &stack(effects),
                Visibility::Split32,
                &what,
            );
        }
    }
}

#[test]
fn a_camera_among_the_joints_is_clipped_like_any() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("tentacle?tess=4&instances=9");
    let camera = rasterlab::scene::camera::Camera {
        eye: DVec3::new(0.1, 0.8, 0.1),
        target: DVec3::new(1.0, 1.0, 0.4),
        near_m: 0.05,
        ..rasterlab::scene::camera::Camera::default()
    };
    let play = ClipPlayback {
        clip: "Sway".into(),
        ..ClipPlayback::default()
    };
    let preset = Preset {
        camera: Some(camera),
        playback: play,
        clock: Clock {
            time_s: 0.7,
            ..Clock::default()
        },
        ..Preset::default()
    };
    let view = preset.view(&scene, [160, 120]);
    let (capture, verdict) =
        renderer.exact(&scene, &view, &stack(&["lambert"]), &split32(), "inside");
    assert!(
        capture.frame.counters.clipped > 0 && verdict.report.deformed_vertices > 0,
        "{:?}",
        capture.frame.counters
    );
}

#[test]
fn a_thousand_skinned_instances_are_exact() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("tentacle?tess=1&instances=1000");
    let view = moment(
        &scene,
        ["Sway", "Breathe"],
        1.7,
        Skinning::Linear,
        [160, 120],
    );
    insist(
        &mut renderer,
        &scene,
        &view,
        &stack(&["lambert"]),
        Visibility::Split32,
        "a thousand",
    );
    let passes = renderer.explain().passes;
    assert_eq!(passes[0].name, "deform", "{passes:?}");
}

/// The tentacle with weights as files have them: some 0, some that do not sum to 1.
fn careless() -> Arc<Scene> {
    let mut scene = (*scene("tentacle?tess=3&influences=8")).clone();
    for set in scene.primitives[0].deformation.influences.clone() {
        for vertex in 0..set.weights.count {
            let at = set.weights.offset as usize + vertex as usize * set.weights.stride as usize;
            let weights: &mut [u8] = &mut scene.vertex_bytes[at..at + 8];
            match vertex % 3 {
                0 => weights.fill(0),
                1 => weights.chunks_exact_mut(2).for_each(|w| w[1] /= 3),
                _ => {}
            }
        }
    }
    Arc::new(scene)
}

#[test]
fn weights_that_are_zero_or_do_not_sum_to_one_are_put_right_alike() {
    let Some(mut renderer) = loan() else { return };
    let scene = careless();
    for skinning in Skinning::ALL {
        let view = moment(&scene, ["Curl", ""], 1.2, *skinning, [160, 120]);
        insist(
            &mut renderer,
            &scene,
            &view,
            &stack(&["lambert"]),
            Visibility::Split32,
            skinning.name(),
        );
    }
}

#[test]
fn quantized_positions_are_drawn_and_deformed_like_any() {
    let Some(mut renderer) = loan() else { return };
    for normalized in [false, true] {
        let mut scene = (*scene("tentacle?tess=3")).clone();
        let primitive = scene.primitives[0].clone();
        let offset = scene.vertex_bytes.len() as u32;
        let one = if normalized { 32_767.0 / 2.5 } else { 2_000.0 };
        for vertex in 0..primitive.vertex_count() {
            let place = primitive
                .position(&scene, vertex)
                .map(|v| (f64::from(v) * one).round() as i16);
            scene
                .vertex_bytes
                .extend(place.iter().chain([&0]).flat_map(|v| v.to_le_bytes()));
        }
        let count = primitive.vertex_count();
        scene.primitives[0].positions = Accessor {
            offset,
            stride: 8,
            component_type: ComponentType::I16,
            components: 3,
            normalized,
            count,
        };
        // Morph targets and joints are in meters: the quantized mesh is rigid and scaled by its
        // instance.
        let scale = if normalized { 2.5 } else { 1.0 / 2_000.0 };
        let mut placed = scene.clone();
        placed.rig = Default::default();
        placed.instances = vec![rasterlab::scene::Instance::fixed(
            0,
            DMat4::from_scale(DVec3::splat(scale)),
        )];
        placed.primitives[0].deformation = Default::default();
        placed.primitives[0].bounds.min *= 1.1 / scale;
        placed.primitives[0].bounds.max *= 1.1 / scale;
        placed.primitives[0].longest_edge *= 1.1 / scale;
        let placed = Arc::new(placed);
        let view = crate::common::view(&placed, [160, 120]);
        renderer.exact(&placed, &view, &stack(&["lambert"]), &split32(), "placed");
        if normalized {
            let scene = Arc::new(scene);
            let view = moment(
                &scene,
                ["Curl", "Breathe"],
                1.2,
                Skinning::Linear,
                [160, 120],
            );
            insist(
                &mut renderer,
                &scene,
                &view,
                &stack(&["lambert"]),
                Visibility::Split32,
                "deformed",
            );
        }
    }
}

fn mistakes_in_the_pass_are_found(reach: Reach) {
    let Some(gpu) = gpu() else { return };
    let stack = stack(&["lambert"]);
    let scene = careless();
    let mutants = [
        (
            "joint off by one",
            "min(u32(pull_component(format, byte))",
            "min(u32(pull_component(format, byte)) + 1u",
        ),
        (
            "only the first four are followed",
            "for (var i = 0u; i < 4u * deforms[deform].sets; i += 1u) {\n        let weight = influence_weight(deform, vertex, i, sum);\n        let row = 3u",
            "for (var i = 0u; i < 4u * min(1u, deforms[deform].sets); i += 1u) {\n        let weight = influence_weight(deform, vertex, i, sum);\n        let row = 3u",
        ),
        (
            "normals left as they were",
            "skinning_normal(skinning, morph_targets_normal(draw, vertex, normal.xyz))",
            "normal.xyz",
        ),
        (
            "a rotation's opposite taken as another",
            "select(weight, -weight,",
            "select(weight, weight,",
        ),
    ];
    for (what, from, to) in reach.of(2, mutants) {
        let mutant = mutated(from, to);
        let mut found = false;
        for (skinning, clips, time_s) in Skinning::ALL
            .iter()
            .flat_map(|s| [(*s, ["Curl", "Breathe"], 1.4), (*s, ["Twist", ""], 1.0)])
        {
            // Of a rotation and its opposite, files have either: half of the joints turn a whole
            // turn more.
            let scene = if what.contains("opposite") {
                crate::common::scene("tentacle?joints=3&tess=3")
            } else {
                scene.clone()
            };
            let view = moment(&scene, clips, time_s, skinning, [120, 90]);
            let mut renderer = Renderer::with_library(gpu.clone(), mutant.shaders());
            let (_, verdict) = renderer.judged(&scene, &view, &stack, &split32());
            let faults = verdict.report.within(&Budget::default());
            found |= faults
                .is_err_and(|faults| faults.contains("deformed vertices lie outside their bound"));
        }
        assert!(found, "{what} was not found");
    }
}

few_and_all!(
    every_option_deforms_as_the_oracle_does,
    effects_work_on_deformed_meshes,
    mistakes_in_the_pass_are_found,
);
