//! The formats of model files.

use std::path::Path;

use crate::{
    host::model,
    scene::{
        Scene,
        gltf::{self, LoadError},
        memory::MemoryBudget,
        mesh_files::{self, LoadModel},
    },
};

/// A format of model files.
pub struct ModelFormat {
    /// In small letters, without the dot.
    pub extension: &'static str,
    /// Extensions of the files beside a model that it may refer to.
    pub beside: &'static [&'static str],
    read: LoadModel,
}

/// Every format that is read. `tests/house/registry.rs` compares the texts that name them.
pub const MODEL_FORMATS: &[ModelFormat] = &[
    ModelFormat {
        extension: "glb",
        beside: &[],
        read: gltf::load_within,
    },
    ModelFormat {
        extension: "gltf",
        beside: &["bin", "png", "jpg", "jpeg", "ktx2"],
        read: gltf::load_within,
    },
    // A GLB with a person in it.
    ModelFormat {
        extension: "vrm",
        beside: &[],
        read: gltf::load_within,
    },
    ModelFormat {
        extension: "obj",
        beside: &["mtl", "png", "jpg", "jpeg", "webp"],
        read: mesh_files::load_obj,
    },
    ModelFormat {
        extension: "stl",
        beside: &[],
        read: mesh_files::load_stl,
    },
    ModelFormat {
        extension: "ply",
        beside: &["png", "jpg", "jpeg", "webp"],
        read: mesh_files::load_ply,
    },
];

impl ModelFormat {
    /// The format of a file, by its extension; none if it is no model.
    pub fn of(path: &Path) -> Option<&'static Self> {
        MODEL_FORMATS.iter().find(|format| {
            path.extension()
                .is_some_and(|extension| extension.eq_ignore_ascii_case(format.extension))
        })
    }

    /// Loads a file of this format within the memory budget of the process.
    ///
    /// # Errors
    /// As [`model::load_as`].
    pub fn load(&self, path: &Path) -> Result<Scene, LoadError> {
        model::load_as(path, MemoryBudget::of_process(), self.read)
    }

    /// Every extension with its dot, with commas between them, and `last` before the last.
    pub fn names(last: &str) -> String {
        let names: Vec<String> = MODEL_FORMATS
            .iter()
            .map(|format| format!(".{}", format.extension))
            .collect();
        match names.split_last() {
            Some((end, rest)) => format!("{}{last}{end}", rest.join(", ")),
            None => String::new(),
        }
    }
}
