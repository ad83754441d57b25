//! Promise: what cannot be is refused with its line, key, value and range; what is unknown warns
//! and stays.

use rasterlab::{
    preset::animation::MAX_KEYFRAMES,
    preset_file::{self, PresetError},
};

use super::*;

#[test]
fn errors_name_line_key_value_and_range() {
    let cases = r##"
[effects.facet]¶amount = -1 ⇒ preset.toml:3: effects.facet.amount -1 lies outside 0..=1
[effects.facet]¶amount = 1e39 ⇒ preset.toml:3: effects.facet.amount 1e39 is too large for a 32-bit float, which ends at 3.4028235e38
[effects.facet]¶amount = nan ⇒ preset.toml:3: effects.facet.amount nan is not a finite number
[effects.facet]¶seed = 1.5 ⇒ preset.toml:3: effects.facet.seed 1.5 must be a whole number
[effects.facet]¶seed = -1 ⇒ preset.toml:3: effects.facet.seed -1 lies outside 0..=4294967295
[effects.facet]¶pattern = "radail" ⇒ preset.toml:3: effects.facet.pattern "radail" is not one of uniform, sweep, radial, random; did you mean "radial"?
[effects.facet]¶center = [1, 2] ⇒ preset.toml:3: effects.facet.center must be a list of 3 numbers, not a list of 2
[effects.depth]¶fit = 1 ⇒ preset.toml:3: effects.depth.fit must be true or false, not a number
[output]¶size = [16385, 1] ⇒ preset.toml:3: output.size 16385 lies outside 0..=16384
[ground]¶size = 0 ⇒ preset.toml:3: ground.size 0 lies outside 0.1..=1e3
[ground]¶cells = 129 ⇒ preset.toml:3: ground.cells 129 lies outside 1..=128
[ground]¶shape = "dics" ⇒ preset.toml:3: ground.shape "dics" is not one of disc, square; did you mean "disc"?
[output]¶background_bottom = [0, 0, 2, 1] ⇒ preset.toml:3: output.background_bottom 2 lies outside 0..=1
[camera]¶fov_y_deg = 180 ⇒ preset.toml:3: camera.fov_y_deg 180 lies outside 1..=179
[camera]¶eye = [0, inf, 0] ⇒ preset.toml:3: camera.eye inf is not a finite number
[camera]¶eye = [0, 1e10, 0] ⇒ preset.toml:3: camera.eye 1e10 lies outside -1e9..=1e9
[accuracy]¶tier = 3 ⇒ preset.toml:3: accuracy.tier must be one of draft, fast, precise, reference, strict, not a number
[test]¶max_pixels = 9 ⇒ preset.toml:2: test.why must say why the budget is above the default
[test]¶max_wrong_triangles = 9¶why = "because" ⇒ preset.toml:2: test.max_wrong_triangles must be 0 here; it needs a pinned option that is not exact, or the tier draft or fast
[accuracy]¶visibility = "race"¶[test]¶max_wrong_triangles = 9 ⇒ preset.toml:4: test.why must say why the budget is above the default
name = "\u001b[31m" ⇒ preset.toml:2: name contains the control character '\u{1b}'
effects = 3 ⇒ preset.toml:2: effects must be a table, written [effects]
effects.facet = true ⇒ preset.toml:2: effects.facet must be a table, written [effects.facet]
[[camera]] ⇒ preset.toml:2: camera must be a table, written [camera]
[scene]¶path = "https://example.org/a.glb" ⇒ preset.toml:3: scene.path must be a file, not an address
[scene]¶path = "a.glb"¶builtin = "knot" ⇒ preset.toml:3: scene.path and scene.builtin exclude each other
[clock]¶range_s = [2, 2] ⇒ preset.toml:3: clock.range_s must rise, but 2 is not before 2
[clock]¶speed = 0 ⇒ preset.toml:3: clock.speed 0 lies outside 0.01..=100
animation = 3 ⇒ preset.toml:2: animation must be a table, written [animation]
[animation]¶facet = 3 ⇒ preset.toml:3: animation.facet must be a table, written [animation.facet]
"##;
    all_refused("schema = 2\n", cases);
    let schemas = r##"
# mine¶schema = 1 ⇒ preset.toml:2: schema 1 is older than 2, the oldest that this program reads; write schema = 2, then mend the keys that are reported as unknown
schema = "2" ⇒ preset.toml:1: schema must be the whole number 2
"##;
    all_refused("", schemas);
}

