//! Promise: presets survive a round trip to the bit, keep unknown keys, load from every older schema, and refuse harmful values.

use std::path::{Path, PathBuf};

use proptest::prelude::*;
use rasterlab::{
    effects::{EFFECTS, Effect},
    params::ValueType,
    preset::{
        AccuracyRequest, Animation, ClipPlayback, Clock, GoldenTest, Output, PinnedOptions, Preset, SceneSource, Tier, Visibility,
        animation::{Easing, Keyframe, MAX_KEYFRAMES, Track, steps},
    },
    preset_file::{self, PresetError, PresetFile},
    scene::camera::{Camera, MIN_NEAR_M, Projection},
};

fn parse(text: &str) -> PresetFile {
    preset_file::parse(text, "preset").unwrap_or_else(|error| panic!("{error}"))
}

fn refusal(text: &str) -> String {
    match preset_file::parse(text, "preset") {
        Err(error) => error.to_string(),
        Ok(_) => panic!("this should have been refused:\n{text}"),
    }
}

/// Everything in a session as bits and words, so that -0.0 and 0.0 differ.
fn bits(preset: &Preset) -> String {
    format!("{preset:?}")
}

fn preset_files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("presets");
    let files = std::fs::read_dir(folder).expect("presets/ is there").map(|entry| entry.unwrap().path());
    files.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect()
}

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
    assert_eq!(preset_file.warnings, Vec::<String>::new());
    assert_eq!((s.name.as_str(), s.tags.len(), s.spin_deg_per_s, s.clock.time_s), ("Ink on glass", 2, 30.0, 1.25));
    assert_eq!(s.stack.0.iter().map(|e| e.effect.name).collect::<Vec<_>>(), ["lambert", "facet"]);
    let facet = s.stack.get("facet").unwrap();
    let value = |name: &str| facet.effect.field(name).unwrap().get(&facet.words);
    assert_eq!((value("amount"), value("pattern"), value("center")), (vec![f64::from(0.8f32)], vec![2.0], vec![1.0, 2.0, 3.0]));
    assert_eq!(s.camera.unwrap().projection, Projection::Perspective { fov_y_deg: 60.0 });
    assert_eq!(s.clock, Clock { time_s: 1.25, range_s: [0.0, 2.5], is_looping: false, speed: 0.5 });
    let amount = s.animation.get("facet", "amount").unwrap();
    assert_eq!(
        amount.keys().iter().map(|key| (key.time_s, key.easing)).collect::<Vec<_>>(),
        [(0.0, Easing::Smooth), (2.0, Easing::Linear)]
    );
    assert_eq!(s.animation.get("facet", "seed").unwrap().keys()[0].easing, Easing::Hold);
    // 0.625 of the way in time, by the smoothstep.
    let posed = s.evaluated_stack().get("facet").unwrap().words.clone();
    assert_eq!(facet.effect.field("amount").unwrap().get(&posed), [f64::from((0.625f64 * 0.625 * (3.0 - 1.25)) as f32)]);
    assert_eq!(facet.effect.field("seed").unwrap().get(&posed), [7.0]);
    assert_eq!(
        s.accuracy,
        AccuracyRequest { tier: Tier::Fast, pins: PinnedOptions::of(Visibility::Packed64), ..AccuracyRequest::default() }
    );
    assert_eq!(s.output.size, [64, 48]);
    assert_eq!(s.test.as_ref().unwrap().max_channel, 2);
}

#[test]
fn an_unmodified_look_is_written_byte_for_byte() {
    let odd = "# mine\nschema=2\nname  =  'odd'   # spaced\n[effects]\n lambert = { sun = [1,1.0,0.50,1e0] } # inline\n\n[output]\nsize=[ 0x10, 1_0 ]\nx-own = 2024-01-01\n";
    assert_eq!(preset_file::to_toml(&parse(odd)), odd);
    for path in preset_files() {
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(preset_file::to_toml(&preset_file::load(&path).unwrap()), text, "{}", path.display());
    }
}

#[test]
fn comments_and_unknown_keys_survive_a_change() {
    let text = "# head\nschema = 2\n# why\nfuture = { a = 1 }\n\n[camera] # pose\neye = [1.0, 2.0, 3.0] # high\nup = [0.0, 1.0, 0.5]\n\n[effects.facet]\n# half\namount = 0.5 # of the way\n\n[effects.later]\nx = 1\n# tail\n";
    let mut preset_file = parse(text);
    preset_file::set(&mut preset_file, "facet.amount", ".25").unwrap();
    preset_file::set(&mut preset_file, "camera.eye", "[1, 2, 4]").unwrap();
    preset_file::unset(&mut preset_file, "camera.up").unwrap();
    let written = preset_file::to_toml(&preset_file);
    let wanted =
        text.replace("amount = 0.5 #", "amount = 0.25 #").replace("3.0] # high", "4.0] # high").replace("up = [0.0, 1.0, 0.5]\n", "");
    assert_eq!(written, wanted);
    preset_file::unset(&mut preset_file, "facet.amount").unwrap();
    assert!(preset_file::to_toml(&preset_file).contains("# half\namount = 1.0 # of the way"), "a commented line is kept with its default");
}

