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
