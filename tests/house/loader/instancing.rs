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
/// Where the extension stands in the models below.
const PLACE: &str = "/nodes/0/extensions/EXT_mesh_gpu_instancing";

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

/// Two primitives, one a triangle of the square, shown by a node with these attributes.
fn instanced(attributes: impl FnOnce(&mut Model) -> Value) -> Model {
    let mut model = Model::square();
    let more = json!({ "attributes": { "POSITION": 0 } });
    model.primitive(more);
    let attributes = attributes(&mut model);
    let mut node = node();
    node["extensions"] = json!({ EXTENSION: { "attributes": attributes } });
    model
        .with("/nodes", json!([node]))
        .with("/extensionsUsed", json!([EXTENSION]))
        .with("/extensionsRequired", json!([EXTENSION]))
}

fn four() -> Model {
    instanced(|model| {
        let (places, turns, sizes) = (
            model.floats("VEC3", &PLACES.concat()),
            model.floats("VEC4", &TURNS.concat()),
            model.floats("VEC3", &SIZES.concat()),
        );
        json!({ "TRANSLATION": places, "ROTATION": turns, "SCALE": sizes })
    })
}

/// The same with a node below the first one for each instance.
fn repeated() -> Model {
    let mut nodes = vec![node()];
    nodes[0]["children"] = json!([1, 2, 3, 4]);
    nodes[0].as_object_mut().unwrap().remove("mesh");
    for ((place, turn), size) in PLACES.iter().zip(TURNS).zip(SIZES) {
        nodes.push(json!({ "mesh": 0, "translation": place, "rotation": turn, "scale": size }));
    }
    instanced(|_| json!({})).with("/nodes", json!(nodes))
}

fn places(scene: &Scene) -> Vec<(usize, [f64; 16])> {
    let place = |instance: &rasterlab::scene::Instance| {
        let transform = instance.world_from_object.to_cols_array();
        (instance.primitive, transform)
    };
    scene.instances.iter().map(place).collect()
}

#[test]
fn instances_are_drawn_as_nodes_are_and_share_their_mesh() {
    let (scene, nodes) = (four().scene(), repeated().scene());
    assert_eq!((&scene.notes, scene.instances.len()), (&Vec::new(), 8));
    assert_eq!(places(&scene), places(&nodes));
    assert_eq!(
        (&scene.primitives, &scene.vertex_bytes, &scene.index_bytes),
        (&nodes.primitives, &nodes.vertex_bytes, &nodes.index_bytes),
        "no vertex is copied"
    );
    let picture = |scene: &Scene| {
        let (preset, size) = (Preset::default(), [48, 32]);
        let (view, stack) = (preset.view(scene, size), preset.stack_on(scene, size));
        oracle::render(scene, &view, &stack).expect("it is drawn")
    };
    let (drawn, wanted) = (picture(&scene), picture(&nodes));
    assert!(wanted.color.iter().any(|color| *color != wanted.color[0]));
    assert_eq!(
        (drawn.triangle_id, drawn.color),
        (wanted.triangle_id, wanted.color)
    );
}

