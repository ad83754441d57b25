//! Promise: a command that is killed, meets a full disk, or has no home it can write to loses
//! nothing: every file is the old one or the new one, files of others stay, what is left unfinished
//! is swept, and what went wrong is one sentence.
#![cfg(unix)]

use std::time::{Duration, Instant, SystemTime};

use rasterlab::math::hash;

use super::*;
use crate::rounds::rounds;

/// Ends as a PNG does, and its pixels can be read.
fn is_whole(png: &[u8]) -> bool {
    png.ends_with(b"IEND\xae\x42\x60\x82") && image::load_from_memory(png).is_ok()
}

fn unfinished(folder: &Path) -> Vec<std::path::PathBuf> {
    let files = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let is_unfinished = |name: &str| name.starts_with(".rasterlab-") && name.ends_with(".tmp");
    files
        .filter(|path| is_unfinished(&path.file_name().unwrap().to_string_lossy()))
        .collect()
}

/// Kills `args` at `rounds` random moments of its run; `prepare` is called before each run, and
/// `check` after it.
fn kill_at_random(folder: &Path, args: &[&str], rounds: u32, prepare: impl Fn(), check: impl Fn()) {
    let timed = || {
        prepare();
        // Asks for the real time: processes are killed at a share of what a whole run takes here.
        let began = Instant::now();
        let run = run_in(folder, args);
        assert_eq!(run.code, 0, "{args:?}: {}", run.err);
        began.elapsed().as_micros() as u64
    };
    let whole_us = (0..3).map(|_| timed()).min().unwrap();
    let mut killed = 0;
    for round in 0..rounds {
        prepare();
        let mut child = command(folder)
            .args(args)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // The files are written at the end: half of the kills come there.
        let share = if round % 2 == 0 {
            u64::from(hash(round) % 1000)
        } else {
            700 + u64::from(hash(round) % 300)
        };
        std::thread::sleep(Duration::from_micros(whole_us * share / 1000));
        child.kill().unwrap();
        killed += u32::from(child.wait().unwrap().code().is_none());
        check();
    }
    assert!(killed > 0, "none of {rounds} processes was still running");
    // Unfinished files of the dead are removed once they are a minute old.
    // Whether they are is told from the time of the day.
    let long_ago = SystemTime::now() - Duration::from_secs(120);
    unfinished(folder).iter().for_each(|path| {
        fs::File::options()
            .write(true)
            .open(path)
            .unwrap()
            .set_modified(long_ago)
            .unwrap()
    });
    // A run that writes nothing sweeps nothing.
    prepare();
    assert_eq!(run_in(folder, args).code, 0);
    assert!(unfinished(folder).is_empty(), "{:?}", unfinished(folder));
}

#[test]
fn a_command_killed_at_any_moment_leaves_the_old_file_or_the_new_one() {
    let commands: [&[&str]; 4] = [
        &[
            "render",
            "move.toml",
            "--adapter",
            "cpu",
            "--size",
            "160x120",
            "--force",
            "-o",
            "out.png",
        ],
        &[
            "sweep",
            "move.toml",
            "--vary",
            "facet.amount=0..1:3",
            "--adapter",
            "cpu",
            "--size",
            "64x48",
            "--force",
            "-o",
            "out.png",
        ],
        &[
            "sequence",
            "move.toml",
            "--fps",
            "8",
            "--adapter",
            "cpu",
            "--force",
            "--apng",
            "out.png",
        ],
        &[
            "sequence",
            "move.toml",
            "--fps",
            "8",
            "--adapter",
            "cpu",
            "-o",
            "out_{frame:3}.png",
        ],
    ];
    for args in commands {
        let folder = studio();
        let of_others = [
            ("note.png", &b"no picture"[..]),
            (".rasterlab-mine", b"kept"),
            ("out.txt", b"text"),
        ];
        of_others
            .iter()
            .for_each(|(name, bytes)| fs::write(folder.path().join(name), bytes).unwrap());
        let are_frames = args.contains(&"out_{frame:3}.png");
        // Finished frames are not drawn again.
        let prepare = || {
            frames(folder.path())
                .iter()
                .filter(|_| are_frames)
                .filter(|(name, _)| name != "note.png")
                .for_each(|(name, _)| fs::remove_file(folder.path().join(name)).unwrap())
        };
        kill_at_random(folder.path(), args, rounds(16), prepare, || {
            for (name, bytes) in frames(folder.path())
                .iter()
                .filter(|(name, _)| name.starts_with("out"))
            {
                assert!(
                    is_whole(bytes),
                    "{args:?}: {name} is torn: {} bytes",
                    bytes.len()
                );
            }
            assert!(are_frames || folder.path().join("out.png").exists());
            for (name, bytes) in of_others {
                assert_eq!(
                    fs::read(folder.path().join(name)).unwrap(),
                    bytes,
                    "{args:?}: {name}"
                );
            }
            assert_eq!(
                fs::read_to_string(folder.path().join("move.toml")).unwrap(),
                MOVING
            );
        });
    }
}

/// Runs the program with files of at most `blocks` blocks of 512 bytes (or of 1024, as the shell
/// has them): the write beyond fails as on a full disk.
fn with_full_disk(folder: &Path, blocks: u32, args: &[&str]) -> Run {
    let mut shell = Command::new("sh");
    shell
        .arg("-c")
        .arg(format!(
            "trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\""
        ))
        .arg(env!("CARGO_BIN_EXE_rasterlab"))
        .args(args);
    shell
        .current_dir(folder)
        .env_remove("RASTERLAB_ADAPTER")
        .env_remove("RASTERLAB_PRESETS");
    shell
        .env("XDG_CONFIG_HOME", folder.join("config"))
        .env("HOME", folder);
    finished(shell.stdin(Stdio::null()).output().expect("a shell"))
}

