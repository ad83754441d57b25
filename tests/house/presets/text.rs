//! Promise: every section is read, only what differs from a default is written, and what a person
//! wrote keeps its form.

use std::path::Path;

use rasterlab::{
    effects::Effect,
    preset::{
        AccuracyRequest, Clock, PinnedOptions, Tier, Visibility,
        animation::{Easing, Keyframe, Track},
    },
    preset_file,
    scene::camera::Projection,
};

use super::*;

#[test]
fn the_example_of_every_section_is_read() {
    let preset_file = parse(
        r##"#:schema ./schema.json
schema = 2
name = "Ink on glass"
about = "Half facets"
tags = ["stylised", "stack"]
stack = ["lambert", "facet"]

[scene]
builtin = "cube-wall"
spin_deg_per_s = 30.0

[camera]
eye = [3.0, 2, 5.0]
target = [0.0, 0.5, 0.0]
fov_y_deg = 60

[clock]
time_s = 1.25
range_s = [0, 2.5]
loop = false
speed = 0.5

[animation.facet]
amount = [
    { time_s = 2, value = 1, easing = "linear" },
    { time_s = 0.0, value = 0.0 },
]
seed = [{ time_s = 1.0, value = 7 }]

[effects.facet]
amount = 0.8
pattern = "radial"
center = [1, 2, 3]

[effects.lambert]
sun = [0.5, 0.25, 1, 1]

[accuracy]
tier = "fast"
visibility = "packed64"

[output]
size = [64, 48]
background = [0.02, 0.02, 0.03, 1.0]

[test]
max_channel = 2
why = "because"
"##,
    );
    let s = &preset_file.preset;
    assert_eq!(preset_file.warnings, [""; 0]);
    assert_eq!((s.name.as_str(), s.tags.len()), ("Ink on glass", 2));
    assert_eq!(s.spin_deg_per_s, 30.0);
    assert_eq!(stack_names(&preset_file), ["lambert", "facet"]);
    let facet = s.stack.get("facet").unwrap();
    let field = |name: &str| facet.effect.field(name).unwrap();
    assert_eq!(field("amount").get(&facet.words), [f64::from(0.8f32)]);
    assert_eq!(field("pattern").get(&facet.words), [2.0]);
    assert_eq!(field("center").get(&facet.words), [1.0, 2.0, 3.0]);
    let projection = Projection::Perspective { fov_y_deg: 60.0 };
    assert_eq!(s.camera.unwrap().projection, projection);
    let clock = Clock {
        time_s: 1.25,
        range_s: [0.0, 2.5],
        is_looping: false,
        speed: 0.5,
    };
    assert_eq!(s.clock, clock);
    let easings = |field: &str| {
        let keys = s.animation.get("facet", field).unwrap().keys();
        keys.iter()
            .map(|key| (key.time_s, key.easing))
            .collect::<Vec<_>>()
    };
    assert_eq!(
        easings("amount"),
        [(0.0, Easing::Smooth), (2.0, Easing::Linear)]
    );
    assert_eq!(easings("seed"), [(1.0, Easing::Hold)]);
    // 0.625 of the way in time, by the smoothstep.
    let posed = s.evaluated_stack().get("facet").unwrap().words.clone();
    let smooth = 0.625f64 * 0.625 * (3.0 - 1.25);
    assert_eq!(field("amount").get(&posed), [f64::from(smooth as f32)]);
    assert_eq!(field("seed").get(&posed), [7.0]);
    let accuracy = AccuracyRequest {
        tier: Tier::Fast,
        pins: PinnedOptions::of(Visibility::Packed64),
        ..AccuracyRequest::default()
    };
    assert_eq!(s.accuracy, accuracy);
    assert_eq!(s.output.size, [64, 48]);
    assert_eq!(s.test.as_ref().unwrap().max_channel, 2);
}

#[test]
fn an_unmodified_preset_is_written_byte_for_byte() {
    let odd = "# mine\nschema=2\nname  =  'odd'   # spaced\n[effects]\n lambert = { sun = [1,1.0,0.50,1e0] } # inline\n\n[output]\nsize=[ 0x10, 1_0 ]\nx-own = 2024-01-01\n";
    assert_eq!(preset_file::to_toml(&parse(odd)), odd);
    for path in preset_files() {
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(
            preset_file::to_toml(&preset_file::load(&path).unwrap()),
            text,
            "{}",
            path.display()
        );
    }
}

