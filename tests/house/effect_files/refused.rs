//! Files that are refused. « stands before the place that the message must point to, and a comment
//! at the end says what the message must hold.

use rasterlab::effect_files::{Catalog, MAX_BYTES, check_name, read};

use super::{read_ink, with_declarations, with_members, with_statements};

/// Reads the text without its mark; it must be refused there, with these words.
fn refused(marked: &str, words: &str) {
    try_refused(marked, words).unwrap_or_else(|fault| panic!("{fault}"));
}

/// What is wrong with the refusal.
fn try_refused(marked: &str, words: &str) -> Result<(), String> {
    let text = marked.replacen('«', "", 1);
    let Err(error) = read_ink(&text) else {
        return Err(format!("accepted:\n{}", super::beginning(&text)));
    };
    if !error.message.contains(words) {
        return Err(format!("{words:?} is not in:\n{error}"));
    }
    if let Some(offset) = marked.find('«') {
        let line = text[..offset].matches('\n').count() + 1;
        let before = text[..offset].rsplit('\n').next().unwrap_or_default();
        let meant = [line, before.chars().count() + 1].map(|number| number as u32);
        if error.place.as_ref().map(|place| [place.line, place.column]) != Some(meant) {
            return Err(format!("{meant:?} is meant:\n{error}\n{marked}"));
        }
    }
    Ok(())
}

/// Structs of parameters and the hook of a pass, AT, beside these functions.
fn with_hooks(hooks: &str) -> String {
    let at = "fn f(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }";
    let structs = "struct P { @range(0.0, 1.0, 0.5) @unit(m) amount: f32 }\nstruct Q { @range(0.0, 1.0, 0.5) amount: f32 }";
    format!("{structs}\n{}\n", hooks.replace("AT", at))
}