/// The refusal is one sentence that names the file.
fn assert_full(run: &Run, file: &str) {
    let errors: Vec<&str> = run
        .err
        .lines()
        .filter(|line| line.starts_with("error:") || line.starts_with("  because"))
        .collect();
    assert_eq!(run.code, 2, "{file}: {}", run.err);
    assert_eq!(errors.len(), 1, "{file}: {}", run.err);
    assert!(
        errors[0].contains(file) && errors[0].contains("cannot be written"),
        "{}",
        run.err
    );
}

#[test]
fn a_full_disk_is_one_sentence_and_the_old_file_stays() {
    let folder = studio();
    assert_eq!(
        run_in(
            folder.path(),
            &[
                "render",
                "move.toml",
                "--adapter",
                "cpu",
                "--size",
                "8x6",
                "-o",
                "out.png"
            ]
        )
        .code,
        0
    );
    let old = fs::read(folder.path().join("out.png")).unwrap();
    let commands: [(&[&str], &str); 4] = [
        (
            &[
                "render",
                "move.toml",
                "--adapter",
                "cpu",
                "--size",
                "200x150",
                "--force",
                "-o",
                "out.png",
            ],
            "out.png",
        ),
        (
            &[
                "sweep",
                "move.toml",
                "--vary",
                "facet.amount=0..1:3",
                "--adapter",
                "cpu",
                "--size",
                "96x72",
                "--force",
                "-o",
                "out.png",
            ],
            "out.png",
        ),
        (
            &[
                "sequence",
                "move.toml",
                "--fps",
                "8",
                "--adapter",
                "cpu",
                "--size",
                "96x72",
                "--force",
                "--apng",
                "out.png",
            ],
            "out.png",
        ),
        (
            &[
                "sequence",
                "move.toml",
                "--fps",
                "8",
                "--adapter",
                "cpu",
                "--size",
                "96x72",
                "-o",
                "f_{frame:3}.png",
            ],
            "f_000.png",
        ),
    ];
    for (args, file) in commands {
        assert_full(&with_full_disk(folder.path(), 1, args), file);
        assert_eq!(
            fs::read(folder.path().join("out.png")).unwrap(),
            old,
            "{args:?}"
        );
        assert_eq!(unfinished(folder.path()).len(), 0, "{args:?}");
        assert_eq!(frames(folder.path()).len(), 1, "{args:?}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_behind_stdout_is_an_error() {
    let folder = studio();
    for args in [
        &["list"][..],
        &["list", "--json"],
        &["render", "move.toml", "--adapter", "cpu", "-o", "-"],
        &["completions", "bash"],
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let run = finished(
            command(folder.path())
                .args(args)
                .stdout(full)
                .stderr(Stdio::piped())
                .output()
                .unwrap(),
        );
        assert_eq!(run.code, 2, "{args:?}: {}", run.err);
        assert_eq!(
            run.err
                .lines()
                .filter(|line| line.starts_with("error:"))
                .count(),
            1,
            "{args:?}: {}",
            run.err
        );
    }
}

/// The configuration folder cannot be made: a file stands in its place, which stops root too.
#[test]
fn without_a_home_that_can_be_written_commands_work() {
    let folder = studio();
    fs::write(folder.path().join("config"), "no folder").unwrap();
    let run = run_in(
        folder.path(),
        &["render", "move.toml", "--adapter", "cpu", "-o", "a.png"],
    );
    assert!(run.code == 0 && !run.err.contains("error"), "{}", run.err);
    for args in [
        &["list"][..],
        &["check", "move.toml"],
        &["new-effect", "ink"],
    ] {
        let run = run_in(folder.path(), args);
        assert!(
            run.code == 0 && !run.err.contains("error") && !run.err.contains("config"),
            "{args:?}: {}",
            run.err
        );
    }
}

#[test]
fn after_the_clock_went_back_files_are_written_and_what_seems_to_come_from_the_future_stays() {
    let folder = studio();
    let render = || {
        run_in(
            folder.path(),
            &[
                "render",
                "move.toml",
                "--adapter",
                "cpu",
                "--force",
                "-o",
                "a.png",
            ],
        )
    };
    assert_eq!(render().code, 0);
    // Asks for the time of the day: a file may seem to come from tomorrow.
    let later = SystemTime::now() + Duration::from_secs(86_400);
    let from_the_future = [".rasterlab-aaaaaaaaaaaa.tmp", "a.png", "move.toml"];
    fs::write(folder.path().join(from_the_future[0]), "unfinished").unwrap();
    for name in from_the_future {
        fs::File::options()
            .write(true)
            .open(folder.path().join(name))
            .unwrap()
            .set_modified(later)
            .unwrap();
    }
    let again = render();
    assert_eq!(again.code, 0, "{}", again.err);
    assert!(is_whole(&fs::read(folder.path().join("a.png")).unwrap()));
    // It may belong to a process that is about to lock it.
    assert!(folder.path().join(from_the_future[0]).exists());
    assert_eq!(sequence(folder.path(), &[]).code, 0);
    assert!(
        sequence(folder.path(), &[])
            .err
            .contains("0 frames drawn, 8 kept")
    );
}
