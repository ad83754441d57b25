//! Promise: `--preset` puts the look of a preset on the scene that a command names, for every
//! command that draws or describes one.

use rasterlab::preset_file;

use super::*;

fn place() -> Place {
    Place::with([("tri.gltf", TRIANGLE)])
}

#[test]
fn a_look_is_drawn_on_a_model_and_both_are_named() {
    let place = place();
    place.play(
        r#"
        $ render tri.gltf --preset hatch CPU48x36 --json
        /results/0/preset "hatch-tri"
        /results/0/look "hatch"
        /results/0/model "tri"
        "#,
    );
    let inside = preset_file::preset_from_png(&place.read("hatch-tri.png"), "hatch-tri.png")
        .expect("a preset inside");
    let hatch = preset_file::open("hatch", &Default::default()).expect("a built-in preset");
    assert_eq!(
        inside.preset.stack, hatch.preset.stack,
        "the effects are those of the look"
    );
    assert_eq!(
        inside.preset.output.background,
        hatch.preset.output.background
    );
    assert!(inside.preset.camera.is_none() && inside.preset.test.is_none());
}

#[test]
fn lengths_are_fitted_to_the_model() {
    let place = place();
    let text = "schema = 2\n[scene]\nbuiltin = \"sphere?triangles=100\"\n[effects.inflate]\namount_m = 0.5\n[animation.inflate]\n\
         amount_m = [{ time_s = 0, value = 0.5 }, { time_s = 1, value = 1.0 }]\n";
    place.put("look.toml", text);
    let out = |extra: &str| {
        let run = place.run(&format!(
            "render tri.gltf --preset look.toml CPU8x6 -o - {extra}"
        ));
        assert_eq!(run.code, 0, "{}", run.err);
        preset_file::preset_from_png(&run.bytes, "out.png")
            .expect("a preset inside")
            .preset
    };
    let sphere = rasterlab::scene::builtin::build("sphere?triangles=100")
        .unwrap()
        .bounds()
        .radius();
    let wanted = 0.5 * 0.5f64.sqrt() / sphere;
    let keys = out("")
        .animation
        .get("inflate", "amount_m")
        .expect("it is animated")
        .keys()
        .to_vec();
    let is_fitted = |key: usize, wanted: f64| (keys[key].value[0] - wanted).abs() < 1e-6;
    assert!(
        is_fitted(0, wanted) && is_fitted(1, 2.0 * wanted),
        "{keys:?}, {wanted}"
    );
    // --set comes after the look has landed.
    let set = out("--set inflate.amount_m=0.25 --set scene.room=2");
    let word = set.stack.get("inflate").expect("it is enabled").words[0];
    assert_eq!((word, set.room), (0.25f32.to_bits(), 2.0));
}
