//! Promise: `parts` lists what scopes can name; a scope that matches nothing is a warning that
//! names parts, and an error with `--strict`.

use super::*;

#[test]
fn parts_are_listed_as_the_patterns_that_name_them() {
    let place = Place::new();
    let listed = place.run("parts builtin:walker?tess=1&instances=2 --set scene.room=1.5");
    assert_eq!((listed.code, listed.err.as_str()), (0, ""));
    for line in
        "material:hide,material:plaster,node:walker 0,node:walker 1,node:room,mesh:walker,mesh:room"
            .split(',')
    {
        assert!(
            listed.out.lines().any(|found| found.starts_with(line)),
            "{line} is missing in\n{}",
            listed.out
        );
    }
    let object = place.json("parts cube-wall --json");
    let cube = object["results"]
        .as_array()
        .expect("a list")
        .iter()
        .find(|part| part["kind"] == "mesh")
        .expect("the mesh");
    let told = (&cube["pattern"], &cube["draws"], &cube["triangles"]);
    assert_eq!(told, (&"mesh:cube".into(), &160.into(), &1920.into()));
    place.play("$2 parts no-such-thing");
}

#[test]
fn variants_are_listed_as_what_set_takes_and_drawn_in_their_colors() {
    // A triangle that is red as the file has it, green as "leaf" and blue as "sea".
    let head = r#"{"extensions":{"KHR_materials_variants":{"variants":[{"name":"leaf"},{"name":"sea"}]}},"extensionsUsed":["KHR_materials_variants"],
    "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}},{"pbrMetallicRoughness":{"baseColorFactor":[0,1,0,1]}},
        {"pbrMetallicRoughness":{"baseColorFactor":[0,0,1,1]}}],"#;
    let primitive = r#"{"attributes":{"POSITION":0},"material":0,"extensions":{"KHR_materials_variants":{"mappings":[
        {"material":1,"variants":[0]},{"material":2,"variants":[1]}]}}}"#;
    let model = TRIANGLE
        .replacen('{', head, 1)
        .replace(r#"{"attributes":{"POSITION":0}}"#, primitive);
    let place = Place::with([("flag.gltf", &model)]);
    assert!(
        place
            .run("parts flag.gltf")
            .out
            .ends_with("VARIANT\nscene.variant=leaf\nscene.variant=sea\n")
    );
    let object = place.json("parts flag.gltf --json");
    let last = object["results"].as_array().expect("a list").last();
    assert_eq!(
        last,
        Some(&serde_json::json!({ "kind": "variant", "name": "sea" }))
    );
    for (name, channel) in [("", 0), ("leaf", 1), ("sea", 2)] {
        place.play(&format!(
            "$ render flag.gltf CPU16x16 --force -o a.png --set scene.variant={name}"
        ));
        let is_own = |pixel: &[u8; 4]| {
            let own = i32::from(pixel[channel]);
            (0..3).all(|other| other == channel || own > i32::from(pixel[other]) + 40)
        };
        assert!(place.pixels("a.png").iter().any(is_own), "{name}");
    }
    place.play(
        r#"
        $2 render flag.gltf CPU --set scene.variant=sky
        ! scene.variant: the scene has no variant "sky"; it has "leaf", "sea"
        "#,
    );
}

#[test]
fn explain_says_what_effects_act_on() {
    let place = Place::new();
    let line = "explain cube-wall CPU --set 'toon.on=[\"material:coral\", \"node:cube 1?\"]'";
    place.play(&format!(
        "$ {line}\n> toon (surface) on material:coral, node:cube 1?"
    ));
    let object = place.json(&format!("{line} --json"));
    let effects = object["results"][0]["effects"].as_array().expect("a list");
    let toon = effects
        .iter()
        .find(|effect| effect["effect"] == "toon")
        .expect("the effect");
    assert_eq!(
        toon["on"],
        serde_json::json!(["material:coral", "node:cube 1?"])
    );
}
