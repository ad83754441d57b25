//! Promise: skins, clips and morph targets arrive exactly; malformed ones are left out with a
//! message.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec3;
use rasterlab::scene::{
    Scene,
    pose::{Motion, Pose},
};
use serde_json::json;

use super::model::*;

/// A skin of two joints over the square; `tilt` moves the second one away from where it was bound.
pub fn skinned(tilt: f64) -> Model {
    let mut model = Model::square();
    let moved = |x: f32| {
        [
            1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, 0.0, 0.0, 1.0,
        ]
    };
    let inverse = model.floats("MAT4", &[moved(-1.0), moved(-2.0)].concat());
    let joints = model.accessor(&[0, 1, 0, 0].repeat(4), U8, "VEC4", 4);
    let weights = model.floats(
        "VEC4",
        &[
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 2.0, 0.0, 0.0],
            [0.5, 0.5, 0.0, 0.0],
            [1.0, 0.0, 0.0, 0.0],
        ]
        .concat(),
    );
    model
        .with(
            "/skins",
            json!([{ "inverseBindMatrices": inverse, "joints": [1, 2] }]),
        )
        .with(
            "/nodes",
            json!([
                { "mesh": 0, "skin": 0, "translation": [100, 100, 100] },
                { "translation": [4, 0, 0], "children": [2] }, { "translation": [1.0, 0, tilt] },
            ]),
        )
        .with("/scenes/0/nodes", json!([0, 1]))
        .with("/meshes/0/primitives/0/attributes/JOINTS_0", json!(joints))
        .with(
            "/meshes/0/primitives/0/attributes/WEIGHTS_0",
            json!(weights),
        )
}

#[test]
fn a_skin_at_rest_places_its_mesh_by_the_joints_alone() {
    let scene = skinned(0.0).scene();
    assert_eq!(
        posed(&scene, None, 0.0)[0],
        [[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 1.0, 0.0]]
    );
    assert_eq!(scene.primitives.len(), 1, "the file's bytes are drawn");
    assert_eq!(
        (scene.bounds().min, scene.bounds().max),
        (DVec3::new(3.0, 0.0, 0.0), DVec3::new(4.0, 1.0, 0.0))
    );
}

#[test]
fn a_skin_away_from_its_bind_pose_deforms_its_mesh() {
    let scene = skinned(8.0).scene();
    assert_eq!(
        posed(&scene, None, 0.0)[0],
        [[3.0, 0.0, 0.0], [4.0, 0.0, 8.0], [4.0, 1.0, 4.0]],
        "weights are normalized, and blend"
    );
    assert!(
        scene
            .notes
            .iter()
            .any(|note| note.contains("1 vertices have weights that do not sum to 1")),
        "{:?}",
        scene.notes
    );
}

#[test]
fn a_vertex_without_weight_is_held_by_its_first_joint_and_said_to_be() {
    let mut model = skinned(8.0);
    let joints = model.accessor(&[1, 0, 0, 0].repeat(4), U8, "VEC4", 4);
    let weights = model.floats("VEC4", &[0.0; 16]);
    let model = model
        .with("/meshes/0/primitives/0/attributes/JOINTS_0", json!(joints))
        .with(
            "/meshes/0/primitives/0/attributes/WEIGHTS_0",
            json!(weights),
        );
    let scene = model.scene();
    assert_eq!(posed(&scene, None, 0.0)[0][0], [3.0, 0.0, 8.0]);
    assert!(
        scene.notes.iter().any(|note| note
            .contains("4 vertices have only weights of 0; they follow their first joint")),
        "{:?}",
        scene.notes
    );
}

