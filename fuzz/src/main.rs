//! What developers run beyond the tests, on this machine or, as one file, on another with a GPU.

use std::{fs, path::Path, path::PathBuf, process::ExitCode, sync::Arc, thread, time::Instant};

use clap::{Args, Parser, Subcommand};
use pollster::FutureExt as _;
use rasterlab::{
    gpu::{Gpu, Renderer, device::AdapterChoice},
    host,
};
use rasterlab_fuzz::{
    TARGETS, Target, corpus,
    guard::Counting,
    presets, run,
    stress::{self, Outcome},
};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Hostile input, random presets and cases that need code, against what was promised
#[derive(Parser)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Give every file of the corpus, or these files, to its target, which the file's folder names
    Inputs { inputs: Vec<String> },
    /// Judge random presets with every exact option
    Presets {
        #[command(flatten)]
        device: Device,
        #[command(flatten)]
        presets: presets::Options,
    },
    /// Draw and judge the cases whose names contain one of these texts, separated by commas
    Cases {
        #[command(flatten)]
        device: Device,
        filter: Option<String>,
        /// Changes the random cases
        #[arg(long, default_value_t = 0)]
        seed: u32,
        /// List the cases and draw nothing
        #[arg(long)]
        list: bool,
    },
}

#[derive(Args)]
struct Device {
    /// A part of the adapter's name
    #[arg(long)]
    adapter: Option<String>,
    /// Folder of shaders instead of those in the program
    #[arg(long)]
    shaders: Option<PathBuf>,
}

impl Device {
    fn open(self) -> Result<Renderer, String> {
        host::shaders::choose(self.shaders);
        let choice = self
            .adapter
            .map_or(AdapterChoice::Any, AdapterChoice::Named);
        let gpu = Gpu::open(&choice)
            .block_on()
            .map_err(|error| error.to_string())?;
        eprintln!("adapter: {} ({})", gpu.summary.name, gpu.summary.driver);
        Ok(Renderer::new(gpu))
    }
}

fn main() -> ExitCode {
    let faults = match Cli::parse().command {
        Command::Inputs { inputs } => replay(&inputs),
        Command::Presets { device, presets } => device
            .open()
            .and_then(|renderer| presets::run(renderer, &presets)),
        Command::Cases {
            list: true, filter, ..
        } => {
            for case in stress::chosen(filter.as_deref()) {
                println!("{:32} {}", case.name, case.about);
            }
            Ok(0)
        }
        Command::Cases {
            device,
            filter,
            seed,
            ..
        } => device
            .open()
            .and_then(|renderer| run_cases(renderer, filter.as_deref(), seed)),
    };
    match faults {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(sentence) => {
            eprintln!("error: {sentence}");
            ExitCode::from(2)
        }
    }
}

/// The number of cases that failed.
fn run_cases(mut renderer: Renderer, filter: Option<&str>, seed: u32) -> Result<usize, String> {
    let cases = stress::chosen(filter);
    if cases.is_empty() {
        return Err("no case has such a name; rasterlab-fuzz cases --list shows all".into());
    }
    let mut failed = 0;
    for case in cases {
        let (gpu, began) = (renderer.gpu().clone(), Instant::now());
        let report = case.run(&mut renderer, seed);
        println!(
            "{:32} {:20} {:6} pictures {:8.1} s",
            case.name,
            report.outcome.word(),
            report.pictures,
            began.elapsed().as_secs_f64()
        );
        for note in &report.notes {
            println!("  {note}");
        }
        if let Outcome::Failed(why) = &report.outcome {
            eprintln!("case {}: {why} (seed {seed})", case.name);
            failed += 1;
            // A failure may leave queues and caches in a wrong state.
            renderer = Renderer::new(gpu.clone());
        }
        if gpu.is_lost() && report.outcome.is_failure() {
            return Err("the device was lost".into());
        }
    }
    Ok(failed)
}

/// The number of inputs that are not handled as promised.
fn replay(inputs: &[String]) -> Result<usize, String> {
    let mut files: Vec<(&Target, String, Vec<u8>)> = Vec::new();
    for input in inputs {
        let folder = Path::new(input).parent().and_then(Path::file_name);
        let target = TARGETS
            .iter()
            .find(|target| folder.is_some_and(|folder| folder == target.name))
            .ok_or_else(|| format!("{input}: its folder has not the name of a target"))?;
        let bytes = fs::read(input).map_err(|error| format!("{input}: {error}"))?;
        files.push((target, input.clone(), bytes));
    }
    if inputs.is_empty() {
        for target in &TARGETS {
            let of_target = corpus::read(target)
                .map_err(|error| format!("{}: {error}", corpus::folder(target).display()))?;
            if of_target.is_empty() {
                return Err(format!("{} is empty", corpus::folder(target).display()));
            }
            files.extend(
                of_target
                    .into_iter()
                    .map(|(name, bytes)| (target, name, bytes)),
            );
        }
        // The sentence of a panic is printed with its input.
        std::panic::set_hook(Box::new(|_| {}));
    }
    let mut faults = 0;
    for (target, name, bytes) in &files {
        // An input that takes five times as long as allowed may never end.
        let (is_done, what) = (Arc::new(()), format!("{}: {name}", target.name));
        let (watched, limit) = (Arc::downgrade(&is_done), 5 * target.limit.time);
        thread::spawn(move || {
            thread::sleep(limit);
            if watched.upgrade().is_some() {
                eprintln!("{what}: no end after {:.0} s", limit.as_secs_f64());
                std::process::exit(1);
            }
        });
        match run::check(target, bytes) {
            Ok(cost) if !inputs.is_empty() => println!("{name}: {:?}", cost.outcome),
            Ok(_) => {}
            Err(sentence) => {
                eprintln!("{}: {name}: {sentence}", target.name);
                faults += 1;
            }
        }
        drop(is_done);
    }
    println!("{} files, {faults} faults", files.len());
    Ok(faults)
}
