//! Promise: a model looks the same wherever it lies: readers keep what the text says, the oracle
//! places it in f64, and what turns, stands or shines about it is about its middle.

use glam::{DMat4, DVec3};
use rasterlab::{
    effects::{Effect, shadow},
    frame::Frame,
    oracle,
    preset::Preset,
    scene::{
        Ground, Scene,
        mesh_files::{LoadModel, load_obj, load_ply, load_stl},
    },
};
use serde_json::json;

use super::{mesh_files::load, model::*};

/// Places in meters: UTM, some kilometers, the moon, and a corner at the origin.
const PLACES: [DVec3; 4] = [
    DVec3::new(453_123.5, 120.25, -5_412_345.5),
    DVec3::new(4123.5, 0.0, -8345.5),
    DVec3::new(-3.844e8, 5.0, 7.0),
    DVec3::ZERO,
];

/// Steps of 5 cm, as triangles.
fn steps() -> Vec<[DVec3; 3]> {
    let corner = |i: i32, z: f64| DVec3::new(f64::from(i) * 0.05, f64::from(i * i) * 0.05, z);
    (0..6)
        .flat_map(|i| {
            let [a, b] = [corner(i, 0.0), corner(i + 1, 0.0)];
            let [c, d] = [corner(i, 1.0), corner(i + 1, 1.0)];
            [[a, b, d], [a, d, c]]
        })
        .collect()
}

type Text = fn(&[[DVec3; 3]]) -> Vec<u8>;

/// Coordinates with four decimals, as surveyors write them.
fn text(v: DVec3) -> String {
    format!("{:.4} {:.4} {:.4}", v.x, v.y, v.z)
}

fn obj(triangles: &[[DVec3; 3]]) -> Vec<u8> {
    let mut file = String::from("v 0 0 0\n");
    for corners in triangles {
        corners
            .iter()
            .for_each(|v| file += &format!("v {}\n", text(*v)));
        file += "f -3 -2 -1\n";
    }
    file.into()
}

fn stl(triangles: &[[DVec3; 3]]) -> Vec<u8> {
    let mut file = String::from("solid s\n");
    for corners in triangles {
        file += "facet normal 0 0 0\nouter loop\n";
        corners
            .iter()
            .for_each(|v| file += &format!("vertex {}\n", text(*v)));
        file += "endloop\nendfacet\n";
    }
    file.into()
}

fn ply(triangles: &[[DVec3; 3]]) -> Vec<u8> {
    let count = triangles.len();
    let mut file = format!(
        "ply\nformat binary_big_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {count}\n\
         property list uchar int vertex_indices\nend_header\n",
        3 * count
    )
    .into_bytes();
    for v in triangles.as_flattened() {
        let decimals = text(*v);
        let values = decimals
            .split(' ')
            .map(|word| word.parse::<f64>().expect("a number"));
        values.for_each(|value| file.extend(value.to_be_bytes()));
    }
    for face in 0..count as i32 {
        file.push(3);
        (0..3).for_each(|k| file.extend((3 * face + k).to_be_bytes()));
    }
    file
}

const FORMATS: [(LoadModel, Text); 3] = [(load_obj, obj), (load_stl, stl), (load_ply, ply)];

#[test]
fn readers_keep_what_the_text_says_at_any_distance() {
    for (format, write) in FORMATS {
        for place in PLACES {
            let moved: Vec<_> = steps().iter().map(|t| t.map(|v| v + place)).collect();
            let scene = load(format, &write(&moved), &[]).expect("a model");
            assert_sound(&scene);
            let read = triangles(&scene);
            assert_eq!(read.len(), moved.len());
            for (given, read) in moved.as_flattened().iter().zip(read.as_flattened()) {
                let error = (DVec3::from(*read) - *given).abs().max_element();
                // A decimal of the text, a half of an f32's last bit of the size, and an f64's of the place.
                let most = 1.01 * f64::from(f32::EPSILON) + 1e-15 * place.abs().max_element();
                assert!(error <= most, "{place}: {error}");
            }
            let is_near = place == DVec3::ZERO;
            let origin = scene.instances[0].world_from_object;
            assert_eq!(origin == DMat4::IDENTITY, is_near, "{place}: {origin}");
        }
    }
}

