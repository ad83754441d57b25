//! Promise: a node with EXT_mesh_gpu_instancing is drawn as nodes below it would be, one for each
//! instance, and shares their mesh; where the extension is faulty the mesh is drawn once.

use rasterlab::{
    oracle,
    preset::Preset,
    scene::{
        Scene,
        pose::{Motion, Pose},
    },
};
use serde_json::{Value, json};

use super::{model::*, motion::skinned};

const EXTENSION: &str = "EXT_mesh_gpu_instancing";

const PLACES: [[f32; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.5, -0.25, 0.5],
    [-1.0, 2.0, 0.125],
    [0.3, 0.7, -1.9],
];
const TURNS: [[f32; 4]; 4] = [
    [0.0, 0.0, 0.0, 1.0],
    [0.5, 0.5, 0.5, 0.5],
    [0.0, 0.6, 0.0, 0.8],
    [0.1, -0.2, 0.3, 0.9],
];
const SIZES: [[f32; 3]; 4] = [
    [1.0, 1.0, 1.0],
    [2.0, 0.5, 1.0],
    [-1.0, 1.0, 1.0],
    [0.3, 0.7, 1.1],
];

/// The node that is instanced, without the instances.
fn node() -> Value {
    json!({ "mesh": 0, "name": "tree", "translation": [3, 1, -2], "rotation": [0.0, 0.0, 0.6, 0.8], "scale": [1, 2, 0.5] })
}

/// Two primitives, one a triangle of the square, shown by a node with these attributes; accessors 2
/// to 4 hold translations, rotations and scales.
fn instanced(attributes: Value) -> Model {
    let mut model = Model::square();
    model.primitive(json!({ "attributes": { "POSITION": 0 } }));
    model.floats("VEC3", &PLACES.concat());
    model.floats("VEC4", &TURNS.concat());
    model.floats("VEC3", &SIZES.concat());
    let mut node = node();
    node["extensions"] = json!({ EXTENSION: { "attributes": attributes } });
    model
        .with("/nodes", json!([node]))
        .with("/extensionsUsed", json!([EXTENSION]))
        .with("/extensionsRequired", json!([EXTENSION]))
}

fn four() -> Model {
    instanced(json!({ "TRANSLATION": 2, "ROTATION": 3, "SCALE": 4 }))
}

/// The same with a node below the first one for each instance.
fn repeated() -> Model {
    let mut nodes = vec![node()];
    nodes[0]["children"] = json!([1, 2, 3, 4]);
    nodes[0].as_object_mut().unwrap().remove("mesh");
    for ((place, turn), size) in PLACES.iter().zip(TURNS).zip(SIZES) {
        nodes.push(json!({ "mesh": 0, "translation": place, "rotation": turn, "scale": size }));
    }
    instanced(json!({})).with("/nodes", nodes)
}

fn places(scene: &Scene) -> Vec<(usize, [f64; 16])> {
    let instances = scene.instances.iter();
    instances
        .map(|instance| {
            (
                instance.primitive,
                instance.world_from_object.to_cols_array(),
            )
        })
        .collect()
}

#[test]
fn instances_are_drawn_as_nodes_are_and_share_their_mesh() {
    let (scene, nodes) = (four().silent(), repeated().scene());
    assert_eq!(scene.instances.len(), 8);
    assert_eq!(places(&scene), places(&nodes));
    let stored = |scene: &Scene| {
        (
            scene.primitives.clone(),
            scene.vertex_bytes.clone(),
            scene.index_bytes.clone(),
        )
    };
    assert!(stored(&scene) == stored(&nodes), "no vertex is copied");
    let picture = |scene: &Scene| {
        let (preset, size) = (Preset::default(), [48, 32]);
        let (view, stack) = (preset.view(scene, size), preset.stack_on(scene, size));
        let frame = oracle::render(scene, &view, &stack).expect("it is drawn");
        (frame.triangle_id, frame.color)
    };
    let wanted = picture(&nodes);
    assert!(wanted.1.iter().any(|color| *color != wanted.1[0]));
    assert_eq!(picture(&scene), wanted);
}

#[test]
fn each_attribute_may_be_missing_and_rotations_may_be_small_integers() {
    let scene = instanced(json!({ "TRANSLATION": 2 })).scene();
    assert_eq!((scene.instances.len(), scene.faults.len()), (8, 0));
    let node = scene.instances[0].world_from_object;
    for (pair, place) in scene.instances.chunks(2).zip(PLACES) {
        let origin = pair[1].world_from_object.w_axis.truncate();
        let wanted = node.transform_point3(place.map(f64::from).into());
        assert!(origin.abs_diff_eq(wanted, 1e-12), "{origin} {wanted}");
    }
    let exact = instanced(json!({ "ROTATION": 3 })).scene();
    for (kind, largest, most) in [("I8", 127.0, 0.03), ("I16", 32767.0, 1e-4)] {
        let integers = TURNS
            .as_flattened()
            .iter()
            .map(|&v| (f64::from(v) * largest).round().to_string());
        let integers = integers.collect::<Vec<_>>().join(" ");
        let scene = instanced(json!({ "ROTATION": 5, "_ID": 99, "_COLOR_0": 99 }))
            .set(&format!(
                "& VEC4 {kind} {integers}\n/accessors/5/normalized true"
            ))
            .scene();
        for (near, exact) in scene.instances.iter().zip(&exact.instances) {
            let (near, exact) = (near.world_from_object, exact.world_from_object);
            assert!(near.abs_diff_eq(exact, most), "{near} {exact}");
        }
        let note = "node \"tree\" EXT_mesh_gpu_instancing: colors of instances are not drawn";
        assert_eq!(scene.notes, [note]);
    }
}

