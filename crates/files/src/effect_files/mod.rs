//! Effect files: effects that anyone can write, one WGSL file each. A file is read, checked, made
//! safe to link, and evaluated in f64 for the oracle.

mod catalog;
mod check;
mod duplicate;
mod evaluated;
mod images;
mod precision;
mod read;
mod rewrite;
mod soundness;
mod template;

use rasterlab_model::effects::text::{
    declaration, error, parameters, picture_twin, tokens, twin, words,
};

pub use self::{
    catalog::{Catalog, CustomEffect},
    duplicate::duplicate,
    error::{EffectError, Place},
    evaluated::{EvaluatedError, evaluated},
    precision::{
        ErrorsOfEffect, LargestError, Place as ErrorPlace, Quantity, has_f32_error, overreaching,
        precision,
    },
    read::{MAX_BYTES, RESERVED_NAMES, check_name, read, read_beside, stem},
    rewrite::MAX_TURNS,
    soundness::{Crossing, Unsound, crossings},
    template::{Hook, template},
    words::LIBRARY,
};
