//! Promise: stdout carries data only, exit codes mean what they say, nothing is overwritten
//! unasked, a closed pipe is no error. Most of it is told by transcripts, which `Place::play` runs.

mod arrays;
mod commands;
mod effects;
mod faults;
mod files_kept;
mod films;
mod limits;
mod links;
mod looks;
mod manual;
mod parts;
mod pictures;
mod review;
mod sequences;
mod sweeps;

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
};

use rasterlab::preset_file::png_pixels;
use rayon::prelude::*;
use serde_json::Value;

/// A model of one triangle, 1 m wide.
const TRIANGLE: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"tri","mesh":0}],
    "meshes":[{"name":"tri","primitives":[{"attributes":{"POSITION":0}}]}],
    "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]}"#;

/// A preset that turns while a front crosses it.
const MOVING: &str = "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\nspin_deg_per_s = 90.0\n[clock]\nrange_s = [0.0, 1.0]\n\
    [effects.facet]\n[effects.lambert]\n[animation.facet]\namount = [{ time_s = 0.0, value = 0.0 }, { time_s = 1.0, value = 1.0 }]\n\
    [output]\nsize = [24, 18]\n";

/// A preset with a test.
const KNOT: &str =
    "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\n[output]\nsize = [64, 48]\n[test]\n";

/// Draws the moving preset, eight frames a second.
const SEQUENCE: &str = "sequence move.toml --fps 8 CPU -o f_{frame:3}.png";

/// A folder of its own, in which commands run in a clean world: no environment of ours, no presets
/// of the person's own.
struct Place(tempfile::TempDir);

struct Run {
    code: i32,
    out: String,
    err: String,
    bytes: Vec<u8>,
}

/// The words of a command line: split at blanks, where '...' keeps a word together. `CPU` stands for
/// `--adapter cpu`, `CPU8x6` for `--adapter cpu --size 8x6`.
fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (index, piece) in line.split('\'').enumerate() {
        if index % 2 == 1 {
            words.push(piece.to_owned());
            continue;
        }
        for word in piece.split_whitespace() {
            match word.strip_prefix("CPU") {
                Some(size) => {
                    words.extend(["--adapter", "cpu"].map(String::from));
                    if !size.is_empty() {
                        words.extend(["--size", size].map(String::from));
                    }
                }
                None => words.push(word.to_owned()),
            }
        }
    }
    words
}

impl Run {
    /// Lines that report an error.
    fn errors(&self) -> usize {
        let lines = self.err.lines();
        lines.filter(|line| line.starts_with("error: ")).count()
    }
}