#[test]
fn faulty_instances_cost_the_extension_and_the_mesh_is_drawn_once() {
    for (changes, sentence) in [
        (
            "& VEC3 F32 nan*12\nX/attributes/TRANSLATION 5",
            "the transform of instance 0 is not finite",
        ),
        (
            "& VEC3 F32 1*9 inf*3\nX/attributes/SCALE 5",
            "the transform of instance 3 is not finite",
        ),
        (
            "& VEC4 F32 0*16\nX/attributes/ROTATION 5",
            "instance 0 has as rotation a quaternion of length 0e0",
        ),
        (
            "& VEC4 F32 nan*16\nX/attributes/ROTATION 5",
            "instance 0 has as rotation a quaternion of length NaN",
        ),
        (
            "& VEC3 F32 0*9\nX/attributes/TRANSLATION 5",
            "TRANSLATION has 3 elements and ROTATION has 4; all must have as many",
        ),
        (
            "& VEC4 F32 1*16\nX/attributes/SCALE 5",
            "SCALE: must be of a type that the extension allows for it",
        ),
        (
            "/accessors/2/componentType 5125",
            "TRANSLATION: must be of a type",
        ),
        (
            "/accessors/2/count 1048576",
            "TRANSLATION: accessor 2: 1048576 elements of 12 bytes from byte 0 exceed bufferView 2",
        ),
        ("/accessors/3/count 0", "ROTATION: accessor 3: count is 0"),
        (
            "X/attributes/SCALE 77",
            "its SCALE is 77, but there are only 5 accessors",
        ),
        (
            "X/attributes {\"_ID\":2}",
            "it has none of the attributes TRANSLATION, ROTATION and SCALE",
        ),
        (
            "X/attributes 3",
            "its attributes is 3; it must be an object",
        ),
        ("X []", "it must be an object"),
    ] {
        let changes = changes.replace('X', "/nodes/0/extensions/EXT_mesh_gpu_instancing");
        let scene = four().set(&changes).dropped(sentence);
        assert_eq!(
            (scene.instances.len(), scene.faults.len()),
            (2, 1),
            "{:?}",
            scene.faults
        );
    }
    let mut limp = skinned(0.0);
    limp.floats("VEC3", &PLACES.concat());
    let limp = limp
        .set(r#"/nodes/0/extensions {"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":5}}}"#);
    limp.left_out("node 0 EXT_mesh_gpu_instancing: joints place its mesh; it is drawn once");
    assert_eq!(limp.scene().instances.len(), 1);
}

#[test]
fn instances_without_bytes_are_limited_before_they_take_memory() {
    let claim = |count: u64| {
        let mut model = instanced(json!({ "SCALE": 5 }));
        model.push(
            "accessors",
            json!({ "componentType": F32, "type": "VEC3", "count": count }),
        );
        model
    };
    assert_eq!(
        claim(131_072).scene().instances.len(),
        262_144,
        "two primitives each"
    );
    for (count, shown) in [(131_073, "262146"), (29_000_000, "58000000")] {
        claim(count).refused(&format!(
            "the nodes show {shown} primitives or more; allowed: at most 262144, because its files have only"
        ));
    }
}

#[test]
fn many_nodes_with_one_faulty_list_are_not_read_for_hours() {
    let model = instanced(json!({ "TRANSLATION": 5 })).set("& VEC3 F32 0*14997 nan 0*2");
    let node = model.json["nodes"][0].clone();
    model
        .with("/nodes", vec![node; 2_000])
        .with("/scenes/0/nodes", (0..2_000).collect::<Vec<_>>())
        .refused("primitives or more; allowed: at most 262144, because its files have only");
}

#[test]
fn a_clip_moves_the_node_of_all_its_instances() {
    let scene = four()
        .set("& SCALAR F32 0 2\n& VEC3 F32 0*3 4 0 8")
        .animated(
            json!({ "node": 0, "path": "translation" }),
            json!({ "input": 5, "output": 6 }),
        )
        .scene();
    let origins = |clip: Option<usize>| {
        let pose = Pose::at(
            &scene,
            &Motion {
                clip,
                time_s: 1.0,
                ..Motion::default()
            },
        );
        [0, 1, 2, 3, 4, 5, 6, 7].map(|index| pose.instance_transform(index).w_axis.truncate())
    };
    let (still, moved) = (origins(None), origins(Some(0)));
    for ((still, moved), instance) in still.into_iter().zip(moved).zip(&scene.instances) {
        assert_eq!(still, instance.world_from_object.w_axis.truncate());
        // From 3 1 -2 to 2 0 4.
        let step = moved - still;
        assert!(step.abs_diff_eq([-1.0, -1.0, 6.0].into(), 1e-12), "{step}");
    }
}
