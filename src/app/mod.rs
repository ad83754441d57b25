//! The window (being written).

use std::path::PathBuf;

use crate::gpu::device::AdapterChoice;

/// What the command line tells the window.
pub struct Options {
    /// A look, model or picture, as `preset::open` takes it.
    pub open: Option<String>,
    pub adapter: AdapterChoice,
    pub presets_dir: Option<PathBuf>,
}

/// Opens the window and returns when it is closed.
pub fn run(_options: Options) -> anyhow::Result<()> {
    anyhow::bail!("not yet")
}
