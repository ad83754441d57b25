//! What the tests of the evaluator share: linked effects, and calls with typed values.

use rasterlab::evaluator::{LANES, Limits, Machine, NoHost, Options, Precision, Program, Word};

/// The text of a built-in effect with all that it uses.
pub fn link(effect: &str) -> String {
    let effect = rasterlab::effects::Effect::find(effect).expect("a built-in effect");
    rasterlab::shader::link::link_effect(&rasterlab::shader::library::Library::Embedded, effect)
        .expect("it links")
        .text
}

/// A module that naga's validator accepts.
pub fn parse(source: &str) -> naga::Module {
    let module = naga::front::wgsl::parse_str(source)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string(source)));
    let validated = naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::all(),
    )
    .validate(&module);
    if let Err(error) = validated {
        panic!("{}", error.emit_to_string(source));
    }
    module
}

pub fn program_with(source: &str, function: &str, options: &Options) -> Program {
    Program::new(&parse(source), function, options)
        .unwrap_or_else(|error| panic!("{error}\n{source}"))
}

pub fn program(source: &str, function: &str) -> Program {
    program_with(source, function, &Options::default())
}

pub fn single(source: &str, function: &str) -> Program {
    program_with(
        source,
        function,
        &Options {
            precision: Precision::Single,
            ..Options::default()
        },
    )
}

pub fn call(program: &Program, arguments: &[Word]) -> Vec<Word> {
    let mut machine: Machine = program.machine();
    machine
        .call(arguments, &mut NoHost)
        .unwrap_or_else(|error| panic!("{error}"))
        .to_vec()
}

/// Results for any number of samples, as many at once as can be.
pub fn words_of_all(program: &Program, samples: &[Vec<Word>]) -> Vec<Vec<Word>> {
    let mut registers = program.registers();
    let mut results = Vec::new();
    for samples in samples.chunks(LANES) {
        let mut alike = Vec::new();
        for (lane, sample) in samples.iter().enumerate() {
            alike.clear();
            for (index, &word) in sample.iter().enumerate() {
                match program.argument(&registers, index) {
                    Some(row) => row[lane].set(word),
                    None if index >= program.own_argument_words() => alike.push(word),
                    None => {}
                }
            }
        }
        let ended = program.run(&mut registers, &alike, samples.len(), &mut NoHost);
        assert_eq!(ended.count_ones() as usize, samples.len());
        let word = |lane: usize, at: usize| {
            let row = program.result(&registers, at);
            row.map_or_else(|| samples[lane][at], |row| row[lane].get())
        };
        let result = |lane| {
            (0..program.result_words())
                .map(|at| word(lane, at))
                .collect()
        };
        results.extend((0..samples.len()).map(result));
    }
    results
}

/// The same of whole numbers.
pub fn call_all(program: &Program, samples: &[Vec<i32>]) -> Vec<Vec<i32>> {
    let words = |sample: &Vec<i32>| sample.iter().copied().map(Word::from_i32).collect();
    let samples: Vec<Vec<Word>> = samples.iter().map(words).collect();
    let results = words_of_all(program, &samples);
    let numbers = |words: &Vec<Word>| words.iter().map(|word| word.to_i32()).collect();
    results.iter().map(numbers).collect()
}

pub fn floats(values: &[f64]) -> Vec<Word> {
    values.iter().map(|&value| Word::from_f64(value)).collect()
}

pub fn to_floats(words: &[Word]) -> Vec<f64> {
    words.iter().map(|word| word.to_f64()).collect()
}

pub fn limits(steps: u64) -> Limits {
    Limits {
        steps,
        ..Limits::default()
    }
}

/// Random numbers that are the same in every run.
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u64 {
        // Splitmix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In `low` to `high`, an f32.
    pub fn float(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.bits() >> 11) as f64 / (1u64 << 53) as f64;
        f64::from((low + (high - low) * unit) as f32)
    }

    pub fn u32(&mut self, below: u32) -> u32 {
        (self.bits() % u64::from(below)) as u32
    }
}

type Operator = (&'static str, fn(i32, i32) -> i32);

/// Operators on numbers, and what they do.
pub const OPERATORS: [Operator; 15] = [
    ("(A + B)", i32::wrapping_add),
    ("(A - B)", i32::wrapping_sub),
    ("(A * B)", i32::wrapping_mul),
    ("(A / B)", |a, b| a.checked_div(b).unwrap_or(a)),
    ("(A % B)", |a, b| a.checked_rem(b).unwrap_or(0)),
    ("(A & B)", |a, b| a & b),
    ("(A | B)", |a, b| a | b),
    ("(A ^ B)", |a, b| a ^ b),
    ("(A << bitcast<u32>(B))", |a, b| a << (b & 31)),
    ("(A >> bitcast<u32>(B))", |a, b| a >> (b & 31)),
    ("min(A, B)", i32::min),
    ("max(A, B)", i32::max),
    ("(-A)", |a, _| a.wrapping_neg()),
    ("(~A)", |a, _| !a),
    ("select(A, B, B < 0)", |a, b| if b < 0 { b } else { a }),
];
