//! Promise: `--preset` puts the look of a preset on the scene that a command names, for every
//! command that draws or describes one.

use super::*;

/// A model of one triangle, 1 m wide.
const MODEL: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"tri","mesh":0}],
    "meshes":[{"name":"tri","primitives":[{"attributes":{"POSITION":0}}]}],
    "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]}"#;

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("tri.gltf"), MODEL).unwrap();
    folder
}

#[test]
fn a_look_is_drawn_on_a_model_and_both_are_named() {
    let folder = folder();
    let args = [
        "render",
        "tri.gltf",
        "--preset",
        "hatch",
        "--adapter",
        "cpu",
        "--size",
        "48x36",
        "--json",
    ];
    let run = run_in(folder.path(), &args);
    assert_eq!(run.code, 0, "{}", run.err);
    let result = json(&run)["results"][0].clone();
    assert_eq!(
        (&result["preset"], &result["look"], &result["model"]),
        (&"hatch-tri".into(), &"hatch".into(), &"tri".into())
    );
    let picture = fs::read(folder.path().join("hatch-tri.png")).expect("the picture");
    let inside = rasterlab::preset_file::preset_from_png(&picture, "hatch-tri.png")
        .expect("a preset inside");
    let hatch =
        rasterlab::preset_file::open("hatch", &Default::default()).expect("a built-in preset");
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
    let folder = folder();
    fs::write(
        folder.path().join("look.toml"),
        "schema = 2\n[scene]\nbuiltin = \"sphere?triangles=100\"\n[effects.inflate]\namount_m = 0.5\n[animation.inflate]\n\
         amount_m = [{ time_s = 0, value = 0.5 }, { time_s = 1, value = 1.0 }]\n",
    )
    .unwrap();
    let out = |extra: &[&str]| {
        let args = [
            &[
                "render",
                "tri.gltf",
                "--preset",
                "look.toml",
                "--adapter",
                "cpu",
                "--size",
                "8x6",
                "-o",
                "-",
            ],
            extra,
        ]
        .concat();
        let run = run_in(folder.path(), &args);
        assert_eq!(run.code, 0, "{}", run.err);
        rasterlab::preset_file::preset_from_png(&run.bytes, "out.png")
            .expect("a preset inside")
            .preset
    };
    let sphere = rasterlab::scene::builtin::build("sphere?triangles=100")
        .unwrap()
        .bounds()
        .radius();
    let wanted = 0.5 * 0.5f64.sqrt() / sphere;
    let keys = out(&[])
        .animation
        .get("inflate", "amount_m")
        .expect("it is animated")
        .keys()
        .to_vec();
    assert!(
        (keys[0].value[0] - wanted).abs() < 1e-6 && (keys[1].value[0] - 2.0 * wanted).abs() < 1e-6,
        "{keys:?}, {wanted}"
    );
    // --set comes after the look has landed.
    let set = out(&["--set", "inflate.amount_m=0.25", "--set", "scene.room=2"]);
    assert_eq!(
        (
            set.stack.get("inflate").expect("it is enabled").words[0],
            set.room
        ),
        (0.25f32.to_bits(), 2.0)
    );
}

