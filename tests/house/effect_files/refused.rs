//! Files that are refused. « stands before the place that the message must point to.

use std::sync::atomic::{AtomicUsize, Ordering};

use rasterlab::effect_files::{Catalog, EffectError, MAX_BYTES, check_name, read};

use super::{read_ink, with_declarations, with_members, with_statements};

/// Reads the text without its mark; it must be refused there, with these words.
fn refused(marked: &str, words: &str) -> EffectError {
    try_refused(marked, words).unwrap_or_else(|fault| panic!("{fault}"))
}

/// The error, or what is wrong with it.
fn try_refused(marked: &str, words: &str) -> Result<EffectError, String> {
    let offset = marked.find('«');
    let text = marked.replacen('«', "", 1);
    let error = match read_ink(&text) {
        Err(error) => error,
        Ok(_) => return Err(format!("accepted:\n{}", super::beginning(&text))),
    };
    COUNT.fetch_add(1, Ordering::Relaxed);
    println!("{error}");
    if !error.message.contains(words) {
        return Err(format!("{words:?} is not in:\n{error}"));
    }
    if let Some(offset) = offset {
        let Some(place) = &error.place else {
            return Err(format!("no place: {error}\n{marked}"));
        };
        let line = text[..offset].matches('\n').count() + 1;
        let column = text[..offset]
            .rsplit('\n')
            .next()
            .map_or(0, |line| line.chars().count())
            + 1;
        if (place.line as usize, place.column as usize) != (line, column) {
            return Err(format!("{line}:{column} is meant:\n{error}"));
        }
    }
    Ok(error)
}

/// Files that were refused as they should be.
static COUNT: AtomicUsize = AtomicUsize::new(0);

fn all(cases: &[(&str, &str)], wrap: impl Fn(&str) -> String) {
    let faults: Vec<String> = cases
        .iter()
        .filter_map(|(case, words)| try_refused(&wrap(case), words).err())
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
    println!("{} refused so far", COUNT.load(Ordering::Relaxed));
}

