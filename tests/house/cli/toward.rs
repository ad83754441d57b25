//! Promise: a preset goes toward another on the same scene without a jump at either end, in a picture
//! and in a film; a picture is seen from a bookmark; sizes have names.

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
fn a_film_goes_from_one_preset_to_another() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let (one, two) = (
        "amount = 0.2\n[effects.lambert]\n",
        "amount = 0.8\n[effects.lambert]\n",
    );
    let clock = "[clock]\nrange_s = [0.0, 1.0]\n";
    // Keyframes count with their values at the time of a frame.
    let keys = "[animation.facet]\namount = [{ time_s = 0.0, value = 0.2 }]\n";
    put(
        "a.toml",
        &format!("{HEAD}{clock}[effects.facet]\namount = 0.9\n[effects.lambert]\n{keys}"),
    );
    put("b.toml", &format!("{HEAD}{clock}[effects.facet]\n{two}"));
    put("flat.toml", &format!("{HEAD}[effects.facet]\n{one}"));
    put("c.toml", "schema = 2\n[scene]\nbuiltin = \"teapot\"\n");
    let run = |args: &[&str]| run_in(folder.path(), &[args, &["--adapter", "cpu"]].concat());
    let film = |toward: &str| {
        let output = ["-o", "f_{frame}.png", "--fps", "3"];
        run(&[&["sequence", "a.toml", "--toward", toward], &output[..]].concat())
    };
    let drawn = film("b.toml");
    assert_eq!(drawn.code, 0, "{}", drawn.err);
    let pixels = |name: &str| {
        let path = folder.path().join(name);
        rasterlab::preset_file::png_pixels(&path).unwrap().0
    };
    for (frame, args) in [
        (0, &["render", "flat.toml"][..]),
        (1, &["render", "flat.toml", "--toward", "b.toml"]),
        (2, &["render", "b.toml"]),
    ] {
        let name = format!("alone_{frame}.png");
        let alone = run(&[args, &["-o", &name]].concat());
        assert_eq!(alone.code, 0, "{}", alone.err);
        assert!(
            pixels(&name) == pixels(&format!("f_{frame}.png")),
            "{frame}"
        );
    }
    assert!(pixels("f_0.png") != pixels("f_1.png") && pixels("f_1.png") != pixels("f_2.png"));
    let other = film("c.toml");
    assert!(
        other.code == 2
            && other
                .err
                .contains("a shows the scene knot and c shows teapot"),
        "{}",
        other.err
    );
}

#[test]
fn a_picture_is_seen_from_a_bookmark() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let camera = "eye = [0.0, 4.0, 0.5]\nfov_y_deg = 40.0\n";
    put(
        "a.toml",
        &format!(
            "{HEAD}[bookmarks.above]\n{camera}[bookmarks.\"from afar\"]\neye = [0.0, 0.0, 40.0]\n"
        ),
    );
    put("b.toml", &format!("{HEAD}[camera]\n{camera}"));
    let draw = |args: &[&str]| {
        let cpu = ["--adapter", "cpu", "--bare", "-o", "-"];
        run_in(folder.path(), &[&["render"], args, &cpu[..]].concat())
    };
    let (above, alone) = (draw(&["a.toml", "--bookmark", "above"]), draw(&["b.toml"]));
    assert!(
        above.code == 0 && above.bytes == alone.bytes,
        "{}",
        above.err
    );
    assert!(draw(&["a.toml"]).bytes != alone.bytes);
    let unknown = draw(&["a.toml", "--bookmark", "below"]);
    assert!(
        unknown.code == 2
            && unknown.err.contains(
                "a: the preset has no bookmark \"below\"; it has \"above\", \"from afar\""
            ),
        "{}",
        unknown.err
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
        let explain = ["explain", "lambert", "--adapter", "cpu", "--size", name];
        let explained = json(&run(&[&explain[..], &["--json"]].concat()));
        assert_eq!(explained["results"][0]["size"], serde_json::json!(size));
    }
    let wrong = run(&["explain", "lambert", "--adapter", "cpu", "--size", "huge"]);
    assert!(
        wrong.code == 2 && wrong.err.contains("1080p, 4k, square, story"),
        "{}",
        wrong.err
    );
}
