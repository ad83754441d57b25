//! Limits, errors, and what cannot be lowered.

use rasterlab::evaluator::{EvalError, Host, LowerError, NoHost, Options, Program, Word};

use super::{
    common,
    common::{call, limits, parse, program, program_with},
};

fn refused(source: &str, function: &str) -> LowerError {
    match Program::new(&parse(source), function, &Options::default()) {
        Err(error) => error,
        Ok(_) => panic!("lowered:\n{source}"),
    }
}

#[test]
fn endless_loops_stop() {
    let source = "
        fn inner(n: u32) -> u32 { var i = n; loop { i += 1u; if i == 0u && n == 1u { break; } } return i; }
        fn outer(n: u32) -> u32 { return inner(n) + 1u; }
        fn count(n: u32) -> u32 { var sum = 0u; for (var i = 0u; i < n; i++) { sum += i; } return sum; }";
    let limited = |function: &str, steps| {
        let options = Options {
            limits: limits(steps),
            ..Options::default()
        };
        program_with(source, function, &options)
    };
    let endless = limited("outer", 100_000);
    let stopped = endless
        .machine()
        .call(&[Word::from_u32(2)], &mut NoHost)
        .unwrap_err();
    let function = "inner".to_owned();
    assert_eq!(
        stopped,
        EvalError::Steps {
            steps: 100_000,
            function
        }
    );
    let count = limited("count", 10_000);
    let mut machine = count.machine();
    // A machine works after an error as before.
    for (n, sum) in [(100, Some(4950)), (100_000, None), (100, Some(4950))] {
        let result = machine.call(&[Word::from_u32(n)], &mut NoHost);
        assert_eq!(result.ok().map(|words| words[0].to_u32()), sum);
    }
}

#[test]
fn large_arrays_are_refused() {
    for body in [
        "var a: array<f32, 100000000>; a[i] = 1.0; return a[i / 2u];",
        "var a: array<array<array<vec4f, 300>, 300>, 400>; return a[i][i][i].x;",
    ] {
        let error = refused(&format!("fn f(i: u32) -> f32 {{ {body} }}"), "f");
        assert!(matches!(error, LowerError::Slots { .. }), "{error}");
    }
}

#[test]
fn trees_of_calls_are_refused() {
    // Each function calls the one before, called T, as its text says.
    let calling = |first: &str, next: &str, count: usize| -> String {
        let next = |level: usize| {
            next.replace('N', &level.to_string())
                .replace('T', &format!("t{}", level - 1))
        };
        first.to_owned() + &(1..count).map(next).collect::<String>()
    };
    let tree = calling(
        "fn t0(x: f32) -> f32 { return x * x + 1.0; }",
        "fn tN(x: f32) -> f32 { return T(x) + T(x + 1.0); }",
        60,
    );
    let error = refused(&tree, "t59");
    assert!(
        matches!(
            error,
            LowerError::Instructions { .. } | LowerError::Slots { .. }
        ),
        "{error}"
    );
    let constant = calling(
        "fn t0() -> u32 { return 1u; }",
        "fn tN() -> u32 { return T() + T(); }",
        60,
    );
    let error = refused(&constant, "t59");
    assert!(matches!(error, LowerError::Instructions { .. }), "{error}");
    let chain = calling(
        "fn t0(x: f32) -> f32 { return x; }",
        "fn tN(x: f32) -> f32 { return T(x); }",
        3000,
    );
    let error = refused(&chain, "t2999");
    assert!(matches!(error, LowerError::Depth { .. }), "{error}");
}

#[test]
fn unsupported_code_is_named_with_its_line() {
    let source = "@group(0) @binding(0) var t: texture_2d<f32>;
        @group(0) @binding(1) var<storage, read_write> counters: array<atomic<u32>, 4>;
        @group(0) @binding(2) var<uniform> size: vec2u;
        @group(0) @binding(3) var<storage, read_write> out: array<f32, 4>;
        var<workgroup> shared_sum: u32;
        fn texture(x: i32) -> f32 {
            let y = x + 1;
            return textureLoad(t, vec2i(x, y), 0).x;
        }
        fn atomics(x: u32) -> u32 { return atomicAdd(&counters[x], 1u); }
        fn derivative(x: f32) -> f32 { return dpdx(x); }
        fn barrier(x: u32) -> u32 { workgroupBarrier(); return x; }
        fn uniform_size() -> u32 { return size.x; }
        fn written(x: f32) { out[0] = x; }
        fn in_workgroup() -> u32 { return shared_sum; }
        fn pointer(p: ptr<function, f32>) -> f32 { return *p; }
        fn outer(x: i32) -> f32 { return 2.0 * texture(x); }";
    let line = |error: &LowerError| error.line(source);
    let texture = refused(source, "texture");
    assert!(texture.to_string().contains("uses a texture"), "{texture}");
    assert_eq!(line(&texture), Some(8));
    assert!(refused(source, "outer").to_string().contains("`texture`"));
    for (function, word, at) in [
        ("atomics", "counters", 10),
        ("derivative", "derivative", 11),
        ("barrier", "barrier", 12),
        ("uniform_size", "size", 13),
        ("written", "out", 14),
        ("in_workgroup", "shared_sum", 15),
        ("pointer", "pointer", 16),
    ] {
        let error = refused(source, function);
        assert!(error.to_string().contains(word), "{error}");
        assert_eq!(line(&error), Some(at), "{error}");
    }
    assert_eq!(
        refused(source, "nothing"),
        LowerError::NoFunction("nothing".to_owned())
    );
    // A store to what the host supplies is no less refused.
    let options = Options {
        globals: vec!["out".to_owned(), "counters".to_owned()],
        ..Options::default()
    };
    for function in ["written", "atomics"] {
        assert!(matches!(
            Program::new(&parse(source), function, &options),
            Err(LowerError::Unsupported { .. })
        ));
    }
}