#[test]
fn eight_joints_hold_a_vertex_in_any_width() {
    let narrow = skinned(8.0);
    let mut wide = narrow.clone();
    let joints = wide.shorts("VEC4", &[0; 16]);
    let more = wide.accessor(&[1; 16], U8, "VEC4", 4);
    let weights = wide.shorts("VEC4", &[13_107, 0, 0, 0].repeat(4));
    let others = wide.accessor(&[51, 51, 51, 51].repeat(4), U8, "VEC4", 4);
    for accessor in [weights, others] {
        wide.json["accessors"][accessor]["normalized"] = json!(true);
    }
    let set = |model: Model, name: &str, accessor: usize| {
        model.with(
            &format!("/meshes/0/primitives/0/attributes/{name}"),
            json!(accessor),
        )
    };
    let wide = set(
        set(
            set(set(wide, "JOINTS_0", joints), "WEIGHTS_0", weights),
            "JOINTS_1",
            more,
        ),
        "WEIGHTS_1",
        others,
    );
    let scene = wide.scene();
    assert_eq!(scene.primitives[0].deformation.influences.len(), 2);
    // A fifth of the first joint, four fifths of the second.
    let [_, _, z] = posed(&scene, None, 0.0)[0][0];
    assert!((z - 0.8 * 8.0).abs() < 1e-12, "{z}");
    wide.without("/meshes/0/primitives/0/attributes/WEIGHTS_1")
        .dropped("lacks JOINTS_1 or WEIGHTS_1");
}

/// A square under a node that a clip named "Move" moves: keys at 1 and 3 s.
fn clip(path: &str, interpolation: &str, kind: &str, values: &[f32]) -> Model {
    let mut model = Model::square();
    let input = model.floats("SCALAR", &[1.0, 3.0]);
    let output = model.floats(kind, values);
    model.with("/nodes", json!([{ "children": [1], "translation": [10, 0, 0] }, { "mesh": 0, "name": "Part" }])).with(
        "/animations",
        json!([{
            "name": "Move", "channels": [{ "sampler": 0, "target": { "node": 1, "path": path } }],
            "samplers": [{ "input": input, "output": output, "interpolation": interpolation }],
        }]),
    )
}

#[test]
fn clips_move_nodes_and_all_that_hangs_on_them() {
    let values = [0.0, 0.0, 0.0, 0.0, 4.0, 8.0];
    let scene = clip("translation", "LINEAR", "VEC3", &values).scene();
    assert_eq!(
        (
            scene.rig.clips[0].name.as_str(),
            scene.rig.clips[0].duration_s
        ),
        ("Move", 3.0)
    );
    let corner = |scene: &Scene, time_s: f64| posed(scene, scene.rig.clip("Move"), time_s)[0][0];
    assert_eq!(
        [0.0, 1.5, 3.0].map(|t| corner(&scene, t)),
        [[10.0, 0.0, 0.0], [10.0, 1.0, 2.0], [10.0, 4.0, 8.0]]
    );
    assert_eq!(
        corner(&scene, 4.5),
        corner(&scene, 1.5),
        "a clip goes round"
    );
    assert_eq!(
        posed(&scene, None, 2.0),
        triangles(&scene),
        "at rest the file's placements hold"
    );
    let step = clip("translation", "STEP", "VEC3", &values).scene();
    assert_eq!(corner(&step, 2.9), [10.0, 0.0, 0.0]);
    let tangents = [
        [9.0; 3],
        [0.0; 3],
        [0.0, 2.0, 0.0],
        [0.0, -2.0, 0.0],
        [0.0, 4.0, 8.0],
        [9.0; 3],
    ]
    .concat();
    let cubic = clip("translation", "CUBICSPLINE", "VEC3", &tangents).scene();
    // Half way of a cubic Hermite curve over 2 s: (a + b) / 2 + 2 (out - in) / 8.
    assert_eq!(corner(&cubic, 2.0), [10.0, 3.0, 4.0]);
}

