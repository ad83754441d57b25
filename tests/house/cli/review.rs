//! Promise: `review` lists the presets whose picture is not their golden, with numbers and their
//! pictures, and nothing else.

use super::*;

#[test]
fn what_differs_from_its_golden_is_listed_with_numbers_and_pictures() {
    let place = Place::new();
    let transcript = r#"
        @ presets/one.toml HEAD
        @ presets/two.toml HEAD
        @ presets/three.toml HEAD
        $ bless one two
        $ review one two
        >=
        ! none of 2 presets differs
        # A budget is for adapters: what the oracle draws is exact.
        @ presets/one.toml HEADmax_channel = 255\nwhy = "all"\n
        @ presets/two.toml HEAD[effects.posterize]\n
        SPLIT
        == found/two.golden.png presets/snapshots/two.png
        + found/two.difference.png
        - found/three.now.png
        # What was written is accepted as it is.
        $ bless two
        == found/two.now.png presets/snapshots/two.png
        # Nothing is overwritten.
        $2 review three -o found
        $1 review one three --json
        /results/0/preset "three"
        /results/1 null
    "#;
    let head = r#"schema = 2\n[scene]\nbuiltin = "knot?tess=3"\n[effects.lambert]\n[output]\nsize = [64, 48]\n[test]\n"#;
    let transcript = transcript.replace("HEAD", head);
    let (before, after) = transcript.split_once("SPLIT").unwrap();
    place.play(before);
    let found = place.run("review one two three -o found");
    assert!(
        found.code == 1 && found.err.contains("2 of 3 presets differ"),
        "{}",
        found.err
    );
    place.play(after);
    let listed = found.out;
    assert_eq!(place.read("found/review.txt"), listed.as_bytes());
    let lines: Vec<&str> = listed.lines().collect();
    assert_eq!(lines.len(), 2, "{listed}");
    assert!(lines[0].starts_with("three: ") && lines[0].contains("three.png is missing"));
    assert!(
        lines[1].starts_with("two: ") && lines[1].contains(" of 3072 pixels differ, at most by "),
        "{listed}"
    );
}
