//! Promise: the picture of what surrounds a scene is found beside its preset alone, travels with it,
//! and is refused in a sentence where it cannot be read. That of the preset hall is arithmetic.

use std::{fs, path::Path};

use glam::DVec3;
use rasterlab::{
    preset_file::{self, SceneError, from_line, load_scene, surroundings, to_line},
    scene::radiance,
};

/// A small picture, brighter above.
fn picture(bright: f64) -> Vec<u8> {
    let light = |i: usize| DVec3::splat(if i < 128 { bright } else { 0.1 });
    radiance::write([16, 16], &(0..256).map(light).collect::<Vec<_>>())
}

/// A preset file in this folder that names a picture.
fn naming(folder: &Path, named: &str) -> preset_file::PresetFile {
    let path = folder.join("mine.toml");
    let text = format!(
        "schema = 2\n[scene]\nbuiltin = \"sphere?triangles=100\"\nsurroundings = {named:?}\n[effects.studio]\nenvironment = \"picture\"\n"
    );
    fs::write(&path, text).expect("a file");
    preset_file::load(&path).expect("a preset")
}

fn loaded(file: &preset_file::PresetFile) -> Result<Vec<u32>, SceneError> {
    let scene = load_scene(&file.preset, file.path.as_deref())?;
    let panorama = scene.panorama.as_ref().expect("it names a picture");
    Ok(panorama.words().to_vec())
}

#[test]
fn a_picture_lies_beside_the_preset_or_below_or_is_one_of_the_gallery() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir(folder.path().join("light")).expect("a folder");
    for name in ["a.hdr", "light/b.HDR"] {
        fs::write(folder.path().join(name), picture(2.0)).expect("a file");
        loaded(&naming(folder.path(), name)).expect("a picture");
    }
    let file = naming(folder.path(), "hall.hdr");
    loaded(&file).expect("a picture of the gallery");
    assert_eq!(
        surroundings::known(file.path.as_deref()),
        ["a.hdr", "hall.hdr"]
    );
    let outside = tempfile::tempdir().expect("a folder");
    fs::write(outside.path().join("c.hdr"), picture(2.0)).expect("a file");
    fs::write(folder.path().join("notes.txt"), "secret").expect("a file");
    fs::write(folder.path().join("cut.hdr"), &picture(2.0)[..90]).expect("a file");
    let mut refused = vec![
        (
            "../c.hdr",
            "../c.hdr, the picture of scene.surroundings, lies outside of the folder of the preset",
        ),
        ("/c.hdr", "lies outside of the folder"),
        ("notes.txt", "is no .hdr file"),
        ("none.hdr", "put the .hdr beside the preset"),
        ("cut.hdr", "is cut off in line "),
        (
            "data:image/vnd.radiance;base64,#",
            "the picture inside the preset, the picture of scene.surroundings, is cut off or garbled",
        ),
    ];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(outside.path().join("c.hdr"), folder.path().join("link.hdr"))
            .expect("a link");
        refused.push(("link.hdr", "is a link that leads out of the folder"));
    }
    for (named, said) in refused {
        let error = loaded(&naming(folder.path(), named))
            .expect_err(named)
            .to_string();
        assert!(
            error.contains(said) && !error.contains('\n'),
            "{named}: {error}"
        );
    }
    // Neither is taken along.
    for named in ["notes.txt", "../c.hdr"] {
        assert_eq!(naming(folder.path(), named).shared_surroundings(), named);
    }
}

#[test]
fn a_preset_that_is_saved_elsewhere_has_its_picture_there() {
    let folder = tempfile::tempdir().expect("a folder");
    for part in ["old/light", "new", "other/light"] {
        fs::create_dir_all(folder.path().join(part)).expect("a folder");
    }
    let place = |name: &str| folder.path().join(name);
    fs::write(place("old/light/a.hdr"), picture(3.0)).expect("a file");
    fs::write(place("other/light/a.hdr"), picture(1.0)).expect("a file");
    let file = naming(&place("old"), "light/a.hdr");
    let words = loaded(&file).expect("a picture");
    for (to, is_named) in [
        ("new/b.toml", true),
        ("old/b.toml", true),
        ("other/b.toml", false),
    ] {
        let mut saved = file.clone();
        preset_file::save(&mut saved, &place(to)).expect("it is saved");
        assert_eq!(loaded(&saved).expect("a picture"), words, "{to}");
        assert_eq!(saved.preset.surroundings == "light/a.hdr", is_named, "{to}");
    }
    assert_eq!(
        fs::read(place("other/light/a.hdr")).expect("it stays"),
        picture(1.0)
    );
}