#[test]
fn arguments_are_counted() {
    let program = program(
        "fn f(a: vec3f, b: u32) -> f32 { return a.x * f32(b); }",
        "f",
    );
    assert_eq!((program.argument_words(), program.result_words()), (4, 1));
    let error = program
        .machine()
        .call(&[Word::ZERO], &mut NoHost)
        .unwrap_err();
    assert_eq!(
        error,
        EvalError::Arguments {
            expected: 4,
            given: 1
        }
    );
}

#[test]
fn overrides_take_their_values() {
    let source = "override SCALE: f32 = 2.0; override TWICE = SCALE * 2.0; override ON: bool = false; override COUNT: u32;
        @id(7) override LEVEL: i32 = -3;
        fn scaled(x: f32) -> f32 { if ON { return x; } return x * TWICE; }
        fn counted() -> u32 { return COUNT; }
        fn level() -> i32 { return LEVEL; }";
    let three = Word::from_f64(3.0);
    let cases = [
        ("scaled", None, Word::from_f64(12.0)),
        ("scaled", Some(("SCALE", 0.1)), Word::from_f64(3.0 * 0.2)),
        ("scaled", Some(("ON", 1.0)), three),
        ("counted", Some(("COUNT", 5.0)), Word::from_u32(5)),
        ("level", Some(("7", -9.0)), Word::from_i32(-9)),
        ("level", None, Word::from_i32(-3)),
    ];
    for (function, set, expected) in cases {
        let overrides = set.map(|(name, value)| (name.to_owned(), value));
        let options = Options {
            overrides: overrides.into_iter().collect(),
            ..Options::default()
        };
        let arguments = if function == "scaled" {
            &[three][..]
        } else {
            &[]
        };
        let program = program_with(source, function, &options);
        assert_eq!(call(&program, arguments), [expected], "{function} {set:?}");
    }
    let name = "COUNT".to_owned();
    assert_eq!(refused(source, "counted"), LowerError::Override { name });
}

struct Square;

impl Host for Square {
    fn external(&mut self, index: usize, arguments: &[Word], result: &mut [Word]) {
        assert_eq!((index, arguments.len(), result.len()), (1, 3, 2));
        let (x, y, n) = (
            arguments[0].to_f64(),
            arguments[1].to_f64(),
            arguments[2].to_u32(),
        );
        result[0] = Word::from_f64(x * x * f64::from(n));
        result[1] = Word::from_f64(y * y * f64::from(n));
    }
}

#[test]
fn the_host_computes_its_functions_and_supplies_variables() {
    let source = "struct Frame { size: vec2u, scale: f32 }
        @group(0) @binding(0) var<uniform> frame: Frame;
        @group(0) @binding(1) var<storage, read> table: array<vec2f, 3>;
        @group(0) @binding(2) var t: texture_2d<f32>;
        var<private> calls: u32 = 5u;
        var<private> seed: u32;
        fn other() {}
        fn square(v: vec2f, n: u32) -> vec2f { return textureLoad(t, vec2u(v), 0).xy * f32(n); }
        fn f(v: vec2f, i: u32) -> vec3f {
            calls += 1u;
            seed += calls;
            let a = square(v + table[i], 2u);
            let b = square(v, frame.size.y);
            return vec3f(a + b, f32(seed)) * frame.scale;
        }";
    let options = Options {
        externals: ["other", "square"].map(String::from).into(),
        globals: ["frame", "absent", "table", "seed"]
            .map(String::from)
            .into(),
        ..Options::default()
    };
    let program = program_with(source, "f", &options);
    assert_eq!(program.global_words(2), Some(6));
    assert_eq!(program.global_words(1), None);
    let mut machine = program.machine();
    let frame = [Word::from_u32(8), Word::from_u32(3), Word::from_f64(10.0)];
    machine.set_global(0, &frame).unwrap();
    let table = common::floats(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    machine.set_global(2, &table).unwrap();
    machine.set_global(3, &[Word::from_u32(100)]).unwrap();
    assert!(machine.set_global(0, &[Word::ZERO]).is_err());
    for _ in 0..3 {
        let arguments = [Word::from_f64(1.0), Word::from_f64(-1.0), Word::from_u32(1)];
        let result = common::to_floats(machine.call(&arguments, &mut Square).unwrap());
        assert_eq!(result, [(32.0 + 3.0) * 10.0, (18.0 + 3.0) * 10.0, 1060.0]);
    }
}
