//! Promise: a shared line and a saved picture give their preset back; hostile ones are refused.

use rasterlab::{
    preset::SceneSource,
    preset_file::{self, PresetFile},
};

use super::*;

#[test]
fn a_shared_line_gives_the_preset_back() {
    let mut preset_file =
        parse("schema = 2\nname = \"Tinte ✒\"\n[effects.facet]\namount = 0.1\n# kept\n");
    preset_file.preset.clock.time_s = 0.1;
    let line = preset_file::to_line(&preset_file);
    assert!(line.starts_with("rasterlab1:") && !line.contains('\n'));
    let (head, tail) = line.split_at(30);
    let back = preset_file::from_line(&format!("  {head}\n{tail} ")).unwrap();
    assert_eq!(bits(&back.preset), bits(&preset_file.preset));
    assert!(preset_file::to_toml(&back).contains("# kept"));
}

#[test]
fn the_text_of_a_file_is_pasted_as_it_is() {
    let text = "# Tinte\n[effects.facet] # half\namount = 0.25\n";
    assert!(preset_file::is_preset_text(text));
    let pasted = preset_file::from_line(text).unwrap();
    assert_eq!(bits(&pasted.preset), bits(&parse(text).preset));
    let values = [
        "[0.1, 0.2, 0.3, 1.0]",
        "[\"ink\", \"lambert\"]",
        "0.5",
        "amount",
    ];
    for value in values {
        assert!(!preset_file::is_preset_text(value), "{value}");
    }
}

#[test]
fn hostile_shared_lines_are_refused() {
    use std::io::Write as _;
    let pack = |bytes: &[u8]| {
        let mut deflate =
            flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::best());
        deflate.write_all(bytes).unwrap();
        use base64::Engine as _;
        format!(
            "rasterlab1:{}",
            base64::engine::general_purpose::STANDARD.encode(deflate.finish().unwrap())
        )
    };
    let bomb = preset_file::from_line(&pack(&vec![b' '; 64 << 20]))
        .unwrap_err()
        .to_string();
    assert!(bomb.contains("more than 1 MiB"), "{bomb}");
    // A model outside of the folder is named, and nothing of it is read before it is allowed.
    for path in [
        "../secret.glb",
        "/etc/passwd",
        "a/../../b.glb",
        "C:\\x.glb",
        "..\\x.glb",
    ] {
        let line = pack(format!("schema = 2\n[scene]\npath = '{path}'\n").as_bytes());
        let held = preset_file::from_line(&line).unwrap();
        let model = held.outside_model.clone().expect(path);
        assert!(model.is_absolute() && !model.to_string_lossy().contains("/../"));
        assert!(!matches!(held.preset.scene, SceneSource::File(_)), "{path}");
        assert_eq!(
            held.with_outside_model().preset.scene,
            SceneSource::File(model)
        );
    }
    for line in [
        "",
        "rasterlab2:AAAA",
        "rasterlab1:",
        "rasterlab1:!!",
        "rasterlab1:AAAA",
    ] {
        assert!(
            preset_file::from_line(line).is_err() || line == "rasterlab1:",
            "{line}"
        );
    }
}

#[test]
fn a_saved_picture_gives_its_preset_back_and_a_bare_one_says_so() {
    let preset_file = parse("schema = 2\nname = \"Tinte ✒\"\n[effects.facet]\namount = 0.1\n");
    let frame = rasterlab::frame::Frame {
        width: 2,
        height: 1,
        color: vec![[1, 2, 3, 255], [4, 5, 6, 255]],
        ..Default::default()
    };
    let provenance = preset_file::Provenance {
        adapter: "cpu".into(),
        driver: "none".into(),
    };
    let png = preset_file::png_with_preset(&frame, &preset_file, &provenance).unwrap();
    let back = preset_file::preset_from_png(&png, "shot.png").unwrap();
    assert_eq!(back.preset, preset_file.preset);
    let bare = preset_file::png_bytes(&frame.color, [2, 1]).unwrap();
    assert!(
        preset_file::preset_from_png(&bare, "bare.png")
            .unwrap_err()
            .to_string()
            .contains("bare")
    );
    assert!(preset_file::preset_from_png(b"no png", "x.png").is_err());
    assert!(preset_file::png_bytes(&[], [0, 1]).is_err());
}

#[test]
fn a_line_and_a_picture_name_their_model_wherever_they_are_opened() {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("models/fox.glb");
    let mut preset_file =
        PresetFile::of_scene("fox", SceneSource::File("../models/fox.glb".into()));
    preset_file.path = Some(folder.path().join("presets/fox.toml"));
    let pasted = preset_file::from_line(&preset_file::to_line(&preset_file)).unwrap();
    assert_eq!(pasted.outside_model.as_deref(), Some(model.as_path()));

    let frame = rasterlab::frame::Frame {
        width: 1,
        height: 1,
        color: vec![[1, 2, 3, 255]],
        ..Default::default()
    };
    let picture = folder.path().join("pictures/shot.png");
    std::fs::create_dir(folder.path().join("pictures")).unwrap();
    let png = preset_file::png_with_preset(
        &frame,
        &preset_file.for_picture(&picture),
        &preset_file::Provenance::default(),
    )
    .unwrap();
    std::fs::write(&picture, png).unwrap();
    let open = || preset_file::open(&picture.to_string_lossy(), &Default::default()).unwrap();
    assert_eq!(open().outside_model.as_deref(), Some(model.as_path()));
    // One of its name beside the picture is nearer.
    std::fs::write(folder.path().join("pictures/fox.glb"), "").unwrap();
    assert_eq!(open().outside_model, None);
    assert_eq!(open().preset.scene, SceneSource::File("fox.glb".into()));
}