#[test]
fn rotations_are_slerped_and_taken_by_their_direction() {
    let root = FRAC_1_SQRT_2 as f32;
    let scene = clip(
        "rotation",
        "LINEAR",
        "VEC4",
        &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0 * root, 2.0 * root],
    )
    .scene();
    assert!(
        scene.notes.iter().any(
            |note| note == "1 rotation keyframes are not unit quaternions; they are normalized"
        )
    );
    // A third of a quarter turn about z takes (1, 0, 0) to (cos 30°, sin 30°, 0).
    let [x, y, _] = posed(&scene, Some(0), 1.0 + 2.0 / 3.0)[0][1];
    assert!(
        (x - 10.0 - 0.75f64.sqrt()).abs() < 1e-7 && (y - 0.5).abs() < 1e-7,
        "{x} {y}"
    );
}

#[test]
fn clips_blend_joint_by_joint() {
    let mut model = clip(
        "translation",
        "LINEAR",
        "VEC3",
        &[0.0, 0.0, 0.0, 0.0, 0.0, 8.0],
    );
    let mut second = model.json["animations"][0].clone();
    second["name"] = json!("Still");
    second["samplers"][0]["output"] = json!(model.floats("VEC3", &[0.0, 2.0, 0.0, 0.0, 2.0, 0.0]));
    model.push("animations", second);
    let scene = model.scene();
    let pose = Pose::at(
        &scene,
        &Motion {
            clip: Some(0),
            other: Some(1),
            blend: 0.25,
            time_s: 2.0,
            ..Motion::default()
        },
    );
    assert_eq!(
        pose.instance_transform(0).w_axis.truncate(),
        DVec3::new(10.0, 0.5, 3.0)
    );
}

/// A square with two morph targets, the second sparse, and weights for them.
pub fn morphed() -> Model {
    let mut model = Model::square();
    let first = model.floats("VEC3", &[[0.0, 0.0, 1.0]; 4].concat());
    let turned = model.floats("VEC3", &[[1.0, 0.0, 0.0]; 4].concat());
    let (at, values) = (model.view(&[2]), model.view(&le_floats(&[0.0, 5.0, 0.0])));
    let second = model.push(
        "accessors",
        json!({ "componentType": F32, "type": "VEC3", "count": 4, "min": [0, 0, 0], "max": [0, 5, 0],
            "sparse": { "count": 1, "indices": { "bufferView": at, "componentType": U8 }, "values": { "bufferView": values } } }),
    );
    model
        .with(
            "/meshes/0/primitives/0/targets",
            json!([{ "POSITION": first, "NORMAL": turned }, { "POSITION": second }]),
        )
        .with("/meshes/0/weights", json!([0.5, 1.0]))
}

#[test]
fn morph_targets_are_mixed_by_the_weights_of_node_mesh_and_clip() {
    let scene = morphed().scene();
    assert_eq!(
        posed(&scene, None, 0.0)[0],
        [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, 6.0, 0.5]]
    );
    assert_eq!(
        posed(
            &morphed()
                .with("/nodes/0/weights", json!([0.0, 0.0]))
                .scene(),
            None,
            0.0
        ),
        square()
    );
    let mut moving = morphed();
    let input = moving.floats("SCALAR", &[0.0, 2.0]);
    let output = moving.floats("SCALAR", &[0.0, 0.0, 1.0, -1.0]);
    let moving = moving.with(
        "/animations",
        json!([{ "channels": [{ "sampler": 0, "target": { "node": 0, "path": "weights" } }], "samplers": [{ "input": input, "output": output }] }]),
    );
    let scene = moving.scene();
    assert_eq!(scene.rig.clips[0].name, "clip 0");
    assert_eq!(
        posed(&scene, Some(0), 1.0)[0],
        [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, -1.5, 0.5]]
    );
    moving
        .clone()
        .with("/animations/0/channels/0/target/node", json!(0))
        .with("/accessors/6/count", json!(3))
        .dropped(
            "clip 0 channel 0: weights of node 0: output: has 3 elements; its keyframes need 4",
        );
    moving
        .without("/meshes/0/primitives/0/targets")
        .without("/meshes/0/weights")
        .dropped("the node has no mesh with morph targets");
}