#[test]
fn only_differences_from_defaults_are_written() {
    let mut preset_file = PresetFile::new("new", Preset::default());
    assert_eq!(preset_file::to_toml(&preset_file), "schema = 2\n");
    preset_file::set(&mut preset_file, "facet", "").unwrap();
    preset_file::set(&mut preset_file, "lambert.headlight", "0.2").unwrap();
    preset_file::set(&mut preset_file, "accuracy.tier", "draft").unwrap();
    preset_file::set(&mut preset_file, "camera", "").unwrap();
    assert_eq!(
        preset_file::to_toml(&preset_file),
        "schema = 2\n\n[camera]\n\n[effects.facet]\n\n[effects.lambert]\nheadlight = 0.2\n\n[accuracy]\ntier = \"draft\"\n"
    );
    for path in ["effects.lambert.headlight", "accuracy", "camera", "facet", "lambert"] {
        preset_file::unset(&mut preset_file, path).unwrap();
    }
    assert_eq!(preset_file::to_toml(&preset_file), "schema = 2\n");
}

#[test]
fn the_stack_key_is_written_only_where_order_is_unusual() {
    let mut preset_file = parse("schema = 2\n[effects.facet]\n[effects.lambert]\n");
    preset_file.preset.stack.0.reverse();
    let written = preset_file::to_toml(&preset_file);
    assert!(written.contains("stack = [\"lambert\", \"facet\"]"), "{written}");
    let mut again = parse(&written);
    assert_eq!(again.preset, preset_file.preset);
    again.preset.stack.0.reverse();
    assert!(!preset_file::to_toml(&again).contains("stack"));
    preset_file::set(&mut preset_file, "stack", "[\"facet\", \"lambert\"]").unwrap();
    assert!(preset_file.preset.stack.is_canonical());
}

#[test]
fn the_stack_key_names_each_enabled_effect_exactly_once() {
    let with = |stack: &str| format!("schema = 2\nstack = {stack}\n[effects.facet]\n[effects.lambert]\n");
    assert_eq!(refusal(&with("[\"facet\"]")), "preset.toml:2: stack leaves out lambert, which is enabled");
    assert_eq!(refusal(&with("[\"facet\", \"lambert\", \"facet\"]")), "preset.toml:2: stack names facet twice");
    assert!(refusal(&with("[\"facet\", \"lambert\", \"depth\"]")).contains("names depth, which is not enabled"));
    assert!(refusal(&with("[\"fascet\", \"lambert\"]")).contains("did you mean \"facet\"?"));
    assert!(refusal(&with("\"facet\"")).contains("must be a list of effect names"));
}

#[test]
fn errors_name_line_key_value_and_range() {
    let cases = [
        ("schema = 2\n[effects.facet]\namount = -1\n", "preset.toml:3: effects.facet.amount -1 lies outside 0..=1"),
        (
            "schema = 2\n[effects.facet]\namount = 1e39\n",
            "preset.toml:3: effects.facet.amount 1e39 is too large for a 32-bit float, which ends at 3.4028235e38",
        ),
        ("schema = 2\n[effects.facet]\namount = nan\n", "preset.toml:3: effects.facet.amount nan is not a finite number"),
        ("schema = 2\n[effects.facet]\nseed = 1.5\n", "preset.toml:3: effects.facet.seed 1.5 must be a whole number"),
        ("schema = 2\n[effects.facet]\nseed = -1\n", "preset.toml:3: effects.facet.seed -1 lies outside 0..=4294967295"),
        (
            "schema = 2\n[effects.facet]\npattern = \"radail\"\n",
            "preset.toml:3: effects.facet.pattern \"radail\" is not one of uniform, sweep, radial, random; did you mean \"radial\"?",
        ),
        (
            "schema = 2\n[effects.facet]\ncenter = [1, 2]\n",
            "preset.toml:3: effects.facet.center must be a list of 3 numbers, not a list of 2",
        ),
        ("schema = 2\n[effects.depth]\nfit = 1\n", "preset.toml:3: effects.depth.fit must be true or false, not a number"),
        ("schema = 2\n[output]\nsize = [16385, 1]\n", "preset.toml:3: output.size 16385 lies outside 0..=16384"),
        ("schema = 2\n[camera]\nfov_y_deg = 180\n", "preset.toml:3: camera.fov_y_deg 180 lies outside 1..=179"),
        ("schema = 2\n[camera]\neye = [0, inf, 0]\n", "preset.toml:3: camera.eye inf is not a finite number"),
        ("schema = 2\n[camera]\neye = [0, 1e10, 0]\n", "preset.toml:3: camera.eye 1e10 lies outside -1e9..=1e9"),
        (
            "schema = 2\n[accuracy]\ntier = 3\n",
            "preset.toml:3: accuracy.tier must be one of draft, fast, precise, reference, strict, not a number",
        ),
        ("schema = 2\n[test]\nmax_pixels = 9\n", "preset.toml:2: test.why must say why the budget is above the default"),
        (
            "schema = 2\n[test]\nmax_wrong_owner = 9\nwhy = \"because\"\n",
            "preset.toml:2: test.max_wrong_triangles must be 0 here; it needs a pinned option that is not exact, or the tier draft or fast",
        ),
        (
            "schema = 2\n[accuracy]\nvisibility = \"race\"\n[test]\nmax_wrong_owner = 9\n",
            "preset.toml:4: test.why must say why the budget is above the default",
        ),
        ("schema = 2\nname = \"\\u001b[31m\"\n", "preset.toml:2: name contains the control character '\\u{1b}'"),
        ("schema = 2\neffects = 3\n", "preset.toml:2: effects must be a table, written [effects]"),
        ("schema = 2\neffects.facet = true\n", "preset.toml:2: effects.facet must be a table, written [effects.facet]"),
        ("schema = 2\n[[camera]]\n", "preset.toml:2: camera must be a table, written [camera]"),
        ("schema = 0\n", "preset.toml:1: schema must be a whole number from 1 up"),
        ("schema = 2\n[scene]\npath = \"https://example.org/a.glb\"\n", "preset.toml:3: scene.path must be a file, not an address"),
        ("schema = 2\n[scene]\npath = \"a.glb\"\nbuiltin = \"knot\"\n", "preset.toml:3: scene.path and scene.builtin exclude each other"),
    ];
    for (text, wanted) in cases {
        assert_eq!(refusal(text), wanted);
    }
}

