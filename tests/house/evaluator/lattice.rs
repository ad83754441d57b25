//! Checks of expressions on a lattice of values.

use rasterlab::evaluator::{NoHost, Word};

use super::common::{call, floats, program, to_floats};

/// Values of one type.
pub trait Scalar: Copy + std::fmt::Debug + 'static {
    const NAME: &'static str;
    fn word(self) -> Word;
    fn value(word: Word) -> Self;
    /// Equal up to the rounding of f64.
    fn same(self, other: Self) -> bool;
    fn lattice() -> Vec<Self>;
}

impl Scalar for f64 {
    const NAME: &'static str = "f32";

    fn word(self) -> Word {
        Word::from_f64(self)
    }

    fn value(word: Word) -> f64 {
        word.to_f64()
    }

    fn same(self, other: f64) -> bool {
        self == other
            || self.is_nan() && other.is_nan()
            || (self - other).abs() <= 1e-12 * other.abs()
    }

    fn lattice() -> Vec<f64> {
        let (smallest, normal) = (f64::from(f32::from_bits(1)), f64::from(f32::MIN_POSITIVE));
        let two_to_31 = 2f64.powi(31);
        let mut values = vec![
            0.0, smallest, normal, 1e-30, 1e-4, 0.1, 0.25, 0.5, 0.75, 0.999, 1.0, 1.5, 2.0, 2.5,
            3.0, 3.5, 7.3, 127.5, 1000.25, 65504.0, 65520.0, 16777217.0, 1e30,
        ];
        values.extend([two_to_31 - 128.0, two_to_31, 2.0 * two_to_31, f64::INFINITY]);
        values.extend(values.clone().iter().map(|x| -x));
        values.push(f64::NAN);
        values
    }
}

/// A type of whole numbers or flags.
macro_rules! whole {
    ($type:ty, $from:ident, $to:ident, $lattice:expr) => {
        impl Scalar for $type {
            const NAME: &'static str = stringify!($type);

            fn word(self) -> Word {
                Word::$from(self)
            }

            fn value(word: Word) -> Self {
                word.$to()
            }

            fn same(self, other: Self) -> bool {
                self == other
            }

            fn lattice() -> Vec<Self> {
                $lattice
            }
        }
    };
}

whole!(i32, from_i32, to_i32, INTEGERS.to_vec());
whole!(
    u32,
    from_u32,
    to_u32,
    INTEGERS.map(i32::cast_unsigned).to_vec()
);
whole!(bool, from_bool, to_bool, vec![false, true]);

const INTEGERS: [i32; 19] = [
    0,
    1,
    -1,
    2,
    -2,
    3,
    7,
    -7,
    31,
    32,
    33,
    100,
    -100,
    0x12345678,
    -0x1234567,
    i32::MAX,
    i32::MIN,
    -i32::MAX,
    0x55555555,
];

/// Compares `expression` of `a`, `b` and `c` with what is expected.
#[track_caller]
pub fn three<A: Scalar, B: Scalar, C: Scalar, R: Scalar>(
    expression: &str,
    expected: impl Fn(A, B, C) -> R,
) {
    let [a, b, c, result] = [A::NAME, B::NAME, C::NAME, R::NAME];
    let source = format!("fn f(a: {a}, b: {b}, c: {c}) -> {result} {{ return {expression}; }}");
    let program = program(&source, "f");
    let mut machine = program.machine();
    for a in A::lattice() {
        for b in B::lattice() {
            for c in C::lattice() {
                let arguments = [a.word(), b.word(), c.word()];
                let result = machine.call(&arguments, &mut NoHost).expect("no loops")[0];
                let (given, expected) = (R::value(result), expected(a, b, c));
                assert!(
                    given.same(expected),
                    "{expression} at {:?} is {given:?} instead of {expected:?}",
                    (a, b, c)
                );
            }
        }
    }
}

#[track_caller]
pub fn two<A: Scalar, B: Scalar, R: Scalar>(expression: &str, expected: impl Fn(A, B) -> R) {
    three(expression, |a, b, _: Unused| expected(a, b));
}

#[track_caller]
pub fn one<A: Scalar, R: Scalar>(expression: &str, expected: impl Fn(A) -> R) {
    two(expression, |a, _: Unused| expected(a));
}

/// An argument that an expression does not name.
#[derive(Clone, Copy, Debug)]
struct Unused;

impl Scalar for Unused {
    const NAME: &'static str = "u32";

    fn word(self) -> Word {
        Word::ZERO
    }

    fn value(_: Word) -> Self {
        Self
    }

    fn same(self, _: Self) -> bool {
        true
    }

    fn lattice() -> Vec<Self> {
        vec![Self]
    }
}

/// A vector-valued or many-argument function, at chosen floats.
#[track_caller]
pub fn vectors(signature: &str, expression: &str, arguments: &[f64], expected: &[f64]) {
    let (arguments_of, result) = signature.split_once(" -> ").expect("a result");
    let source = format!("fn f({arguments_of}) -> {result} {{ return {expression}; }}");
    let program = program(&source, "f");
    let given = to_floats(&call(&program, &floats(arguments)));
    assert_eq!(given.len(), expected.len());
    for (given, expected) in given.iter().zip(expected) {
        assert!(
            (given - expected).abs() <= 1e-12 * (1.0 + expected.abs()),
            "{expression}: {given} instead of {expected}"
        );
    }
}

pub fn smaller(a: f64, b: f64) -> f64 {
    if a.is_nan() || b < a { b } else { a }
}

pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b > a { b } else { a }
}
