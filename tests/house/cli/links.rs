//! Promise: `link` prints a line that opens as the same preset, with the bits of its picture; what a
//! page cannot draw is refused or said; `page` writes one file that stands alone, and overwrites
//! nothing unasked.

use rasterlab::preset_file;

use super::*;

/// Its name is not as harmless in HTML as it looks.
const PLAIN: &str = "schema = 2\nname = \"<b>Plain & simple</b>\"\n[scene]\nbuiltin = \"cube-wall\"\n[output]\nsize = [32, 24]\n";

#[test]
fn a_link_opens_as_the_preset_and_carries_its_bits() {
    let place = Place::with([("plain.toml", PLAIN)]);
    let linked = place.run("link plain.toml --page https://example.org/lab/");
    assert_eq!((linked.code, linked.err.as_str()), (0, ""));
    let link = linked.out.trim();
    let line = link
        .strip_prefix("https://example.org/lab/#")
        .expect("the address of the page");
    let (_, bits) = line.split_once(';').expect("bits behind the line");
    let words: Vec<&str> = bits.split('-').collect();
    let is_word = |word: &&str| word.len() == 16 && u64::from_str_radix(word, 16).is_ok();
    assert!(words.len() == 2 && words.iter().all(is_word), "{bits}");
    let own = preset_file::parse(PLAIN, "plain").expect("a preset");
    for text in [link, line] {
        assert_eq!(
            preset_file::from_line(text).expect("a line").preset,
            own.preset
        );
    }
    place.play(&format!(
        "# Another picture has other bits.
        $ link plain.toml --set scene.spin_deg_per_s=5 --set clock.time_s=3
        >- {bits}
        $ link plain.toml --set wobble
        >- ;
        ! not bit by bit"
    ));
}

#[test]
fn a_page_stands_alone_and_overwrites_nothing_unasked() {
    let place = Place::with([("plain.toml", PLAIN)]);
    place.play("$ page plain.toml -o plain.html --page https://example.org/\"onload=\"x\n!=");
    let text = String::from_utf8(place.read("plain.html")).unwrap();
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
    place.play("$2 page plain.toml -o plain.html\n! --force");
    assert_eq!(place.read("plain.html"), text.as_bytes());
    place.play("$ page plain.toml -o plain.html --force");
    let replaced = String::from_utf8(place.read("plain.html")).unwrap();
    assert!(replaced.contains("http://localhost:8000/?embed#rasterlab1:"));
}