#[test]
fn statements_with_a_mistake() {
    let cases = [
        ("let x = «;", "expected"),
        ("let x = 1.0 «let y = 2.0;", "expected"),
        (
            "const x = «reflect(vec2f(1.0), vec2f(0.0, 1.0));",
            "write let in a function in place of const",
        ),
        ("var x = «smoothstep(0.0, 1.0, 0.25);", "as in 0.5f"),
        ("let = 1.0;", "expected"),
        ("let x = «missing;", "missing"),
        ("let x = «missing(1.0);", "missing"),
        ("let «x: u32 = 1.5;", "u32"),
        ("let «x: vec3f = vec2f(1.0);", "vec3"),
        ("s.color = «1.0;", ""),
        ("s.color.«q = 1.0;", "q"),
        ("s.«colour = vec4f(1.0);", "colour"),
        ("s.color = «vec4f(1.0) * vec3f(1.0);", "Multiply"),
        ("let x = 1u + 1.0;", ""),
        ("let x = 1.0 + true;", ""),
        ("if «1.0 { s.rank = 0.0; }", ""),
        ("if s.rank { s.rank = 0.0; }", ""),
        ("while 1u { }", ""),
        ("p.amount = 1.0;", ""),
        ("let x = 1.0; x = 2.0;", ""),
        ("surface.rank = 1.0;", ""),
        ("var x: f64 = 1.0;", ""),
        ("var x: f16 = 1.0h;", ""),
        ("var x: «Missing;", "Missing"),
        ("let x = helper();", ""),
        ("let x = «helper(1.0, 2.0);", "takes 1, and 2"),
        ("let x = helper(true);", ""),
        ("helper(vec3f(1.0));", ""),
        ("let x = vec3f(1.0, 2.0);", ""),
        ("let x = vec3f(1.0)[7];", ""),
        ("let a = array<f32, 3>(1.0, 2.0); let x = a[0];", ""),
        ("let a = array(1.0, 2.0); let x = a[5];", ""),
        ("return 1.0;", ""),
        ("return;", ""),
        ("«break;", ""),
        ("«continue;", ""),
        ("switch 1.0 { default: { } }", ""),
        ("switch 1u { case 1u: { } }", ""),
        ("switch 1u { case 1u: { } case 1u: { } default: { } }", ""),
        ("switch 1u { case 1i: { } default: { } }", ""),
        ("let fn = 1.0;", "fn"),
        ("let «class = 1.0;", "class"),
        ("let __x = 1.0;", ""),
        ("let x = 1.0; let «x = 2.0;", "x"),
        ("goto «end;", ""),
        ("s.rank = 1.0 / (1.0 - 1.0) + 0.5;", ""),
        ("let x = 99999999999999999999;", ""),
        ("let x = 1e999;", ""),
        ("let x = 5000000000u;", ""),
        ("let x = sqrt(«\"text\");", ""),
        ("let x = sqrt('a');", ""),
        ("let x = «#1;", ""),
        ("let x = 1.0 $ 2.0;", ""),
        ("s.rank = mix(0.0, 1.0);", ""),
        ("s.rank = max(1.0, 1u);", ""),
        ("s.rank = clamp(1.0);", ""),
        ("s.rank = dot(1.0, 2.0);", ""),
        ("s.normal = normalize(1.0);", ""),
        ("s.normal = cross(vec2f(1.0), vec2f(2.0));", ""),
        ("s.rank = select(1.0, 2.0, 3.0);", ""),
        ("s.rank = bitcast<f32>(vec2u(1u));", ""),
        ("let x = &s.color.x;", ""),
        ("let q = &s; q.missing = 1.0;", ""),
        ("*s = surface;", ""),
        ("s = p;", ""),
        ("s += surface;", ""),
        ("s.color++;", ""),
        ("s.triangle_id += 1.0;", ""),
        ("loop { continuing { break if 1.0; } }", ""),
        ("for (var i = 0u; i < 4.0; i++) { }", ""),
        ("const c = s.rank;", ""),
        ("const_assert «1 > 2;", ""),
        ("let x = ink(s, p).color;", ""),
        ("var x = vec3<f32, f32>(1.0);", ""),
        ("let x = «effects.ink.amount;", "effects"),
        ("let x = «frame.size;", "frame"),
        ("s.color = «color[0];", "color"),
        ("let x = «hash(1u);", "//@ use lib/hash"),
        ("s.color = «color_pack(s.color);", ""),
    ];
    all(&cases, with_statements);
}

#[test]
fn what_only_kernels_may_do() {
    let statements = [
        ("«workgroupBarrier();", "barriers"),
        ("«storageBarrier();", "barriers"),
        ("«textureBarrier();", "barriers"),
        ("«subgroupBarrier();", "subgroup"),
        ("let x = «subgroupAdd(1.0);", "subgroup"),
        ("let x = «quadSwapX(1.0);", "subgroup"),
        ("let x = «dpdx(s.rank);", "derivatives"),
        ("let x = «dpdyFine(s.rank);", "derivatives"),
        ("let x = «fwidth(s.rank);", "derivatives"),
        ("let x = «textureLoad(t, vec2i(0), 0);", "textures"),
        ("let x = «atomicAdd(&s.triangle_id, 1u);", "atomics"),
        ("var x: «atomic<u32>;", "atomics"),
        ("let x = «arrayLength(&s);", "bindings"),
        ("«discard;", "discard"),
        ("var<«workgroup> x: u32;", "workgroup memory"),
        ("var<«private> x: u32;", ""),
        ("var<«storage> x: u32;", "bindings"),
        ("let x: ptr<«uniform, f32> = &s.rank;", "bindings"),
        ("var x: «sampler;", "textures"),
        ("var x: «texture_2d<f32>;", "textures"),
    ];
    all(&statements, with_statements);
    let declarations = [
        ("«var<private> x: u32;", "module scope"),
        ("«var<workgroup> x: u32;", "module scope"),
        (
            "«var<storage, read_write> x: array<u32, 4>;",
            "module scope",
        ),
        ("«@group(0) @binding(0) var<uniform> x: u32;", "no binding"),
        (
            "«@group(0) @binding(0) var x: texture_2d<f32>;",
            "no binding",
        ),
        ("«@compute @workgroup_size(1) fn main() { }", "entry point"),
        (
            "«@fragment fn main() -> @location(0) vec4f { return vec4f(1.0); }",
            "entry point",
        ),
        ("«@must_use fn more() -> f32 { return 1.0; }", "attributes"),
        ("«override SCALE: f32 = 1.0;", "override"),
        ("«@id(3) override SCALE: f32 = 1.0;", "attributes"),
        ("«enable f16;", "directives"),
        (
            "«requires readonly_and_readwrite_storage_textures;",
            "directives",
        ),
        ("«diagnostic(off, derivative_uniformity);", "directives"),
        ("«import package::x;", "expected"),
        ("«#include \"x\"", "expected"),
        ("«5", "expected"),
        ("«}", "closes nothing"),
        ("«)", "closes nothing"),
    ];
    all(&declarations, with_declarations);
}

