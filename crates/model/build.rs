//! Says where the files of `shaders/` are embedded from; a new file there is embedded by the next
//! build. A page gets them with the feature `terse`, without comments but
//! those of effects, which are what a person reads of them.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
};

fn main() -> io::Result<()> {
    println!("cargo:rerun-if-changed=../../shaders");
    let folder = |name| PathBuf::from(env::var_os(name).expect("cargo sets it"));
    let mut shaders = folder("CARGO_MANIFEST_DIR").join("../../shaders");
    if env::var_os("CARGO_FEATURE_TERSE").is_some() {
        let terse = folder("OUT_DIR").join("shaders");
        copy_terse(&shaders, &terse, false)?;
        shaders = terse;
    }
    println!("cargo:rustc-env=RASTERLAB_SHADERS={}", shaders.display());
    Ok(())
}

/// Copies a folder of WGSL files without comments, all lines in their places. Lines that begin with
/// `//@` are directives; where `is_told`, lines that are comments stay.
fn copy_terse(from: &Path, to: &Path, is_told: bool) -> io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let (from, to) = (entry.path(), to.join(entry.file_name()));
        if from.is_dir() {
            copy_terse(&from, &to, from.ends_with("effects"))?;
            continue;
        }
        let terse = |line: &str| match line.split_once("//") {
            Some((code, _)) if !(line.starts_with("//@") || is_told && code.trim().is_empty()) => {
                format!("{}\n", code.trim_end())
            }
            _ => format!("{line}\n"),
        };
        let text: String = fs::read_to_string(&from)?.lines().map(terse).collect();
        fs::write(to, text)?;
    }
    Ok(())
}