#[test]
fn every_command_that_draws_takes_a_look() {
    let folder = folder();
    let explain = run_in(
        folder.path(),
        &[
            "explain",
            "tri.gltf",
            "--preset",
            "hatch",
            "--adapter",
            "cpu",
            "--json",
        ],
    );
    assert_eq!(
        (explain.code, &json(&explain)["results"][0]["look"]),
        (0, &"hatch".into()),
        "{}",
        explain.err
    );
    let verify = run_in(
        folder.path(),
        &[
            "verify",
            "tri.gltf",
            "--preset",
            "hatch",
            "--adapter",
            "cpu",
            "--size",
            "24x18",
            "--json",
        ],
    );
    assert_eq!(
        (verify.code, &json(&verify)["results"][0]["model"]),
        (0, &"tri".into()),
        "{}",
        verify.err
    );
    let args = [
        "sequence",
        "tri.gltf",
        "--preset",
        "facet-sweep",
        "--adapter",
        "cpu",
        "--size",
        "8x6",
        "--frames",
        "0..2",
        "-o",
        "{frame}.png",
    ];
    let sequence = run_in(folder.path(), &[&args[..], &["--json"]].concat());
    assert_eq!(
        (sequence.code, &json(&sequence)["results"][1]["look"]),
        (0, &"facet-sweep".into()),
        "{}",
        sequence.err
    );
    let args = [
        "compare",
        "tri.gltf",
        "tri.gltf",
        "--preset",
        "hatch",
        "--adapter",
        "cpu",
        "--size",
        "24x18",
        "--json",
    ];
    let compare = run_in(folder.path(), &args);
    assert_eq!(
        (compare.code, &json(&compare)["results"][0]["look"]),
        (0, &"hatch".into()),
        "{}",
        compare.err
    );
    let alone = run_in(
        folder.path(),
        &[
            "verify",
            "--preset",
            "facet",
            "--adapter",
            "cpu",
            "--size",
            "24x18",
            "--json",
        ],
    );
    let results = json(&alone)["results"].as_array().unwrap().clone();
    assert_eq!(
        (alone.code, results.len(), &results[0]["preset"]),
        (0, 1, &"facet".into()),
        "{}",
        alone.err
    );
}

#[test]
fn what_a_look_leaves_out_is_one_warning_each_and_strict_makes_it_an_error() {
    let folder = folder();
    fs::write(
        folder.path().join("look.toml"),
        "schema = 2\n[scene]\nbuiltin = \"walker\"\nclip = \"Walk\"\n[effects.hatch]\non = [\"node:walker 1\", \"mesh:tri\"]\n",
    )
    .unwrap();
    let args = [
        "render",
        "tri.gltf",
        "--preset",
        "look.toml",
        "--adapter",
        "cpu",
        "--size",
        "8x6",
    ];
    let run = run_in(folder.path(), &args);
    assert_eq!(run.code, 0, "{}", run.err);
    let said = |words: &str| run.err.lines().filter(|line| line.contains(words)).count();
    assert_eq!(
        (
            said("clip \"Walk\" was left out"),
            said("effects.hatch.on: 1 of its 2 parts")
        ),
        (1, 1),
        "{}",
        run.err
    );
    let strict = run_in(
        folder.path(),
        &[&args[..], &["--strict", "--force"]].concat(),
    );
    assert_eq!(
        (strict.code, strict.out.as_str()),
        (2, ""),
        "{}",
        strict.err
    );
}

#[test]
fn a_look_that_is_not_there_or_means_nothing_is_wrong_usage() {
    let folder = folder();
    let cases: [(&[&str], &str); 5] = [
        (
            &[
                "render",
                "tri.gltf",
                "--preset",
                "hatsch",
                "--adapter",
                "cpu",
            ],
            "hatch",
        ),
        (
            &[
                "render",
                "absent.glb",
                "--preset",
                "explode",
                "--adapter",
                "cpu",
            ],
            "absent.glb",
        ),
        (
            &["list", "--preset", "hatch"],
            "--preset has no meaning for list",
        ),
        (
            &["bless", "facet", "--preset", "hatch", "--dry-run"],
            "--preset has no meaning for bless",
        ),
        (
            &["check", "facet", "--preset", "hatch"],
            "--preset has no meaning for check",
        ),
    ];
    for (args, words) in cases {
        let run = run_in(folder.path(), args);
        assert_eq!(
            (run.code, run.out.as_str()),
            (2, ""),
            "{args:?}\n{}",
            run.err
        );
        assert!(
            run.err.contains(words)
                && run
                    .err
                    .lines()
                    .filter(|line| line.starts_with("error: "))
                    .count()
                    == 1,
            "{args:?}\n{}",
            run.err
        );
    }
}
