//! The host: what the core, which knows no files and no environment, is given of the machine it
//! runs on.

pub mod disk;
pub mod memory;
pub mod model;
pub mod shaders;

use std::path::{Component, Path};

/// Is this a path inside the folder that it starts at, on every system?
pub fn stays_inside(path: &Path) -> bool {
    let text = path.to_string_lossy();
    path.components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
        && !text.contains(['\\', ':'])
}