#[test]
fn names_that_are_taken() {
    let declarations = [
        (
            "fn «helper(x: u32) -> u32 { return x; }",
            "already declared",
        ),
        ("const «helper = 1.0;", "already declared"),
        ("struct «Ink { x: f32 }", "already declared"),
        ("fn «Surface() -> f32 { return 1.0; }", "hook"),
        ("struct «Vertex { x: f32 }", "hook"),
        ("struct «Pixel { x: f32 }", "hook"),
        ("alias «Sample = f32;", "hook"),
        ("fn «mix(x: f32) -> f32 { return x; }", "WGSL itself"),
        ("struct «vec3f { x: f32 }", "WGSL itself"),
        ("alias «f32 = u32;", "WGSL itself"),
        ("fn «function(x: f32) -> f32 { return x; }", "WGSL itself"),
        ("fn «class(x: f32) -> f32 { return x; }", "reserved"),
        ("const «_ = 1.0;", "reserved"),
        ("const «__x = 1.0;", "reserved"),
        ("fn «loop() { }", "reserved"),
        ("struct «static { x: f32 }", "reserved"),
        ("fn «atomicAdd(x: f32) -> f32 { return x; }", "WGSL itself"),
        (
            "struct Twice { x: f32, «x: f32 }\nfn twice(t: Twice) -> f32 { return t.x; }",
            "",
        ),
        ("fn «more", "incomplete"),
        ("fn «more() -> f32;", "incomplete"),
        ("«fn (x: f32) { }", "name"),
        ("«struct { x: f32 }", "name"),
        ("struct «More;", "members"),
        ("struct Empty { }\nfn empty(e: Empty) { }", ""),
        ("const x = «1.0", "missing"),
        ("const x = 1.0 +«; ", ""),
        ("const «x: u32 = 1.5;", "u32"),
        ("alias A = «Missing;", "Missing"),
        ("const A = B; const «B = A;", "cyclic"),
        ("alias A = B; alias «B = A;", "cyclic"),
        ("struct A { b: B } struct B { a: A }", ""),
        ("const_assert «false;", ""),
        ("fn more(x: f32, x: f32) -> f32 { return x; }", ""),
        ("fn more(x: f32) -> f32 { }", ""),
        ("fn more(x: Missing) -> f32 { return 1.0; }", "Missing"),
        ("fn more(x) -> f32 { return 1.0; }", ""),
    ];
    all(&declarations, with_declarations);
    let choice = "@choice(a, b-c, b_c) mode: u32,";
    refused(&with_members(choice), "INK_MODE_B_C");
    refused(
        &(with_members("@choice(a, b) mode: u32,") + "const «INK_MODE_A = 1u;"),
        "constant of a choice",
    );
    for name in [
        "toon", "stack", "fn", "array", "mix", "surface", "Ink", "ink__x", "ink_", "_ink", "9x",
        "", "in k", "é", "class",
    ] {
        assert!(check_name(name).is_err(), "{name}");
        let error =
            read("x.wgsl", name, &with_declarations("")).expect_err("a name that no effect has");
        assert!(!error.to_string().contains('\n'), "{error}");
    }
    assert!(check_name(&"x".repeat(41)).is_err());
}

