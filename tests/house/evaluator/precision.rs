//! Literals, precision, and threads.

use rasterlab::evaluator::{NoHost, Options, Precision, Program, Word};
use rayon::prelude::*;

use super::{
    common,
    common::{call, link, parse, program, program_with, single},
};

fn float(program: &Program, x: f64) -> f64 {
    call(program, &[Word::from_f64(x)])[0].to_f64()
}

#[test]
fn literals_are_the_numbers_that_were_written() {
    let cases = [
        ("fn f(x: f32) -> f32 { return x * 0.1; }", 3.0, 3.0 * 0.1),
        (
            "const C = 1e-6; fn f(x: f32) -> f32 { return x + C; }",
            0.0,
            1e-6,
        ),
        (
            "fn f(x: f32) -> f32 { return x + vec3f(0.7152).y; }",
            0.0,
            0.7152,
        ),
        (
            "var<private> p: vec2f = vec2f(0.3, 0.2126); fn f(x: f32) -> f32 { return x + p.y; }",
            0.0,
            0.2126,
        ),
        // naga computes constant expressions in f32.
        (
            "fn f(x: f32) -> f32 { return x + 1.0f / 3.0f; }",
            0.0,
            0.33333334,
        ),
    ];
    for (source, x, expected) in cases {
        assert_eq!(float(&program(source, "f"), x), expected, "{source}");
    }
    let source = "fn f(x: f32) -> f32 { return x * 0.017453292519943295; }";
    assert_eq!(float(&program(source, "f"), 1.0), 0.017453292);
    let with_source = Options {
        source: Some(source),
        ..Options::default()
    };
    assert_eq!(
        float(&program_with(source, "f", &with_source), 1.0),
        0.017453292519943295
    );
    for text in ["-0.5", "1.5f", "3", "2e3", "0x1p-3"] {
        let source = format!("fn f(x: f32) -> f32 {{ return x + {text}; }}");
        let options = Options {
            source: Some(&source),
            ..Options::default()
        };
        let program = program_with(&source, "f", &options);
        let expected = match text {
            "0x1p-3" => 0.125,
            decimal => decimal.trim_end_matches('f').parse().unwrap(),
        };
        assert_eq!(float(&program, 0.0), expected, "{text}");
    }
}

#[test]
fn single_precision_rounds_every_operation() {
    let source = "fn f(x: f32) -> f32 { return (x + 0.1) * 3.0 - x / 7.0; }";
    let x = 0.7f32;
    assert_eq!(
        float(&single(source, "f"), x.into()),
        f64::from((x + 0.1) * 3.0 - x / 7.0)
    );
    let x = f64::from(x);
    assert_eq!(float(&program(source, "f"), x), (x + 0.1) * 3.0 - x / 7.0);
    assert_eq!(
        float(&single("fn f(x: f32) -> f32 { return x * x; }", "f"), 1e30),
        f64::INFINITY
    );
    let clamped = single(
        "fn f(x: f32) -> vec2i { return vec2i(i32(x), i32(u32(x))); }",
        "f",
    );
    // The largest f32 that each integer type holds.
    assert_eq!(
        call(&clamped, &[Word::from_f64(1e20)]),
        [Word::from_i32(2147483520), Word::from_u32(4294967040)]
    );
}

#[test]
fn threads_share_a_program() {
    let source = link("toon");
    let program = program(&source, "toon");
    let parallel: Vec<u64> = (0..2000u32)
        .into_par_iter()
        .map_init(|| program.machine(), |machine, seed| sum(machine, seed))
        .collect();
    let mut machine = program.machine();
    let serial: Vec<u64> = (0..2000).map(|seed| sum(&mut machine, seed)).collect();
    assert_eq!(parallel, serial);
}

fn sum(machine: &mut rasterlab::evaluator::Machine, seed: u32) -> u64 {
    let mut random = common::Random(seed.into());
    let count = machine.program().argument_words();
    let mut arguments: Vec<Word> = (0..count)
        .map(|_| Word::from_f64(random.float(-1.0, 1.0)))
        .collect();
    arguments[46] = Word::from_u32(1 + random.u32(8));
    machine
        .call(&arguments, &mut NoHost)
        .unwrap()
        .iter()
        .fold(0, |sum, word| sum ^ word.to_bits().rotate_left(7))
}

/// Words of every kind give a result or an error, in both precisions.
#[test]
fn no_words_panic() {
    let mut random = common::Random(3);
    let odd = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        0.0,
        -0.0,
        5e-324,
        f64::MAX,
        1e30,
        -1e-30,
        4294967296.0,
    ];
    for effect in ["facet", "fog", "lambert", "toon", "hatch", "wobble"] {
        let module = parse(&link(effect));
        for precision in [Precision::Double, Precision::Single] {
            let program = Program::new(
                &module,
                effect,
                &Options {
                    precision,
                    limits: common::limits(10_000),
                    ..Options::default()
                },
            )
            .unwrap();
            let mut machine = program.machine();
            for _ in 0..2000 {
                let words: Vec<Word> = (0..program.argument_words())
                    .map(|_| match random.u32(3) {
                        0 => Word::from_f64(odd[random.u32(odd.len() as u32) as usize]),
                        1 => Word::from_f64(f64::from_bits(random.bits())),
                        _ => Word::from_u32(random.bits() as u32),
                    })
                    .collect();
                let _ = machine.call(&words, &mut NoHost);
            }
        }
    }
}
