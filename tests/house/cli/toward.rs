//! Promise: a preset goes toward another on the same scene without a jump at either end; sizes have
//! names.

use super::*;

const HEAD: &str = "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\n[output]\nsize = [48, 32]\n";

#[test]
fn a_preset_goes_toward_another_and_begins_and_ends_with_both() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    put(
        "a.toml",
        &format!(
            "{HEAD}background = \"#000000\"\n[effects.lambert]\n[effects.facet]\namount = 0.2\n"
        ),
    );
    put(
        "b.toml",
        &format!(
            "{HEAD}background = \"#ffffff\"\n[effects.facet]\namount = 0.8\n[effects.posterize]\n"
        ),
    );
    put("c.toml", "schema = 2\n[scene]\nbuiltin = \"teapot\"\n");
    let draw = |args: &[&str]| {
        let cpu = [
            "--adapter",
            "cpu",
            "--bare",
            "--set",
            "accuracy.render_scale=full",
        ];
        run_in(
            folder.path(),
            &[&["render"], args, &["-o", "-"], &cpu[..]].concat(),
        )
    };
    let between = |by: &str| draw(&["a.toml", "--toward", "b.toml", "--by", by]);
    let (first, last) = (draw(&["a.toml"]), draw(&["b.toml"]));
    assert!(
        first.code == 0 && last.code == 0,
        "{}{}",
        first.err,
        last.err
    );
    assert!(between("0").bytes == first.bytes && between("1").bytes == last.bytes);
    let middle = between("0.5");
    assert!(![&first.bytes, &last.bytes].contains(&&middle.bytes) && middle.code == 0);
    assert_eq!(draw(&["a.toml", "--toward", "b.toml"]).bytes, middle.bytes);

    let other = draw(&["a.toml", "--toward", "c.toml"]);
    assert_eq!(other.code, 2);
    assert!(
        other
            .err
            .contains("a shows the scene knot and c shows teapot"),
        "{}",
        other.err
    );
    let beyond = between("1.5");
    assert!(
        beyond.code == 2 && beyond.err.contains("is no number from 0 to 1"),
        "{}",
        beyond.err
    );
}

#[test]
fn a_size_has_a_name() {
    for (name, size) in [
        ("1080p", [1920, 1080]),
        ("4K", [3840, 2160]),
        ("square", [1080, 1080]),
        ("story", [1080, 1920]),
    ] {
        let explained = json(&run(&["explain", "lambert", "--size", name, "--json"]));
        assert_eq!(explained["results"][0]["size"], serde_json::json!(size));
    }
    let wrong = run(&["explain", "lambert", "--size", "huge"]);
    assert!(
        wrong.code == 2 && wrong.err.contains("1080p, 4k, square, story"),
        "{}",
        wrong.err
    );
}