#[test]
fn functions_that_call_themselves() {
    let declarations = [
        ("fn again(x: f32) -> f32 { return again(x); }", "again"),
        (
            "fn a(x: f32) -> f32 { return b(x); }\nfn b(x: f32) -> f32 { return a(x); }",
            "",
        ),
        (
            "fn a(x: f32) -> f32 { return b(x); }\nfn b(x: f32) -> f32 { return c(x); }\nfn c(x: f32) -> f32 { return a(x); }",
            "",
        ),
    ];
    all(&declarations, with_declarations);
    refused(&with_statements("s = ink(s, p);"), "ink");
}

#[test]
fn members_with_a_mistake() {
    let cases = [
        ("", "at least one member"),
        ("«amount: f32,", "needs @range"),
        ("@range(0.0, 1.0) amount: f32,", "takes min, max, default"),
        ("«@range(NaN, 1.0, 0.5) amount: f32,", "finite"),
        ("«@range(0.0, inf, 0.5) amount: f32,", "finite"),
        ("«@range(0.0, 1e39, 0.5) amount: f32,", "finite"),
        ("«@range(0.0, 1e400, 0.5) amount: f32,", "finite"),
        ("«@range(-infinity, 1.0, 0.5) amount: f32,", "finite"),
        ("«@range(1.0, 0.0, 0.5) amount: f32,", "empty"),
        ("«@range(1.0, 1.0, 1.0) amount: f32,", "empty"),
        ("«@range(0.0, 1e-60, 0.0) amount: f32,", "empty in f32"),
        ("«@range(0.0, 1.0, 2.0) amount: f32,", "outside"),
        ("«@range(0.0, 1.0, x) amount: f32,", "finite"),
        ("«@range(0.0, 1.0, ) amount: f32,", "finite"),
        ("«@range() amount: f32,", "takes"),
        ("«@range amount: f32,", "takes"),
        ("@range(0.0, 1.0, 0.5 amount: f32,", "must close"),
        ("«@range(0, 1, 0, 1, 2) amount: f32,", "takes"),
        (
            "«@range(0, 1, 0, 0.1) amount: f32,",
            "takes min, max, default and nothing else",
        ),
        ("«@range(0.5, 4, 1) count: u32,", "whole"),
        ("@range(0, 4, 1.5) «count: u32,", "whole"),
        ("«@range(-1, 4, 1) count: u32,", ""),
        ("«@range(0, 1e10, 1) count: u32,", "lies within"),
        ("«@range(-3e9, 4, 1) count: i32,", "lies within"),
        ("@range(0, 4, 1) «@hard(-5, 10) count: u32,", "lies within"),
        ("@range(0, 4, 1) «@hard(1, 10) count: u32,", "contain"),
        ("@range(0, 4, 1) «@hard(4, 0) count: u32,", "ascending"),
        ("@range(0, 4, 1) «@hard(0) count: u32,", "takes"),
        ("@range(0, 4, 9) @hard(0, 5) «count: u32,", "default"),
        ("«@rnge(0.0, 1.0, 0.5) amount: f32,", "range"),
        (
            "@range(0.0, 1.0, 0.5) «@range(0.0, 1.0, 0.5) amount: f32,",
            "twice",
        ),
        ("@range(0.0, 1.0, 0.5) «@toggle(0) amount: f32,", "exclude"),
        ("«@toggle(0) amount: f32,", "does not fit"),
        ("«@toggle(2) on_off: u32,", "0 or 1"),
        ("«@toggle on_off: u32,", "0 or 1"),
        ("«@color(1.0, 0.0, 0.0) tint: f32,", "does not fit"),
        ("«@color(1.0, 0.0) tint: vec4f,", "takes"),
        ("@color(2.0, 0.0, 0.0) «tint: vec4f,", "default"),
        ("@color(-1.0, 0.0, 0.0) «tint: vec4f,", "default"),
        ("«@color(red) tint: vec4f,", "takes"),
        ("«@point(1.0, 0.0) at: vec4f,", "takes"),
        ("«@point(1.0, 0.0, NaN) at: vec4f,", "finite"),
        ("@point(1e9, 0.0, 0.0) «at: vec4f,", "default"),
        ("«tint: vec4f,", "needs @color"),
        ("@color(1, 0, 0) «tint: vec3f,", "a parameter is"),
        ("@range(0, 1, 0) «x: bool,", "a parameter is"),
        ("@range(0, 1, 0) «x: array<f32, 4>,", "a parameter is"),
        ("@range(0, 1, 0) «x: Missing,", "a parameter is"),
        ("@range(0, 1, 0) «x: ,", "needs a type"),
        ("@range(0, 1, 0) «x:", "needs a type"),
        ("@range(0, 1, 0) «x,", "needs a type"),
        ("@range(0, 1, 0) «x", "needs a type"),
        ("@range(0, 1, 0)", "name: type"),
        ("@", "name after @"),
        (
            "@range(0, 1, 0.5) x: f32 «@range(0, 1, 0.5) y: f32",
            "expected ,",
        ),
        (
            "@range(0, 1, 0.5) x: f32«; @range(0, 1, 0.5) y: f32",
            "expected ,",
        ),
        ("«@choice(a) mode: u32,", "2 to 32"),
        ("«@choice(a, a) mode: u32,", "different"),
        ("«@choice(A, B) mode: u32,", "small letters"),
        ("«@choice(a b, c) mode: u32,", "small letters"),
        ("«@choice(é, c) mode: u32,", "small letters"),
        ("«@choice(a, b) mode: f32,", "does not fit"),
        ("@choice(a, b) «@default(c) mode: u32,", "takes one of"),
        ("@choice(a, b) «@default mode: u32,", "takes one of"),
        (
            "@range(0, 1, 0.5) «@default(0.5) x: f32,",
            "belongs to @choice",
        ),
        (
            "@range(0, 1, 0.5) «@when(mode, a) x: f32,",
            "no choice mode",
        ),
        (
            "@range(0, 1, 0.5) y: f32, @range(0, 1, 0.5) «@when(y, a) x: f32,",
            "no choice y",
        ),
        (
            "@choice(a, b) mode: u32, @range(0, 1, 0.5) «@when(mode, c) x: f32,",
            "no word c",
        ),
        (
            "@choice(a, b) mode: u32, @range(0, 1, 0.5) «@when(mode) x: f32,",
            "takes the name",
        ),
        (
            "@choice(a, b) mode: u32, @range(0, 1, 0.5) «@when x: f32,",
            "takes the name",
        ),
        (
            "@choice(a, b) mode: u32, @range(0, 1, 0.5) «@when(mode, a\nb) x: f32,",
            "no word",
        ),
        ("@range(0, 1, 0.5) «@log x: f32,", "above 0"),
        ("@range(1, 2, 1) «@log(2) x: f32,", "@log"),
        ("@range(1, 2, 1) «@log x: u32,", "@log"),
        ("@range(1, 2, 1) «@unit x: f32,", "@unit"),
        ("@range(1, 2, 1) «@unit() x: f32,", "@unit"),
        ("@range(1, 2, 1) «@unit(a, b) x: f32,", "@unit"),
        ("@range(1, 2, 1) «@unit(kilometers) x: f32,", "@unit"),
        ("@range(1, 2, 1) «@unit(a\nb) x: f32,", "@unit"),
        ("«@align(16) x: f32,", "no attribute"),
        (
            "@range(0, 1, 0.5) x: f32, @range(0, 1, 0.5) «x: f32,",
            "twice",
        ),
        ("@range(0, 1, 0.5) «effect: f32,", "preset"),
        ("@range(0, 1, 0.5) «on: f32,", "preset"),
        ("@range(0, 1, 0.5) «static: f32,", "reserved"),
        ("@range(0, 1, 0.5) «höhe: f32,", "letters"),
        ("@range(0, 1, 0.5) «_x: f32,", "letters"),
    ];
    all(&cases, with_members);
    let many: String = (0..65)
        .map(|index| format!("@range(0, 1, 0.5) x{index}: f32,\n"))
        .collect();
    refused(&with_members(&many), "at most 64");
    refused(
        &with_members(&format!("@range(0, 1, 0.5) «{}: f32,", "x".repeat(60))),
        "letters",
    );
}

