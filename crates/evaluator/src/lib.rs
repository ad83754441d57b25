//! Evaluates functions of WGSL on the CPU, without a driver: naga's IR is lowered to flat code over
//! scalars, each instruction is executed for up to 64 samples at once, integers are exact, and floats
//! are f64 (or rounded to f32 after every operation).

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
mod rows;
mod scalar;
mod word;

pub use error::{EvalError, LowerError};
pub use machine::{Host, LANES, Machine, NoHost, Registers, Row};
pub use program::{Limits, Options, Precision, Program};
pub use word::Word;
