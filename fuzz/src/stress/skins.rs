//! Skins and morph targets beside meshes that stay as they are.

use std::sync::Arc;

use glam::DVec3;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check},
    context::CaseContext,
    culling::{camera_anywhere, compare_culled},
    drawing::{pinned, stack},
};
use crate::{
    accuracy::{PinnedOptions, Skinning},
    plan::AccuracyRequest,
    preset::{ClipPlayback, Clock, Preset},
    scene::{
        Accessor, Instance, Scene,
        deformation::{Deformation, MorphTarget},
        pose,
        rig::{LocalTransform, Node, Trs},
    },
};

pub const CASES: &[Case] = &[
    Case {
        number: 30,
        name: "skins-beside-other-meshes",
        about: "a skin, morph targets alone and meshes that stay as they are, in turn, also with NaN and infinities: each mesh follows what moves it",
        expectation: Expectation::Exact,
        run: skins_beside_other_meshes,
    },
    Case {
        number: 30,
        name: "culled-skins",
        about: "the same meshes from 48 cameras in 48 moments: culling goes by where a mesh bends, not by where it was",
        expectation: Expectation::Exact,
        run: culled_skins,
    },
];

/// Five meshes that can deform, beside one another: one follows joints, two follow morph targets,
/// of which some move positions or normals alone, and two, the first among them, follow neither in
/// this picture.
fn mixed_company(tentacle: &Scene) -> Scene {
    let mut scene = tentacle.clone();
    let mut boneless = scene.primitives[0].clone();
    boneless.deformation = Deformation {
        influences: Vec::new(),
        joint_bounds: Vec::new(),
        ..boneless.deformation
    };
    let whole = boneless.deformation.morph_targets[0];
    boneless.deformation.morph_targets.extend([
        MorphTarget {
            normals: None,
            ..whole
        },
        MorphTarget {
            positions: None,
            ..whole
        },
    ]);
    scene.primitives.push(boneless);
    for (place, weights) in [
        (-2.0, [0.0; 3]),
        (-1.0, [1.5, 0.25, -0.5]),
        (1.0, [0.0; 3]),
        (2.0, [-0.75, -0.125, 1.0]),
    ] {
        let rest = Trs {
            translation: DVec3::X * place,
            ..Trs::default()
        };
        let node = scene.rig.nodes.len();
        scene.rig.nodes.push(Node {
            name: String::new(),
            parent: None,
            rest: LocalTransform::Trs(rest),
            weights: weights.to_vec(),
        });
        let rest = LocalTransform::Trs(rest).matrix();
        scene.instances.push(Instance {
            node: Some(node),
            ..Instance::fixed(1, rest)
        });
    }
    // The skin comes third: a mesh that stays lies before and behind it.
    scene.instances.rotate_left(1);
    scene.instances.swap(4, 2);
    scene.rig.motion_bounds = pose::motion_bounds(&scene);
    scene
}

/// Writes values into a component of every seventh vertex, beginning with `first`.
fn spoil(scene: &mut Scene, accessor: &Accessor, first: u32) {
    let values = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        -f32::NAN,
        1e-40,
    ];
    for (i, vertex) in (first..accessor.count).step_by(7).enumerate() {
        let at = (accessor.offset + vertex * accessor.stride) as usize + 4 * (i % 3);
        scene.vertex_bytes[at..at + 4].copy_from_slice(&values[i / 3 % values.len()].to_le_bytes());
    }
}

fn skins_beside_other_meshes(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let sound = mixed_company(&*context.scene("tentacle?tess=3&joints=5")?);
    let mut spoiled = sound.clone();
    let primitive = sound.primitives[0].clone();
    let target = &primitive.deformation.morph_targets[0];
    for (first, accessor) in [
        (0, Some(primitive.positions)),
        (2, Some(primitive.normals)),
        (4, target.positions),
        (5, target.normals),
    ] {
        if let Some(accessor) = accessor {
            spoil(&mut spoiled, &accessor, first);
        }
    }
    for skinning in Skinning::ALL {
        for (what, scene) in [("sound", &sound), ("with NaN and infinities", &spoiled)] {
            let what = format!("{what}, {} skinning", skinning.name());
            let preset = Preset {
                playback: ClipPlayback {
                    clip: "Curl".into(),
                    ..ClipPlayback::default()
                },
                clock: Clock {
                    time_s: 1.25,
                    ..Clock::default()
                },
                accuracy: AccuracyRequest {
                    pins: PinnedOptions::of(*skinning),
                    ..AccuracyRequest::default()
                },
                ..Preset::of_sphere(scene, [160, 96])
            };
            let (scene, view) = (Arc::new(scene.clone()), preset.view(scene, [160, 96]));
            let accuracy = pinned(context.quick_option());
            for effects in [&["normals"][..], &["wobble", "lambert"]] {
                let what = format!("{what}, {}", effects.join(" and "));
                let (capture, verdict) =
                    context.exact(&scene, &view, &stack(effects), &accuracy, &what)?;
                check!(
                    capture.frame.covered() > 800,
                    "{what}: {} pixels",
                    capture.frame.covered()
                );
                let bent = 3 * u64::from(primitive.vertex_count());
                check!(
                    verdict.report.deformed_vertices == bent,
                    "{what}: {} of {bent} vertices bend",
                    verdict.report.deformed_vertices
                );
            }
        }
    }
    Ok(())
}

fn culled_skins(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut rng = context.rng(0x5c1);
    let scene = Arc::new(mixed_company(&*context.scene("tentacle?tess=3&joints=5")?));
    let (mut covered, mut culled) = (0, 0);
    for step in 0..if context.is_slow() { 12 } else { 48 } {
        let preset = Preset {
            playback: ClipPlayback {
                clip: "Curl".into(),
                ..ClipPlayback::default()
            },
            clock: Clock {
                time_s: 0.05 * f64::from(step),
                ..Clock::default()
            },
            camera: Some(camera_anywhere(&scene, &mut rng, step as usize)),
            ..Preset::default()
        };
        let view = preset.view(&scene, [64, 48]);
        let left_out = compare_culled(context, &scene, &view, &format!("{:?}", preset.camera))?;
        covered += left_out.covered;
        culled += left_out.outside + left_out.backfacing;
    }
    check!(
        covered > 3_000 && culled > 200,
        "{covered} pixels are covered, and {culled} meshlets were left out"
    );
    Ok(())
}
