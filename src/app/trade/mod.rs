//! Trade: measures the time and the error of combinations of accuracy options on the scene that is
//! shown.

pub mod measure;
pub mod pace;
pub mod point;
pub mod request;
#[cfg(target_arch = "wasm32")]
pub mod sent;