#[test]
fn keys_that_cannot_be_are_refused_by_name() {
    let with = |keys: &str| format!("schema = 2\n[effects.facet]\n[animation.facet]\namount = {keys}\n");
    let many = format!("[{}]", (0..=MAX_KEYFRAMES).map(|i| format!("{{ time_s = {i}, value = 0 }}")).collect::<Vec<_>>().join(", "));
    for (text, wanted) in [
        (with("[{ time_s = 0, value = 2 }]"), "preset.toml:4: animation.facet.amount keyframe 1: value 2 lies outside 0..=1"),
        (with("[{ time_s = 0, value = nan }]"), "preset.toml:4: animation.facet.amount keyframe 1: value nan is not a finite number"),
        (with("[{ time_s = 0, value = 1e-46 }]"), "value 1e-46 is too small for a 32-bit float"),
        (with("[{ time_s = 2e9, value = 0 }]"), "keyframe 1: time_s 2e9 lies outside -1e9..=1e9"),
        (
            with("[{ time_s = 0, value = 0 },\n { time_s = -0.0, value = 1 }]"),
            "preset.toml:5: animation.facet.amount keyframe 2: there is already a keyframe at time_s -0",
        ),
        (
            with("[{ time_s = 0, value = 0, easing = \"smoth\" }]"),
            "\"smoth\" is not one of hold, linear, smooth, in, out; did you mean \"smooth\"?",
        ),
        (with("[{ time_s = 0 }]"), "preset.toml:4: animation.facet.amount keyframe 1 must have time_s and value"),
        (with("[{}]"), "animation.facet.amount keyframe 1 must have time_s and value"),
        (with("[]"), "preset.toml:4: animation.facet.amount must be a list of 1 to 256 keyframes"),
        (with(&many), "must be a list of 1 to 256 keyframes"),
        (with("[0.5]"), "must be a list of 1 to 256 keyframes"),
        (with("3"), "must be a list of 1 to 256 keyframes"),
        (
            "schema = 2\n[effects.facet]\n[animation.facet]\nseed = [{ time_s = 0, value = 1, easing = \"linear\" }]\n".into(),
            "keyframe 1: easing must be hold, not linear",
        ),
        (
            "schema = 2\n[effects.facet]\n[animation.facet]\ncenter = [{ time_s = 0, value = 1 }]\n".into(),
            "value must be a list of 3 numbers",
        ),
        ("schema = 2\nanimation = 3\n".into(), "preset.toml:2: animation must be a table, written [animation]"),
        ("schema = 2\n[animation]\nfacet = 3\n".into(), "preset.toml:3: animation.facet must be a table, written [animation.facet]"),
        ("schema = 2\n[clock]\nrange_s = [2, 2]\n".into(), "preset.toml:3: clock.range_s must rise, but 2 is not before 2"),
        ("schema = 2\n[clock]\nspeed = 0\n".into(), "preset.toml:3: clock.speed 0 lies outside 0.01..=100"),
    ] {
        let said = refusal(&text);
        assert!(said.contains(wanted), "{said}");
    }
}

#[test]
fn keys_of_what_is_not_there_warn_and_stay() {
    let text = "schema = 2\n[animation.facet]\namount = [{ time_s = 0, value = 1, note = 3 }]\namuont = []\n[animation.fascet]\nx = 1\n";
    let preset_file = parse(text);
    let warnings = preset_file.warnings.join("\n");
    for wanted in [
        "preset.toml:2: animation.facet moves nothing; add [effects.facet]",
        "preset.toml:3: unknown key animation.facet.amount keyframe 1: note",
        "preset.toml:4: unknown key animation.facet.amuont; did you mean \"amount\"?",
        "preset.toml:5: unknown key animation.fascet; did you mean \"facet\"?",
    ] {
        assert!(warnings.contains(wanted), "{wanted:?} is not among\n{warnings}");
    }
    assert!(preset_file.preset.evaluated_stack().0.is_empty());
    assert_eq!(preset_file::to_toml(&preset_file), text);
}