#[test]
fn tables_and_inline_tables_say_the_same_keys() {
    let inline = parse(
        "schema = 2\n[effects.facet]\n[animation]\nfacet.amount = [{ time_s = 0, value = 0.5 }, { time_s = 1, value = 1 }]\n",
    );
    let tables = "schema = 2\n[effects.facet]\n[[animation.facet.amount]]\ntime_s = 0\nvalue = 0.5\n[[animation.facet.amount]]\ntime_s = 1\nvalue = 1\n";
    let mut tables = parse(tables);
    assert_eq!(inline.preset, tables.preset);
    let track = tables.preset.animation.get_mut("facet", "amount").unwrap();
    track.move_keyframe(1, 2.0);
    assert_eq!(parse(&preset_file::to_toml(&tables)).preset, tables.preset);
}

#[test]
fn keys_are_written_one_a_line_and_comments_stay_with_theirs() {
    let mut preset_file = parse("schema = 2\n[effects.facet]\n");
    let keys = [(0.0, 0.0, Easing::Smooth), (1.5, 0.1, Easing::Linear)];
    let keys = keys
        .map(|(time_s, value, easing)| Keyframe {
            time_s,
            value: vec![value],
            easing,
        })
        .to_vec();
    let facet = Effect::find("facet").unwrap();
    preset_file
        .preset
        .animation
        .put(Track::new(facet, facet.field("amount").unwrap(), keys).unwrap());
    let written = preset_file::to_toml(&preset_file);
    let wanted = "schema = 2\n[effects.facet]\n\n[animation.facet]\namount = [\n    { time_s = 0.0, value = 0.0 },\n    { time_s = 1.5, value = 0.1, easing = \"linear\" },\n]\n";
    assert_eq!(written, wanted);
    let mut preset_file = parse(&written.replace(
        "    { time_s = 1.5, value = 0.1",
        "    # the end\n    { time_s = 1.50, value = 0.10, mine = 7",
    ));
    let track = preset_file
        .preset
        .animation
        .get_mut("facet", "amount")
        .unwrap();
    track.move_keyframe(0, 0.25);
    track.set_easing(1, Easing::Out);
    let written = preset_file::to_toml(&preset_file);
    assert!(
        written.contains("{ time_s = 0.25, value = 0.0 }"),
        "{written}"
    );
    assert!(
        written
            .contains("# the end\n    { time_s = 1.50, value = 0.10, mine = 7, easing = \"out\" }"),
        "{written}"
    );
    preset_file::unset(&mut preset_file, "animation").unwrap();
    assert!(
        !preset_file::to_toml(&preset_file).contains("animation"),
        "{}",
        preset_file::to_toml(&preset_file)
    );
}

#[test]
fn schema_json_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets/schema.json");
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(&path, preset_file::schema::text()).unwrap();
    }
    let stored = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        stored == preset_file::schema::text(),
        "presets/schema.json is stale; UPDATE_SNAPSHOTS=1 cargo test --release --test house writes it"
    );
}

#[test]
fn the_schema_refuses_a_room_that_the_loader_refuses() {
    let schema: serde_json::Value = serde_json::from_str(&preset_file::schema::text()).unwrap();
    let room = &schema["properties"]["scene"]["properties"]["room"];
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    for value in [0.0, 0.1, 0.999, 1.0, 50.0, 100.0, 100.5] {
        let not = &room["not"];
        let is_between =
            value > number(&not["exclusiveMinimum"]) && value < number(&not["exclusiveMaximum"]);
        let allows =
            value >= number(&room["minimum"]) && value <= number(&room["maximum"]) && !is_between;
        let loads = preset_file::parse(
            &format!("schema = 2\n[scene]\nroom = {value:?}\n"),
            "preset",
        )
        .is_ok();
        assert_eq!(allows, loads, "{value}");
    }
}

#[test]
fn an_edit_of_one_value_neither_prints_nor_parses_a_whole_preset() {
    let source = include_str!("../../../crates/files/src/preset_file/edit.rs");
    for name in ["to_toml(", "parse(text", "parse_file(", "DocumentMut"] {
        assert!(
            !source.contains(name),
            "crates/files/src/preset_file/edit.rs uses {name}"
        );
    }
}