/// Every line of the file is a case; ¶ in it is a line break. A line of `===` says where they stand.
#[test]
fn every_mistake_is_refused_at_its_place() {
    let mut faults = Vec::new();
    for part in include_str!("refused.txt").split("=== ").skip(1) {
        let (place, cases) = part.split_once('\n').expect("a place and its cases");
        let wrap: fn(&str) -> String = match place.split(' ').next() {
            Some("in") if place.starts_with("in a function") => with_statements,
            Some("in") => with_members,
            Some("beside") => with_declarations,
            Some("hooks") => with_hooks,
            Some("arrays") => |case| with_statements(case) + "const MANY = 5000;",
            _ => panic!("the file has no cases for {place}"),
        };
        for line in cases.lines().filter(|line| !line.is_empty()) {
            let (case, words) = line.rsplit_once("// ").unwrap_or((line, ""));
            let case = case.trim().replace('¶', "\n");
            faults.extend(try_refused(&wrap(&case), words.trim()).err());
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}

#[test]
fn names_that_are_taken() {
    let choice = "@choice(a, b-c, b_c) mode: u32,";
    refused(&with_members(choice), "INK_MODE_B_C");
    let constant = with_members("@choice(a, b) mode: u32,") + "const «INK_MODE_A = 1u;";
    refused(&constant, "constant of a choice");
    for name in [
        "toon", "stack", "fn", "array", "mix", "surface", "Ink", "ink__x", "ink_", "_ink", "9x",
        "", "in k", "é", "class",
    ] {
        assert!(check_name(name).is_err(), "{name}");
        let error = read("x.wgsl", name, &with_declarations("")).expect_err(name);
        assert!(!error.to_string().contains('\n'), "{error}");
    }
    assert!(check_name(&"x".repeat(41)).is_err());
}

#[test]
fn too_many_members_or_none() {
    refused(&with_members(""), "at least one member");
    let member = |index: usize| format!("@range(0, 1, 0.5) x{index}: f32,\n");
    let many: String = (0..65).map(member).collect();
    refused(&with_members(&many), "at most 64");
    let long = format!("@range(0, 1, 0.5) «{}: f32,", "x".repeat(60));
    refused(&with_members(&long), "letters");
}

#[test]
fn files_without_a_hook() {
    let reading = "//@ use lib/image\nfn f(s: Surface, p: Q) -> Surface { return s; }";
    refused(&with_hooks(reading), "no other hook");
    refused(&with_hooks(""), "no function has the signature");
    for empty in ["", "\n\n", "// nothing", "/* nothing */", "\u{feff}"] {
        refused(empty, "no function has the signature");
    }
    for directive in [
        "use lib/nothing",
        "use stages/shade/resolve",
        "use lib/frame",
        "binding var<uniform> x: u32;",
    ] {
        let text = format!("«//@ {directive}\n{}", with_declarations(""));
        refused(&text, "may use");
    }
}

#[test]
fn brackets_and_characters() {
    let statements = [
        ("let x = (1.0«];", "where ) must close"),
        ("let x = array<f32, 2>(1.0, 2.0)[0«);", "where ] must close"),
        ("«/* open", "no end"),
        ("let x = 1.0; «\u{7}", "U+0007"),
        ("let x = 1.0; // hidden «\r discard;", "U+000D"),
        ("let x = 1.0; // hidden «\u{2028} discard;", "U+2028"),
        ("let x = 1.0; // hidden «\u{85} discard;", "U+0085"),
        ("let x = 1.0; «\u{feff}", "U+FEFF"),
        ("let x = 1.0; «\0", "U+0000"),
        ("\tlet «x: u32 =\t1.5;", ""),
    ];
    for (case, words) in statements {
        refused(&with_statements(case), words);
    }
    // The innermost bracket that is not closed.
    refused("fn f() «{ if true { }", "not closed");
    let (wide, sum) = (" ".repeat(3000), "1.0 + ".repeat(60));
    refused(
        &with_statements(&format!("{wide}let «x: u32 = 1.5;{wide}")),
        "",
    );
    refused(
        &with_statements(&format!("let x = {sum}«missing;")),
        "missing",
    );
}

/// `count` functions, each of which calls the one before as `body` says, where T is its name.
fn calling(count: usize, body: &str) -> String {
    let function = |level: usize| {
        let body = body.replace('T', &format!("t{}", level.saturating_sub(1)));
        let body = if level == 0 { "x * x" } else { &body };
        format!("fn t{level}(x: f32) -> f32 {{ return {body}; }}\n")
    };
    (0..count).map(function).collect()
}

#[test]
fn what_is_too_large_or_too_deep() {
    for count in [100, 10_000] {
        // What stands inside itself: before, in the middle, and after.
        for (open, middle, close, most) in [
            ("(", "1.0", ")", 10_000),
            ("vec3f(", "1.0", ")", 9000),
            ("a[", "0", "]", 10_000),
            ("if true {", "", "}", 5000),
            ("loop {", "", "}", 5000),
            ("else if true { } ", "", "", 3000),
            ("(", "", "", 10_000),
            ("{", "", "", 10_000),
        ] {
            let count = count.min(most);
            let [open, close] = [open, close].map(|bracket| bracket.repeat(count));
            let before = match () {
                () if open.starts_with("else") => "if true { } ",
                () if middle.is_empty() => "",
                () => "let x = ",
            };
            let statement = format!("{before}{open}{middle}{close};");
            refused(&with_statements(&statement), "inside each other");
        }
        for (before, operator, after) in [
            ("1.0", " + 1.0", ""),
            ("", "-", "1.0"),
            ("", "&*", "s"),
            ("s", ".x", ""),
            ("s", "[0]", ""),
            ("true", " && true", ""),
        ] {
            let operators = operator.repeat(count.clamp(300, 7000));
            let statement = format!("let x = {before}{operators}{after};");
            refused(&with_statements(&statement), "operators");
        }
    }
    let doubling: String = (1..30)
        .map(|level| format!("struct S{level} {{ a: S{0}, b: S{0} }}\n", level - 1))
        .collect();
    let large = "struct S0 { x: vec4f }\nfn large(s: S29) -> f32 { return 1.0; }\n";
    refused(&with_declarations(&(large.to_owned() + &doubling)), "");
    let tree = calling(40, "T(x) + T(x + 1.0)");
    refused(
        &(with_statements("s.rank = t39(s.rank);") + &tree),
        "needs more than",
    );
    // Long code may have no loops: together they would take too long on every pixel.
    let twelve = with_statements("s.rank = t12(s.rank);") + &tree;
    let looped = "for (var i = 0; i < 9; i += 1) { s.rank += t12(s.rank); }";
    refused(
        &(with_statements(looped) + &tree),
        "an effect with loops has at most",
    );
    read_ink(&twelve).expect("without a loop it is read");
    let chain = with_statements("s.rank = t1199(s.rank);") + &calling(1200, "T(x)");
    refused(&chain, "deep");
    refused(&" ".repeat(MAX_BYTES + 1), "bytes");
    refused(&"x".repeat(1 << 20), "bytes");
    for (text, words) in [
        ("x", ""),
        ("@", ""),
        ("((", "inside each other"),
        ("/*", "no end"),
        ("fn ", ""),
    ] {
        refused(&text.repeat(MAX_BYTES / text.len()), words);
    }
}

#[test]
fn files_that_are_no_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut catalog = Catalog::default();
    let wide = "fn f() { }".encode_utf16().flat_map(u16::to_le_bytes);
    let cases: [(&str, Vec<u8>, &str); 6] = [
        ("latin", b"// caf\xe9\nfn f() { }\n".to_vec(), "UTF-8"),
        ("wide", wide.collect(), "U+0000"),
        ("binary", (0..=255).collect(), ""),
        ("huge", vec![b' '; 1 << 20], "bytes"),
        ("turned", "// \u{202e}hidden\n".into(), "U+202E"),
        ("nothing", Vec::new(), "no function"),
    ];
    for (name, bytes, words) in cases {
        let path = folder.path().join(format!("{name}.wgsl"));
        std::fs::write(&path, bytes).expect("written");
        catalog.add_file(&path);
        let error = catalog.find(name).expect_err("it is no effect");
        assert!(error.message.contains(words), "{error}");
        assert!(error.to_string().split('\n').count() <= 3, "{error}");
    }
    catalog.add_file(&folder.path().join("gone.wgsl"));
    assert!(catalog.find("gone").is_err());
    let error = catalog.find("latin").expect_err("it is no effect");
    let place = error.place.as_ref().expect("a place");
    assert_eq!((place.line, place.column), (1, 7));
    assert_eq!(catalog.effects().count(), rasterlab::effects::EFFECTS.len());
}