#[test]
fn tables_and_inline_tables_say_the_same_keys() {
    let inline =
        parse("schema = 2\n[effects.facet]\n[animation]\nfacet.amount = [{ time_s = 0, value = 0.5 }, { time_s = 1, value = 1 }]\n");
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
    let keys = keys.map(|(time_s, value, easing)| Keyframe { time_s, value: vec![value], easing }).to_vec();
    let facet = Effect::find("facet").unwrap();
    preset_file.preset.animation.put(Track::new(facet, facet.field("amount").unwrap(), keys).unwrap());
    let written = preset_file::to_toml(&preset_file);
    let wanted = "schema = 2\n[effects.facet]\n\n[animation.facet]\namount = [\n    { time_s = 0.0, value = 0.0 },\n    { time_s = 1.5, value = 0.1, easing = \"linear\" },\n]\n";
    assert_eq!(written, wanted);
    let mut preset_file =
        parse(&written.replace("    { time_s = 1.5, value = 0.1", "    # the end\n    { time_s = 1.50, value = 0.10, mine = 7"));
    let track = preset_file.preset.animation.get_mut("facet", "amount").unwrap();
    track.move_keyframe(0, 0.25);
    track.set_easing(1, Easing::Out);
    let written = preset_file::to_toml(&preset_file);
    assert!(written.contains("{ time_s = 0.25, value = 0.0 }"), "{written}");
    assert!(written.contains("# the end\n    { time_s = 1.50, value = 0.10, mine = 7, easing = \"out\" }"), "{written}");
    preset_file::unset(&mut preset_file, "animation").unwrap();
    assert!(!preset_file::to_toml(&preset_file).contains("animation"), "{}", preset_file::to_toml(&preset_file));
}

#[test]
fn set_animates_and_a_value_set_by_hand_holds_still() {
    let mut preset_file = PresetFile::new("new", Preset::default());
    preset_file::set(&mut preset_file, "animation.facet.amount", "[{ time_s = 0, value = 0 }, { time_s = 1, value = 1 }]").unwrap();
    preset_file::set(&mut preset_file, "clock.range_s", "[1, 2]").unwrap();
    assert!(preset_file.preset.is_moving() && preset_file.preset.stack.get("facet").is_some());
    assert_eq!(parse(&preset_file::to_toml(&preset_file)).preset, preset_file.preset);
    for (path, value, wanted) in [
        ("animation.facet.amount", "[{ time_s = 0, value = 9 }]", "keyframe 1: value 9 lies outside 0..=1"),
        ("animation.facet.amount", "[", "--set animation.facet.amount=["),
        ("animation.facet", "1", "animation.facet takes no value"),
        ("animation.facet.amuont", "[]", "did you mean \"amount\"?"),
        ("animation.camera.eye", "[]", "is unknown; only parameters of effects can be animated"),
        ("clock.range_s", "[2, 1]", "clock.range_s must rise"),
    ] {
        let error = preset_file::set(&mut preset_file, path, value).unwrap_err().to_string();
        assert!(error.contains(wanted) && !error.contains('\n'), "{error}");
    }
    preset_file::set(&mut preset_file, "facet.amount", "0.5").unwrap();
    assert!(preset_file.preset.animation.is_empty() && !preset_file.preset.is_moving());
    for unset in ["animation.facet.amount", "animation.facet", "animation", "facet.amount", "facet"] {
        preset_file::set(&mut preset_file, "animation.facet.amount", "[{ time_s = 0, value = 0 }]").unwrap();
        preset_file::unset(&mut preset_file, unset).unwrap();
        assert!(preset_file.preset.animation.is_empty(), "{unset}");
    }
}

#[test]
fn a_syntax_error_names_its_line() {
    for (text, line) in [("schema = 2\nname = \n", 2), ("schema = 2\n\n[effects.facet\n", 3), ("schema = 2\nschema = 2\n", 2)] {
        let message = refusal(text);
        assert!(message.starts_with(&format!("preset.toml:{line}: ")), "{message}");
        assert!(!message.contains('\n'), "{message}");
    }
}

#[test]
fn unknown_keys_warn_with_a_suggestion_and_strictness_refuses_them() {
    let preset_file = parse("schema = 2\nnmae = 1\n[effects.fascet]\n[effects.lambert]\nsnu = 1\n[camera]\nfov = 3\n[otuput]\n");
    let warnings = preset_file.warnings.join("\n");
    for wanted in [
        "preset.toml:2: unknown key nmae; did you mean \"name\"?",
        "preset.toml:3: unknown key effects.fascet; did you mean \"facet\"?",
        "preset.toml:5: unknown key effects.lambert.snu; did you mean \"sun\"?",
        "preset.toml:7: unknown key camera.fov",
        "preset.toml:8: unknown key otuput; did you mean \"output\"?",
    ] {
        assert!(warnings.contains(wanted), "{wanted:?} is not among\n{warnings}");
    }
    assert!(matches!(preset_file.strict(), Err(PresetError::Strict(warnings)) if warnings.len() == 5));
    assert!(parse("name = \"x\"").warnings[0].contains("schema is missing"));
}

#[test]
fn a_newer_schema_opens_read_only_and_is_never_written() {
    let mut preset_file = parse("schema = 99\nname = \"new\"\n");
    assert!(preset_file.read_only && preset_file.warnings[0].contains("schema 99 is newer"));
    preset_file.preset.name = "changed".into();
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("copy.toml");
    assert!(matches!(preset_file::save(&mut preset_file, &target), Err(PresetError::ReadOnly { .. })));
    assert!(!target.exists());
}

