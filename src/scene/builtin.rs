//! Builtin scenes (being written).

/// A builtin scene for listings.
pub struct Builtin {
    pub name: &'static str,
    pub about: &'static str,
}

/// A query that names no builtin, or a parameter outside its range.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BuiltinError(pub String);

/// Every builtin scene.
pub const BUILTINS: &[Builtin] = &[];

/// Builds `name?key=value&...`.
pub fn build(_query: &str) -> Result<super::Scene, BuiltinError> {
    Err(BuiltinError("not yet".into()))
}
