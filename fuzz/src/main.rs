//! Replays the corpus of each target and mutates it at random for some seconds: `rasterlab-fuzz
//! [--seconds S] [--seed N] [TARGET or FILE]...`. A file is given to the target that its folder
//! names.

use std::{
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::{Arc, Mutex, PoisonError},
    thread,
    time::{Duration, Instant},
};

use clap::Parser;
use rasterlab_fuzz::{
    TARGETS, Target, corpus,
    guard::Counting,
    mutate::{Random, mutated},
    run::check,
};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Looks for input that a target does not handle as promised.
#[derive(Parser)]
struct Args {
    /// Names of targets, or files whose folder is named after one; without any, every target
    inputs: Vec<String>,
    /// How long each target is given mutated input; with 0 it says what became of each file of its
    /// corpus
    #[arg(long, default_value_t = 10.0)]
    seconds: f64,
    /// The same seed tries the same input, as far as the time reaches
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// What mutated input came to.
#[derive(Default)]
struct Tried {
    count: u64,
    accepted: u64,
    /// The longest time, and the most memory in bytes.
    time: Duration,
    bytes: usize,
}

/// The input that is running, and since when; none between inputs.
type Running = Arc<Mutex<Option<(&'static Target, Vec<u8>, Instant)>>>;

fn main() -> ExitCode {
    let args = Args::parse();
    let running = Running::default();
    watch(running.clone());
    // The sentence of a panic is printed with its input.
    if args.inputs.iter().all(|input| !Path::new(input).is_file()) {
        std::panic::set_hook(Box::new(|_| {}));
    }
    let mut faults = 0;
    let chosen = |input: &str| TARGETS.iter().find(|target| target.name == input);
    for input in &args.inputs {
        let folder = Path::new(input)
            .parent()
            .and_then(Path::file_name)
            .map(|name| name.to_string_lossy().into_owned())
            .unwrap_or_default();
        match (chosen(input), chosen(&folder), fs::read(input)) {
            (Some(target), ..) => faults += fuzz(target, &args, &running),
            (None, Some(target), Ok(bytes)) => {
                faults += u32::from(!try_input(target, input, &bytes, &running, None, true))
            }
            (None, _, Err(error)) => {
                return usage(&format!("{input} is no target, and as a file: {error}"));
            }
            (None, None, Ok(_)) => {
                return usage(&format!("{input}: its folder has not the name of a target"));
            }
        }
    }
    if args.inputs.is_empty() {
        faults = TARGETS
            .iter()
            .map(|target| fuzz(target, &args, &running))
            .sum();
    }
    match faults {
        0 => ExitCode::SUCCESS,
        _ => {
            eprintln!(
                "{faults} faults; their input is in {}",
                corpus::found().display()
            );
            ExitCode::FAILURE
        }
    }
}

fn usage(sentence: &str) -> ExitCode {
    eprintln!("{sentence}; the targets:");
    TARGETS
        .iter()
        .for_each(|target| eprintln!("  {:14} {}", target.name, target.about));
    ExitCode::from(2)
}

/// Faults of a target, at most eight.
fn fuzz(target: &'static Target, args: &Args, running: &Running) -> u32 {
    let files = match corpus::read(target) {
        Ok(files) if !files.is_empty() => files,
        Ok(_) => panic!("{} is empty", corpus::folder(target).display()),
        Err(error) => panic!("{}: {error}", corpus::folder(target).display()),
    };
    let mut faults: u32 = files
        .iter()
        .map(|(name, bytes)| {
            u32::from(!try_input(
                target,
                name,
                bytes,
                running,
                None,
                args.seconds == 0.0,
            ))
        })
        .sum();
    let (mut random, start) = (Random::new(args.seed), Instant::now());
    let mut tried = Tried::default();
    while start.elapsed().as_secs_f64() < args.seconds && faults < 8 {
        let [one, other] = [(); 2].map(|()| &files[random.below(files.len())].1);
        let mut input = mutated(target, one, other, &mut random);
        // Some mutations show only together.
        for _ in 0..random.below(3) * random.below(2) {
            input = mutated(target, &input, other, &mut random);
        }
        faults += u32::from(!try_input(
            target,
            "mutated input",
            &input,
            running,
            Some(&mut tried),
            false,
        ));
    }
    let Tried {
        count,
        accepted,
        time,
        bytes,
    } = tried;
    println!(
        "{:13} {} files, {count} mutated inputs in {:.0} s, {accepted} accepted; at most {:.2} s and {} MiB each; {faults} faults",
        target.name,
        files.len(),
        start.elapsed().as_secs_f64(),
        time.as_secs_f64(),
        bytes >> 20
    );
    faults
}

/// Does the target handle the input as promised? Otherwise the input is kept in a file.
fn try_input(
    target: &'static Target,
    name: &str,
    input: &[u8],
    running: &Running,
    tried: Option<&mut Tried>,
    is_told: bool,
) -> bool {
    *running.lock().unwrap_or_else(PoisonError::into_inner) =
        Some((target, input.to_vec(), Instant::now()));
    let outcome = check(target, input);
    *running.lock().unwrap_or_else(PoisonError::into_inner) = None;
    match (outcome, tried) {
        (Ok(cost), Some(tried)) => {
            tried.count += 1;
            tried.accepted += u64::from(cost.outcome.is_ok());
            (tried.time, tried.bytes) = (tried.time.max(cost.time), tried.bytes.max(cost.bytes));
        }
        (Ok(cost), None) if is_told => {
            println!(
                "{}: {name}: {}",
                target.name,
                cost.outcome
                    .err()
                    .map_or("accepted".into(), |refusal| format!("refused: {refusal}"))
            )
        }
        (Ok(_), None) => {}
        (Err(sentence), _) => {
            eprintln!(
                "{}: {name}: {sentence}\n  the input: {}",
                target.name,
                kept(target, input).display()
            );
            return false;
        }
    }
    true
}

/// Writes the input to a file named after its bytes.
fn kept(target: &Target, input: &[u8]) -> PathBuf {
    let name = input.iter().fold(0xcbf2_9ce4_8422_2325u64, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    });
    let folder = corpus::found().join(target.name);
    let path = folder.join(format!("{name:016x}"));
    fs::create_dir_all(&folder)
        .and_then(|()| fs::write(&path, input))
        .expect("the folder can be written");
    path
}

/// Ends the process where an input takes five times as long as allowed: it may never end.
fn watch(running: Running) {
    thread::spawn(move || {
        loop {
            thread::sleep(Duration::from_millis(500));
            let now = running
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .clone();
            if let Some((target, input, since)) = now
                && since.elapsed() > 5 * target.limit.time
            {
                eprintln!(
                    "{}: no end after {:.0} s\n  the input: {}",
                    target.name,
                    since.elapsed().as_secs_f64(),
                    kept(target, &input).display()
                );
                std::process::exit(1);
            }
        }
    });
}
