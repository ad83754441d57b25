//! Files that are read: what they say reaches the effect, and they link and validate beside
//! anything else.

use std::sync::Arc;

use rasterlab::{
    accuracy::{Parameters, Visibility},
    effect_files::{Hook, check_name, read, template},
    effects::{EFFECTS, Effect},
    params::ValueType,
    shader::Fetch,
};

use super::{
    super::shaders::{all_passes, key, validate},
    read_ink, with_declarations, with_members, with_statements,
};

/// Effects with as many features of the language as there are room for.
pub const EXAMPLES: [&str; 8] = [
    include_str!("examples/surface.wgsl"),
    include_str!("examples/sample.wgsl"),
    include_str!("examples/vertex.wgsl"),
    include_str!("examples/pixel.wgsl"),
    include_str!("examples/passes.wgsl"),
    include_str!("examples/kept.wgsl"),
    include_str!("examples/constants.wgsl"),
    include_str!("examples/picture.wgsl"),
];

fn accepted(text: &str) -> Arc<Effect> {
    read_ink(text).unwrap_or_else(|error| panic!("{error}\n---\n{text}"))
}

/// Validates every pass with these effects.
fn validates(effects: Vec<Arc<Effect>>) {
    for is_baked in [false, true] {
        let mut key = key(Fetch::Indexed, Visibility::Split32, true, effects.clone());
        if is_baked {
            key.options.parameters = Parameters::Baked;
            key.effects.baked = effects
                .iter()
                .map(|effect| effect.defaults.clone())
                .collect();
        }
        for pass in all_passes(&key) {
            validate(&key, pass);
        }
    }
}

fn all_examples() -> Vec<String> {
    let templates = Hook::ALL.iter().map(|hook| template("ink", *hook));
    templates.chain(EXAMPLES.map(str::to_owned)).collect()
}

#[test]
fn templates_and_examples_link_alone_and_beside_all_others() {
    let texts = all_examples();
    let mut effects = Vec::new();
    for (index, text) in texts.iter().enumerate() {
        validates(vec![accepted(text)]);
        let stem = format!("ink{index}");
        let text = text.replace("INK_MODE", &format!("INK{index}_MODE"));
        effects.push(
            read(&format!("{stem}.wgsl"), &stem, &text).unwrap_or_else(|error| panic!("{error}")),
        );
    }
    validates(effects.clone());
    validates(EFFECTS.iter().cloned().chain(effects).collect());
}

#[test]
fn names_of_two_files_never_meet() {
    // Without a mark between the two parts these would both be custom_ink_a_b and INK_A_B_C.
    let one = with_members("@choice(x, c) a_b: u32,")
        + "fn a_b() -> f32 { return 1.0; }\nfn b() -> f32 { return a_b(); }\n";
    let other = one
        .replace("a_b: u32", "b: u32")
        .replace("fn a_b()", "fn b_()")
        .replace("a_b()", "b_()");
    let effects = [("ink", &one), ("ink_a", &other)].map(|(stem, text)| {
        let text = text.replace(
            "return surface;",
            &format!("var s = surface; s.rank = f32({}); return s;", "1u"),
        );
        read(&format!("{stem}.wgsl"), stem, &text).unwrap_or_else(|error| panic!("{error}\n{text}"))
    });
    validates(effects.to_vec());
}

#[test]
fn templates_suit_every_name() {
    for name in "a s p v q rim a_1b type turns square center hook_surface x2 dark wave".split(' ') {
        if let Err(reason) = check_name(name) {
            assert!(reason.contains("word of WGSL"), "{name} {reason}");
            continue;
        }
        for hook in Hook::ALL {
            let text = template(name, hook);
            let effect = read("x.wgsl", name, &text).unwrap_or_else(|error| panic!("{error}"));
            validates(vec![effect.clone()]);
        }
    }
}

#[test]
fn line_ends_comments_and_marks_change_nothing() {
    for text in all_examples() {
        let plain = accepted(&text);
        let others = [
            text.replace('\n', "\r\n"),
            format!("\u{feff}{text}"),
            format!("\u{feff}{}", text.replace('\n', "\r\n")),
            text.trim_end().to_owned(),
            text.replace("    ", "\t"),
            text.replace("{\n", "{ /* frame draws /* color */ é */ // hash\n"),
            format!("{text}\n\n// frame"),
        ];
        for other in others {
            let effect = accepted(&other);
            assert_eq!(effect.about, plain.about);
            assert_eq!(effect.defaults, plain.defaults);
            validates(vec![effect.clone()]);
        }
    }
}

#[test]
fn names_of_ones_own_are_ones_own() {
    let mut effects = Vec::new();
    let mut add = |text: String| {
        let stem = format!("ink{}", effects.len());
        effects.push(read("x.wgsl", &stem, &text).unwrap_or_else(|error| panic!("{error}")));
    };
    for part in include_str!("accepted.txt").split("=== ").skip(1) {
        let (place, texts) = part.split_once('\n').expect("a place and texts");
        let wrap = if place == "in a function" {
            with_statements
        } else {
            with_declarations
        };
        let texts = texts.lines().filter(|text| !text.is_empty());
        texts.for_each(|text| add(wrap(&text.replace('¶', "\n"))));
    }
    add(with_declarations("").replace("Ink", "ink_values"));
    // All declare the same names.
    validates(effects);
}