#[test]
fn saving_is_atomic_and_leaves_an_unmodified_file_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    let mut preset_file = PresetFile::new("new", Preset::default());
    preset_file::save(&mut preset_file, &path).unwrap();
    assert_eq!((preset_file.id.as_str(), preset_file.path.as_deref()), ("mine", Some(path.as_path())));
    let stamp = |path: &Path| std::fs::metadata(path).unwrap().modified().unwrap();
    let before = stamp(&path);
    std::thread::sleep(std::time::Duration::from_millis(20));
    preset_file::save(&mut preset_file, &path).unwrap();
    assert_eq!(stamp(&path), before, "an unmodified preset was rewritten");
    preset_file::set(&mut preset_file, "name", "Changed").unwrap();
    preset_file::save(&mut preset_file, &path).unwrap();
    assert_eq!(preset_file::load(&path).unwrap().preset.name, "Changed");
    let names: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert_eq!(names, ["mine.toml"], "no temporary file is left behind");
}

#[test]
fn a_failed_save_keeps_the_old_file_and_the_unsaved_state() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept.toml");
    let mut preset_file = PresetFile::new("new", Preset { name: "old".into(), ..Preset::default() });
    preset_file::save(&mut preset_file, &path).unwrap();
    let mut permissions = std::fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).unwrap();
    preset_file.preset.name = "new".into();
    assert!(matches!(preset_file::save(&mut preset_file, &path), Err(PresetError::Write { .. })));
    assert!(preset_file.is_modified());
    assert_eq!(preset_file::load(&path).unwrap().preset.name, "old");
    assert!(matches!(preset_file::save(&mut preset_file, &folder.path().join("no/such/folder.toml")), Err(PresetError::Write { .. })));
}

#[test]
fn saving_elsewhere_keeps_the_way_to_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let (preset_files, deeper) = (folder.path().join("presets"), folder.path().join("presets/a/b"));
    std::fs::create_dir_all(&deeper).unwrap();
    let model = folder.path().join("scenes/fox.glb");
    let mut preset_file = PresetFile::of_scene("fox", SceneSource::File(model));
    preset_file::save(&mut preset_file, &preset_files.join("fox.toml")).unwrap();
    assert_eq!(preset_file.preset.scene, SceneSource::File("../scenes/fox.glb".into()));
    preset_file::save(&mut preset_file, &deeper.join("fox.toml")).unwrap();
    assert_eq!(preset_file.preset.scene, SceneSource::File("../../../scenes/fox.glb".into()));
    let absent = preset_file::load_scene(&preset_file.preset, preset_file.path.as_deref()).unwrap_err().to_string();
    assert!(absent.contains("fox.glb of the preset does not exist"), "{absent}");
}

#[test]
fn set_obeys_the_rules_of_files() {
    let mut preset_file = PresetFile::new("new", Preset::default());
    for (path, value, wanted) in [
        ("facet.amount", "2", "--set facet.amount=2: facet.amount 2 lies outside 0..=1"),
        ("facet.amount", "inf", "facet.amount inf is not a finite number"),
        ("facet.amuont", "1", "facet.amuont is unknown; did you mean \"amount\"?"),
        ("fascet.amount", "1", "did you mean \"facet.amount\"?"),
        ("output.size", "[1]", "output.size must be a list of 2 numbers"),
        ("facet", "1", "facet takes no value"),
        ("stack", "[\"facet\"]", "stack names facet, which is not enabled"),
    ] {
        let error = preset_file::set(&mut preset_file, path, value).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
    assert_eq!(preset_file.preset, Preset::default(), "a refused value changes nothing");
    for (path, value) in [
        ("effects.facet.pattern", "random"),
        ("depth.fit", "false"),
        ("name", "42"),
        ("scene.builtin", "teapot?tess=16"),
        ("tags", "[\"a\"]"),
    ] {
        preset_file::set(&mut preset_file, path, value).unwrap_or_else(|e| panic!("{e}"));
    }
    assert_eq!((preset_file.preset.name.as_str(), preset_file.preset.stack.0.len()), ("42", 2));
    assert_eq!(preset_file.preset.scene, SceneSource::Builtin("teapot?tess=16".into()));
    preset_file::set(&mut preset_file, "camera.orthographic_height_m", "3").unwrap();
    preset_file::unset(&mut preset_file, "camera.orthographic_height_m").unwrap();
    assert_eq!(preset_file.preset.camera, Some(Camera::default()));
}

/// A preset of schema 1 with every key and word that schema 2 renames, and the same in schema 2.
const SCHEMA_1: &str = include_str!("migrations/schema-1.toml");
const SCHEMA_2: &str = include_str!("migrations/schema-2.toml");

#[test]
fn a_preset_of_schema_1_loads_and_is_written_as_schema_2_with_its_comments() {
    let (old, new) = (parse(SCHEMA_1), parse(SCHEMA_2));
    assert_eq!((&old.warnings, &new.warnings), (&Vec::new(), &Vec::new()));
    assert_eq!(bits(&old.preset), bits(&new.preset));
    assert_eq!(preset_file::to_toml(&old), SCHEMA_2);
    assert!(!old.is_modified(), "a migration is no edit");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("old.toml");
    std::fs::write(&path, SCHEMA_1).unwrap();
    let migrated = preset_file::migrated(&path).unwrap();
    assert_eq!((migrated.from, migrated.before.as_str(), migrated.after.as_str()), (1, SCHEMA_1, SCHEMA_2));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), SCHEMA_1, "loading never rewrites a file");
}

