//! Promise: an effect of one's own is one file: written by a command, switched on by its name,
//! judged, and refused in one sentence.

use super::*;

/// A folder in which `new-effect` has written the effect `name`.
fn folder_with_effect(name: &str, hook: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let run = run_in(folder.path(), &["new-effect", name, "--hook", hook]);
    assert_eq!(
        (run.code, run.out.trim()),
        (0, format!("effects/{name}.wgsl").as_str()),
        "{}",
        run.err
    );
    folder
}

#[test]
fn a_new_effect_of_every_hook_is_drawn_and_judged_without_a_driver() {
    for hook in ["surface", "vertex", "sample", "pixel"] {
        let folder = folder_with_effect("ink", hook);
        let args = [
            "render",
            "builtin:knot",
            "--size",
            "64x48",
            "--adapter",
            "cpu",
        ];
        let plain = run_in(folder.path(), &[&args[..], &["-o", "plain.png"]].concat());
        let inked = run_in(
            folder.path(),
            &[&args[..], &["--set", "ink", "-o", "inked.png"]].concat(),
        );
        assert_eq!(
            (plain.code, inked.code),
            (0, 0),
            "{hook}: {}{}",
            plain.err,
            inked.err
        );
        let read = |name: &str| {
            rasterlab::preset_file::png_pixels(&folder.path().join(name))
                .unwrap()
                .0
        };
        assert_ne!(
            read("plain.png"),
            read("inked.png"),
            "{hook}: the effect changes the picture"
        );
        let verified = run_in(
            folder.path(),
            &[
                "verify",
                "builtin:knot",
                "--size",
                "64x48",
                "--adapter",
                "cpu",
                "--set",
                "ink",
                "--json",
            ],
        );
        assert_eq!(verified.code, 0, "{hook}: {}", verified.err);
        assert_eq!(
            json(&verified)["results"][0]["judged_by_own_text"][0],
            "ink"
        );
    }
}

#[test]
fn a_faulty_effect_is_one_sentence_with_its_line_and_a_caret() {
    let folder = folder_with_effect("ink", "surface");
    let path = folder.path().join("effects/ink.wgsl");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace("s.normal", "s.norml")).unwrap();
    let run = run_in(
        folder.path(),
        &[
            "render",
            "teapot",
            "--adapter",
            "cpu",
            "--set",
            "ink",
            "-o",
            "x.png",
        ],
    );
    assert_eq!((run.code, run.out.as_str()), (2, ""));
    let line = text
        .lines()
        .position(|line| line.contains("s.normal"))
        .unwrap()
        + 1;
    assert!(
        run.err.contains(&format!("effects/ink.wgsl:{line}:"))
            && run.err.contains("norml")
            && run.err.contains("^^^^^"),
        "{}",
        run.err
    );
    // Presets that do not use it are not disturbed.
    let other = run_in(
        folder.path(),
        &[
            "render",
            "builtin:knot",
            "--size",
            "32x24",
            "--adapter",
            "cpu",
            "-o",
            "y.png",
        ],
    );
    assert_eq!(other.code, 0, "{}", other.err);
}

#[test]
fn a_new_effect_overwrites_nothing_and_its_name_is_checked() {
    let folder = folder_with_effect("ink", "surface");
    let path = folder.path().join("effects/ink.wgsl");
    fs::write(&path, "// mine").unwrap();
    let again = run_in(folder.path(), &["new-effect", "ink"]);
    assert_eq!(again.code, 2);
    assert!(
        again.err.contains("exists") && again.err.contains("--force"),
        "{}",
        again.err
    );
    assert_eq!(fs::read_to_string(&path).unwrap(), "// mine");
    for (name, reason) in [
        ("facet", "built-in"),
        ("Ink", "small letter"),
        ("camera", "another meaning"),
        ("a__b", "single _"),
        ("../x", "small letter"),
    ] {
        let run = run_in(folder.path(), &["new-effect", name]);
        assert!(
            run.code == 2 && run.err.contains(reason),
            "{name}: {}",
            run.err
        );
    }
}

#[test]
fn effects_are_found_beside_the_preset_and_in_a_chosen_folder() {
    let folder = folder_with_effect("ink", "pixel");
    let elsewhere = tempfile::tempdir().unwrap();
    let preset = folder.path().join("mine.toml");
    fs::write(
        &preset,
        "schema = 2\n[scene]\nbuiltin = \"knot\"\n[effects.ink]\namount = 0.9\n",
    )
    .unwrap();
    let (preset, effects) = (preset.to_str().unwrap(), folder.path().join("effects"));
    let beside = run_in(
        elsewhere.path(),
        &[
            "render",
            preset,
            "--size",
            "32x24",
            "--adapter",
            "cpu",
            "--strict",
            "-o",
            "a.png",
        ],
    );
    assert_eq!(beside.code, 0, "{}", beside.err);
    let chosen = [
        "render",
        "builtin:knot",
        "--size",
        "32x24",
        "--adapter",
        "cpu",
        "--set",
        "ink",
        "-o",
        "b.png",
    ];
    assert_eq!(
        run_in(elsewhere.path(), &chosen).code,
        2,
        "nothing is found elsewhere"
    );
    let run = run_in(
        elsewhere.path(),
        &[&chosen[..], &["--effects", effects.to_str().unwrap()]].concat(),
    );
    assert_eq!(run.code, 0, "{}", run.err);
    // The picture brings the effect, and says so.
    let again = run_in(
        tempfile::tempdir().unwrap().path(),
        &["check", elsewhere.path().join("b.png").to_str().unwrap()],
    );
    assert_eq!(again.code, 0, "{}", again.err);
    let drawn = run_in(
        elsewhere.path(),
        &[
            "render",
            "b.png",
            "--size",
            "32x24",
            "--adapter",
            "cpu",
            "-o",
            "c.png",
        ],
    );
    assert!(
        drawn.code == 0 && drawn.err.contains("brings the effect ink"),
        "{}",
        drawn.err
    );
}

#[test]
fn the_code_of_a_file_is_never_compiled_without_checks() {
    let folder = folder_with_effect("ink", "surface");
    let preset = "schema = 2\n[scene]\nbuiltin = \"knot\"\n[effects.ink]\n[accuracy]\nshader_checks = \"trusted\"\n";
    fs::write(folder.path().join("mine.toml"), preset).unwrap();
    let run = run_in(folder.path(), &["check", "mine.toml"]);
    assert!(
        run.code == 2
            && run.out.contains("the effect ink comes from a file")
            && run.out.contains("use checked"),
        "{}{}",
        run.out,
        run.err
    );
    // Effects of the program itself may be.
    fs::write(
        folder.path().join("plain.toml"),
        preset.replace("ink", "facet"),
    )
    .unwrap();
    let run = run_in(folder.path(), &["check", "plain.toml"]);
    assert_eq!(run.code, 0, "{}", run.err);
}
