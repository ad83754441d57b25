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

/// Every line is a case; ¶ in it is a line break.
fn all(cases: &str, wrap: impl Fn(&str) -> String) {
    let faults: Vec<String> = cases
        .trim()
        .lines()
        .map(|line| line.rsplit_once("// ").unwrap_or((line, "")))
        .filter_map(|(case, words)| {
            let case = case.trim().replace('¶', "\n");
            try_refused(&wrap(&case), words.trim()).err()
        })
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}

#[test]
fn statements_with_a_mistake() {
    let cases = r##"
let x = «; // expected
let x = 1.0 «let y = 2.0; // expected
const x = «reflect(vec2f(1.0), vec2f(0.0, 1.0)); // write let in a function in place of const
var x = «smoothstep(0.0, 1.0, 0.25); // as in 0.5f
let x = «missing; // missing
let x = «missing(1.0); // missing
let «x: u32 = 1.5; // u32
let «x: vec3f = vec2f(1.0); // vec3
s.color = «1.0;
s.color.«q = 1.0; // q
s.«colour = vec4f(1.0); // colour
s.color = «vec4f(1.0) * vec3f(1.0); // Multiply
if «1.0 { s.rank = 0.0; }
p.amount = 1.0;
var x: f64 = 1.0;
var x: f16 = 1.0h;
var x: «Missing; // Missing
let x = «helper(1.0, 2.0); // takes 1, and 2
let x = helper(true);
let x = vec3f(1.0)[7];
let a = array(1.0, 2.0); let x = a[5];
return 1.0;
return;
«break;
«continue;
switch 1u { case 1u: { } case 1u: { } default: { } }
let fn = 1.0; // fn
let «class = 1.0; // class
let x = 1.0; let «x = 2.0; // x
goto «end;
s.rank = 1.0 / (1.0 - 1.0) + 0.5;
let x = 99999999999999999999;
let x = 1e999;
let x = sqrt(«"text");
let x = «#1;
let x = 1.0 $ 2.0;
s.rank = mix(0.0, 1.0);
s.rank = dot(1.0, 2.0);
s.rank = bitcast<f32>(vec2u(1u));
let x = &s.color.x;
*s = surface;
s += surface;
s.triangle_id += 1.0;
loop { continuing { break if 1.0; } }
for (var i = 0u; i < 4.0; i++) { }
const c = s.rank;
const_assert «1 > 2;
var x = vec3<f32, f32>(1.0);
let x = «effects.ink.amount; // effects
let x = «frame.size; // frame
s.color = «color[0]; // color
let x = «hash(1u); // //@ use lib/hash
s.color = «color_pack(s.color);
s = ink(s, p); // ink
"##;
    all(cases, with_statements);
}

#[test]
fn what_only_kernels_may_do() {
    let statements = "
«workgroupBarrier(); // barriers
«storageBarrier(); // barriers
«subgroupBarrier(); // subgroup
let x = «quadSwapX(1.0); // subgroup
let x = «dpdx(s.rank); // derivatives
let x = «dpdyFine(s.rank); // derivatives
let x = «fwidth(s.rank); // derivatives
let x = «textureLoad(t, vec2i(0), 0); // textures
let x = «atomicAdd(&s.triangle_id, 1u); // atomics
var x: «atomic<u32>; // atomics
let x = «arrayLength(&s); // bindings
«discard; // discard
var<«workgroup> x: u32; // workgroup memory
var<«private> x: u32; // variables outside functions
var<«storage> x: u32; // bindings
let x: ptr<«uniform, f32> = &s.rank; // bindings
var x: «sampler; // textures
var x: «texture_2d<f32>; // textures
";
    all(statements, with_statements);
    let declarations = r#"
«var<private> x: u32; // module scope
«var<storage, read_write> x: array<u32, 4>; // module scope
«@group(0) @binding(0) var<uniform> x: u32; // no binding
«@compute @workgroup_size(1) fn main() { } // entry point
«@must_use fn more() -> f32 { return 1.0; } // attributes
«override SCALE: f32 = 1.0; // override
«@id(3) override SCALE: f32 = 1.0; // attributes
«enable f16; // directives
«requires readonly_and_readwrite_storage_textures; // directives
«diagnostic(off, derivative_uniformity); // directives
«import package::x; // expected
«#include "x" // expected
«5 // expected
«} // closes nothing
«) // closes nothing
"#;
    all(declarations, with_declarations);
}

