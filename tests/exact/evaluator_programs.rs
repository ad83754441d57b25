//! Promise: random programs on whole numbers and floats that no operation rounds, conversions among
//! them, give the same on the adapter and in the evaluator, to the bit. Needs an adapter.

use rasterlab_fuzz::stress::scenes::Rng;

use super::evaluator_gpu::{WHOLE, compare};

const PROGRAMS: usize = 96;
const DEPTH: u32 = 5;

/// One of these shapes, where U, I, F and B are values of a type: u32, i32, f32 and bool.
fn shape(rng: &mut Rng, kind: char, depth: u32) -> &'static str {
    let shapes: &[&str] = match (kind, depth) {
        ('U', 0) => &["a", "b", "c"],
        ('I', 0) => &["i32(a)", "i32(b)", "i32(c)"],
        ('F', 0) => &["f32(a)", "f32(i32(b))", "f32(i32(c))"],
        ('B', 0) => &["(a < b)", "(i32(b) < i32(c))"],
        ('U', _) => &[
            "(U + U)",
            "(U - U)",
            "(U * U)",
            "(U / U)",
            "(U % U)",
            "(U ^ U)",
            "(U & U)",
            "(U << (U & 31u))",
            "(U >> (U & 31u))",
            "min(U, U)",
            "u32(I)",
            "u32(F)",
            "u32(F)",
            "u32(B)",
            "select(U, U, B)",
            "countOneBits(U)",
        ],
        ('I', _) => &[
            "(I + I)",
            "(I - I)",
            "(I * I)",
            "(I / I)",
            "(I % I)",
            "(I | I)",
            "(-I)",
            "abs(I)",
            "max(I, I)",
            "(I >> (U & 31u))",
            "i32(U)",
            "i32(F)",
            "i32(F)",
            "select(I, I, B)",
        ],
        ('F', _) => &[
            "f32(I)",
            "f32(U)",
            "(F * 1024.0)",
            "(F * 0.001953125)",
            "floor(F)",
            "ceil(F)",
            "round(F)",
            "trunc(F)",
            "abs(F)",
            "(-F)",
            "min(F, F)",
            "max(F, F)",
            "sign(F)",
            "step(F, F)",
            "select(F, F, B)",
        ],
        _ => &[
            "(U <= U)", "(I > I)", "(F < F)", "(F >= F)", "(F == F)", "(!B)", "(B && B)", "(B | B)",
        ],
    };
    shapes[rng.between(0, shapes.len() as i32) as usize]
}

fn expression(rng: &mut Rng, kind: char, depth: u32) -> String {
    let shape = shape(rng, kind, depth);
    let part = |c: char| match c {
        'U' | 'I' | 'F' | 'B' => expression(rng, c, depth - 1),
        other => other.into(),
    };
    // A name of a function has no capital that is a type, but for those with `Bits`.
    let (name, rest) = match shape.strip_prefix("countOneBits") {
        Some(rest) => ("countOneBits", rest),
        None => ("", shape),
    };
    name.to_owned() + &rest.chars().map(part).collect::<String>()
}

#[test]
fn random_programs_give_the_same() {
    let mut rng = Rng(50);
    let texts: Vec<String> = (0..PROGRAMS)
        .map(|_| expression(&mut rng, 'U', DEPTH))
        .collect();
    let expressions: Vec<&str> = texts.iter().map(String::as_str).collect();
    compare("u32", &expressions, &WHOLE, |_, _, evaluated, found| {
        evaluated == found
    });
}
