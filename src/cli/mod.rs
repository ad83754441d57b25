//! The command line: every subcommand over the same core as the window. None of them opens a window or touches a surface.
//!
//! stdout carries data only, stderr everything else; the exit code says what happened ([`Exit`]).

mod adapters;
mod args;
mod bench;
mod bless;
mod check;
mod compare;
mod explain;
mod fault;
mod files;
pub mod gallery;
pub mod golden;
mod list;
mod migrate;
mod painter;
mod render;
mod report;
mod sequence;
mod streams;
mod stress;
pub mod sweep;
mod verify;

use std::io::{self, Write as _};

use clap::CommandFactory as _;
use serde_json::{Value, json};

use args::Common;
pub use args::{Cli, Command};
pub use fault::{Exit, Fault};
use streams::Streams;

use crate::preset_file::{self, PresetError, PresetFile};

/// Runs what was asked. Errors are for [`complain`].
pub fn run(cli: &Cli) -> Result<Exit, Fault> {
    let Some(command) = &cli.command else { return window(cli) };
    if let Some(preset_file) = &cli.open {
        return Err(Fault::usage(format!("{preset_file:?} stands before a command; a preset without a command opens the window")));
    }
    let mut streams = Streams::new(cli.common.quiet, cli.common.json);
    let result = dispatch(&cli.common, command, &mut streams).and_then(|exit| streams.finish().map(|()| exit).map_err(Fault::from));
    match result {
        // The reader of a pipe has seen enough.
        Err(fault) if fault.is_closed_pipe() => Ok(Exit::Done),
        result => result,
    }
}

fn dispatch(common: &Common, command: &Command, streams: &mut Streams) -> Result<Exit, Fault> {
    match command {
        Command::List(args) => list::run(common, args, streams),
        Command::Adapters => adapters::run(streams),
        Command::Render(args) => render::run(common, args, streams),
        Command::Sequence(args) => sequence::run(common, args, streams),
        Command::Verify(args) => verify::run(common, args, streams),
        Command::Compare(args) => compare::run(common, args, streams),
        Command::Explain(args) => explain::run(common, args, streams),
        Command::Bless(args) => bless::run(common, args, streams),
        Command::Bench(args) => bench::run(common, args, streams),
        Command::Stress(args) => stress::run(common, args, streams),
        Command::Gallery(args) => gallery::run(args, streams),
        Command::Check(args) => check::run(common, args, streams),
        Command::Migrate(args) => migrate::run(args, streams),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Cli::command(), "rasterlab", &mut script);
            streams.bytes(&script)?;
            Ok(Exit::Done)
        }
    }
}

#[cfg(feature = "gui")]
fn window(cli: &Cli) -> Result<Exit, Fault> {
    if let Some(what) = &cli.open {
        // Said here, where a person reads it, rather than in a window that opens and shows nothing.
        open(&cli.common, what).map_err(|fault| perhaps_a_command(fault, what))?;
    }
    let adapter = match painter::wanted(&cli.common) {
        painter::Wanted::Cpu => {
            return Err(Fault::usage("the window needs a GPU adapter; --adapter cpu serves render, verify, compare and check"));
        }
        painter::Wanted::Gpu(choice) => choice,
    };
    let options = crate::app::Options { open: cli.open.clone(), adapter, presets_dir: cli.common.presets_dir() };
    crate::app::run(options).map_err(Fault::window)?;
    Ok(Exit::Done)
}

/// What is no preset may be a command with a slip of the finger.
#[cfg(feature = "gui")]
fn perhaps_a_command(fault: Fault, what: &str) -> Fault {
    let names: Vec<String> = Cli::command().get_subcommands().map(|command| command.get_name().to_owned()).collect();
    let hint = crate::params::did_you_mean(what, names.iter().map(String::as_str));
    let is_unknown = matches!(fault.error.downcast_ref(), Some(PresetError::NoPreset { .. }));
    if hint.is_empty() || !is_unknown { fault } else { Fault::usage(format!("there is no preset and no command {what:?}{hint}")) }
}

#[cfg(not(feature = "gui"))]
fn window(_: &Cli) -> Result<Exit, Fault> {
    Err(Fault::usage("this build has no window; rasterlab --help lists the commands"))
}

/// Opens what a person named and applies `--unset`, then `--set`, in that order.
fn open(common: &Common, what: &str) -> Result<PresetFile, Fault> {
    let mut preset_file = if what == "-" {
        preset_file::parse_file(&files::stdin_text()?, "stdin", "stdin")?
    } else {
        preset_file::open(what, common.presets_dir().as_deref())?
    };
    if common.strict {
        preset_file = preset_file.strict()?;
    }
    for path in &common.unset {
        preset_file::unset(&mut preset_file, path)?;
    }
    for set in &common.set {
        let (path, value) = set.split_once('=').unwrap_or((set, ""));
        preset_file::set(&mut preset_file, path.trim(), value)?;
    }
    Ok(preset_file)
}

/// Every gallery look that has a golden, or those that were named.
fn preset_files(common: &Common, names: &[String], streams: &Streams) -> Result<Vec<PresetFile>, Fault> {
    let preset_files: Vec<PresetFile> = if names.is_empty() {
        let entries = preset_file::gallery(common.presets_dir().as_deref());
        let preset_files = entries.iter().map(|entry| open(common, &gallery_name(entry))).collect::<Result<Vec<_>, _>>()?;
        preset_files.into_iter().filter(|preset_file| preset_file.preset.test.is_some()).collect()
    } else {
        names.iter().map(|name| open(common, name)).collect::<Result<_, _>>()?
    };
    preset_files.iter().flat_map(|preset_file| &preset_file.warnings).for_each(|warning| streams.note(warning));
    Ok(preset_files)
}

/// The path of a preset on disk, so that a file wins over whatever else has its name.
fn gallery_name(entry: &preset_file::GalleryEntry) -> String {
    entry.path.as_ref().map_or_else(|| entry.id.clone(), |path| path.to_string_lossy().into_owned())
}

/// Says what went wrong: the error chain on stderr, one sentence per level, and as JSON on stdout where that was asked for.
pub fn complain(cli: &Cli, fault: &Fault) {
    // A reader who has gone away needs no error.
    for (depth, cause) in fault.error.chain().enumerate() {
        let _ = writeln!(io::stderr(), "{}{cause}", if depth == 0 { "error: " } else { "  because " });
    }
    if cli.common.json {
        let position = fault.error.downcast_ref::<PresetError>().and_then(PresetError::position).unwrap_or_default();
        let file = if position.file.is_empty() { Value::Null } else { json!(position.file) };
        let error = json!({ "code": fault.exit as u8, "message": fault.sentence(), "file": file, "line": position.line });
        let command = cli.command.as_ref().map(Command::name);
        let object = json!({ "schema": 1, "command": command, "adapter": null, "results": [], "errors": [error] });
        let _ = Streams::new(true, true).text(&format!("{object:#}\n"));
    }
}
