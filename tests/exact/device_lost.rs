//! Promise: a device that is lost at any moment ends a command with exit code 4 and one sentence.
//! Finished files are whole, and the command drawn again finishes what is missing, with the same
//! bytes. Needs an adapter.

use std::{
    fs,
    path::Path,
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use clap::Parser as _;
use rasterlab::{
    cli::{self, Cli, CliError, Exit},
    gpu::Gpu,
    math::hash,
};

use crate::rounds::rounds;

const MOVING: &str = "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\nspin_deg_per_s = 90.0\n[clock]\nrange_s = [0.0, 1.0]\n\
    [effects.facet]\n[effects.lambert]\n[effects.shadow]\n[output]\nsize = [64, 48]\n";

/// Runs a command in this process; its device is lost after this time, if there is one.
fn run(args: &[String], lost_after: Option<Duration>) -> Result<Exit, CliError> {
    let lost = Arc::new(Mutex::new(None));
    let thread = lost.clone();
    Gpu::watch_opened(move |device| {
        let Some(after) = lost_after else { return };
        let device = device.clone();
        let spawned = std::thread::spawn(move || {
            // Sleeps: the device is lost in the middle of a run, at a share of the time that one takes here.
            std::thread::sleep(after);
            device.destroy();
        });
        *thread.lock().unwrap() = Some(spawned);
    });
    let cli = Cli::try_parse_from(args).expect("a command line");
    let outcome = cli::run(&cli);
    Gpu::watch_opened(|_| {});
    let spawned = lost.lock().unwrap().take();
    if let Some(thread) = spawned {
        thread.join().expect("the device is destroyed");
    }
    outcome
}

/// Every picture of the folder by name, each of them whole.
fn pictures(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found: Vec<(String, Vec<u8>)> = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert!(!name.starts_with(".rasterlab-"), "{name} is left");
        if name.ends_with(".png") {
            let bytes = fs::read(&path).unwrap();
            assert!(image::load_from_memory(&bytes).is_ok(), "{name} is torn");
            found.push((name, bytes));
        }
    }
    found.sort();
    found
}

#[test]
fn a_device_lost_at_any_moment_ends_a_command_with_4_and_loses_nothing() {
    let Some(gpu) = crate::common::gpu() else {
        return;
    };
    let adapter = gpu.summary.name.clone();
    let commands: [(&str, &[&str]); 3] = [
        ("render", &["-o", "OUT/a.png"]),
        ("sequence", &["--fps", "6", "-o", "OUT/f_{frame}.png"]),
        ("verify", &["--frames", "3"]),
    ];
    let (mut lost, mut finished) = (0, 0);
    for (number, (command, more)) in commands.into_iter().enumerate() {
        let attempt = |folder: &Path, after: Option<Duration>| {
            let preset = folder.join("move.toml");
            fs::write(&preset, MOVING).unwrap();
            let given = [
                "rasterlab",
                command,
                &preset.to_string_lossy(),
                "--adapter",
                &adapter,
                "--quiet",
            ]
            .map(str::to_owned);
            let more = more
                .iter()
                .map(|arg| arg.replace("OUT", &folder.to_string_lossy()));
            run(&given.into_iter().chain(more).collect::<Vec<_>>(), after)
        };
        let whole = tempfile::tempdir().unwrap();
        let began = Instant::now();
        assert_eq!(
            attempt(whole.path(), None)
                .unwrap_or_else(|error| panic!("{command}: {}", error.sentence())),
            Exit::Done
        );
        let took = began.elapsed();
        for round in 0..rounds(3) {
            let folder = tempfile::tempdir().unwrap();
            // The first is lost before anything was done with it.
            let share = if round == 0 {
                0.0
            } else {
                f64::from(hash(100 * number as u32 + round) % 1000) / 1000.0
            };
            match attempt(folder.path(), Some(took.mul_f64(share))) {
                Ok(exit) => {
                    assert_eq!(
                        exit,
                        Exit::Done,
                        "{command}: a lost device is no difference"
                    );
                    finished += 1;
                }
                Err(error) => {
                    let sentence = error.sentence();
                    assert_eq!(
                        error.exit,
                        Exit::DeviceLost,
                        "{command} after {:.0} %: {sentence}",
                        100.0 * share
                    );
                    assert!(
                        !sentence.contains('\n') && sentence.contains("lost"),
                        "{sentence}"
                    );
                    lost += 1;
                }
            }
            let before = pictures(folder.path());
            if command == "sequence" {
                assert_eq!(
                    attempt(folder.path(), None)
                        .unwrap_or_else(|error| panic!("{}", error.sentence())),
                    Exit::Done
                );
                let after = pictures(folder.path());
                assert_eq!(after, pictures(whole.path()));
                assert!(
                    before.iter().all(|picture| after.contains(picture)),
                    "a finished frame was drawn otherwise"
                );
            }
        }
    }
    eprintln!("{lost} commands lost their device, {finished} were done before");
    assert!(
        lost >= 3,
        "{lost} commands lost their device, {finished} were done before"
    );
}