#[test]
fn a_shared_preset_brings_its_picture_and_a_look_takes_it_to_another_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("a.hdr"), picture(3.0)).expect("a file");
    let file = naming(folder.path(), "a.hdr");
    let words = loaded(&file).expect("a picture");
    let shared = from_line(&to_line(&file)).expect("a preset");
    assert_eq!(loaded(&shared).expect("the picture inside"), words);
    assert_eq!(to_line(&shared), to_line(&file));
    let own = preset_file::PresetFile::of_scene(
        "own",
        rasterlab::preset::SceneSource::Builtin("teapot".into()),
    );
    let landed = file.landed_on(&own, None);
    assert_eq!(loaded(&landed).expect("the picture inside"), words);
    // A picture that changes is prepared again.
    fs::write(folder.path().join("a.hdr"), picture(4.0)).expect("a file");
    assert_ne!(loaded(&file).expect("a picture"), words);
}

/// Light that comes to the middle of a hall from a direction: three windows in one wall, a floor of
/// boards that shines below them, plaster, and a light at the other end.
fn hall(d: DVec3) -> DVec3 {
    let half = DVec3::new(2.0, 1.2, 3.2);
    let reach = half / d.abs().max(DVec3::splat(1e-9));
    let distance = reach.min_element();
    let at = d * distance;
    // What the windows give a place: nearer places get more.
    let windows = DVec3::new(-half.x, 0.25, 0.0);
    let near = 1.0 / (1.0 + 0.35 * (at - windows).length_squared());
    let daylight = DVec3::new(1.0, 0.97, 0.9) * (0.12 + 0.9 * near);
    if distance == reach.y && d.y < 0.0 {
        let board = (at.x * 3.0).floor().rem_euclid(2.0);
        return daylight * DVec3::new(0.42, 0.26, 0.15) * (0.8 + 0.2 * board);
    }
    if distance == reach.y {
        return daylight * 0.8;
    }
    let along = (at.z + 2.4).rem_euclid(1.6) - 0.8;
    if distance == reach.x && d.x < 0.0 && along.abs() < 0.5 && (at.y - 0.25).abs() < 0.7 {
        let is_frame = along.abs() < 0.04 || (at.y - 0.25).abs() < 0.04;
        let sky = DVec3::new(5.5, 7.0, 9.0) * (0.7 + 0.4 * at.y);
        return if is_frame { daylight * 0.3 } else { sky };
    }
    if distance == reach.z && d.z > 0.0 && DVec3::new(at.x - 0.9, at.y + 0.1, 0.0).length() < 0.28 {
        return DVec3::new(9.0, 5.6, 2.6);
    }
    daylight * DVec3::new(0.74, 0.68, 0.58)
}

#[test]
fn the_picture_of_the_hall_is_what_its_arithmetic_says() {
    const SIZE: [usize; 2] = [96, 48];
    let direction = |i: usize| {
        let turn = std::f64::consts::TAU * (((i % SIZE[0]) as f64 + 0.5) / SIZE[0] as f64 - 0.5);
        let down = std::f64::consts::PI * ((i / SIZE[0]) as f64 + 0.5) / SIZE[1] as f64;
        let ((sin, cos), (right, ahead)) = (libm::sincos(down), libm::sincos(turn));
        DVec3::new(sin * right, cos, -sin * ahead)
    };
    let light: Vec<DVec3> = (0..SIZE[0] * SIZE[1]).map(|i| hall(direction(i))).collect();
    let bytes = radiance::write(SIZE, &light);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/hall.hdr");
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        fs::write(&path, &bytes).expect("presets/ is there");
    }
    assert!(bytes.len() <= 32 << 10, "{} bytes", bytes.len());
    assert!(
        fs::read(&path).is_ok_and(|there| there == bytes),
        "presets/hall.hdr is stale: UPDATE_SNAPSHOTS=1 writes it"
    );
}
