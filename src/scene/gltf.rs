//! glTF (being written).

use std::path::Path;

/// Why a model cannot be drawn; one sentence.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct LoadError(pub String);

/// Loads a `.gltf` or `.glb`.
pub fn load(_path: &Path) -> Result<super::Scene, LoadError> {
    Err(LoadError("not yet".into()))
}
