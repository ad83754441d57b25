//! Exit codes, and errors with their exit code.

use std::process::ExitCode;

use crate::{
    effects::Conflict,
    gpu::{RenderError, device::OpenError},
    preset_file::{PresetError, SceneError},
    scene::draw::DrawError,
};

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    Done = 0,
    /// A comparison, check or stress case failed, an error exceeds its limit, or a dry run found
    /// changes.
    Failed = 1,
    /// Wrong usage, or a file that cannot be read, parsed or written.
    Usage = 2,
    /// No adapter, or none with the required features.
    NoAdapter = 3,
    DeviceLost = 4,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

impl Exit {
    /// The first failure wins.
    pub fn and(self, next: Self) -> Self {
        if self == Self::Done { next } else { self }
    }

    pub fn failed_if(failed: bool) -> Self {
        if failed { Self::Failed } else { Self::Done }
    }
}

/// An error with the exit code it leads to.
#[derive(Debug)]
pub struct CliError {
    pub exit: Exit,
    pub error: anyhow::Error,
}

impl CliError {
    pub fn usage(sentence: impl std::fmt::Display) -> Self {
        Self {
            exit: Exit::Usage,
            error: anyhow::anyhow!("{sentence}"),
        }
    }

    /// The window did not open: no adapter, a lost device, or no display.
    pub fn window(error: anyhow::Error) -> Self {
        #[cfg(feature = "gui")]
        if error.downcast_ref::<crate::app::DeviceLost>().is_some() {
            return Self {
                exit: Exit::DeviceLost,
                error,
            };
        }
        let exit = match (
            error.downcast_ref::<OpenError>(),
            error.downcast_ref::<RenderError>(),
        ) {
            (Some(open), _) => exit_of_open(open),
            (_, Some(render)) => exit_of_render(render),
            _ => Exit::Usage,
        };
        Self { exit, error }
    }

    /// Adds what was being done.
    pub fn during(self, what: impl std::fmt::Display + Send + Sync + 'static) -> Self {
        Self {
            exit: self.exit,
            error: self.error.context(what),
        }
    }

    /// The whole chain in one line.
    pub fn sentence(&self) -> String {
        format!("{:#}", self.error)
    }

    pub fn is_closed_pipe(&self) -> bool {
        self.error
            .downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    }
}

fn exit_of_open(error: &OpenError) -> Exit {
    if matches!(error, OpenError::Ambiguous { .. }) {
        Exit::Usage
    } else {
        Exit::NoAdapter
    }
}

/// Only what another adapter may draw is the adapter's fault.
fn exit_of_render(error: &RenderError) -> Exit {
    match error {
        error if error.is_lost() => Exit::DeviceLost,
        error if error.depends_on_adapter() => Exit::NoAdapter,
        _ => Exit::Usage,
    }
}

impl From<OpenError> for CliError {
    fn from(error: OpenError) -> Self {
        Self {
            exit: exit_of_open(&error),
            error: error.into(),
        }
    }
}

impl From<RenderError> for CliError {
    fn from(error: RenderError) -> Self {
        Self {
            exit: exit_of_render(&error),
            error: error.into(),
        }
    }
}

macro_rules! usage_errors {
    ($($error:ty),*) => {$(
        impl From<$error> for CliError {
            fn from(error: $error) -> Self {
                Self { exit: Exit::Usage, error: error.into() }
            }
        }
    )*};
}

/// Where no preset is near to what was typed, it says what lists them all.
impl From<PresetError> for CliError {
    fn from(mut error: PresetError) -> Self {
        if let PresetError::NoPreset { hint, .. } = &mut error
            && hint.is_empty()
        {
            *hint = "; rasterlab list presets shows all of them".into();
        }
        Self {
            exit: Exit::Usage,
            error: error.into(),
        }
    }
}

usage_errors![SceneError, DrawError, Conflict, std::io::Error];