#[test]
fn the_fixture_has_every_key_and_word_that_a_migration_renames() {
    for (owner, old, new) in preset_file::migrate::RENAMED_KEYS {
        for (text, key) in [(SCHEMA_1, old), (SCHEMA_2, new)] {
            let document: toml_edit::DocumentMut = text.parse().unwrap();
            let tables = [document.get(owner), document.get("effects").and_then(|effects| effects.get(owner))];
            assert!(tables.into_iter().flatten().any(|table| table.get(key).is_some()), "{owner}.{key} is missing in the fixture");
        }
    }
    for (_, _, old, new) in preset_file::migrate::RENAMED_WORDS {
        assert!(SCHEMA_1.contains(&format!("\"{old}\"")) && SCHEMA_2.contains(&format!("\"{new}\"")), "{old} -> {new}");
    }
}

#[test]
fn errors_of_an_older_schema_name_the_line_of_its_file() {
    assert_eq!(refusal("schema = 1\n\n[clock] # time\nloops = false\nspeed = 0\n"), "preset.toml:5: clock.speed 0 lies outside 0.01..=100");
    assert_eq!(
        refusal("schema = 1\n[accuracy]\ntaps = \"2\"\n"),
        "preset.toml:3: accuracy.shadow_taps \"2\" is not one of planned, 1, 9, 25"
    );
}

#[test]
fn a_line_and_a_picture_of_schema_1_load() {
    use base64::Engine as _;
    use std::io::Write as _;
    let mut deflate = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::best());
    deflate.write_all(SCHEMA_1.as_bytes()).unwrap();
    let line = format!("rasterlab1:{}", base64::engine::general_purpose::STANDARD.encode(deflate.finish().unwrap()));
    assert_eq!(preset_file::from_line(&line).unwrap().preset, parse(SCHEMA_2).preset);
    // As schema 1 wrote it: under another keyword.
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 1, 1);
    encoder.set_color(png::ColorType::Rgba);
    encoder.add_itxt_chunk("rasterlab look".into(), SCHEMA_1.into()).unwrap();
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[0; 4]).unwrap();
    writer.finish().unwrap();
    assert_eq!(preset_file::preset_from_png(&bytes, "old.png").unwrap().preset, parse(SCHEMA_2).preset);
}

#[test]
fn set_with_a_name_of_an_older_schema_suggests_the_new_one() {
    let mut preset_file = PresetFile::new("new", Preset::default());
    for (path, value, wanted) in [
        ("accuracy.vertices", "packed16", "accuracy.vertices is unknown; did you mean \"accuracy.position_format\"?"),
        ("accuracy.taps", "9", "did you mean \"accuracy.shadow_taps\"?"),
        ("accuracy.render_scale", "whole", "did you mean \"full\"?"),
        ("clock.loops", "true", "did you mean \"clock.loop\"?"),
    ] {
        let error = preset_file::set(&mut preset_file, path, value).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}");
    }
    assert_eq!(preset_file.preset, Preset::default());
}

#[test]
fn hostile_text_is_refused_without_harm() {
    let deep = format!("schema = 2\nx = {}{}\n", "[".repeat(100_000), "]".repeat(100_000));
    let long = format!("schema = 2\nname = \"{}\"\n", "x".repeat(2 << 20));
    let wide = format!("schema = 2\ntags = [{}]\n", "\"t\",".repeat(1000));
    let huge = "schema = 2\n[effects.facet]\nseed = 99999999999999999999\n".to_owned();
    for text in [deep, long, wide, huge, "\u{0}".into(), "schema = [1]".into(), "=".into(), "[]".into()] {
        assert!(preset_file::parse(&text, "hostile").is_err());
    }
    let folder = tempfile::tempdir().unwrap();
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, [0xff, 0xfe, 0x00]).unwrap();
    assert!(preset_file::load(&binary).unwrap_err().to_string().contains("not UTF-8"));
}

#[test]
fn a_shared_line_gives_the_look_back() {
    let mut preset_file = parse("schema = 2\nname = \"Tinte ✒\"\n[effects.facet]\namount = 0.1\n# kept\n");
    preset_file.preset.clock.time_s = 0.1;
    let line = preset_file::to_line(&preset_file);
    assert!(line.starts_with("rasterlab1:") && !line.contains('\n'));
    let (head, tail) = line.split_at(30);
    let back = preset_file::from_line(&format!("  {head}\n{tail} ")).unwrap();
    assert_eq!(bits(&back.preset), bits(&preset_file.preset));
    assert!(preset_file::to_toml(&back).contains("# kept"));
}

#[test]
fn hostile_shared_lines_are_refused() {
    use std::io::Write as _;
    let pack = |bytes: &[u8]| {
        let mut deflate = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::best());
        deflate.write_all(bytes).unwrap();
        use base64::Engine as _;
        format!("rasterlab1:{}", base64::engine::general_purpose::STANDARD.encode(deflate.finish().unwrap()))
    };
    let bomb = preset_file::from_line(&pack(&vec![b' '; 64 << 20])).unwrap_err().to_string();
    assert!(bomb.contains("more than 1 MiB"), "{bomb}");
    for path in ["../secret.glb", "/etc/passwd", "a/../../b.glb", "C:\\x.glb", "..\\x.glb"] {
        let line = pack(format!("schema = 2\n[scene]\npath = '{path}'\n").as_bytes());
        let error = preset_file::from_line(&line).unwrap_err().to_string();
        assert!(error.contains("leaves the folder of the preset"), "{path}: {error}");
    }
    for line in ["", "rasterlab2:AAAA", "rasterlab1:", "rasterlab1:!!", "rasterlab1:AAAA"] {
        assert!(preset_file::from_line(line).is_err() || line == "rasterlab1:", "{line}");
    }
}

