//! Parse, dispatch, print the error chain, exit code; nothing else.

use std::process::ExitCode;

use clap::Parser as _;
use rasterlab::cli::{self, Cli};

fn main() -> ExitCode {
    let cli = Cli::parse();
    match cli::run(&cli) {
        Ok(exit) => exit.into(),
        Err(error) => {
            cli::report_error(&cli, &error);
            error.exit.into()
        }
    }
}
