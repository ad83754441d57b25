//! The corpus: `fuzz/corpus/TARGET/` holds small files, each a beginning for mutations.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use crate::Target;

/// Longest input that is made, bytes.
pub const MAX_INPUT: usize = 1 << 16;

pub fn folder(target: &Target) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("corpus")
        .join(target.name)
}

/// Where input goes that a target failed on; libFuzzer is told the same folder.
pub fn found() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("found")
}

/// The files of a target's corpus by name, with their bytes.
pub fn read(target: &Target) -> io::Result<Vec<(String, Vec<u8>)>> {
    let mut paths: Vec<PathBuf> = fs::read_dir(folder(target))?
        .map(|entry| entry.map(|entry| entry.path()))
        .collect::<io::Result<_>>()?;
    paths.sort();
    let name = |path: &Path| {
        path.file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    };
    paths
        .iter()
        .map(|path| Ok((name(path), fs::read(path)?)))
        .collect()
}
