//! Evaluates functions of WGSL on the CPU, without a driver: naga's IR is lowered to flat code over
//! scalar registers, integers are exact, and floats are f64 (or rounded to f32 after every
//! operation).

mod code;
mod error;
mod facts;
mod float;
mod instruction;
mod layout;
mod lower;
mod machine;
mod operands;
mod optimize;
mod program;
mod scalar;
mod word;

pub use error::{EvalError, LowerError};
pub use machine::{Host, Machine, NoHost};
pub use program::{Limits, Options, Precision, Program};
pub use word::Word;
