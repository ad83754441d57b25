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
/// Accessors 2 to 4 hold inverse matrices, joints and weights.
pub fn skinned(tilt: f64) -> Model {
    let model = Model::square().set(
        r#"
        & MAT4 F32 1 0*4 1 0*4 1 0 -1 0*2 1 1 0*4 1 0*4 1 0 -2 0*2 1
        & VEC4 U8 0 1 0 0 0 1 0 0 0 1 0 0 0 1 0 0
        & VEC4 F32 1 0*3 0 2 0*2 0.5*2 0*2 1 0*3
        /skins [{"inverseBindMatrices":2,"joints":[1,2]}]
        /nodes [{"mesh":0,"skin":0,"translation":[100,100,100]},{"translation":[4,0,0],"children":[2]},{}]
        /scenes/0/nodes [0,1]
        A/JOINTS_0 3
        A/WEIGHTS_0 4
        "#,
    );
    model.with("/nodes/2/translation", json!([1.0, 0, tilt]))
}

#[test]
fn a_skin_at_rest_places_its_mesh_by_the_joints_alone() {
    let scene = skinned(0.0).scene();
    assert_eq!(
        posed(&scene, None, 0.0)[0],
        [[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 1.0, 0.0]]
    );
    assert_eq!(scene.primitives.len(), 1, "the file's bytes are drawn");
    let bounds = (DVec3::new(3.0, 0.0, 0.0), DVec3::new(4.0, 1.0, 0.0));
    assert_eq!((scene.bounds().min, scene.bounds().max), bounds);
}

#[test]
fn a_skin_away_from_its_bind_pose_deforms_its_mesh() {
    let scene = skinned(8.0).scene();
    let wanted = [[3.0, 0.0, 0.0], [4.0, 0.0, 8.0], [4.0, 1.0, 4.0]];
    assert_eq!(
        posed(&scene, None, 0.0)[0],
        wanted,
        "weights are normalized, and blend"
    );
    assert_noted(&scene, "1 vertices have weights that do not sum to 1");
    // A vertex without weight is held by its first joint, and said to be.
    let scene = skinned(8.0)
        .set("& VEC4 U8 1 0*3 1 0*3 1 0*3 1 0*3\n& VEC4 F32 0*16\nA/JOINTS_0 5\nA/WEIGHTS_0 6")
        .scene();
    assert_eq!(posed(&scene, None, 0.0)[0][0], [3.0, 0.0, 8.0]);
    assert_noted(
        &scene,
        "4 vertices have only weights of 0; they follow their first joint",
    );
}

#[test]
fn eight_joints_hold_a_vertex_in_any_width() {
    let wide = skinned(8.0).set(
        r"
        & VEC4 U16 0*16
        & VEC4 U8 1*16
        & VEC4 U16 13107 0*3 13107 0*3 13107 0*3 13107 0*3
        & VEC4 U8 51*16
        /accessors/7/normalized true
        /accessors/8/normalized true
        A/JOINTS_0 5
        A/JOINTS_1 6
        A/WEIGHTS_0 7
        A/WEIGHTS_1 8
        ",
    );
    let scene = wide.scene();
    assert_eq!(scene.primitives[0].deformation.influences.len(), 2);
    // A fifth of the first joint, four fifths of the second.
    let [_, _, z] = posed(&scene, None, 0.0)[0][0];
    assert!((z - 0.8 * 8.0).abs() < 1e-12, "{z}");
    wide.play("- A/WEIGHTS_1\n~ lacks JOINTS_1 or WEIGHTS_1");
}

