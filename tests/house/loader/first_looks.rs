//! Promise: a model that is opened without a preset stands upright, in the plain look, with lights
//! that a picture holds, and what was guessed for it is told once and kept.

use std::path::{Path, PathBuf};

use glam::{DMat4, DVec3};
use rasterlab::{
    effects::Effect,
    preset::{NO_CAMERA, Preset},
    preset_file::{self, Folders, PresetFile, load_scene},
    scene::{Scene, UpAxis, pick, view::View},
};
use serde_json::json;

use super::{lights::lit, model::*};

/// Opens a model as the command line does.
fn opened(path: &Path) -> (PresetFile, std::sync::Arc<Scene>) {
    let name = path.to_string_lossy();
    let mut file = preset_file::open(&name, &Folders::default()).expect("a model");
    let scene = load_scene(&file.preset, None).expect("its scene");
    file.settle(&scene, true);
    (file, scene)
}

/// A tower on z = 0, 1 x 1 x 3 with a point at its top, as text.
fn tower() -> String {
    let mut text = String::new();
    for [x, y] in [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]] {
        text += &format!("v {x} {y} 0\n");
    }
    text + "v 0 0 3\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 4 3 2 1\n"
}

fn written(folder: &Path, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("a file");
    path
}

#[test]
fn a_model_that_stands_on_another_plane_is_set_upright_told_once_and_kept() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = written(folder.path(), "tower.obj", tower());
    let (mut file, scene) = opened(&path);
    assert_eq!((file.preset.parts.up, scene.up), (UpAxis::Z, UpAxis::Z));
    let bounds = scene.content_bounds();
    assert!(
        bounds.min.distance(DVec3::new(-0.5, 0.0, -0.5)) < 1e-9,
        "{bounds:?}"
    );
    assert!(
        bounds.max.distance(DVec3::new(0.5, 3.0, 0.5)) < 1e-9,
        "{bounds:?}"
    );
    let told = |scene: &Scene| {
        scene
            .notes
            .iter()
            .filter(|note| note.contains("scene.up"))
            .count()
    };
    assert_eq!(told(&scene), 1);
    let ground = scene.bounds_of(scene.ground_instances());
    assert!((-0.01..0.0).contains(&ground.max.y), "{ground:?}");
    let saved = folder.path().join("tower.toml");
    preset_file::save(&mut file, &saved).expect("it is saved");
    assert!(preset_file::to_toml(&file).contains("up = \"z\""));
    let again = preset_file::load(&saved).expect("it is read");
    let scene = load_scene(&again.preset, again.path.as_deref()).expect("its scene");
    assert_eq!((scene.content_bounds(), told(&scene)), (bounds, 0));
    // The top is where the camera looks for it.
    let camera = again.preset.camera_for(&scene, 1.0);
    let view = View::new(&camera, 100, 100, &bounds, DMat4::IDENTITY, [0.0; 4]);
    let clip = view.clip_from_world * DVec3::new(0.0, 2.9, 0.0).extend(1.0);
    let uv = glam::DVec2::new(clip.x, -clip.y) / clip.w * 0.5 + 0.5;
    let picked = pick::pick(&scene, &view, uv).expect("the tower");
    assert!(picked.y > 2.5, "{picked}");
}

#[test]
fn a_foot_tells_the_axis_where_the_place_does_not() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // The tower in a corner of its axes, and about the middle of its height.
    for [x, z] in [[0.5, 0.0], [0.0, -1.5]] {
        for up in [UpAxis::Z, UpAxis::Y] {
            let moved = |line: &str| match line.split_whitespace().collect::<Vec<_>>()[..] {
                ["v", a, b, c] => {
                    let [a, b, c] = [a, b, c].map(|word| word.parse::<f64>().expect("a number"));
                    let [a, b, c] = [a + x, b + x, c + z];
                    match up {
                        UpAxis::Z => format!("v {a} {b} {c}\n"),
                        _ => format!("v {a} {c} {}\n", -b),
                    }
                }
                _ => format!("{line}\n"),
            };
            let text: String = tower().lines().map(moved).collect();
            let path = written(folder.path(), "tower.obj", &text);
            assert_eq!(opened(&path).0.preset.parts.up, up, "{text}");
        }
    }
}

#[test]
fn heights_of_a_terrain_and_points_of_a_scanner_are_along_z() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let hill = "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
    let sign = "f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\nf 3 2 1\nf 4 3 1\n";
    for (faces, up) in [(hill, UpAxis::Z), (sign, UpAxis::Y)] {
        let text = format!("v -5 -5 0\nv 5 -5 0\nv 5 5 0\nv -5 5 0\nv 0 0 1\n{faces}");
        let path = written(folder.path(), "hill.obj", &text);
        assert_eq!(opened(&path).0.preset.parts.up, up, "{text}");
    }
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    let path = written(
        folder.path(),
        "room.ply",
        format!("{head}0 0 0\n6 5 0\n2 3 2\n"),
    );
    assert_eq!(opened(&path).0.preset.parts.up, UpAxis::Z);
}

#[test]
fn a_flat_model_is_looked_at_from_higher() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let down = |height: f64| {
        let text = format!(
            "v -5 0 5\nv 5 0 5\nv 5 0 -5\nv -5 0 -5\nv 0 {height} 0\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"
        );
        let (file, scene) = opened(&written(folder.path(), "y-up.obj", text));
        -file.preset.camera_for(&scene, 4.0 / 3.0).forward().y
    };
    let [flat, low, high] = [0.2, 1.5, 6.0].map(down);
    assert!(flat > low && low > high, "{flat} {low} {high}");
    assert!(flat > 0.6 && high < 0.4, "{flat} {high}");
}

