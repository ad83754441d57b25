//! The command line: subcommands over the same core as the window. None of them opens a window or a
//! surface.
//!
//! stdout carries only data, stderr everything else; the exit code tells the outcome ([`Exit`]).

mod adapters;
mod args;
mod arrays;
mod backend;
mod bench;
mod bless;
mod check;
mod compare;
mod error;
mod explain;
mod files;
mod finding;
pub mod gallery;
mod link;
mod list;
mod loading;
mod man;
mod measured;
mod new_effect;
mod open;
mod page;
mod parts;
mod probe;
mod render;
mod report;
mod review;
mod sequence;
mod streams;
mod stress;
mod sweep;
pub mod trade;
mod values;
mod verify;

use std::io::{self, Write as _};

use clap::{CommandFactory as _, FromArgMatches as _, parser::ValueSource};
use serde_json::{Value, json};

use args::Common;
pub use args::{Cli, Command};
pub use error::{CliError, Exit};
use streams::Streams;

use crate::{
    effect_files::check_added, gpu::device_memory::choose_device_memory, host, oracle,
    preset_file::PresetError,
};

/// Runs the command.
///
/// # Errors
/// What failed; [`report_error`] prints it.
pub fn run(cli: &Cli) -> Result<Exit, CliError> {
    if let Some(folder) = cli
        .common
        .shaders
        .as_ref()
        .filter(|folder| !folder.is_dir())
    {
        return Err(CliError::usage(format!(
            "--shaders {}: there is no such folder",
            folder.display()
        )));
    }
    if host::shaders::choose(cli.common.shaders.clone()).is_some() {
        check_added().map_err(CliError::usage)?;
    }
    cli.common
        .memory_budget()
        .map_err(CliError::usage)?
        .unwrap_or_else(host::memory::machine_budget)
        .choose();
    if let Some(gib) = cli.common.oracle_gib() {
        oracle::choose_memory(gib);
    }
    if let Some(bytes) = cli.common.device_memory {
        choose_device_memory(bytes);
    }
    if let Some(folder) = cli.common.presets_dir().filter(|folder| !folder.is_dir()) {
        return Err(CliError::usage(format!(
            "--presets or RASTERLAB_PRESETS: there is no folder {}",
            folder.display()
        )));
    }
    let Some(command) = &cli.command else {
        return window(cli);
    };
    if let Some(option) = (cli.shared.iter()).find(|option| !args::takes(command.name(), option)) {
        let (name, option) = (command.name(), option.replace('_', "-"));
        return Err(CliError::usage(format!(
            "--{option} has no meaning for {name}; rasterlab {name} --help lists what it takes"
        )));
    }
    if let Some(preset_file) = &cli.open {
        return Err(CliError::usage(format!(
            "{preset_file:?} stands before a command; leave it out, or leave out the command to open it in the window"
        )));
    }
    if cli.log.is_some() {
        return Err(CliError::usage(format!(
            "--log has no meaning for {}; it keeps the log of the window",
            command.name()
        )));
    }
    let mut streams = Streams::new(cli.common.quiet, cli.common.json);
    let result = dispatch(&cli.common, command, &mut streams)
        .and_then(|exit| streams.finish().map(|()| exit).map_err(CliError::from));
    match result {
        // A reader that closes the pipe early is no error.
        Err(error) if error.is_closed_pipe() => Ok(Exit::Done),
        result => result,
    }
}

fn dispatch(common: &Common, command: &Command, streams: &mut Streams) -> Result<Exit, CliError> {
    match command {
        Command::List(args) => list::run(common, args, streams),
        Command::Adapters => adapters::run(streams),
        Command::Render(args) => render::run(common, args, streams),
        Command::Sequence(args) => sequence::run(common, args, streams),
        Command::Verify(args) => verify::run(common, args, streams),
        Command::Compare(args) => compare::run(common, args, streams),
        Command::Explain(args) => explain::run(common, args, streams),
        Command::Probe(args) => probe::run(common, args, streams),
        Command::Parts(args) => parts::run(common, args, streams),
        Command::Bless(args) => bless::run(common, args, streams),
        Command::Bench(args) => bench::run(common, args, streams),
        Command::Sweep(args) => sweep::run(common, args, streams),
        Command::Stress(args) => stress::run(common, args, streams),
        Command::Gallery(args) => gallery::run(args, streams),
        Command::Check(args) => check::run(common, args, streams),
        Command::Review(args) => review::run(common, args, streams),
        Command::NewEffect(args) => new_effect::run(common, args, streams),
        Command::Link(args) => link::run(common, args, streams),
        Command::Page(args) => page::run(common, args, streams),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Cli::command(), "rasterlab", &mut script);
            streams.bytes(&script)?;
            Ok(Exit::Done)
        }
        Command::Man { folder } => man::run(folder.as_deref(), streams),
    }
}

