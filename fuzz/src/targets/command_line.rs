//! Command lines: one argument a line. They are parsed, and what `--set`, `--unset` and `--vary`
//! say is done.

use clap::Parser as _;
use rasterlab::{
    cli::{Cli, Command},
    params::legible_line,
    preset_file::{
        self, PresetFile,
        sweep::{Sheet, Variation},
    },
};

use super::{Outcome, Target, assert_told, preset};
use crate::guard::Limit;

pub const TARGET: Target = Target {
    name: "command_line",
    about: "command lines, with what --set, --unset and --vary say",
    views: &[],
    limit: Limit::new(5, 256),
    check,
};

fn check(bytes: &[u8]) -> Outcome {
    let text = String::from_utf8_lossy(bytes);
    let words = std::iter::once("rasterlab").chain(text.lines().filter(|line| !line.is_empty()));
    // Usage takes several lines and repeats what was typed.
    let cli = Cli::try_parse_from(words)
        .map_err(|error| legible_line(error.to_string().lines().next().unwrap_or_default()))?;
    let mut preset_file =
        preset_file::parse("schema = 2\n[effects.facet]\n[effects.lambert]\n", "fuzz")
            .expect("a preset");
    for path in &cli.common.unset {
        told(preset_file::unset(&mut preset_file, path));
    }
    for set in &cli.common.set {
        let (path, value) = set.split_once('=').unwrap_or((set, ""));
        let before = preset_file.preset.clone();
        if !told(preset_file::set(&mut preset_file, path.trim(), value)) {
            assert_eq!(
                format!("{:?}", preset_file.preset),
                format!("{before:?}"),
                "a refused --set changed something"
            );
        }
    }
    if told(preset_file.check_values()) {
        preset::comes_back(&preset_file);
    }
    if let Some(Command::Sweep(sweep)) = &cli.command {
        vary(&preset_file, &sweep.vary);
    }
    Ok(())
}

fn vary(preset_file: &PresetFile, texts: &[String]) {
    let variations: Result<Vec<Variation>, String> =
        texts.iter().map(|text| Variation::parse(text)).collect();
    match variations.and_then(|variations| Sheet::new(preset_file, &variations)) {
        Ok(sheet) => sheet.cells.iter().for_each(|cell| drop(cell.caption())),
        // It repeats what was typed.
        Err(error) => assert_told(&legible_line(&error)),
    }
}

/// Was it done? A refusal is told in one line.
fn told<E: std::fmt::Display>(result: Result<(), E>) -> bool {
    result
        .map_err(|error| assert_told(&error.to_string()))
        .is_ok()
}