fn finished(output: Output) -> Run {
    Run {
        code: output.status.code().expect("the program ends by itself"),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
        bytes: output.stdout,
    }
}

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// With these files.
    fn with<const N: usize>(files: [(&str, &str); N]) -> Self {
        let place = Self::new();
        files.iter().for_each(|(name, text)| place.put(name, text));
        place
    }

    /// With the moving preset as `move.toml`.
    fn studio() -> Self {
        Self::with([("move.toml", MOVING)])
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn has(&self, name: &str) -> bool {
        self.at(name).exists()
    }

    fn put(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::create_dir_all(self.at(name).parent().unwrap()).unwrap();
        fs::write(self.at(name), bytes).unwrap();
    }

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.at(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn pixels(&self, name: &str) -> Vec<[u8; 4]> {
        png_pixels(&self.at(name)).unwrap().0
    }

    fn remove(&self, name: &str) {
        fs::remove_file(self.at(name)).unwrap();
    }

    /// The files of this folder whose names pass.
    fn files(&self, is_wanted: impl Fn(&str) -> bool) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap().map(Result::unwrap);
        let mut names: Vec<String> = entries
            .filter(|entry| !entry.path().is_dir())
            .map(|entry| entry.file_name().to_string_lossy().into_owned())
            .filter(|name| is_wanted(name))
            .collect();
        names.sort();
        names
    }

    /// The pictures of this folder with their bytes.
    fn frames(&self) -> BTreeMap<String, Vec<u8>> {
        let names = self.files(|name| name.ends_with(".png"));
        names
            .into_iter()
            .map(|name| (name.clone(), self.read(&name)))
            .collect()
    }

    /// A command line, before which variables may stand: `NAME=value render ...`.
    fn command(&self, line: &str) -> Command {
        let words = words(line);
        let is_variable = |word: &&String| {
            word.split_once('=')
                .is_some_and(|(name, _)| name.bytes().all(|c| c.is_ascii_uppercase() || c == b'_'))
        };
        let variables = words.iter().take_while(is_variable).count();
        let mut command = Command::new(env!("CARGO_BIN_EXE_rasterlab"));
        command
            .current_dir(self.0.path())
            .args(&words[variables..])
            .stdin(Stdio::null());
        for name in ["ADAPTER", "PRESETS", "MEMORY"] {
            command.env_remove(format!("RASTERLAB_{name}"));
        }
        for name in ["XDG_CONFIG_HOME", "APPDATA"] {
            command.env(name, self.at("config"));
        }
        command.env("HOME", self.0.path());
        command.envs(
            words[..variables]
                .iter()
                .filter_map(|word| word.split_once('=')),
        );
        command
    }

    fn run(&self, line: &str) -> Run {
        finished(self.command(line).output().expect("the program starts"))
    }

    /// Started, with pipes for what it writes.
    fn start(&self, line: &str) -> Child {
        self.command(line)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    }

    /// What stdout has as one JSON object.
    fn json(&self, line: &str) -> Value {
        let run = self.run(line);
        assert_eq!(run.code, 0, "{line}: {}", run.err);
        json(&run)
    }

    /// Runs a transcript, in which `\n` stands for the end of a line:
    ///
    /// - `$ LINE` runs and ends with exit code 0, `$2 LINE` with 2: then stderr has one error and,
    ///   except for `check`, stdout is empty;
    /// - `> TEXT` and `! TEXT`: stdout and stderr have this text, or these, with `&&` between them;
    /// - `!1 TEXT`: stderr has it once; `>- TEXT`, `!- TEXT`: they have it nowhere; `>= TEXT`, `!= TEXT`: they are this text;
    /// - `>> NAME TEXT`, `>>- NAME TEXT`: the file has this text, or has it nowhere;
    /// - `/results/0/name VALUE`: what the JSON object on stdout has there;
    /// - `@ NAME TEXT` writes a file, `@- NAME` removes it;
    /// - `+ NAME` and `- NAME`: the file is there, or is not; `== A B`: two files have the same bytes,
    ///   `=~ A B`: the same pixels, `!~ A B`: others.
    ///
    /// SEQUENCE, TRIANGLE, MOVING and KNOT stand for the texts above.
    fn play(&self, transcript: &str) {
        let mut last = Run {
            code: 0,
            out: String::new(),
            err: String::new(),
            bytes: Vec::new(),
        };
        let mut command = String::new();
        let lines = transcript.lines().map(str::trim_start);
        for line in lines.filter(|line| !line.is_empty()) {
            let (mark, rest) = line.split_once(' ').unwrap_or((line, ""));
            let mut rest = rest.to_owned();
            for (word, text) in [
                ("SEQUENCE", SEQUENCE),
                ("TRIANGLE", TRIANGLE),
                ("MOVING", MOVING),
                ("KNOT", KNOT),
            ] {
                rest = rest.replace(word, text);
            }
            let text = rest.replace("\\n", "\n");
            let told = || {
                format!(
                    "{command}\n{line}\nexit {}\n{}\n{}",
                    last.code, last.out, last.err
                )
            };
            let parts = || text.split(" && ");
            match mark {
                "$" | "$1" | "$2" | "$3" => {
                    last = self.run(&rest);
                    command.clone_from(&rest);
                    let code = mark[1..].parse().unwrap_or(0);
                    assert_eq!(last.code, code, "{rest}\n{}\n{}", last.out, last.err);
                    assert!(!last.err.contains("panicked"), "{rest}\n{}", last.err);
                    let is_silent =
                        code >= 2 && !rest.contains("check ") && !rest.contains("--json");
                    assert!(
                        !is_silent || last.out.is_empty() && last.errors() == 1,
                        "{rest}\n{}\n{}",
                        last.out,
                        last.err
                    );
                }
                ">" => assert!(parts().all(|part| last.out.contains(part)), "{}", told()),
                "!" => assert!(parts().all(|part| last.err.contains(part)), "{}", told()),
                "!1" => assert_eq!(last.err.matches(&*text).count(), 1, "{}", told()),
                ">-" => assert!(parts().all(|part| !last.out.contains(part)), "{}", told()),
                "!-" => assert!(parts().all(|part| !last.err.contains(part)), "{}", told()),
                ">=" => assert_eq!(last.out, text, "{}", told()),
                "!=" => assert_eq!(last.err, text, "{}", told()),
                "@" => {
                    let (name, text) = text.split_once(' ').unwrap_or((&text, ""));
                    self.put(name, text);
                }
                ">>" | ">>-" => {
                    let (name, text) = text.split_once(' ').expect("a file and a text");
                    let file = String::from_utf8_lossy(&self.read(name)).into_owned();
                    assert_eq!(file.contains(text), mark == ">>", "{}", told());
                }
                "@-" => self.remove(&rest),
                "+" => assert!(self.has(&rest), "{}", told()),
                "-" => assert!(!self.has(&rest), "{}", told()),
                "==" | "=~" | "!~" => {
                    let (a, b) = rest.split_once(' ').expect("two files");
                    let is_same = match mark {
                        "==" => self.read(a) == self.read(b),
                        _ => (self.pixels(a) == self.pixels(b)) == (mark == "=~"),
                    };
                    assert!(is_same, "{}", told());
                }
                "#" => {}
                pointer if pointer.starts_with('/') => {
                    let wanted: Value =
                        serde_json::from_str(&rest).expect("a value of the transcript");
                    let object = json(&last);
                    assert_eq!(
                        object.pointer(pointer).unwrap_or(&Value::Null),
                        &wanted,
                        "{}",
                        told()
                    );
                }
                _ => panic!("the transcript has no meaning: {line}"),
            }
        }
    }
}