#[test]
fn keys_that_cannot_be_are_refused_by_name() {
    let head = "schema = 2\n[effects.facet]\n[animation.facet]\n";
    let cases = r##"
amount = [{ time_s = 0, value = 2 }] ⇒ preset.toml:4: animation.facet.amount keyframe 1: value 2 lies outside 0..=1
amount = [{ time_s = 0, value = nan }] ⇒ preset.toml:4: animation.facet.amount keyframe 1: value nan is not a finite number
amount = [{ time_s = 0, value = 1e-46 }] ⇒ value 1e-46 is too small for a 32-bit float
amount = [{ time_s = 2e9, value = 0 }] ⇒ keyframe 1: time_s 2e9 lies outside -1e9..=1e9
amount = [{ time_s = 0, value = 0 },¶ { time_s = -0.0, value = 1 }] ⇒ preset.toml:5: animation.facet.amount keyframe 2: there is already a keyframe at time_s -0
amount = [{ time_s = 0, value = 0, easing = "smoth" }] ⇒ "smoth" is not one of hold, linear, smooth, in, out; did you mean "smooth"?
amount = [{ time_s = 0 }] ⇒ preset.toml:4: animation.facet.amount keyframe 1 must have time_s and value
amount = [{}] ⇒ animation.facet.amount keyframe 1 must have time_s and value
amount = [] ⇒ preset.toml:4: animation.facet.amount must be a list of 1 to 256 keyframes such as { time_s = 0.0, value = … }
amount = [0.5] ⇒ must be a list of 1 to 256 keyframes
amount = 3 ⇒ must be a list of 1 to 256 keyframes
seed = [{ time_s = 0, value = 1, easing = "linear" }] ⇒ keyframe 1: easing must be hold, not linear
center = [{ time_s = 0, value = 1 }] ⇒ value must be a list of 3 numbers
"##;
    all_refused(head, cases);
    let many: String = (0..=MAX_KEYFRAMES)
        .map(|i| format!("{{ time_s = {i}, value = 0 }}, "))
        .collect();
    let said = refusal(&format!("{head}amount = [{many}]\n"));
    assert!(
        said.contains("must be a list of 1 to 256 keyframes"),
        "{said}"
    );
}

#[test]
fn keys_of_what_is_not_there_warn_and_stay() {
    let text = "schema = 2\n[animation.facet]\namount = [{ time_s = 0, value = 1, note = 3 }]\namuont = []\n[animation.fascet]\nx = 1\n";
    let preset_file = parse(text);
    let wanted = r#"
preset.toml:2: animation.facet moves nothing; add [effects.facet]
preset.toml:3: unknown key animation.facet.amount keyframe 1: note
preset.toml:4: unknown key animation.facet.amuont; did you mean "amount"?
preset.toml:5: unknown key animation.fascet; did you mean "facet"?
"#;
    all_told(&preset_file.warnings, wanted);
    assert!(preset_file.preset.evaluated_stack().0.is_empty());
    assert_eq!(preset_file::to_toml(&preset_file), text);
}