#[test]
fn loops_end() {
    use glam::DVec4;
    let statements = [
        "loop { s.rank += 1.0; }",
        "while true { s.rank += 1.0; }",
        "for (;;) { s.rank += 1.0; }",
        "for (;;) { for (;;) { loop { s.rank += 1.0; } } }",
        "for (var i = 0u; i < 4000000000u; i++) { s.rank += 1.0; continue; }",
        "loop { s.rank += 1.0; continuing { s.rank += 1.0; break if s.rank < 0.0; } }",
        "loop { switch 1u { case 1u: { continue; } default: { } } }",
        "loop { if helper(s.rank) < -1.0 { break; } else { continue; } }",
        "var i = 0u; while i < i + 1u { i += 0u; }",
    ];
    for statement in statements {
        let effect = accepted(&with_statements(statement));
        validates(vec![effect.clone()]);
        let source = effect.source.as_ref().expect("a file");
        let is_told = statement.contains("loop") && !statement.contains("break");
        assert_eq!(source.has_endless_loop, is_told, "{statement}");
        let surface =
            super::super::effect_inputs::surface(&mut rasterlab_fuzz::stress::scenes::Rng(1));
        let apply = effect.hooks.surface.as_ref().expect("a surface effect");
        // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
        let start = std::time::Instant::now();
        let mut result = [surface];
        apply(&mut result, &effect.defaults);
        let [result] = result;
        assert!(
            result.color != DVec4::NAN && !result.color.is_nan(),
            "{statement} did not end"
        );
        assert!(
            start.elapsed() < super::MOST_TIME,
            "{statement} took {:?}",
            start.elapsed()
        );
    }
}

#[test]
fn what_the_file_says_reaches_the_effect() {
    let effect = accepted(EXAMPLES[0]);
    assert_eq!(effect.about, "loops, helpers and every kind of parameter");
    let field = |name: &str| effect.field(name).unwrap_or_else(|| panic!("no {name}"));
    assert_eq!(field("mode").doc, "How.");
    let choice = ValueType::choice(&["plain", "cross-hatch"]);
    assert_eq!(field("mode").value_type, choice);
    let amount = field("amount");
    let read = (amount.hard, amount.soft, amount.unit.as_str());
    assert_eq!(read, ([-4.0, 4.0], [0.0, 1.0], "m"));
    assert_eq!(amount.when, Some(("mode".into(), vec!["plain".into()])));
    for (name, wanted) in [
        ("mode", &[1.0][..]),
        ("offset", &[-3.0]),
        ("count", &[3.0]),
        ("helper", &[1.0]),
        ("tint", &[1.0, 0.5, 0.25, 1.0]),
        ("at", &[1.0, -2.0, 3.5]),
    ] {
        assert_eq!(field(name).get(&effect.defaults), wanted, "{name}");
    }
    let [one, other] = [2, 3].map(|example| accepted(EXAMPLES[example]).hooks.clone());
    assert!(one.vertex.is_some() && one.surface.is_some());
    assert!(one.sample.is_none() && one.image.is_none());
    assert!(other.image.is_some_and(|image| image.reads_previous));
    assert!(other.surface.is_none() && other.vertex.is_none());
}

/// The blocks of WGSL in `docs/effects.md`, each with its lines.
fn blocks() -> Vec<Vec<String>> {
    let page = include_str!("../../../docs/effects.md");
    let blocks = page.split("```wgsl\n").skip(1);
    let lines = |block: &str| -> Vec<String> {
        let end = block.find("```").expect("a block ends");
        block[..end]
            .lines()
            .map(|line| line.trim().into())
            .collect()
    };
    blocks.map(lines).collect()
}

#[test]
fn examples_of_the_guide_are_read_and_its_walk_through_leads_to_toon() {
    let blocks = blocks();
    let whole = |block: &&Vec<String>| block.iter().any(|line| line.starts_with("struct "));
    let mut read = 0;
    for block in blocks.iter().filter(whole) {
        let stem = match block.iter().any(|line| line.contains("fn lantern(")) {
            true => "lantern",
            false => "ink",
        };
        rasterlab::effect_files::read("guide.wgsl", stem, &block.join("\n"))
            .unwrap_or_else(|error| panic!("{error}"));
        read += 1;
    }
    assert_eq!(read, 2);
    // Each line of toon stands there, and nothing else that later lines do not replace.
    let toon = include_str!("../../../shaders/effects/toon.wgsl")
        .lines()
        .skip(1);
    let toon: Vec<String> = toon
        .map(|line| line.trim().replace("toon", "ink").replace("Toon", "Ink"))
        .collect();
    let told = blocks[..3].concat();
    for line in &toon {
        assert!(told.contains(line), "{line}");
    }
    let replaced: Vec<&String> = told[1..]
        .iter()
        .filter(|line| !toon.contains(line))
        .collect();
    let expected = [
        "let step = min(floor(position), steps - 1.0);",
        "s.color = vec4f(flat, s.color.a);",
    ];
    assert_eq!(replaced, expected);
}
