//! libFuzzer on one target, which the environment variable RASTERLAB_FUZZ names; `scripts/fuzz.sh`
//! builds and calls it.
#![no_main]

use std::sync::OnceLock;

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use rasterlab_fuzz::{
    TARGETS, Target,
    guard::Counting,
    mutate::{Random, mutated},
    run,
};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn target() -> &'static Target {
    static TARGET: OnceLock<&'static Target> = OnceLock::new();
    TARGET.get_or_init(|| {
        let name = std::env::var("RASTERLAB_FUZZ").unwrap_or_default();
        TARGETS
            .iter()
            .find(|target| target.name == name)
            .unwrap_or_else(|| {
                let names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
                eprintln!(
                    "RASTERLAB_FUZZ is {name:?}; it names one of {}",
                    names.join(", ")
                );
                std::process::exit(2)
            })
    })
}

fuzz_target!(|input: &[u8]| {
    if let Err(sentence) = run::check(target(), input) {
        eprintln!("{sentence}");
        std::process::abort();
    }
});

// One half of the mutations are libFuzzer's own, the others know what is packed inside.
fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    let mut random = Random::new(u64::from(seed));
    if random.below(2) == 0 {
        return fuzzer_mutate(data, size, max_size);
    }
    let changed = mutated(target(), &data[..size], &[], &mut random);
    let length = changed.len().min(max_size);
    data[..length].copy_from_slice(&changed[..length]);
    length
});
