//! Promise: what cannot be is refused with its line, key, value and range; what is unknown warns
//! and stays.

use rasterlab::{
    preset::animation::MAX_KEYFRAMES,
    preset_file::{self, PresetError},
};

use super::*;

/// Every line of the file is a text that is refused, where a line of `===` says, in it at the … or
/// behind it, with ¶ for line breaks; behind ⇒ stand words of the refusal, and those that begin with
/// a place are the whole of it.
#[test]
fn errors_name_line_key_value_and_range() {
    for part in include_str!("refused.txt").split("=== ").skip(1) {
        let (around, cases) = part.split_once('\n').expect("a text and cases");
        let around = if around.contains('…') {
            around.to_owned()
        } else {
            format!("{around}¶…")
        };
        for case in cases.lines().filter(|case| !case.is_empty()) {
            let (text, wanted) = case.split_once(" ⇒ ").expect("an arrow");
            let text = around
                .trim_start_matches('¶')
                .replace('…', text.trim())
                .replace('¶', "\n");
            let said = refusal(&(text + "\n"));
            let is_whole = wanted.starts_with("preset.toml:");
            assert!(
                said == wanted || !is_whole && said.contains(wanted),
                "{case}\n{said}"
            );
            assert!(!said.contains('\n'), "{said}");
        }
    }
}

#[test]
fn a_track_has_at_most_so_many_keys() {
    let head = "schema = 2\n[effects.facet]\n[animation.facet]\n";
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
    // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
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