#[test]
fn skins_must_fit_their_meshes() {
    let place = "mesh \"X\" primitive 0: ";
    skinned(0.0)
        .with("/skins/0/joints", json!([1]))
        .dropped(&format!(
            "{place}JOINTS_0: vertex 0 refers to joint 1, but the skin has 1 joints"
        ));
    skinned(0.0)
        .with("/skins/0/joints", json!([1, 2, 1]))
        .dropped("skin 0: inverseBindMatrices: it has 2 matrices for 3 joints");
    let many = skinned(0.0)
        .with("/skins/0/joints", json!(vec![1; 1_484]))
        .without("/skins/0/inverseBindMatrices")
        .scene();
    assert_eq!(
        (many.rig.skins[0].joints.len(), many.instances[0].skin),
        (1_484, Some(0))
    );
    skinned(0.0)
        .with("/skins/0/joints", json!([]))
        .dropped("skin 0: it has no joints; what it should move is drawn without it");
    skinned(0.0)
        .with("/accessors/2/type", json!("VEC4"))
        .dropped("inverseBindMatrices: must be MAT4 of FLOAT");
    skinned(0.0)
        .with("/accessors/3/componentType", json!(5120))
        .dropped(&format!("{place}JOINTS_0: must be VEC4"));
    skinned(0.0)
        .with("/accessors/4/count", json!(3))
        .dropped(&format!(
            "{place}WEIGHTS_0: has 3 elements, but the primitive has 4 vertices"
        ));
    skinned(0.0)
        .without("/meshes/0/primitives/0/attributes/WEIGHTS_0")
        .dropped("lacks JOINTS_0 or WEIGHTS_0");
    let mut flat = skinned(0.0);
    let inverse = flat.floats("MAT4", &[f32::NAN; 32]);
    flat.with("/skins/0/inverseBindMatrices", json!(inverse))
        .dropped("skin 0: inverseBindMatrices: matrix 0 must be finite");
    let mut negative = skinned(0.0);
    let weights = negative.floats("VEC4", &[-1.0; 16]);
    negative
        .with(
            "/meshes/0/primitives/0/attributes/WEIGHTS_0",
            json!(weights),
        )
        .dropped("WEIGHTS_0: vertex 0 has the weight -1");
}

fn keys(values: [f32; 2], output: &[f32]) -> Model {
    let mut model = clip("translation", "LINEAR", "VEC3", output);
    let input = model.floats("SCALAR", &values);
    model.with("/animations/0/samplers/0/input", json!(input))
}

const CHANNEL: &str = "clip \"Move\" channel 0: translation of node \"Part\": ";