fn json(run: &Run) -> Value {
    let object: Value = serde_json::from_str(&run.out).unwrap_or_else(|e| {
        panic!(
            "stdout is not one JSON object: {e}\n{}\n{}",
            run.out, run.err
        )
    });
    assert_eq!(object["schema"], 2);
    object
}

/// Every transcript of the file, each in a folder of its own.
#[test]
fn commands_answer_as_the_transcripts_say() {
    let transcripts: Vec<&str> = include_str!("transcripts.txt")
        .split("=== ")
        .skip(1)
        .collect();
    assert!(transcripts.len() > 15);
    let play = |transcript: &&str| {
        let (name, transcript) = transcript
            .split_once('\n')
            .expect("a name and a transcript");
        let panic = std::panic::catch_unwind(|| Place::new().play(transcript)).err()?;
        let said = panic.downcast_ref::<String>().cloned().unwrap_or_default();
        Some(format!("{name}: {said}"))
    };
    let failed: Vec<String> = transcripts.par_iter().filter_map(play).collect();
    assert!(failed.is_empty(), "{}", failed.join("\n\n"));
}

/// Whether tests that need an adapter are left out; says so.
fn skips_gpu() -> bool {
    let skips = std::env::var("RASTERLAB_GPU").as_deref() == Ok("skip");
    if skips {
        eprintln!("RASTERLAB_GPU=skip: GPU tests are left out");
    }
    skips
}

/// Ends as a PNG does, and its pixels can be read.
fn is_whole(png: &[u8]) -> bool {
    png.ends_with(b"IEND\xae\x42\x60\x82") && image::load_from_memory(png).is_ok()
}