/// A square under a node "Part" that a clip named "Move" moves: accessor 2 holds the times of its
/// keys, accessor 3 their values.
fn keys(times: &str, path: &str, interpolation: &str, values: &str) -> Model {
    let model = Model::square().set(&format!("& SCALAR F32 {times}\n& {values}"));
    let sampler = json!({ "input": 2, "output": 3, "interpolation": interpolation });
    model
        .set(r#"/nodes [{"children":[1],"translation":[10,0,0]},{"mesh":0,"name":"Part"}]"#)
        .animated(json!({ "node": 1, "path": path }), sampler)
}

pub fn clip(path: &str, interpolation: &str, values: &str) -> Model {
    keys("1 3", path, interpolation, values)
}

#[test]
fn clips_move_nodes_and_all_that_hangs_on_them() {
    let values = "VEC3 F32 0*4 4 8";
    let scene = clip("translation", "LINEAR", values).scene();
    let read = &scene.rig.clips[0];
    assert_eq!((read.name.as_str(), read.duration_s), ("Move", 3.0));
    let corner = |scene: &Scene, time_s: f64| posed(scene, scene.rig.clip("Move"), time_s)[0][0];
    let corners = [0.0, 1.5, 3.0].map(|t| corner(&scene, t));
    assert_eq!(
        corners,
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
    let step = clip("translation", "STEP", values).scene();
    assert_eq!(corner(&step, 2.9), [10.0, 0.0, 0.0]);
    let cubic = clip(
        "translation",
        "CUBICSPLINE",
        "VEC3 F32 9*3 0*4 2 0*2 -2 0*2 4 8 9*3",
    )
    .scene();
    // Half way of a cubic Hermite curve over 2 s: (a + b) / 2 + 2 (out - in) / 8.
    assert_eq!(corner(&cubic, 2.0), [10.0, 3.0, 4.0]);
}

#[test]
fn rotations_are_slerped_and_taken_by_their_direction() {
    let twice = 2.0 * FRAC_1_SQRT_2 as f32;
    let scene = clip(
        "rotation",
        "LINEAR",
        &format!("VEC4 F32 0*3 1 0*2 {twice}*2"),
    )
    .scene();
    assert_noted(
        &scene,
        "1 rotation keyframes are not unit quaternions; they are normalized",
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
    let mut model = clip("translation", "LINEAR", "VEC3 F32 0*5 8").set("& VEC3 F32 0 2 0 0 2 0");
    let mut second = model.json["animations"][0].clone();
    second["samplers"][0]["output"] = json!(4);
    model.push("animations", second);
    let scene = model.scene();
    let motion = Motion {
        clip: Some(0),
        other: Some(1),
        blend: 0.25,
        time_s: 2.0,
        ..Motion::default()
    };
    let place = Pose::at(&scene, &motion)
        .instance_transform(0)
        .w_axis
        .truncate();
    assert_eq!(place, DVec3::new(10.0, 0.5, 3.0));
}

/// A square with two morph targets, the second sparse, and weights for them.
pub fn morphed() -> Model {
    let mut model = Model::square()
        .set("& VEC3 F32 0*2 1 0*2 1 0*2 1 0*2 1\n& VEC3 F32 1 0*2 1 0*2 1 0*2 1 0*2");
    let (at, values) = (model.view(&[2]), model.view(&le_floats(&[0.0, 5.0, 0.0])));
    model.push(
        "accessors",
        json!({ "componentType": F32, "type": "VEC3", "count": 4, "min": [0, 0, 0], "max": [0, 5, 0], "sparse": sparse(1, at, values) }),
    );
    model.set(
        r#"
        P/targets [{"POSITION":2,"NORMAL":3},{"POSITION":4}]
        /meshes/0/weights [0.5,1.0]
        "#,
    )
}

#[test]
fn morph_targets_are_mixed_by_the_weights_of_node_mesh_and_clip() {
    let at_rest = |model: &Model| posed(&model.scene(), None, 0.0);
    assert_eq!(
        at_rest(&morphed())[0],
        [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, 6.0, 0.5]]
    );
    assert_eq!(
        at_rest(&morphed().set("/nodes/0/weights [0.0,0.0]")),
        square()
    );
    let moving = morphed()
        .set("& SCALAR F32 0 2\n& SCALAR F32 0 0 1 -1")
        .animated(
            json!({ "node": 0, "path": "weights" }),
            json!({ "input": 5, "output": 6 }),
        )
        .set("- /animations/0/name");
    let scene = moving.scene();
    assert_eq!(scene.rig.clips[0].name, "clip 0");
    assert_eq!(
        posed(&scene, Some(0), 1.0)[0],
        [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, -1.5, 0.5]]
    );
    moving.play(
        r"
        /accessors/6/count 3
        ~ clip 0 channel 0: weights of node 0: output: has 3 elements; its keyframes need 4
        - P/targets
        - /meshes/0/weights
        ~ the node has no mesh with morph targets
        ",
    );
}

#[test]
fn skins_must_fit_their_meshes() {
    let many = skinned(0.0).with("/skins/0/joints", vec![1; 1_484]);
    let many = many.without("/skins/0/inverseBindMatrices").scene();
    assert_eq!(
        (many.rig.skins[0].joints.len(), many.instances[0].skin),
        (1_484, Some(0))
    );
}

#[test]
fn keys_and_channels_that_do_not_fit_are_left_out() {
    let channel = "~ clip \"Move\" channel 0: translation of node \"Part\": ";
    for (times, values, sentence) in [
        (
            "1 3",
            "VEC3 F32 0*4 nan 0",
            "output: keyframe 1 has the value NaN",
        ),
        (
            "1 3",
            "VEC3 F32 0*4 inf 0",
            "output: keyframe 1 has the value inf",
        ),
        (
            "2 1",
            "VEC3 F32 0*6",
            "input: keyframe 1 at 1 s follows 2 s; times must increase",
        ),
        (
            "-1 1",
            "VEC3 F32 0*6",
            "input: keyframe 0 has the time -1 s",
        ),
        (
            "nan 1",
            "VEC3 F32 0*6",
            "input: keyframe 0 has the time NaN s",
        ),
        (
            "1 inf",
            "VEC3 F32 0*6",
            "input: keyframe 1 has the time inf s",
        ),
        (
            "1 3",
            "VEC3 F32 0*9",
            "output: has 3 elements; its keyframes need 2",
        ),
        (
            "1 3",
            "VEC4 F32 0*8",
            "output: has a type that glTF does not allow for this property",
        ),
    ] {
        keys(times, "translation", "LINEAR", values).play(&format!("{channel}{sentence}"));
    }
    let cubic = clip("translation", "CUBICSPLINE", "VEC3 F32 0*6");
    cubic.play(&format!(
        "{channel}output: has 2 elements; its keyframes need 6"
    ));
    let turned = clip("rotation", "LINEAR", "VEC4 F32 0*3 1 0*4");
    turned.play("~ clip \"Move\" channel 0: keyframe 1 is a quaternion of length 0e0; it is read as no rotation");
    let jump = keys("1 1", "translation", "LINEAR", "VEC3 F32 0*3 5 0*2").dropped(
        "clip \"Move\" channel 0: keyframe 1 has the same time as the one before, 1 s; times must increase, and the value jumps there",
    );
    assert_eq!(
        [0.5, 1.0].map(|time_s| posed(&jump, Some(0), time_s)[0][0][0]),
        [10.0, 15.0]
    );
    let moved = clip("translation", "LINEAR", "VEC3 F32 4*6")
        .set("/nodes/1/matrix [1,0,0,0,0,1,0,0,0,0,1,0,0,0,7,1]")
        .dropped("node \"Part\": it has a matrix, and a clip animates it");
    assert_eq!(posed(&moved, Some(0), 2.0)[0][0], [14.0, 4.0, 4.0]);
}

#[test]
fn morph_targets_must_fit_their_mesh() {
    let mut uneven = morphed();
    uneven.primitive(json!({ "attributes": { "POSITION": 0 }, "indices": 1 }));
    uneven.dropped("node 0: the primitives of its mesh have 0 and 2 morph targets");
    let many = morphed().with("P/targets", vec![json!({ "POSITION": 2 }); 257]);
    let scene = many.without("/meshes/0/weights").scene();
    assert_eq!(scene.primitives[0].deformation.morph_targets.len(), 257);
}