#[test]
fn names_that_are_taken() {
    let declarations = "
fn «helper(x: u32) -> u32 { return x; } // already declared
const «helper = 1.0; // already declared
struct «Ink { x: f32 } // already declared
fn «Surface() -> f32 { return 1.0; } // hook
alias «Sample = f32; // hook
fn «mix(x: f32) -> f32 { return x; } // WGSL itself
struct «vec3f { x: f32 } // WGSL itself
alias «f32 = u32; // WGSL itself
fn «class(x: f32) -> f32 { return x; } // reserved
const «_ = 1.0; // reserved
const «__x = 1.0; // reserved
struct Twice { x: f32, «x: f32 }¶fn twice(t: Twice) -> f32 { return t.x; }
fn «more // incomplete
fn «more() -> f32; // incomplete
«fn (x: f32) { } // name
«struct { x: f32 } // name
struct «More; // members
struct Empty { }¶fn empty(e: Empty) { }
const x = «1.0 // missing
const x = 1.0 +«;
const «x: u32 = 1.5; // u32
alias A = «Missing; // Missing
const A = B; const «B = A; // cyclic
struct A { b: B } struct B { a: A }
const_assert «false;
fn more(x: f32, x: f32) -> f32 { return x; }
fn more(x: f32) -> f32 { }
fn more(x: Missing) -> f32 { return 1.0; } // Missing
fn more(x) -> f32 { return 1.0; }
fn again(x: f32) -> f32 { return again(x); } // again
fn a(x: f32) -> f32 { return b(x); }¶fn b(x: f32) -> f32 { return a(x); }
";
    all(declarations, with_declarations);
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
fn members_with_a_mistake() {
    let cases = "
«amount: f32, // needs @range
«@range(NaN, 1.0, 0.5) amount: f32, // finite
«@range(0.0, inf, 0.5) amount: f32, // finite
«@range(0.0, 1e39, 0.5) amount: f32, // finite
«@range(1.0, 1.0, 1.0) amount: f32, // empty
«@range(0.0, 1e-60, 0.0) amount: f32, // empty in f32
«@range(0.0, 1.0, 2.0) amount: f32, // outside
«@range(0.0, 1.0, x) amount: f32, // finite
«@range(0.0, 1.0, ) amount: f32, // finite
«@range(0.0, 1.0) amount: f32, // takes min, max, default and nothing else
«@range() amount: f32, // takes
«@range amount: f32, // takes
@range(0.0, 1.0, 0.5 amount: f32, // must close
«@range(0, 1, 0, 0.1) amount: f32, // takes min, max, default and nothing else
«@range(0.5, 4, 1) count: u32, // whole
@range(0, 4, 1.5) «count: u32, // whole
«@range(-1, 4, 1) count: u32, // use i32 for negative numbers
«@range(0, 1e10, 1) count: u32, // lies within
«@range(-3e9, 4, 1) count: i32, // lies within
@range(0, 4, 1) «@hard(-5, 10) count: u32, // lies within
@range(0, 4, 1) «@hard(1, 10) count: u32, // contain
@range(0, 4, 1) «@hard(4, 0) count: u32, // ascending
@range(0, 4, 1) «@hard(0) count: u32, // takes
@range(0, 4, 9) @hard(0, 5) «count: u32, // default
«@rnge(0.0, 1.0, 0.5) amount: f32, // range
@range(0.0, 1.0, 0.5) «@range(0.0, 1.0, 0.5) amount: f32, // twice
@range(0.0, 1.0, 0.5) «@toggle(0) amount: f32, // exclude
«@toggle(0) amount: f32, // does not fit
«@toggle(2) on_off: u32, // 0 or 1
«@toggle on_off: u32, // 0 or 1
«@color(1.0, 0.0, 0.0) tint: f32, // does not fit
«@color(1.0, 0.0) tint: vec4f, // takes
@color(2.0, 0.0, 0.0) «tint: vec4f, // default
«@color(red) tint: vec4f, // takes
«@point(1.0, 0.0) at: vec4f, // takes
«@point(1.0, 0.0, NaN) at: vec4f, // finite
@point(1e9, 0.0, 0.0) «at: vec4f, // default
«tint: vec4f, // needs @color
@color(1, 0, 0) «tint: vec3f, // a parameter is
@range(0, 1, 0) «x: array<f32, 4>, // a parameter is
@range(0, 1, 0) «x: , // needs a type
@range(0, 1, 0) «x: // needs a type
@range(0, 1, 0) «x // needs a type
@range(0, 1, 0) // name: type
@ // name after @
@range(0, 1, 0.5) x: f32 «@range(0, 1, 0.5) y: f32 // expected ,
@range(0, 1, 0.5) x: f32«; @range(0, 1, 0.5) y: f32 // expected ,
«@choice(a) mode: u32, // 2 to 32
«@choice(a, a) mode: u32, // different
«@choice(A, B) mode: u32, // small letters
«@choice(a b, c) mode: u32, // small letters
«@choice(é, c) mode: u32, // small letters
«@choice(a, b) mode: f32, // does not fit
@choice(a, b) «@default(c) mode: u32, // takes one of
@choice(a, b) «@default mode: u32, // takes one of
@range(0, 1, 0.5) «@default(0.5) x: f32, // belongs to @choice
@range(0, 1, 0.5) «@when(mode, a) x: f32, // no choice mode
@range(0, 1, 0.5) y: f32, @range(0, 1, 0.5) «@when(y, a) x: f32, // no choice y
@choice(a, b) mode: u32, @range(0, 1, 0.5) «@when(mode, c) x: f32, // no word c
@choice(a, b) mode: u32, @range(0, 1, 0.5) «@when(mode) x: f32, // takes the name
@choice(a, b) mode: u32, @range(0, 1, 0.5) «@when x: f32, // takes the name
@choice(a, b) mode: u32, @range(0, 1, 0.5) «@when(mode, a¶b) x: f32, // no word
@range(0, 1, 0.5) «@log x: f32, // above 0
@range(0, 1, 0.5) y: f32, «@given(week) x: f32, // one of seconds
@range(0, 1, 0.5) y: f32, «@given(seconds) x: u32, // is f32, not u32
@range(0, 1, 0.5) y: f32, @given(seconds) «@unit(s) x: f32, // exclude
@range(0, 1, 0.5) «@soft(0, 1) x: f32, // belongs to a point
@range(0, 1, 0.5) «@height x: f32, // with a @unit
@range(1, 2, 1) «@log(2) x: f32, // @log
@range(0, 2, 1) «@log x: u32, // @log
@range(1, 2, 1) «@unit x: f32, // @unit
@range(1, 2, 1) «@unit() x: f32, // @unit
@range(1, 2, 1) «@unit(a, b) x: f32, // @unit
@range(1, 2, 1) «@unit(kilometers) x: f32, // @unit
@range(1, 2, 1) «@unit(a¶b) x: f32, // @unit
«@align(16) x: f32, // no attribute
@range(0, 1, 0.5) x: f32, @range(0, 1, 0.5) «x: f32, // twice
@range(0, 1, 0.5) «effect: f32, // preset
@range(0, 1, 0.5) «on: f32, // preset
@range(0, 1, 0.5) «static: f32, // reserved
@range(0, 1, 0.5) «höhe: f32, // letters
@range(0, 1, 0.5) «_x: f32, // letters
";
    all(cases, with_members);
    refused(&with_members(""), "at least one member");
    let member = |index: usize| format!("@range(0, 1, 0.5) x{index}: f32,\n");
    let many: String = (0..65).map(member).collect();
    refused(&with_members(&many), "at most 64");
    let long = format!("@range(0, 1, 0.5) «{}: f32,", "x".repeat(60));
    refused(&with_members(&long), "letters");
}

#[test]
fn hooks_with_a_mistake() {
    let cases = "
fn «f(s: Surface) -> Surface { return s; } // signature
fn «f(s: Surface, p: P) { } // signature
fn «f(s: Surface, p: P) -> vec4f { return s.color; } // signature
fn «f(s: Surface, p: f32) -> Surface { return s; } // signature
fn «f(s: Surface, p: P, q: f32) -> Surface { return s; } // signature
fn «f(s: Sample, p: P) -> Sample { return s; } // signature
fn «f(s: Surface, p: Surface) -> Surface { return s; } // signature
fn «f(s: Surface, p: array<f32, 4>) -> Surface { return s; } // signature
fn f(s: Surface, p: «R) -> Surface { return s; } // R
fn f(s: Surface, p: P) -> Surface { return s; }¶fn «g(s: Surface, p: P) -> Surface { return s; } // both
fn f(s: Surface, p: P) -> Surface { return s; }¶fn «g(x: Pixel, p: Q) -> Pixel { return x; } // same struct
fn «f(v: Vertex, p: Q) -> Vertex { return v; } // @unit(m)
fn f(s: Surface, p: Q) -> Surface { return s; }¶fn «g(x: Pixel, p: Q) -> Pixel { return x; } // no other hook
fn h(s: Surface, p: Q) -> Surface { return s; }¶AT // no other hook
@pass(half)¶fn «f(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); } // last pass
«@pass(third)¶AT // full, half or quarter
@pass(half)¶fn «g(x: f32) -> f32 { return x; }¶AT // no pass
@kept(4, 0.1)¶fn «f(at: ImageAt, p: Q) -> vec4f { return image_kept(at.x, at.y); } // is not kept; write another pass after it
@kept(4, 0.1)¶fn g(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }¶@kept(2, 0.1) @pass(half)¶fn «h(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }¶AT // g and h are both kept
«@kept(33, 0.1)¶fn g(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }¶AT // 1 to 32 earlier frames
«@kept(4, 0)¶fn g(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }¶AT // above 0 and at most 60
@kept(4, 0.1)¶fn «g(x: f32) -> f32 { return x; }¶AT // @kept stands before g, which is no pass
fn f(at: ImageAt, p: Q) -> vec4f { return «image_kept(at.x, at.y); } // write @kept(12, 0.04) before a pass
fn f(at: ImageAt, p: Q) -> vec4f { return «image_background(); } // pixel effect
";
    let at = "fn f(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }";
    let with_hooks = |hooks: &str| {
        let structs = "struct P { @range(0.0, 1.0, 0.5) @unit(m) amount: f32 }\nstruct Q { @range(0.0, 1.0, 0.5) amount: f32 }";
        format!("{structs}\n{}\n", hooks.replace("AT", at))
    };
    all(cases, with_hooks);
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
    let arrays = "
var a: array<f32, «100000000>; // length
var a: array<f32, «0>; // length
var a: array<f32, «-1>; // length
var a: array<f32, «1 << 20>; // length
var a: array<f32, «MANY>; // length
var a: «array<f32>; // length
let x = array<u32, «0xffffffff>()[7]; // length
var a: «array<f32; // not closed
«var a: array<f32, 4096>; // bytes
var a: array<array<array<array<array<f32, 2>, 2>, 2>, 2>, 2>; // inside each other
let a = array<array<f32, 4096>, 4096>(); // bytes
";
    all(arrays, |statement| {
        with_statements(statement) + "const MANY = 5000;"
    });
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