#[test]
fn hooks_with_a_mistake() {
    let member = "struct P { @range(0.0, 1.0, 0.5) @unit(m) amount: f32 }\nstruct Q { @range(0.0, 1.0, 0.5) amount: f32 }\n";
    let cases = [
        ("", "no function has the signature"),
        ("fn «f(s: Surface) -> Surface { return s; }", "signature"),
        ("fn «f(s: Surface, p: P) { }", "signature"),
        (
            "fn «f(s: Surface, p: P) -> vec4f { return s.color; }",
            "signature",
        ),
        (
            "fn «f(s: Surface, p: f32) -> Surface { return s; }",
            "signature",
        ),
        (
            "fn «f(s: Surface, p: P, q: f32) -> Surface { return s; }",
            "signature",
        ),
        (
            "fn «f(s: Sample, p: P) -> Sample { return s; }",
            "signature",
        ),
        (
            "fn «f(s: Surface, p: Surface) -> Surface { return s; }",
            "signature",
        ),
        (
            "fn «f(s: Surface, p: array<f32, 4>) -> Surface { return s; }",
            "signature",
        ),
        ("fn f(s: Surface, p: «R) -> Surface { return s; }", "R"),
        (
            "fn f(s: Surface, p: P) -> Surface { return s; }\nfn «g(s: Surface, p: P) -> Surface { return s; }",
            "both",
        ),
        (
            "fn f(s: Surface, p: P) -> Surface { return s; }\nfn «g(x: Pixel, p: Q) -> Pixel { return x; }",
            "same struct",
        ),
        ("fn «f(v: Vertex, p: Q) -> Vertex { return v; }", "@unit(m)"),
        (
            "fn f(s: Surface, p: Q) -> Surface { return s; }\nfn «g(x: Pixel, p: Q) -> Pixel { return x; }",
            "no other hook",
        ),
        (
            "//@ use lib/image\nfn f(s: Surface, p: Q) -> Surface { return s; }",
            "no other hook",
        ),
        (
            "fn f(s: Surface, p: Q) -> Surface { return s; }\nfn g(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }",
            "no other hook",
        ),
        (
            "@pass(half)\nfn «f(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }",
            "last pass",
        ),
        (
            "«@pass(third)\nfn f(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }",
            "full, half or quarter",
        ),
        (
            "@pass(half)\nfn «g(x: f32) -> f32 { return x; }\nfn f(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }",
            "no pass",
        ),
        (
            "@kept(4, 0.1)\nfn «f(at: ImageAt, p: Q) -> vec4f { return image_kept(at.x, at.y); }",
            "is not kept; write another pass after it",
        ),
        (
            "@kept(4, 0.1)\nfn g(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }\n@kept(2, 0.1) @pass(half)\nfn «h(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }\nfn f(at: ImageAt, p: Q) -> vec4f { return image_last(at.x, at.y); }",
            "g and h are both kept",
        ),
        (
            "«@kept(33, 0.1)\nfn g(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }\nfn f(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }",
            "1 to 32 earlier frames",
        ),
        (
            "«@kept(4, 0)\nfn g(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }\nfn f(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }",
            "above 0 and at most 60",
        ),
        (
            "@kept(4, 0.1)\nfn «g(x: f32) -> f32 { return x; }\nfn f(at: ImageAt, p: Q) -> vec4f { return vec4f(0.0); }",
            "@kept stands before g, which is no pass",
        ),
        (
            "fn f(at: ImageAt, p: Q) -> vec4f { return «image_kept(at.x, at.y); }",
            "write @kept(12, 0.04) before a pass",
        ),
        (
            "fn f(at: ImageAt, p: Q) -> vec4f { return «image_background(); }",
            "pixel effect",
        ),
    ];
    for (case, words) in cases {
        refused(&format!("{member}{case}\n"), words);
    }
    for empty in [
        "",
        "\n\n",
        "// nothing",
        "/* nothing */",
        "\u{feff}",
        "struct P { @range(0, 1, 0) x: f32 }",
    ] {
        refused(empty, "no function has the signature");
    }
    for (used, words) in [
        ("lib/nothing", "may use"),
        ("stages/shade/resolve", "may use"),
        ("lib/frame", "may use"),
        ("glue/draws", "may use"),
    ] {
        refused(
            &format!("«//@ use {used}\n{}", with_declarations("")),
            words,
        );
    }
    refused(
        &format!(
            "«//@ binding var<uniform> x: u32;\n{}",
            with_declarations("")
        ),
        "may use",
    );
}