#[test]
fn key_values_that_are_not_finite_are_refused() {
    for bad in [f32::NAN, f32::INFINITY] {
        keys([1.0, 3.0], &[0.0, 0.0, 0.0, 0.0, bad, 0.0])
            .dropped(&format!("{CHANNEL}output: keyframe 1 has the value {bad}"));
    }
    clip("rotation", "LINEAR", "VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
        .dropped("clip \"Move\" channel 0: keyframe 1 is a quaternion of length 0e0; it is read as no rotation");
}

#[test]
fn key_times_that_do_not_rise_are_refused() {
    let jump = keys([1.0, 1.0], &[0.0, 0.0, 0.0, 5.0, 0.0, 0.0]).dropped(
        "clip \"Move\" channel 0: keyframe 1 has the same time as the one before, 1 s; times must increase, and the value jumps there",
    );
    assert_eq!(posed(&jump, Some(0), 0.5)[0][0], [10.0, 0.0, 0.0]);
    assert_eq!(posed(&jump, Some(0), 1.0)[0][0], [15.0, 0.0, 0.0]);
    keys([2.0, 1.0], &[0.0; 6]).dropped(&format!(
        "{CHANNEL}input: keyframe 1 at 1 s follows 2 s; times must increase"
    ));
    keys([-1.0, 1.0], &[0.0; 6]).dropped(&format!("{CHANNEL}input: keyframe 0 has the time -1 s"));
    keys([f32::NAN, 1.0], &[0.0; 6])
        .dropped(&format!("{CHANNEL}input: keyframe 0 has the time NaN s"));
    keys([1.0, f32::INFINITY], &[0.0; 6])
        .dropped(&format!("{CHANNEL}input: keyframe 1 has the time inf s"));
}

#[test]
fn channels_must_fit_their_nodes_and_their_keys() {
    keys([1.0, 3.0], &[0.0; 9]).dropped(&format!(
        "{CHANNEL}output: has 3 elements; its keyframes need 2"
    ));
    clip("translation", "CUBICSPLINE", "VEC3", &[0.0; 6]).dropped(&format!(
        "{CHANNEL}output: has 2 elements; its keyframes need 6"
    ));
    clip("translation", "LINEAR", "VEC4", &[0.0; 8]).dropped(&format!(
        "{CHANNEL}output: has a type that glTF does not allow for this property"
    ));
    let good = clip("translation", "LINEAR", "VEC3", &[0.0; 6]);
    good.clone()
        .with("/animations/0/samplers/0/input", json!(0))
        .dropped(&format!("{CHANNEL}input: must be SCALAR of FLOAT"));
    let moved = keys([1.0, 3.0], &[4.0; 6])
        .with(
            "/nodes/1/matrix",
            json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 7, 1]),
        )
        .dropped("node \"Part\": it has a matrix, and a clip animates it");
    assert_eq!(posed(&moved, Some(0), 2.0)[0][0], [14.0, 4.0, 4.0]);
    good.clone()
        .with("/nodes/1/matrix", json!([1, 0, 0, 0, 3, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]))
        .dropped(&format!("{CHANNEL}the node has a matrix with shear; only a node with translation, rotation and scale can be animated"));
    let twice = json!([{ "sampler": 0, "target": { "node": 1, "path": "translation" } }, { "sampler": 0, "target": { "node": 1, "path": "translation" } }]);
    good.clone().with("/animations/0/channels", twice).dropped(
        "clip \"Move\" channel 1: another channel already animates the translation of its node",
    );
    good.with("/animations/0/channels/0/target/node", json!(7))
        .dropped("clip \"Move\" channel 0: its node is 7, but there are only 2 nodes");
}

#[test]
fn morph_targets_must_fit_their_mesh() {
    let place = "mesh \"X\" primitive 0 target 0 POSITION: ";
    morphed()
        .with("/accessors/2/count", json!(3))
        .dropped(&format!(
            "{place}accessor 2 has 3 elements, but the primitive has 4 vertices"
        ));
    morphed()
        .with("/accessors/2/componentType", json!(U32))
        .dropped(&format!("{place}accessor 2 has the type"));
    morphed()
        .with("/meshes/0/weights", json!([1.0]))
        .dropped("node 0: it has 1 weights for 2 morph targets");
    let mut nan = morphed();
    let bad = nan.floats("VEC3", &[f32::NAN; 12]);
    nan.with("/meshes/0/primitives/0/targets/0/POSITION", json!(bad))
        .dropped(&format!("{place}vertex 0 has a value that is not finite"));
    let mut uneven = morphed();
    uneven.primitive(json!({ "attributes": { "POSITION": 0 }, "indices": 1 }));
    uneven.dropped("node 0: the primitives of its mesh have 0 and 2 morph targets");
    let many = morphed().with(
        "/meshes/0/primitives/0/targets",
        json!(vec![json!({ "POSITION": 2 }); 257]),
    );
    let scene = many.without("/meshes/0/weights").scene();
    assert_eq!(scene.primitives[0].deformation.morph_targets.len(), 257);
}