#[test]
fn each_attribute_may_be_missing_and_rotations_may_be_small_integers() {
    let moved = instanced(|model| json!({ "TRANSLATION": model.floats("VEC3", &PLACES.concat()) }));
    let scene = moved.scene();
    assert_eq!((scene.instances.len(), scene.faults.len()), (8, 0));
    let node = scene.instances[0].world_from_object;
    for (pair, place) in scene.instances.chunks(2).zip(PLACES) {
        let origin = pair[1].world_from_object.w_axis.truncate();
        let wanted = node.transform_point3(place.map(f64::from).into());
        assert!(origin.abs_diff_eq(wanted, 1e-12), "{origin} {wanted}");
    }
    let turned = |component: u32, largest: f64| {
        instanced(|model| {
            let integers = TURNS.as_flattened().iter().map(|&v| f64::from(v) * largest);
            let bytes: Vec<u8> = match component {
                I16 => integers
                    .flat_map(|v| (v.round() as i16).to_le_bytes())
                    .collect(),
                _ => integers.map(|v| v.round() as i8 as u8).collect(),
            };
            let turns = model.accessor(&bytes, component, "VEC4", 4);
            model.json["accessors"][turns]["normalized"] = json!(true);
            json!({ "ROTATION": turns, "_ID": 99, "_COLOR_0": 99 })
        })
        .scene()
    };
    let exact = instanced(|model| json!({ "ROTATION": model.floats("VEC4", &TURNS.concat()) }));
    let exact = exact.scene();
    for (component, largest, most) in [(I8, 127.0, 0.03), (I16, 32767.0, 1e-4)] {
        let scene = turned(component, largest);
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
    let with = |name: &str, kind: &str, values: Vec<f32>| {
        let mut model = four();
        let accessor = model.floats(kind, &values);
        model.with(&format!("{PLACE}/attributes/{name}"), json!(accessor))
    };
    let changed = |place: &str, value: Value| four().with(place, value);
    // Accessors 2 to 4 hold translations, rotations and scales.
    for (model, sentence) in [
        (
            with("TRANSLATION", "VEC3", vec![f32::NAN; 12]),
            "the transform of instance 0 is not finite",
        ),
        (
            with(
                "SCALE",
                "VEC3",
                [vec![1.0; 9], vec![f32::INFINITY; 3]].concat(),
            ),
            "the transform of instance 3 is not finite",
        ),
        (
            with("ROTATION", "VEC4", vec![0.0; 16]),
            "instance 0 has as rotation a quaternion of length 0e0",
        ),
        (
            with("ROTATION", "VEC4", vec![f32::NAN; 16]),
            "instance 0 has as rotation a quaternion of length NaN",
        ),
        (
            with("TRANSLATION", "VEC3", vec![0.0; 9]),
            "TRANSLATION has 3 elements and ROTATION has 4; all must have as many",
        ),
        (
            with("SCALE", "VEC4", vec![1.0; 16]),
            "SCALE: must be of a type that the extension allows for it",
        ),
        (
            changed("/accessors/2/componentType", json!(U32)),
            "TRANSLATION: must be of a type",
        ),
        (
            changed("/accessors/2/count", json!(1u64 << 20)),
            "TRANSLATION: accessor 2: 1048576 elements of 12 bytes from byte 0 exceed bufferView 2",
        ),
        (
            changed("/accessors/3/count", json!(0)),
            "ROTATION: accessor 3: count is 0",
        ),
        (
            changed(&format!("{PLACE}/attributes/SCALE"), json!(77)),
            "its SCALE is 77, but there are only 5 accessors",
        ),
        (
            changed(&format!("{PLACE}/attributes"), json!({ "_ID": 2 })),
            "it has none of the attributes TRANSLATION, ROTATION and SCALE",
        ),
        (
            changed(&format!("{PLACE}/attributes"), json!(3)),
            "its attributes is 3; it must be an object",
        ),
        (changed(PLACE, json!([])), "it must be an object"),
    ] {
        let scene = model.dropped(sentence);
        assert_eq!(
            (scene.instances.len(), scene.faults.len()),
            (2, 1),
            "{:?}",
            scene.faults
        );
    }
    let mut limp = skinned(0.0);
    let places = limp.floats("VEC3", &PLACES.concat());
    let limp = limp.with(
        "/nodes/0/extensions",
        json!({ EXTENSION: { "attributes": { "TRANSLATION": places } } }),
    );
    limp.left_out("node 0 EXT_mesh_gpu_instancing: joints place its mesh; it is drawn once");
    assert_eq!(limp.scene().instances.len(), 1);
}

#[test]
fn instances_without_bytes_are_limited_before_they_take_memory() {
    let claim = |count: u64| {
        let model = instanced(|model| {
            let zeros = json!({ "componentType": F32, "type": "VEC3", "count": count });
            json!({ "SCALE": model.push("accessors", zeros) })
        });
        model.load().map(|scene| scene.instances.len())
    };
    assert_eq!(claim(131_072), Ok(262_144), "two primitives each");
    for (count, shown) in [(131_073, "262146"), (29_000_000, "58000000")] {
        let error = claim(count).expect_err("too many").to_string();
        let wanted = format!(
            "the nodes show {shown} primitives or more; allowed: at most 262144, because its files have only"
        );
        assert!(error.contains(&wanted), "{error}");
    }
}

#[test]
fn many_nodes_with_one_faulty_list_are_not_read_for_hours() {
    let mut model = instanced(|model| {
        let mut places = vec![0.0; 3 * 5_000];
        places[3 * 4_999] = f32::NAN;
        json!({ "TRANSLATION": model.floats("VEC3", &places) })
    });
    let node = model.json["nodes"][0].clone();
    model.json["nodes"] = vec![node; 2_000].into();
    model.json["scenes"] = json!([{ "nodes": (0..2_000).collect::<Vec<_>>() }]);
    model.refused("primitives or more; allowed: at most 262144, because its files have only");
}

#[test]
fn a_clip_moves_the_node_of_all_its_instances() {
    let mut model = four();
    let times = model.floats("SCALAR", &[0.0, 2.0]);
    let places = model.floats("VEC3", &[0.0, 0.0, 0.0, 4.0, 0.0, 8.0]);
    let scene = model
        .with(
            "/animations",
            json!([{
                "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
                "samplers": [{ "input": times, "output": places }],
            }]),
        )
        .scene();
    let origins = |clip: Option<usize>| -> Vec<glam::DVec3> {
        let motion = Motion {
            clip,
            time_s: 1.0,
            ..Motion::default()
        };
        let pose = Pose::at(&scene, &motion);
        (0..8)
            .map(|index| pose.instance_transform(index).w_axis.truncate())
            .collect()
    };
    let (still, moved) = (origins(None), origins(Some(0)));
    for ((still, moved), instance) in still.iter().zip(&moved).zip(&scene.instances) {
        assert_eq!(*still, instance.world_from_object.w_axis.truncate());
        // From 3 1 -2 to 2 0 4.
        let step = *moved - *still;
        assert!(step.abs_diff_eq([-1.0, -1.0, 6.0].into(), 1e-12), "{step}");
    }
}
