//! Parse, dispatch, print the error chain, exit code; nothing else.

use std::process::ExitCode;

use clap::Parser as _;
use rasterlab::cli::{self, Cli, Exit};

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => match cli::mistyped_command(&error) {
            Some(sentence) => {
                eprintln!("error: {sentence}");
                return Exit::Usage.into();
            }
            None => error.exit(),
        },
    };
    match cli::run(&cli) {
        Ok(exit) => exit.into(),
        Err(error) => {
            cli::report_error(&cli, &error);
            error.exit.into()
        }
    }
}