#[cfg(feature = "gui")]
fn window(cli: &Cli) -> Result<Exit, CliError> {
    // Errors are reported on the terminal instead of in an empty window.
    // Without anything to open or to change, the window goes on with its last session.
    let is_asked = cli.open.is_some()
        || cli.common.preset.is_some()
        || !(cli.common.set.is_empty() && cli.common.unset.is_empty());
    let opened = match (&cli.open, &cli.common.preset) {
        (None, Some(look)) => Some((look.as_str(), open::open_alone(&cli.common, look))),
        (what, _) if is_asked => {
            let what = what.as_deref().unwrap_or(crate::app::FIRST_PRESET);
            Some((what, open::open_to_ask(&cli.common, what)))
        }
        _ => None,
    };
    let opened = opened
        .map(|(what, opened)| opened.map_err(|error| suggest_command(error, what)))
        .transpose()?;
    let model = opened.as_ref().filter(|opened| opened.chose_scene);
    model.map_or(Ok(()), backend::check_model)?;
    let adapter = match backend::backend_choice(&cli.common) {
        backend::BackendChoice::Oracle => {
            return Err(CliError::usage(
                "the window needs a GPU adapter; --adapter cpu serves render, verify, compare and check",
            ));
        }
        backend::BackendChoice::Gpu(choice) => choice,
    };
    let log = cli.log.as_ref().map(|path| {
        let file = std::fs::File::options()
            .create(true)
            .append(true)
            .open(path);
        file.map_err(|error| {
            CliError::usage(format!(
                "--log {}: the file cannot be written: {error}",
                path.display()
            ))
        })
    });
    let options = crate::app::Options {
        open: cli.open.clone(),
        opened,
        adapter,
        folders: cli.common.window_folders(),
        config: crate::app::config_folder(),
        log: log.transpose()?.map(std::sync::Arc::new),
        ..Default::default()
    };
    crate::app::run(options).map_err(CliError::window)?;
    Ok(Exit::Done)
}

/// The name of a preset that does not exist may be a mistyped command.
#[cfg(feature = "gui")]
fn suggest_command(error: CliError, what: &str) -> CliError {
    let is_unknown = matches!(
        error.error.downcast_ref(),
        Some(PresetError::NoPreset { .. })
    );
    match hinted_command(what) {
        Some(sentence) if is_unknown => CliError::usage(sentence),
        _ => error,
    }
}

/// The arguments of this process.
///
/// # Errors
/// They cannot be read, or ask for help.
pub fn parse() -> Result<Cli, clap::Error> {
    let mut command = args::command();
    let matches = command.try_get_matches_from_mut(std::env::args_os())?;
    let mut cli = Cli::from_arg_matches(&matches).map_err(|error| error.format(&mut command))?;
    if let Some((_, given)) = matches.subcommand() {
        let is_typed = |name: &String| given.value_source(name) == Some(ValueSource::CommandLine);
        cli.shared = args::shared_options()
            .into_iter()
            .filter(is_typed)
            .collect();
    }
    Ok(cli)
}

/// What is wrong with arguments that cannot be read because the first word is a mistyped command.
pub fn mistyped_command(error: &clap::Error) -> Option<String> {
    use clap::error::ErrorKind;
    if !matches!(
        error.kind(),
        ErrorKind::UnknownArgument | ErrorKind::InvalidSubcommand | ErrorKind::TooManyValues
    ) {
        return None;
    }
    let first = std::env::args().nth(1)?;
    let is_command = Cli::command().find_subcommand(&first).is_some();
    if is_command || first.starts_with('-') || std::path::Path::new(&first).exists() {
        return None;
    }
    hinted_command(&first)
}

/// `there is no preset and no command "rendr"; did you mean …`: none if no command is like it.
fn hinted_command(what: &str) -> Option<String> {
    let names: Vec<String> = Cli::command()
        .get_subcommands()
        .map(|command| command.get_name().to_owned())
        .collect();
    let hint = crate::params::did_you_mean(what, names.iter().map(String::as_str));
    (!hint.is_empty()).then(|| format!("there is no preset and no command {what:?}{hint}"))
}

#[cfg(not(feature = "gui"))]
fn window(_: &Cli) -> Result<Exit, CliError> {
    Err(CliError::usage(
        "this build has no window; rasterlab --help lists the commands",
    ))
}

/// Prints the error chain to stderr, one sentence per level, and with `--json` an object to stdout.
pub fn report_error(cli: &Cli, error: &CliError) {
    // A closed stderr leaves no place for an error.
    for (depth, cause) in error.error.chain().enumerate() {
        let _ = writeln!(
            io::stderr(),
            "{}{cause}",
            if depth == 0 { "error: " } else { "  because " }
        );
    }
    if cli.common.json {
        let position = error
            .error
            .downcast_ref::<PresetError>()
            .and_then(PresetError::position)
            .unwrap_or_default();
        let file = if position.file.is_empty() {
            Value::Null
        } else {
            json!(position.file)
        };
        let error = json!({ "code": error.exit as u8, "message": error.sentence(), "file": file, "line": position.line });
        let command = cli.command.as_ref().map(Command::name);
        let object = json!({ "schema": streams::JSON_SCHEMA, "command": command, "adapter": null, "results": [], "errors": [error] });
        let _ = Streams::new(true, true).text(&format!("{object:#}\n"));
    }
}
