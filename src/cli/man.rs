//! `man`: the manual pages, from the same table as `--help`.

use std::path::Path;

use clap::CommandFactory as _;

use super::{
    args::Cli,
    error::{CliError, Exit},
    streams::Streams,
};

/// Prints the page of the program, or writes it and a page for each command into `folder`.
pub fn run(folder: Option<&Path>, streams: &mut Streams) -> Result<Exit, CliError> {
    match folder {
        Some(folder) => clap_mangen::generate_to(Cli::command(), folder).map_err(|error| {
            CliError::from(error).during(format!(
                "{}: the manual pages cannot be written",
                folder.display()
            ))
        })?,
        None => {
            let mut page = Vec::new();
            clap_mangen::Man::new(Cli::command().disable_help_subcommand(true))
                .render(&mut page)?;
            streams.bytes(&page)?;
        }
    }
    Ok(Exit::Done)
}
