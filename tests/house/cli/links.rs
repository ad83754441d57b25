//! Promise: `link` prints a line that opens as the same preset, with the bits of its picture; what a page cannot draw is refused or said; `page` writes one file that stands alone, and
//! overwrites nothing unasked.

use rasterlab::preset_file;

use super::*;

/// Its name is not as harmless in HTML as it looks.
const PLAIN: &str = "schema = 2\nname = \"<b>Plain & simple</b>\"\n[scene]\nbuiltin = \"cube-wall\"\n[output]\nsize = [32, 24]\n";

#[test]
fn a_link_opens_as_the_preset_and_carries_its_bits() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("plain.toml"), PLAIN).unwrap();
    let linked = run_in(
        folder.path(),
        &["link", "plain.toml", "--page", "https://example.org/lab/"],
    );
    assert_eq!((linked.code, linked.err.as_str()), (0, ""));
    let link = linked.out.trim();
    let line = link
        .strip_prefix("https://example.org/lab/#")
        .expect("the address of the page");
    let (_, bits) = line.split_once(';').expect("bits behind the line");
    let words: Vec<&str> = bits.split('-').collect();
    assert!(
        words.len() == 2
            && words
                .iter()
                .all(|word| word.len() == 16 && u64::from_str_radix(word, 16).is_ok()),
        "{bits}"
    );
    let [whole, cut] = [link, line].map(|text| preset_file::from_line(text).expect("a line"));
    let own = preset_file::parse(PLAIN, "plain").expect("a preset");
    assert_eq!((&whole.preset, &cut.preset), (&own.preset, &own.preset));

    let turned = run_in(
        folder.path(),
        &[
            "link",
            "plain.toml",
            "--set",
            "scene.spin_deg_per_s=5",
            "--set",
            "clock.time_s=3",
        ],
    );
    assert!(!turned.out.contains(bits), "another picture has other bits");
    let moved = run_in(folder.path(), &["link", "plain.toml", "--set", "wobble"]);
    assert_eq!((moved.code, moved.out.contains(';')), (0, false));
    assert!(moved.err.contains("not bit by bit"), "{}", moved.err);
}

#[test]
fn a_model_on_disk_has_no_link() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("a.gltf"),
        r#"{"asset":{"version":"2.0"}}"#,
    )
    .unwrap();
    for command in [&["link", "a.gltf"][..], &["page", "a.gltf", "-o", "a.html"]] {
        let refused = run_in(folder.path(), command);
        assert_eq!((refused.code, refused.out.as_str()), (2, ""));
        assert!(
            refused.err.contains("a page cannot read"),
            "{}",
            refused.err
        );
    }
    assert!(!folder.path().join("a.html").exists());
}

#[test]
fn a_page_stands_alone_and_overwrites_nothing_unasked() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("plain.toml"), PLAIN).unwrap();
    let write = |extra: &[&str]| {
        run_in(
            folder.path(),
            &[&["page", "plain.toml", "-o", "plain.html"], extra].concat(),
        )
    };
    let written = write(&["--page", "https://example.org/\"onload=\"x"]);
    assert_eq!((written.code, written.err.as_str()), (0, ""));
    let text = fs::read_to_string(folder.path().join("plain.html")).unwrap();
    for part in [
        "src=\"data:image/png;base64,iVBOR",
        "&lt;b&gt;Plain &amp; simple&lt;/b&gt;",
        "https://example.org/&quot;onload=&quot;x?embed#rasterlab1:",
    ] {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
    for name in [
        "{title}", "{page}", "{line}", "{png}", "{width}", "{height}",
    ] {
        assert!(!text.contains(name), "{name} is left");
    }
    let again = write(&[]);
    assert_eq!(again.code, 2);
    assert!(again.err.contains("--force"), "{}", again.err);
    assert_eq!(
        fs::read_to_string(folder.path().join("plain.html")).unwrap(),
        text
    );
    assert_eq!(write(&["--force"]).code, 0);
    let replaced = fs::read_to_string(folder.path().join("plain.html")).unwrap();
    assert!(replaced.contains("http://localhost:8000/?embed#rasterlab1:"));
}