#[test]
fn a_saved_picture_gives_its_look_back_and_a_bare_one_says_so() {
    let preset_file = parse("schema = 2\nname = \"Tinte ✒\"\n[effects.facet]\namount = 0.1\n");
    let frame = rasterlab::frame::Frame { width: 2, height: 1, color: vec![[1, 2, 3, 255], [4, 5, 6, 255]], ..Default::default() };
    let provenance = preset_file::Provenance { adapter: "cpu".into(), driver: "none".into() };
    let png = preset_file::png_with_preset(&frame, &preset_file, &provenance).unwrap();
    let back = preset_file::preset_from_png(&png, "shot.png").unwrap();
    assert_eq!(back.preset, preset_file.preset);
    let bare = preset_file::png_bytes(&frame.color, [2, 1]).unwrap();
    assert!(preset_file::preset_from_png(&bare, "bare.png").unwrap_err().to_string().contains("bare"));
    assert!(preset_file::preset_from_png(b"no png", "x.png").is_err());
    assert!(preset_file::png_bytes(&[], [0, 1]).is_err());
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
        "presets/schema.json is stale; UPDATE_SNAPSHOTS=1 cargo test --release --test presets writes it"
    );
}

fn finite_f32() -> impl Strategy<Value = f32> {
    any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |v| v.is_finite())
}

/// Any value that a key of this range may have, with a taste for its ends.
fn within(low: f64, high: f64) -> impl Strategy<Value = f64> {
    prop_oneof![Just(low), Just(high), low..=high, Just(0.0f64.clamp(low, high)), Just((-0.0f64).max(low))]
}

fn any_effect() -> impl Strategy<Value = (usize, u64)> {
    (0..EFFECTS.len(), any::<u64>())
}

/// Fills every field with values drawn from its hard range.
fn filled(effect: &'static Effect, seed: u64) -> Vec<u32> {
    let mut words = (effect.defaults)();
    let mut state = seed as u32;
    for field in effect.fields {
        let lanes: Vec<f64> = (0..field.value_type.components())
            .map(|_| {
                state = rasterlab::math::hash(state.wrapping_add(0x9e37_79b9));
                let [low, high] = field.hard;
                let value = low + (high - low) * f64::from(state) / f64::from(u32::MAX);
                match field.value_type {
                    ValueType::F32 | ValueType::Color | ValueType::Point if state.is_multiple_of(7) && (low..=high).contains(&-0.0) => -0.0,
                    ValueType::F32 | ValueType::Color | ValueType::Point => f64::from(value as f32).clamp(low, high),
                    _ => value.round(),
                }
            })
            .collect();
        field.set(&mut words, &lanes).unwrap();
    }
    words
}

prop_compose! {
    fn any_camera()(
        eye in prop::array::uniform3(within(-1e9, 1e9)),
        target in prop::array::uniform3(within(-1e9, 1e9)),
        up in prop::array::uniform3(within(-1e9, 1e9)),
        fov in prop::option::of(within(1.0, 179.0)),
        height in within(1e-6, 1e9),
        near_m in within(MIN_NEAR_M, 1e6),
    ) -> Camera {
        let projection = fov.map_or(Projection::Orthographic { height_m: height }, |fov_y_deg| Projection::Perspective { fov_y_deg });
        Camera { eye: eye.into(), target: target.into(), up: up.into(), projection, near_m }
    }
}

prop_compose! {
    fn any_clock()(time_s in within(-1e9, 1e9), from in within(-1e9, 0.0), to in within(1e-3, 1e9), is_looping in any::<bool>(), speed in within(0.01, 100.0)) -> Clock {
        Clock { time_s, range_s: [from, to], is_looping, speed }
    }
}

/// Time, seed of the value, easing.
type AnyKeyframe = (f64, u64, usize);

fn any_keyframes() -> impl Strategy<Value = Vec<AnyKeyframe>> {
    prop::collection::vec((within(-1e9, 1e9), any::<u64>(), 0..Easing::ALL.len()), 1..6)
}

/// Keys on parameters of the enabled effects.
fn animated(stack: &rasterlab::effects::Stack, tracks: Vec<(prop::sample::Index, prop::sample::Index, Vec<AnyKeyframe>)>) -> Animation {
    let mut animation = Animation::default();
    for (effect, field, keys) in tracks.into_iter().filter(|_| !stack.0.is_empty()) {
        let effect = stack.0[effect.index(stack.0.len())].effect;
        if effect.fields.is_empty() {
            continue;
        }
        let field = &effect.fields[field.index(effect.fields.len())];
        let mut frames: Vec<Keyframe> = Vec::new();
        for (time_s, seed, easing) in keys {
            let easing = if steps(field) { Easing::Hold } else { Easing::ALL[easing] };
            if !frames.iter().any(|frame| frame.time_s == time_s) {
                frames.push(Keyframe { time_s, value: field.get(&filled(effect, seed)), easing });
            }
        }
        animation.put(Track::new(effect, field, frames).expect("sound keys"));
    }
    animation
}