/// A square of 64 triangles with f32 corners that the place leaves exact.
fn stored(place: [f32; 3]) -> Model {
    let mut model = Model::empty();
    let corner = |i: u16| {
        let [x, y] = [i % 9, i / 9].map(|k| f32::from(k) / 8.0);
        [x + place[0], y + place[1], x * y + place[2]]
    };
    let positions: Vec<f32> = (0..81).flat_map(corner).collect();
    let cell = |i: u16| {
        let a = i % 8 + i / 8 * 9;
        [a, a + 1, a + 10, a, a + 10, a + 9]
    };
    let indices: Vec<u16> = (0..64).flat_map(cell).collect();
    let positions = model.floats("VEC3", &positions);
    let bytes: Vec<u8> = indices.iter().flat_map(|v| v.to_le_bytes()).collect();
    let indices = model.accessor(&bytes, U16, "SCALAR", indices.len());
    model.primitive(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
    model
}

fn drawn(scene: &Scene, preset: &Preset) -> Frame {
    let size = [64, 48];
    let view = preset.view(scene, size);
    oracle::render(scene, &view, &preset.stack_on(scene, size)).expect("a picture")
}

#[test]
fn the_oracle_places_what_is_stored_far_away_in_f64_and_the_view_says_so() {
    let preset = Preset::default();
    let near = stored([0.0; 3]).scene();
    let expected = drawn(&near, &preset);
    assert!(!preset.view(&near, [64, 48]).precision.is_relative);
    assert!(expected.covered() > 500);
    for place in [
        [40_000.0, 0.0, 0.0],
        [0.0, 65_536.0, -8192.0],
        [500_000.0, 0.0, -90_000.0],
    ] {
        let far = stored(place).scene();
        assert!(
            preset.view(&far, [64, 48]).precision.is_relative,
            "{place:?}"
        );
        let given = drawn(&far, &preset);
        assert_eq!(given.triangle_id, expected.triangle_id, "{place:?}");
    }
}

#[test]
fn a_node_is_where_its_text_says() {
    let place = DVec3::new(453_123.55, 120.25, -5_412_345.45);
    let by_matrix = DMat4::from_translation(place).to_cols_array();
    for scene in [
        Model::square()
            .with("/nodes/0/translation", json!(place.to_array()))
            .scene(),
        Model::square()
            .with("/nodes/0/matrix", json!(by_matrix))
            .scene(),
    ] {
        assert_eq!(
            scene.instances[0].world_from_object,
            DMat4::from_translation(place)
        );
    }
}

#[test]
fn turning_rooms_grounds_and_shadows_are_about_the_middle_of_what_is_shown() {
    let twin = |place: [f64; 3], preset: &Preset| {
        let scene = stored([0.0; 3])
            .with("/nodes/0/translation", json!(place))
            .scene()
            .counted();
        let scene = match &preset.ground {
            Some(ground) => scene.on_ground(ground),
            None => scene,
        };
        let scene = if preset.room > 0.0 {
            scene.in_room(preset.room)
        } else {
            scene
        };
        drawn(&scene, preset)
    };
    let mut turned = Preset {
        spin_deg_per_s: 40.0,
        ..Preset::default()
    };
    turned.clock.time_s = 1.0;
    let standing = Preset {
        ground: Some(Ground::default()),
        ..turned.clone()
    };
    let inside = Preset {
        room: 1.5,
        ..turned.clone()
    };
    let with = |effect: &str, values: &[(&str, f64)]| {
        let mut preset = turned.clone();
        let enabled = preset.stack.enable(Effect::named(effect));
        for (name, value) in values {
            enabled.set(name, &[*value]);
        }
        preset
    };
    let wobbling = with("wobble", &[("amplitude_m", 0.2), ("wavelength_m", 0.7)]);
    let hatched = with("hatch", &[("space", 1.0), ("dark", 0.4)]);
    for (what, mut preset) in [
        ("spin", turned),
        ("ground", standing),
        ("room", inside),
        ("wobble", wobbling),
        ("hatch", hatched),
    ] {
        preset.stack.enable(&shadow::EFFECT);
        let expected = twin([0.0; 3], &preset);
        assert!(expected.covered() > 300, "{what}");
        for place in [
            [10.0, 0.0, 0.0],
            [-4096.0, 0.0, 512.0],
            [453_120.0, 128.0, -5_412_352.0],
        ] {
            let given = twin(place, &preset);
            assert_eq!(
                given.triangle_id, expected.triangle_id,
                "{what} at {place:?}"
            );
            let differing = given.color.iter().zip(&expected.color);
            let apart =
                |(a, b): &(&[u8; 4], &[u8; 4])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1);
            let pixels = differing.filter(apart).count();
            assert_eq!(pixels, 0, "{what} at {place:?}");
        }
    }
}