#[test]
fn presets_and_gltf_files_are_not_turned_unless_they_say_so() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    written(folder.path(), "tower.obj", tower());
    for (keys, up) in [
        ("", DVec3::Z),
        ("up = \"z\"", DVec3::Y),
        ("up = \"-x\"", DVec3::Z),
    ] {
        let text = format!("schema = 2\n[scene]\npath = \"tower.obj\"\n{keys}\n");
        let path = written(folder.path(), "tower.toml", &text);
        let file = preset_file::load(&path).expect("a preset");
        let bounds = load_scene(&file.preset, Some(&path))
            .expect("a scene")
            .bounds();
        let size = bounds.max - bounds.min;
        assert_eq!(size.dot(up), 3.0, "{keys}: {bounds:?}");
    }
    let mut model = Model::square();
    model.json["nodes"][0]["translation"] = json!([-0.5, 4.0, 0.0]);
    let path = written(folder.path(), "a z-up square.glb", model.glb());
    assert_eq!(opened(&path).0.preset.parts.up, UpAxis::Y);
}

#[test]
fn a_cloud_keeps_its_colors_in_the_plain_look_and_effects_of_faces_say_why_they_are_idle() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let text = |columns: &str| format!("0 0 0 {columns}\n1 0 0 {columns}\n0 1 1 {columns}\n");
    for columns in ["200 90 9", ""] {
        let (file, scene) = opened(&written(folder.path(), "cloud.xyz", text(columns)));
        let stack = &file.preset.stack;
        assert_eq!(
            stack.get("studio").expect("studio").on.texts(),
            ["material:ground"]
        );
        assert!(stack.get("ambient").is_some());
        let idle = |name| Effect::named(name).why_idle(&scene).is_some();
        let named = [
            "wireframe",
            "facet",
            "dots",
            "inflate",
            "explode",
            "dissolve",
        ];
        assert_eq!(named.map(idle), [true, true, true, true, false, false]);
    }
    let ply = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n\
               property float nx\nproperty float ny\nproperty float nz\nend_header\n0 0 0 0 0 1\n1 1 1 0 0 1\n";
    let (file, scene) = opened(&written(folder.path(), "normals.ply", ply));
    let studio = file.preset.stack.get("studio").expect("studio");
    assert!(studio.on.is_whole_scene() && Effect::named("inflate").why_idle(&scene).is_none());
    let (file, scene) = opened(&written(folder.path(), "tower.obj", tower()));
    assert!(file.preset.stack.get("ambient").is_none());
    assert!(Effect::named("wireframe").why_idle(&scene).is_none());
}

#[test]
fn lights_of_hundreds_of_candelas_are_dimmed_in_the_plain_look_alone() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (light, height, dimmed) in [
        (r#"{"type":"point","intensity":54351}"#, 8.0, 4e-3),
        (r#"{"type":"directional","intensity":20000}"#, 8.0, 2e-4),
        (r#"{"type":"point","intensity":40}"#, 8.0, 1.0),
    ] {
        let mut model = lit(light);
        model.json["nodes"][1]["translation"] = json!([0.5, 0.5, height]);
        let path = written(folder.path(), "lit.glb", model.glb());
        let (file, scene) = opened(&path);
        let lights = |preset: &Preset| {
            preset
                .stack
                .get("studio")
                .map(|studio| studio.number("lights"))
        };
        let is_near = |value: Option<f64>| (value.unwrap() / dimmed - 1.0).abs() < 1e-6;
        assert!(
            is_near(lights(&file.preset)),
            "{light}: {:?}",
            lights(&file.preset)
        );
        // Another look keeps what it says, and knows the number.
        let lamps = preset_file::open("lamps", &Folders::default()).expect("a preset");
        let mut landed = lamps.landed_on(&file, None);
        landed.settle(&scene, true);
        assert_eq!(lights(&landed.preset), Some(1.0));
        assert_eq!(landed.preset.dimmed_lights(&scene).is_some(), dimmed < 1.0);
        // A note on them holds until they are dimmed.
        let notes = |preset: &Preset| preset.notes_on(&scene).count();
        let too_strong = usize::from(dimmed < 1.0);
        assert_eq!(notes(&landed.preset), notes(&file.preset) + too_strong);
        // What a person has set stays.
        let mut plain =
            preset_file::open(&path.to_string_lossy(), &Folders::default()).expect("it");
        plain.settle(&scene, false);
        assert_eq!(lights(&plain.preset), Some(1.0));
    }
}

#[test]
fn a_camera_of_the_file_that_crops_the_model_is_known_and_can_be_left_out() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (away, crops) in [(0.6, true), (6.0, false)] {
        let mut model = Model::square();
        model.json["cameras"] = json!([{
            "name": "Closer", "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.01 }
        }]);
        model.push(
            "nodes",
            json!({ "camera": 0, "translation": [0.5, 0.5, away] }),
        );
        model.json["scenes"][0]["nodes"] = json!([0, 1]);
        let path = written(folder.path(), "seen.glb", model.glb());
        let (mut file, scene) = opened(&path);
        let cropping = file
            .preset
            .cropping_camera(&scene)
            .map(|camera| &*camera.name);
        assert_eq!(cropping, crops.then_some("Closer"), "{away}");
        file.preset.scene_camera = NO_CAMERA.into();
        assert!(file.preset.check(&scene).is_ok());
        assert!(file.preset.cropping_camera(&scene).is_none());
        assert_ne!(
            file.preset.camera_for(&scene, 1.0).eye,
            DVec3::new(0.5, 0.5, away)
        );
    }
}
