//! Parts of the shaders, to make mistakes in: the head of a file (`lib/fixed`) or a section of one (`variants/coverage/fixed`).

use std::{
    fs,
    ops::Range,
    path::{Path, PathBuf},
};

use rasterlab::shader::library::sections;

/// The file of a part, its text, and where the part lies in it.
pub fn find(shaders: &Path, part: &str) -> Result<(PathBuf, String, Range<usize>), String> {
    let file = |name: &str| shaders.join(format!("{name}.wgsl"));
    let (path, section) = match part.rsplit_once('/') {
        Some((name, section)) if !file(part).exists() => (file(name), section),
        _ => (file(part), ""),
    };
    let text = fs::read_to_string(&path).map_err(|error| format!("{part}: {error}"))?;
    let found = sections(&text).into_iter().find(|(name, _)| *name == section).map(|(_, range)| range);
    let range = found.ok_or_else(|| format!("{} has no section {section}", path.display()))?;
    Ok((path, text, range))
}

/// A copy of the project's shaders.
pub fn copied() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    copy_folder(&Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders"), folder.path());
    folder
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder for shaders");
    for entry in fs::read_dir(from).expect("shaders/ can be read") {
        let path = entry.expect("shaders/ can be read").path();
        let target = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            copy_folder(&path, &target);
        } else {
            fs::copy(&path, target).expect("a shader is copied");
        }
    }
}
