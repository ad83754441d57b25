//! Where the look of a preset comes from that has landed on another scene.

use std::path::PathBuf;

/// The preset that a look comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Look {
    pub id: String,
    pub path: Option<PathBuf>,
    pub title: String,
}