#[test]
fn a_syntax_error_names_its_line() {
    let cases = "
name =  ⇒ preset.toml:2: 
¶[effects.facet ⇒ preset.toml:3: 
schema = 2 ⇒ preset.toml:2: 
";
    for case in cases.trim().lines() {
        let (text, line) = case.split_once(" ⇒ ").expect("an arrow");
        let said = refusal(&format!("schema = 2\n{}\n", text.replace('¶', "\n")));
        assert!(said.starts_with(line) && !said.contains('\n'), "{said}");
    }
}

#[test]
fn unknown_keys_warn_with_a_suggestion_and_strictness_refuses_them() {
    let preset_file = parse(
        "schema = 2\nnmae = 1\n[effects.fascet]\n[effects.lambert]\nsnu = 1\n[camera]\nfov = 3\n[otuput]\n",
    );
    let wanted = r#"
preset.toml:2: unknown key nmae; did you mean "name"?
preset.toml:3: unknown key effects.fascet; did you mean "facet"?
preset.toml:5: unknown key effects.lambert.snu; did you mean "sun"?
preset.toml:7: unknown key camera.fov
preset.toml:8: unknown key otuput; did you mean "output"?
"#;
    all_told(&preset_file.warnings, wanted);
    assert!(
        matches!(preset_file.strict(), Err(PresetError::Strict(warnings)) if warnings.len() == 5)
    );
    assert!(parse("name = \"x\"").warnings[0].contains("schema is missing"));
}

#[test]
fn hostile_text_is_refused_without_harm() {
    let deep = format!(
        "schema = 2\nx = {}{}\n",
        "[".repeat(100_000),
        "]".repeat(100_000)
    );
    let long = format!("schema = 2\nname = \"{}\"\n", "x".repeat(2 << 20));
    let wide = format!("schema = 2\ntags = [{}]\n", "\"t\",".repeat(1000));
    let huge = "schema = 2\n[effects.facet]\nseed = 99999999999999999999\n".to_owned();
    for text in [
        deep,
        long,
        wide,
        huge,
        "\u{0}".into(),
        "schema = [1]".into(),
        "=".into(),
        "[]".into(),
    ] {
        assert!(preset_file::parse(&text, "hostile").is_err());
    }
    let folder = tempfile::tempdir().unwrap();
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, [0xff, 0xfe, 0x00]).unwrap();
    assert!(
        preset_file::load(&binary)
            .unwrap_err()
            .to_string()
            .contains("not UTF-8")
    );
}

#[test]
fn a_file_full_of_unknown_keys_is_read_in_a_moment() {
    let began = std::time::Instant::now();
    let short: String = (0..45_000)
        .map(|i| format!("facet_amuont{i} = 1\n"))
        .collect();
    let effects: String = (0..19_000)
        .map(|i| format!("[effects.facet{i}]\n[animation.facet{i}]\n"))
        .collect();
    let long = format!("{} = 1\n", "a".repeat(1_000_000));
    let fields = format!(
        "[effects.facet]\n{}",
        (0..60_000)
            .map(|i| format!("amuont{i} = 1\n"))
            .collect::<String>()
    );
    let list: String = (0..100_000).map(|i| format!("\"x{i}\",")).collect();
    for text in [&short, &effects, &long, &fields] {
        let preset_file = parse(&format!("schema = 2\n{text}"));
        assert!(
            preset_file.warnings.len() <= 33
                && preset_file
                    .warnings
                    .iter()
                    .all(|warning| warning.len() < 200)
        );
        if text != &long {
            let last = preset_file.warnings.last().unwrap();
            assert!(
                last.starts_with("preset.toml: ") && last.ends_with("more warnings of this kind"),
                "{last}"
            );
        }
        assert!(preset_file.strict().is_err());
    }
    let _ = preset_file::parse(&format!("schema = 2\nstack = [{list}]\n"), "preset");
    assert!(began.elapsed().as_secs() < 30, "{:?}", began.elapsed());
}

/// What a preset of anyone says must not clear the terminal that shows it, nor fill it.
#[test]
fn messages_quote_no_control_characters_and_no_long_values() {
    let key = "\"a\\u001b[2J\\u202e\\nb\"";
    let warned = parse(&format!(
        "schema = 2\n{key} = 1\n[effects.facet]\n{key} = 1\n[effects.{key}]\n[animation.{key}]\n"
    ));
    assert_eq!(warned.warnings.len(), 4, "{:?}", warned.warnings);
    let refused = [
        refusal(&format!("schema = 2\nstack = [{key}]\n")),
        refusal(&format!(
            "schema = 2\n[effects.{key}]\neffect = \"facet\"\n"
        )),
        refusal(&format!("schema = 2\n[effects.facet]\non = [{key}]\n")),
        refusal(&format!(
            "schema = 2\n[effect_files]\n{key} = \"\"\n[effects.{key}]\n"
        )),
    ];
    for message in warned.warnings.iter().chain(&refused) {
        assert!(
            !message.chars().any(rasterlab::params::is_hidden),
            "{message:?}"
        );
        assert!(message.contains("u{1b}[2J"), "{message}");
    }
    let long = refusal(&format!(
        "schema = 2\n[scene]\nunit = \"{}\"\n",
        "ab ".repeat(10_000)
    ));
    assert!(
        long.chars().count() < 1100,
        "{} characters",
        long.chars().count()
    );
    assert!(
        long.starts_with("preset.toml:3: scene.unit \"ab ab")
            && long.contains(" … ")
            && long.ends_with("scene"),
        "{long}"
    );
}
