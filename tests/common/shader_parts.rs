//! A copy of the shaders, to make mistakes in.

use std::{fs, path::Path};

/// A copy of the project's shaders.
pub fn copied() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    copy_folder(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders"),
        folder.path(),
    );
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
