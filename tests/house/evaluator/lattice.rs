//! Checks of expressions on a lattice of values.

use rasterlab::evaluator::Word;

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
        let smallest = f64::from(f32::from_bits(1));
        let mut values = vec![
            0.0,
            smallest,
            f64::from(f32::MIN_POSITIVE),
            1e-30,
            1e-4,
            0.1,
            0.25,
            0.5,
            0.75,
            0.999,
            1.0,
            1.5,
            2.0,
            2.5,
            3.0,
        ];
        values.extend([
            3.5,
            7.3,
            127.5,
            1000.25,
            65504.0,
            65520.0,
            16777217.0,
            2147483520.0,
            2147483648.0,
            4294967296.0,
            1e30,
            f64::INFINITY,
        ]);
        values.extend(values.clone().iter().map(|x| -x));
        values.push(f64::NAN);
        values
    }
}

impl Scalar for i32 {
    const NAME: &'static str = "i32";

    fn word(self) -> Word {
        Word::from_i32(self)
    }

    fn value(word: Word) -> i32 {
        word.to_i32()
    }

    fn same(self, other: i32) -> bool {
        self == other
    }

    fn lattice() -> Vec<i32> {
        vec![
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
            0x1234_5678,
            -0x1234_5678,
            i32::MAX,
            i32::MIN,
            i32::MIN + 1,
            0x5555_5555,
        ]
    }
}

impl Scalar for u32 {
    const NAME: &'static str = "u32";

    fn word(self) -> Word {
        Word::from_u32(self)
    }

    fn value(word: Word) -> u32 {
        word.to_u32()
    }

    fn same(self, other: u32) -> bool {
        self == other
    }

    fn lattice() -> Vec<u32> {
        i32::lattice().into_iter().map(i32::cast_unsigned).collect()
    }
}

impl Scalar for bool {
    const NAME: &'static str = "bool";

    fn word(self) -> Word {
        Word::from_bool(self)
    }

    fn value(word: Word) -> bool {
        word.to_bool()
    }

    fn same(self, other: bool) -> bool {
        self == other
    }

    fn lattice() -> Vec<bool> {
        vec![false, true]
    }
}

#[track_caller]
pub fn check<R: Scalar>(expression: &str, at: &dyn std::fmt::Debug, given: R, expected: R) {
    assert!(
        given.same(expected),
        "{expression} at {at:?} is {given:?} instead of {expected:?}"
    );
}

/// `expression` of `a`, for scalars and for a component of a vector.
#[track_caller]
pub fn one<A: Scalar, R: Scalar>(expression: &str, expected: impl Fn(A) -> R) {
    let scalar = program(
        &format!(
            "fn f(a: {}) -> {} {{ return {expression}; }}",
            A::NAME,
            R::NAME
        ),
        "f",
    );
    let mut machine = scalar.machine();
    for a in A::lattice() {
        let given = machine
            .call(&[a.word()], &mut rasterlab::evaluator::NoHost)
            .expect("no loops")[0];
        check(expression, &a, R::value(given), expected(a));
    }
}

#[track_caller]
pub fn two<A: Scalar, B: Scalar, R: Scalar>(expression: &str, expected: impl Fn(A, B) -> R) {
    let source = format!(
        "fn f(a: {}, b: {}) -> {} {{ return {expression}; }}",
        A::NAME,
        B::NAME,
        R::NAME
    );
    let scalar = program(&source, "f");
    let mut machine = scalar.machine();
    for a in A::lattice() {
        for b in B::lattice() {
            let given = machine
                .call(&[a.word(), b.word()], &mut rasterlab::evaluator::NoHost)
                .expect("no loops")[0];
            check(expression, &(a, b), R::value(given), expected(a, b));
        }
    }
}

#[track_caller]
pub fn three<A: Scalar, B: Scalar, C: Scalar, R: Scalar>(
    expression: &str,
    expected: impl Fn(A, B, C) -> R,
) {
    let source = format!(
        "fn f(a: {}, b: {}, c: {}) -> {} {{ return {expression}; }}",
        A::NAME,
        B::NAME,
        C::NAME,
        R::NAME
    );
    let scalar = program(&source, "f");
    let mut machine = scalar.machine();
    for a in A::lattice() {
        for b in B::lattice() {
            for c in C::lattice() {
                let given = machine
                    .call(
                        &[a.word(), b.word(), c.word()],
                        &mut rasterlab::evaluator::NoHost,
                    )
                    .expect("no loops")[0];
                check(expression, &(a, b, c), R::value(given), expected(a, b, c));
            }
        }
    }
}

/// A vector-valued or many-argument function, at chosen floats.
#[track_caller]
pub fn vectors(signature: &str, expression: &str, arguments: &[f64], expected: &[f64]) {
    let program = program(
        &format!(
            "fn f({}) -> {} {{ return {expression}; }}",
            signature.split(" -> ").next().unwrap(),
            signature.split(" -> ").nth(1).unwrap()
        ),
        "f",
    );
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