#[test]
fn brackets_and_characters() {
    let statements = [
        ("{ «(", "not closed"),
        ("let x = (1.0«];", "where ) must close"),
        ("let x = vec2f(1.0, 2.0«};", "where ) must close"),
        ("let x = array<f32, 2>(1.0, 2.0)[0«);", "where ] must close"),
        ("«/* open", "no end"),
        ("/* /* nested */ «", ""),
        ("let x = 1.0; «\u{7}", "U+0007"),
        ("let x = 1.0; // hidden «\r discard;", "U+000D"),
        ("let x = 1.0; // hidden «\u{2028} discard;", "U+2028"),
        ("let x = 1.0; // hidden «\u{85} discard;", "U+0085"),
        ("let x = 1.0; «\u{feff}", "U+FEFF"),
        ("let x = 1.0; «\0", "U+0000"),
        ("\tlet «x: u32 =\t1.5;", ""),
    ];
    for (case, words) in statements {
        if case.starts_with("/* /*") {
            continue;
        }
        // What is opened and not closed is the innermost bracket only where the file ends with it.
        let text = if words == "not closed" {
            format!("fn f() {{ {}", case)
        } else {
            with_statements(case)
        };
        let text = if words == "not closed" {
            text.replacen('«', "", 1)
        } else {
            text
        };
        refused(&text, words);
    }
    refused("fn f() «{ if true { }", "not closed");
    refused(
        &with_declarations("}")
            .replacen("}", "«}", 99)
            .replace("«}", "}"),
        "closes nothing",
    );
    let long = format!("{}let «x: u32 = 1.5;{}", " ".repeat(3000), " ".repeat(3000));
    refused(&with_statements(&long), "");
    refused(
        &with_statements(&format!("let x = {}«missing;", "1.0 + ".repeat(60))),
        "missing",
    );
}

