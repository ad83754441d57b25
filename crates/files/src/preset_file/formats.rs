//! The formats of model files.

use std::path::Path;

use crate::{
    host::model,
    scene::{Scene, gltf::LoadError},
};

/// A format of model files.
pub struct ModelFormat {
    /// In small letters, without the dot.
    pub extension: &'static str,
    /// Extensions of the files beside a model that it may refer to.
    pub beside: &'static [&'static str],
    pub(super) load: fn(&Path) -> Result<Scene, LoadError>,
}

/// Every format that is read. `tests/house/registry.rs` compares the help texts that name them.
pub const MODEL_FORMATS: &[ModelFormat] = &[
    ModelFormat {
        extension: "glb",
        beside: &[],
        load: model::load,
    },
    ModelFormat {
        extension: "gltf",
        beside: &["bin", "png", "jpg", "jpeg", "ktx2"],
        load: model::load,
    },
    // A GLB with a person in it.
    ModelFormat {
        extension: "vrm",
        beside: &[],
        load: model::load,
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
