//! Arithmetic that every stage of the oracle shares: integer edge functions, depth keys, the
//! classification of float bits, f32 with flush-to-zero, and vector geometry. Nothing here knows a
//! scene.

pub mod bits;
pub mod depth_key;
pub mod edge;
pub mod ftz;
pub mod vector;