#[test]
fn what_is_too_large_or_too_deep() {
    let nested = |open: &str, middle: &str, close: &str, count: usize| {
        format!("{}{middle}{}", open.repeat(count), close.repeat(count))
    };
    for count in [100, 10_000] {
        let statements = [
            format!("let x = {};", nested("(", "1.0", ")", count)),
            nested("{", "", "}", count),
            format!("let x = {};", nested("vec3f(", "1.0", ")", count.min(9000))),
            format!("let x = {};", nested("a[", "0", "]", count)),
            format!(
                "if true {{ }}{}",
                " else if true { }".repeat(count.min(3000))
            ),
            nested("if true {", "", "}", count.min(5000)),
            nested("loop {", "", "}", count.min(5000)),
        ];
        for statement in statements {
            refused(&with_statements(&statement), "inside each other");
        }
        let statements = [
            format!("let x = 1.0{};", " + 1.0".repeat(count.clamp(300, 9000))),
            format!("let x = {}1.0;", "-".repeat(count.max(300))),
            format!("let x = {}true;", "!".repeat(count.max(300))),
            format!("let x = {}s;", "&*".repeat(count.max(300))),
            format!("let x = s{};", ".x".repeat(count.max(300))),
            format!("let x = s{};", "[0]".repeat(count.max(300))),
            format!("let x = true{};", " && true".repeat(count.clamp(300, 7000))),
        ];
        for statement in statements {
            refused(&with_statements(&statement), "operators");
        }
        // Brackets that are never closed.
        refused(&with_statements(&"(".repeat(count)), "inside each other");
        refused(&with_statements(&"{".repeat(count)), "inside each other");
    }
    let arrays = [
        ("var a: array<f32, «100000000>;", "length"),
        ("var a: array<f32, «4294967295u>;", "length"),
        ("var a: array<f32, «0>;", "length"),
        ("var a: array<f32, «-1>;", "length"),
        ("var a: array<f32, «1 << 20>;", "length"),
        ("var a: array<f32, «MANY>;", "length"),
        ("var a: «array<f32>;", "length"),
        ("let x = array<u32, «1000000000>()[7];", "length"),
        ("let x = array<u32, «0xffffffff>()[7];", "length"),
        ("var a: «array<f32;", "not closed"),
        ("«var a: array<f32, 4096>;", "bytes"),
        (
            "var a: array<array<array<array<array<f32, 2>, 2>, 2>, 2>, 2>;",
            "inside each other",
        ),
        (
            "var a: array<array<array<array<f32, 4096>, 4096>, 4096>, 4096>;",
            "",
        ),
        ("let a = array<array<f32, 4096>, 4096>();", "bytes"),
    ];
    all(&arrays, |statement| {
        with_statements(statement) + "const MANY = 5000;"
    });
    let doubling: String = (1..30)
        .map(|level| format!("struct S{level} {{ a: S{0}, b: S{0} }}\n", level - 1))
        .collect();
    refused(
        &with_declarations(&format!(
            "struct S0 {{ x: vec4f }}\n{doubling}fn large(s: S29) -> f32 {{ return 1.0; }}"
        )),
        "",
    );
    let tree: String = (1..40)
        .map(|level| {
            format!(
                "fn t{level}(x: f32) -> f32 {{ return t{0}(x) + t{0}(x + 1.0); }}\n",
                level - 1
            )
        })
        .collect();
    let text = with_statements("s.rank = t39(s.rank);")
        + "fn t0(x: f32) -> f32 { return x * x; }\n"
        + &tree;
    refused(&text, "needs more than");
    // Long code may have no loops: together they would take too long on every pixel.
    let looped = "for (var i = 0; i < 9; i += 1) { s.rank += t12(s.rank); }";
    let text = with_statements(looped) + "fn t0(x: f32) -> f32 { return x * x; }\n" + &tree;
    refused(&text, "an effect with loops has at most");
    read_ink(
        &(with_statements("s.rank = t12(s.rank);")
            + "fn t0(x: f32) -> f32 { return x * x; }\n"
            + &tree),
    )
    .expect("without a loop it is read");
    let chain: String = (1..1200)
        .map(|level| {
            format!(
                "fn t{level}(x: f32) -> f32 {{ return t{}(x); }}\n",
                level - 1
            )
        })
        .collect();
    let text = with_statements("s.rank = t1199(s.rank);")
        + "fn t0(x: f32) -> f32 { return x * x; }\n"
        + &chain;
    refused(&text, "deep");
    refused(&" ".repeat(MAX_BYTES + 1), "bytes");
    refused(&"x".repeat(1 << 20), "bytes");
    refused(&"x".repeat(MAX_BYTES), "");
    refused(&"@".repeat(MAX_BYTES), "");
    refused(&"((".repeat(MAX_BYTES / 2), "inside each other");
    refused(&"/*".repeat(MAX_BYTES / 2), "no end");
    refused(&"fn ".repeat(MAX_BYTES / 3), "");
}

#[test]
fn files_that_are_no_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut catalog = Catalog::default();
    let cases: [(&str, Vec<u8>, &str); 6] = [
        ("latin", b"// caf\xe9\nfn f() { }\n".to_vec(), "UTF-8"),
        (
            "wide",
            "fn f() { }"
                .encode_utf16()
                .flat_map(u16::to_le_bytes)
                .collect(),
            "U+0000",
        ),
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
    let place = catalog
        .find("latin")
        .expect_err("it is no effect")
        .place
        .as_ref()
        .expect("a place");
    assert_eq!((place.line, place.column), (1, 7));
    assert_eq!(catalog.effects().count(), rasterlab::effects::EFFECTS.len());
}
