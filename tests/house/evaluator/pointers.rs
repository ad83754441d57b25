//! Pointers, aliases, and the time that lowering takes.

use rasterlab::evaluator::Word;

use super::{
    common,
    common::{call, program},
};

fn evaluated(source: &str, arguments: &[i32]) -> Vec<i32> {
    let words: Vec<Word> = arguments.iter().map(|&x| Word::from_i32(x)).collect();
    call(&program(source, "f"), &words)
        .iter()
        .map(|word| word.to_i32())
        .collect()
}

#[test]
fn values_read_through_pointers_stay_as_they_were() {
    let two = "fn both(p: ptr<function, i32>, q: ptr<function, i32>) -> i32 { let x = *p; *q += 1; return x * 100 + *p; }";
    assert_eq!(
        evaluated(
            &format!("{two} fn f(a: i32) -> i32 {{ var x = a; var y = a; return both(&x, &y); }}"),
            &[3]
        ),
        [303]
    );
    let passed_on = "fn inner(p: ptr<function, vec2i>, v: vec2i) -> vec2i { (*p).x = 9; return v; }
        fn outer(p: ptr<function, vec2i>) -> vec2i { let r = inner(p, *p); return r * 10 + *p; }
        fn f(a: i32) -> vec2i { var v = vec2i(a, a); let p = &v; let r = outer(p); v.y = 0; return r + v; }";
    assert_eq!(evaluated(passed_on, &[2]), [20 + 9 + 9, 20 + 2]);
    let returned = "fn fetch(p: ptr<function, i32>) -> i32 { return *p; }
        fn f(a: i32) -> i32 { var x = a; let before = fetch(&x); x = 0; return before + x; }";
    assert_eq!(evaluated(returned, &[7]), [7]);
    let private = "var<private> g: array<i32, 3>; fn put(p: ptr<private, i32>, x: i32) { *p = x; }
        fn f(a: i32) -> i32 { let before = g[1]; put(&g[1], a); let after = g[1]; g[1] = 5; return before * 100 + after * 10 + g[1]; }";
    assert_eq!(evaluated(private, &[4]), [45]);
}

#[test]
fn dynamic_places_nest() {
    let source = "struct S { pad: i32, m: array<mat2x2f, 2>, n: array<array<vec3i, 2>, 3> }
        fn put(p: ptr<function, S>, i: i32, x: i32) { (*p).n[i][i - 1][i] = x; (*p).m[i - 1][1][i - 1] = f32(x); }
        fn f(i: i32, x: i32) -> vec4i {
            var s: S;
            put(&s, i, x);
            let row = s.n[i];
            let copy = s;
            s.n[i][0] = vec3i(0);
            return vec4i(row[i - 1].z, copy.n[2][1].z, s.n[i][i - 1][i], i32(copy.m[1][1].y) + i32(s.m[1][i - 1][i - 1]));
        }";
    assert_eq!(evaluated(source, &[2, 42]), [42, 42, 42, 84]);
}

#[test]
fn long_functions_are_lowered_in_time() {
    let mut source =
        "fn g(x: f32) -> f32 { return x * 0.5 + 1.0; }\nfn f(a: f32) -> f32 { var s = vec4f(a);\n"
            .to_owned();
    for at in 0..4000 {
        source.push_str(&format!(
            "let k{at} = g(s.x + s.y);\ns.{} = k{at};\n",
            ["x", "y", "z", "w"][at % 4]
        ));
    }
    source.push_str("for (var i = 0; i < 3; i++) {\n".repeat(30).as_str());
    source.push_str("s.x += k0 + k1;\n");
    source.push_str("}\n".repeat(30).as_str());
    source.push_str("return s.x; }");
    let module = common::parse(&source);
    // Asks for the real time: the promise is that this is quick, with a limit far above what it takes.
    let start = std::time::Instant::now();
    let lowered =
        rasterlab::evaluator::Program::new(&module, "f", &rasterlab::evaluator::Options::default());
    assert!(
        lowered.is_ok() && start.elapsed().as_secs() < 5,
        "{:?}",
        start.elapsed()
    );
}
