//! Random programs on integers, against direct execution.

mod generator;
mod run;
mod text;

use proptest::prelude::*;
use rasterlab::evaluator::{NoHost, Word};
use run::{End, State, result, run};
use text::{PRELUDE, RESULT, text};

use super::common::{Random, program};

proptest! {
    #![proptest_config(ProptestConfig { cases: std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(256), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn statements(seed in any::<u64>()) {
        let mut random = Random(seed);
        let mut generator = generator::Generator { random: &mut random, names: 0, budget: 40 };
        let body = generator.block(0, &mut Vec::new());
        let source = format!("{PRELUDE}\nfn f(a: vec4i, b: vec4i) -> vec4i {{\nvar s: S;\ns.v = a;\nvar w = b;\n{}return {RESULT};\n}}\n", text(&body));
        let program = program(&source, "f");
        let mut machine = program.machine();
        for _ in 0..4 {
            let arguments: Vec<i32> = (0..8).map(|_| random.bits() as i32 >> random.u32(30)).collect();
            let mut state = State::default();
            state.s.v.copy_from_slice(&arguments[..4]);
            state.w.copy_from_slice(&arguments[4..]);
            let end = run(&body, &mut state);
            let expected = if end == End::Return { state.w } else { result(&state) };
            let words: Vec<Word> = arguments.iter().map(|&x| Word::from_i32(x)).collect();
            let given: Vec<i32> = machine.call(&words, &mut NoHost).expect("it ends").iter().map(|word| word.to_i32()).collect();
            prop_assert_eq!(given, expected, "{} at {:?}", source, arguments);
        }
    }
}
