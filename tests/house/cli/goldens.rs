//! Promise: `bless` draws what `check` then accepts, and finds what every command finds.

use super::*;

#[test]
fn bless_draws_what_check_then_accepts() {
    let place = Place::new();
    place.play(
        r#"
        @ presets/mine.toml KNOT[effects.facet]\n[effects.lambert]\n
        $1 check presets/mine.toml --render CPU
        > mine.png is missing
        $1 bless --all --dry-run
        - tests
        $ bless --all
        > mine: new
        $ bless --all --dry-run
        $ check presets/mine.toml --render CPU --report r.html
        @ presets/mine.toml KNOT[effects.facet]\namount = 0.2\n[effects.lambert]\n
        $1 check presets/mine.toml --render CPU
        > pixels differ from the golden
        $ bless mine
        > pixels change, at most by
    "#,
    );
    let report = String::from_utf8(place.read("r.html")).unwrap();
    assert!(report.contains("data:image/png;base64,") && !report.contains("{{"));
}

#[test]
fn bless_finds_what_every_command_finds() {
    let place = Place::new();
    place.play(r#"
        $ new-effect ink
        # The folder of presets is made with the first one.
        $ new-effect wash
        $ bless wash
        $ check wash --render CPU
        @ presets/inked.toml name = 'Inked'\nKNOT[effects.ink]\n
        $ bless inked
        $ bless Inked --dry-run
        $ check inked --render CPU
        $ verify inked CPU
        $ render inked CPU
        $ list presets
        > the folder presets here
        # A preset without a test gets one in its file, since it was named.
        @ bare.toml schema = 2\n[scene]\nbuiltin = "knot?tess=3"\n[effects.ink]\n[output]\nsize = [64, 48]\n
        $ bless bare.toml
        # An effect without a preset gets its first one.
        $ bless ink
        > (its preset is created, too)
        $ check ink --render CPU
        $2 bless no-such-effect
        ! no preset and no effect
    "#);
    let catalog = rasterlab::effect_files::Catalog::of_folders([&*place.at("effects")]);
    for name in ["bare.toml", "presets/ink.toml"] {
        let tested = rasterlab::preset_file::load_with(&place.at(name), &catalog);
        assert!(
            tested.is_ok_and(|tested| tested.preset.test.is_some()),
            "{name}"
        );
    }
}
