//! Promise: a command that is killed, meets a full disk, or has no home it can write to loses
//! nothing: every file is the old one or the new one, files of others stay, what is left unfinished
//! is swept, and what went wrong is one sentence.
#![cfg(unix)]

use std::time::{Duration, Instant, SystemTime};

use rasterlab::math::hash;

use super::*;
use crate::rounds::rounds;

fn unfinished(place: &Place) -> Vec<String> {
    place.files(|name| name.starts_with(".rasterlab-") && name.ends_with(".tmp"))
}

fn set_modified(place: &Place, name: &str, time: SystemTime) {
    let file = fs::File::options()
        .write(true)
        .open(place.at(name))
        .unwrap();
    file.set_modified(time).unwrap();
}

/// Kills a command at `rounds` random moments of its run; `prepare` is called before each run, and
/// `check` after it.
fn kill_at_random(place: &Place, line: &str, rounds: u32, prepare: impl Fn(), check: impl Fn()) {
    let timed = || {
        prepare();
        // Asks for the real time: processes are killed at a share of what a whole run takes here.
        let began = Instant::now();
        place.play(&format!("$ {line}"));
        began.elapsed().as_micros() as u64
    };
    let whole_us = (0..3).map(|_| timed()).min().unwrap();
    let mut killed = 0;
    for round in 0..rounds {
        prepare();
        let mut child = place.start(line);
        // The files are written at the end: half of the kills come there.
        let random = u64::from(hash(round));
        let share = if round % 2 == 0 {
            random % 1000
        } else {
            700 + random % 300
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
    unfinished(place)
        .iter()
        .for_each(|name| set_modified(place, name, long_ago));
    // A run that writes nothing sweeps nothing.
    prepare();
    place.play(&format!("$ {line}"));
    assert_eq!(unfinished(place), [""; 0]);
}

#[test]
fn a_command_killed_at_any_moment_leaves_the_old_file_or_the_new_one() {
    for line in [
        "render move.toml CPU160x120 --force -o out.png",
        "sweep move.toml --vary facet.amount=0..1:3 CPU64x48 --force -o out.png",
        "sequence move.toml --fps 8 CPU --force --apng out.png",
        "sequence move.toml --fps 8 CPU -o out_{frame:3}.png",
    ] {
        let place = Place::studio();
        let of_others = [
            ("note.png", "no picture"),
            (".rasterlab-mine", "kept"),
            ("out.txt", "text"),
            ("move.toml", MOVING),
        ];
        of_others
            .iter()
            .for_each(|(name, text)| place.put(name, text));
        let are_frames = line.contains("{frame");
        // Finished frames are not drawn again.
        let prepare = || {
            place
                .files(|name| are_frames && name.starts_with("out_"))
                .iter()
                .for_each(|name| place.remove(name));
        };
        kill_at_random(&place, line, rounds(16), prepare, || {
            for (name, bytes) in place
                .frames()
                .iter()
                .filter(|(name, _)| name.starts_with("out"))
            {
                assert!(
                    is_whole(bytes),
                    "{line}: {name} is torn: {} bytes",
                    bytes.len()
                );
            }
            assert!(are_frames || place.has("out.png"));
            for (name, text) in of_others {
                assert_eq!(place.read(name), text.as_bytes(), "{line}: {name}");
            }
        });
    }
}

/// Runs the program with files of at most one block of 512 bytes (or of 1024, as the shell has
/// them): the write beyond fails as on a full disk.
fn with_full_disk(place: &Place, line: &str) -> Run {
    let command = place.command(line);
    let mut shell = Command::new("sh");
    shell.args(["-c", "trap '' XFSZ; ulimit -f 1; exec \"$0\" \"$@\""]);
    shell
        .arg(command.get_program())
        .args(command.get_args())
        .current_dir(place.at(""));
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => shell.env(name, value),
            None => shell.env_remove(name),
        };
    }
    finished(shell.stdin(Stdio::null()).output().expect("a shell"))
}

#[test]
fn a_full_disk_is_one_sentence_and_the_old_file_stays() {
    let place = Place::studio();
    place.play("$ render move.toml CPU8x6 -o out.png");
    let old = place.read("out.png");
    for (line, file) in [
        ("render move.toml CPU200x150 --force -o out.png", "out.png"),
        (
            "sweep move.toml --vary facet.amount=0..1:3 CPU96x72 --force -o out.png",
            "out.png",
        ),
        (
            "sequence move.toml --fps 8 CPU96x72 --force --apng out.png",
            "out.png",
        ),
        (
            "sequence move.toml --fps 8 CPU96x72 -o f_{frame:3}.png",
            "f_000.png",
        ),
    ] {
        let run = with_full_disk(&place, line);
        let is_error = |line: &&str| line.starts_with("error:") || line.starts_with("  because");
        let errors: Vec<&str> = run.err.lines().filter(is_error).collect();
        assert_eq!((run.code, errors.len()), (2, 1), "{line}: {}", run.err);
        assert!(
            errors[0].contains(file) && errors[0].contains("cannot be written"),
            "{}",
            run.err
        );
        assert!(place.read("out.png") == old, "{line}");
        assert_eq!(
            (unfinished(&place).len(), place.frames().len()),
            (0, 1),
            "{line}"
        );
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_behind_stdout_is_an_error() {
    let place = Place::studio();
    for line in [
        "list",
        "list --json",
        "render move.toml CPU -o -",
        "completions bash",
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let run = finished(
            place
                .command(line)
                .stdout(full)
                .stderr(Stdio::piped())
                .output()
                .unwrap(),
        );
        let errors = run
            .err
            .lines()
            .filter(|line| line.starts_with("error:"))
            .count();
        assert_eq!((run.code, errors), (2, 1), "{line}: {}", run.err);
    }
}

#[test]
fn after_the_clock_went_back_files_are_written_and_what_seems_to_come_from_the_future_stays() {
    let place = Place::studio();
    place.play("$ render move.toml CPU --force -o a.png\n@ .rasterlab-aaaaaaaaaaaa.tmp unfinished");
    // Asks for the time of the day: a file may seem to come from tomorrow.
    let later = SystemTime::now() + Duration::from_secs(86_400);
    for name in [".rasterlab-aaaaaaaaaaaa.tmp", "a.png", "move.toml"] {
        set_modified(&place, name, later);
    }
    place.play(&format!(
        "$ render move.toml CPU --force -o a.png
        # It may belong to a process that is about to lock it.
        + .rasterlab-aaaaaaaaaaaa.tmp
        $ {SEQUENCE}
        $ {SEQUENCE}
        ! 0 frames drawn, 8 kept"
    ));
    assert!(is_whole(&place.read("a.png")));
}
