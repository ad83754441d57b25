//! libFuzzer on one target, which the environment variable RASTERLAB_FUZZ names; `scripts/fuzz.sh`
//! builds and calls it.
#![no_main]

use std::sync::OnceLock;

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use rasterlab_fuzz::{TARGETS, Target, guard::Counting, run};

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

// Of an input that has something packed inside, one half of the mutations are made there.
fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    let views = target().views;
    let view = views.get(seed as usize / 2 % views.len().max(1));
    let inside = view.and_then(|view| Some((view, (view.open)(&data[..size])?)));
    match inside.filter(|_| seed % 2 == 0) {
        Some((view, mut inside)) => {
            let length = inside.len();
            inside.resize(length.max(1) * 2, 0);
            let (most, length) = (inside.len(), length.max(1));
            let length = fuzzer_mutate(&mut inside, length, most);
            let changed = (view.close)(&data[..size], &inside[..length]);
            let length = changed.len().min(max_size);
            data[..length].copy_from_slice(&changed[..length]);
            length
        }
        None => fuzzer_mutate(data, size, max_size),
    }
});
