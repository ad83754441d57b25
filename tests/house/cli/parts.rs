//! Promise: `parts` lists what scopes can name; a scope that matches nothing is a warning that
//! names parts, and an error with `--strict`.

use super::*;

#[test]
fn parts_are_listed_as_the_patterns_that_name_them() {
    let listed = run(&[
        "parts",
        "builtin:walker?tess=1&instances=2",
        "--set",
        "scene.room=1.5",
    ]);
    assert_eq!((listed.code, listed.err.as_str()), (0, ""));
    for line in [
        "material:hide",
        "material:plaster",
        "node:walker 0",
        "node:walker 1",
        "node:room",
        "mesh:walker",
        "mesh:room",
    ] {
        assert!(
            listed.out.lines().any(|found| found.starts_with(line)),
            "{line} is missing in\n{}",
            listed.out
        );
    }
    let object = json(&run(&["parts", "cube-wall", "--json"]));
    let parts = object["results"].as_array().expect("a list");
    let cube = parts
        .iter()
        .find(|part| part["kind"] == "mesh")
        .expect("the mesh");
    assert_eq!(
        (&cube["pattern"], &cube["draws"], &cube["triangles"]),
        (&"mesh:cube".into(), &160.into(), &1920.into())
    );
    let unknown = run(&["parts", "no-such-thing"]);
    assert_eq!((unknown.code, unknown.out.as_str()), (2, ""));
}

/// A triangle that is red as the file has it, green as "leaf" and blue as "sea".
const VARIANTS: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "extensions":{"KHR_materials_variants":{"variants":[{"name":"leaf"},{"name":"sea"}]}},"extensionsUsed":["KHR_materials_variants"],
    "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}},{"pbrMetallicRoughness":{"baseColorFactor":[0,1,0,1]}},
        {"pbrMetallicRoughness":{"baseColorFactor":[0,0,1,1]}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0,"extensions":{"KHR_materials_variants":{"mappings":[
        {"material":1,"variants":[0]},{"material":2,"variants":[1]}]}}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3,"min":[0,0,0],"max":[1,1,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;

#[test]
fn variants_are_listed_as_what_set_takes_and_drawn_in_their_colors() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("flag.gltf"), VARIANTS).unwrap();
    let in_folder = |args: &[&str]| run_in(folder.path(), args);
    let listed = in_folder(&["parts", "flag.gltf"]);
    let wanted = "VARIANT\nscene.variant=leaf\nscene.variant=sea\n";
    assert!(
        listed.code == 0 && listed.out.ends_with(wanted),
        "{}",
        listed.out
    );
    let object = json(&in_folder(&["parts", "flag.gltf", "--json"]));
    let last = object["results"].as_array().expect("a list").last();
    assert_eq!(
        last,
        Some(&serde_json::json!({ "kind": "variant", "name": "sea" }))
    );
    for (name, channel) in [("", 0), ("leaf", 1), ("sea", 2)] {
        let set = format!("scene.variant={name}");
        let args = "render flag.gltf --adapter cpu --size 16x16 --force -o a.png --set";
        let mut args: Vec<&str> = args.split(' ').collect();
        args.push(&set);
        let drawn = in_folder(&args);
        assert_eq!(drawn.code, 0, "{}", drawn.err);
        let picture = image::open(folder.path().join("a.png"))
            .expect("a picture")
            .into_rgb8();
        let is_own = |pixel: &image::Rgb<u8>| {
            let own = i32::from(pixel.0[channel]);
            (0..3).all(|other| other == channel || own > i32::from(pixel.0[other]) + 40)
        };
        assert!(picture.pixels().any(is_own), "{name}");
    }
    let unknown = in_folder(&[
        "render",
        "flag.gltf",
        "--adapter",
        "cpu",
        "--set",
        "scene.variant=sky",
    ]);
    let wanted = "scene.variant: the scene has no variant \"sky\"; it has \"leaf\", \"sea\"";
    assert!(
        unknown.code == 2 && unknown.err.contains(wanted),
        "{}",
        unknown.err
    );
}

#[test]
fn a_part_that_is_not_there_is_a_warning_and_with_strict_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let preset = "schema = 2\n[scene]\nbuiltin = \"cube-wall\"\n[effects.toon]\non = [\"material:corral\", \"mesh:cube\"]\n[output]\nsize = [8, 8]\n";
    fs::write(folder.path().join("mine.toml"), preset).unwrap();
    let wanted = "mine.toml: effects.toon.on: the scene has no material that matches \"corral\"";
    let in_folder = |args: &[&str]| run_in(folder.path(), args);
    let lenient = in_folder(&["check", "mine.toml"]);
    assert_eq!((lenient.code, lenient.out.as_str()), (0, "ok    mine\n"));
    assert!(
        lenient.err.contains(&format!("warning: {wanted}"))
            && lenient.err.contains("did you mean \"coral\"?"),
        "{}",
        lenient.err
    );
    assert_eq!(
        lenient.err.matches("effects.toon.on").count(),
        1,
        "{}",
        lenient.err
    );
    let strict = in_folder(&["check", "mine.toml", "--strict"]);
    assert_eq!(strict.code, 2);
    assert!(strict.out.contains(wanted), "{}", strict.out);
    let drawn = in_folder(&["render", "mine.toml", "--adapter", "cpu", "-o", "a.png"]);
    assert!(
        drawn.code == 0 && drawn.err.contains(wanted),
        "{}",
        drawn.err
    );
    let refused = in_folder(&[
        "render",
        "mine.toml",
        "--adapter",
        "cpu",
        "-o",
        "b.png",
        "--strict",
    ]);
    assert!(
        refused.code == 2 && refused.err.contains(wanted) && !folder.path().join("b.png").exists(),
        "{}",
        refused.err
    );
    let fixed = in_folder(&[
        "check",
        "mine.toml",
        "--strict",
        "--set",
        "toon.on=[\"material:c*\"]",
    ]);
    assert_eq!((fixed.code, fixed.err.as_str()), (0, ""));
}

#[test]
fn explain_says_what_effects_act_on() {
    let args = [
        "explain",
        "cube-wall",
        "--adapter",
        "cpu",
        "--set",
        "toon.on=[\"material:coral\", \"node:cube 1?\"]",
    ];
    let explained = run(&args);
    assert!(
        explained
            .out
            .contains("toon (surface) on material:coral, node:cube 1?"),
        "{}",
        explained.out
    );
    let object = json(&run(&[&args[..], &["--json"]].concat()));
    let effects = object["results"][0]["effects"]
        .as_array()
        .expect("a list")
        .clone();
    let on = |name: &str| {
        effects
            .iter()
            .find(|effect| effect["effect"] == name)
            .map(|effect| effect["on"].clone())
    };
    assert_eq!(
        on("toon"),
        Some(serde_json::json!(["material:coral", "node:cube 1?"]))
    );
}