prop_compose! {
    fn any_playback()(
        names in prop::array::uniform2("[^\\p{Cc}]{0,20}"),
        speed in within(-100.0, 100.0),
        clip_time_s in prop::option::of(within(0.0, 1e9)),
        blend in within(0.0, 1.0),
    ) -> ClipPlayback {
        let [clip, second_clip] = names;
        ClipPlayback { clip, speed, clip_time_s, second_clip, blend }
    }
}

prop_compose! {
    fn any_preset()(
        texts in prop::array::uniform3("[^\\p{Cc}]{0,40}"),
        tags in prop::collection::vec("[a-z \"\\\\#']{0,12}", 0..4),
        scene in prop_oneof![Just(SceneSource::Builtin("knot?tess=8".into())), Just(SceneSource::File("a b/fox.glb".into())), Just(Preset::default().scene)],
        room in prop_oneof![Just(0.0), within(1.0, 100.0)],
        spin_deg_per_s in within(-1e6, 1e6),
        playback in any_playback(),
        camera in prop::option::of(any_camera()),
        clock in any_clock(),
        tracks in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), any_keyframes()), 0..5),
        effects in prop::collection::vec(any_effect(), 0..6),
        reversed in any::<bool>(),
        tier in 0..4usize,
        visibility in prop::option::of(0..2usize),
        size in prop::array::uniform2(0..=16_384u32),
        background in prop::array::uniform4(0.0..=1.0f32),
        test in prop::option::of((any::<u8>(), any::<u32>())),
    ) -> Preset {
        let [name, about, why] = texts;
        let mut stack = rasterlab::effects::Stack::default();
        for (index, seed) in effects {
            // Two effects in one slot are no session.
            if stack.rival(EFFECTS[index]).is_none() {
                stack.enable(EFFECTS[index]).words = filled(EFFECTS[index], seed);
            }
        }
        if reversed {
            stack.0.reverse();
        }
        Preset {
            name, about, tags, scene, room, spin_deg_per_s, playback, camera,
            polyline: if reversed { [[background[0], -background[1], 1.0], [1e9, background[2], 1e-9], [0.0; 3]].into() } else { [].into() },
            scene_camera: if reversed { "from above".into() } else { String::new() },
            clock,
            animation: animated(&stack, tracks),
            stack,
            accuracy: AccuracyRequest { tier: Tier::ALL[tier], pins: visibility.map_or(PinnedOptions::default(), |i| PinnedOptions::of(Visibility::EXACT[i])), ..AccuracyRequest::default() },
            output: Output { size, background },
            test: test.map(|(max_channel, max_pixels)| GoldenTest { max_channel, max_pixels, max_wrong_triangles: 0, why: format!("because {why}") }),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_round_trip_keeps_every_bit(preset in any_preset()) {
        let text = preset_file::to_toml(&PresetFile::new("any", preset.clone()));
        let back = preset_file::parse(&text, "any").map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        prop_assert_eq!(bits(&back.preset), bits(&preset), "{}", text);
        prop_assert!(back.warnings.is_empty(), "{:?}", back.warnings);
        prop_assert_eq!(preset_file::to_toml(&back), text);
    }

    #[test]
    fn any_preset_can_be_patched_into_any_other(before in any_preset(), after in any_preset()) {
        let mut preset_file = parse(&preset_file::to_toml(&PresetFile::new("any", before)));
        preset_file.preset = after.clone();
        let text = preset_file::to_toml(&preset_file);
        let back = preset_file::parse(&text, "any").map_err(|e| TestCaseError::fail(format!("{e}\n{text}")))?;
        prop_assert_eq!(bits(&back.preset), bits(&after), "{}", text);
    }

    #[test]
    fn whatever_the_time_every_value_stays_inside_its_hard_range(preset in any_preset(), time_s in any::<f64>()) {
        for enabled in preset.stack_at(time_s).0 {
            for field in enabled.effect.fields {
                let [low, high] = field.hard.map(|bound| bound as f32);
                let lanes = field.get(&enabled.words);
                let inside = |lane: &f64| !matches!(field.value_type, ValueType::F32 | ValueType::Color | ValueType::Point) || (low..=high).contains(&(*lane as f32));
                prop_assert!(lanes.iter().all(inside), "{}.{} {lanes:?}", enabled.effect.name, field.name);
            }
        }
    }

    #[test]
    fn a_parameter_survives_whatever_its_bits(value in finite_f32()) {
        let written = format!("schema = 2\n[effects.facet]\namount = {value:?}\n");
        match preset_file::parse(&written, "any") {
            Ok(preset_file) => prop_assert_eq!(preset_file.preset.stack.get("facet").unwrap().effect.field("amount").unwrap().get(&preset_file.preset.stack.0[0].words)[0].to_bits(), f64::from(value).to_bits()),
            Err(error) => prop_assert!(!(0.0..=1.0).contains(&value), "{error}"),
        }
    }

    #[test]
    fn no_text_panics(text in "\\PC{0,200}") {
        let _ = preset_file::parse(&text, "any");
        let _ = preset_file::from_line(&text);
        let _ = preset_file::preset_from_png(text.as_bytes(), "any");
    }
}
