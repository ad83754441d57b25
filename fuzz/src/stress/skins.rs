//! Skins of untrusted files: unusual ones are drawn, invalid ones are refused with a message.

use std::sync::Arc;

use glam::DVec3;
use serde_json::json;

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, same},
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
        gltf, pose,
        rig::{LocalTransform, Node, Trs},
    },
};

pub const CASES: &[Case] = &[
    Case {
        number: 30,
        name: "unusual-skins",
        about: "weights of 0, weights that do not sum to 1, and tiny weights",
        expectation: Expectation::Bounded(
            "finite vertices and an exact picture, or a message of the loader",
        ),
        run: unusual_skins,
    },
    Case {
        number: 30,
        name: "rotations-of-any-length",
        about: "rotations of length 3, 10^-3 and 10^18 are normalized, with a note",
        expectation: Expectation::Exact,
        run: rotations_of_any_length,
    },
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

struct Skin {
    joints: [u8; 4],
    weights: [f32; 4],
    /// Rotation of the second joint.
    rotation: [f64; 4],
}

const SOUND: Skin = Skin {
    joints: [0, 1, 0, 0],
    weights: [0.5, 0.5, 0.0, 0.0],
    rotation: [0.0, 0.0, 0.0, 1.0],
};

/// Four triangles around a vertex, with two joints.
fn model(skin: &Skin) -> Result<crate::scene::Scene, gltf::LoadError> {
    let positions: [[f32; 3]; 5] = [
        [-1.0, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
        [0.0, 0.0, 0.5],
    ];
    let indices = [[0u16, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    let mut bytes: Vec<u8> = positions
        .iter()
        .flatten()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    // Only the vertex in the center differs.
    bytes.extend((0..5).flat_map(|i| if i == 4 { skin.joints } else { SOUND.joints }));
    bytes.extend(
        (0..5)
            .flat_map(|i| if i == 4 { skin.weights } else { SOUND.weights })
            .flat_map(f32::to_le_bytes),
    );
    bytes.extend(indices.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [
            { "mesh": 0, "skin": 0 },
            { "children": [2] },
            { "rotation": skin.rotation, "translation": [0.0, 0.1, 0.0] }
        ],
        "skins": [{ "joints": [1, 2] }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2 }, "indices": 3 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3", "min": [-1.0, -1.0, 0.0], "max": [1.0, 1.0, 0.5] },
            { "bufferView": 1, "componentType": 5121, "count": 5, "type": "VEC4" },
            { "bufferView": 2, "componentType": 5126, "count": 5, "type": "VEC4" },
            { "bufferView": 3, "componentType": 5123, "count": 12, "type": "SCALAR" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 60 },
            { "buffer": 0, "byteOffset": 60, "byteLength": 20 },
            { "buffer": 0, "byteOffset": 80, "byteLength": 80 },
            { "buffer": 0, "byteOffset": 160, "byteLength": 24 }
        ],
        "buffers": [{ "uri": "skin.bin", "byteLength": 184 }]
    });
    gltf::load(document.to_string().as_bytes(), &mut |_, _| {
        Ok(bytes.clone())
    })
}

fn unusual_skins(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let skins = [
        ("a sound skin", SOUND),
        (
            "weights of zero",
            Skin {
                weights: [0.0; 4],
                ..SOUND
            },
        ),
        (
            "weights of the sum 3",
            Skin {
                weights: [2.0, 1.0, 0.0, 0.0],
                ..SOUND
            },
        ),
        (
            "weights of 1e-30",
            Skin {
                weights: [1e-30, 1e-30, 0.0, 0.0],
                ..SOUND
            },
        ),
    ];
    for (i, (what, skin)) in skins.into_iter().enumerate() {
        match model(&skin) {
            Ok(scene) => {
                let bounds = scene.bounds();
                check!(
                    bounds.min.is_finite() && bounds.max.is_finite(),
                    "{what}: vertices of {bounds:?}"
                );
                let view = context.view(&scene, [64, 48]);
                let capture = context.exact_on_all_with(
                    &Arc::new(scene),
                    &view,
                    &stack(&["lambert"]),
                    what,
                )?;
                check!(
                    capture.frame.covered() > 300,
                    "{what}: {} pixels",
                    capture.frame.covered()
                );
            }
            Err(error) => {
                check!(i > 0, "{what} is refused: {error}");
                context.note(format!("{what}: {error}"));
            }
        }
    }
    Ok(())
}

/// A quaternion of any length rotates as its unit quaternion does, and the loader reports that it
/// normalized it.
fn rotations_of_any_length(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let turned = |length: f64| Skin {
        rotation: [0.0, 0.0, half * length, half * length],
        ..SOUND
    };
    let taken = |length: f64| {
        model(&turned(length))
            .map_err(|error| EarlyEnd::Failed(format!("a rotation of length {length}: {error}")))
    };
    let sound = taken(1.0)?;
    let view = context.view(&sound, [64, 48]);
    let says = |scene: &crate::scene::Scene| {
        scene
            .notes
            .iter()
            .any(|note| note.contains("rotation") && note.contains("normalized"))
    };
    check!(
        !says(&sound),
        "a unit quaternion is reported: {:?}",
        sound.notes
    );
    let reference = context.exact_on_all_with(
        &Arc::new(sound),
        &view,
        &stack(&["lambert"]),
        "a rotation of length 1",
    )?;
    for length in [3.0, 1e-3, 1e18] {
        let what = format!("a rotation of length {length:e}");
        let scene = taken(length)?;
        check!(
            says(&scene),
            "{what} is accepted without a note: {:?}",
            scene.notes
        );
        let capture =
            context.exact_on_all_with(&Arc::new(scene), &view, &stack(&["lambert"]), &what)?;
        same(&capture, &reference, &what)?;
    }
    Ok(())
}

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
