//! Effects: pure functions with parameters. Each is a file in `shaders/effects`: kernels run it in
//! f32, and the reference is the same [text](mod@text) in f64, unless a module here is. Panel, preset
//! settings, `--set`, uniform bytes, layout test, golden and bench row are loops over [`EFFECTS`].

/// The effects that have a side in Rust.
macro_rules! for_each_in_rust {
    ($callback:ident) => {
        $callback![
            points, draw_order, particles, dissolve, studio, shadow, glass, xray, overdraw, dots,
        ];
    };
}

macro_rules! modules {
    ($($name:ident),* $(,)?) => { $(pub mod $name;)* };
}

for_each_in_rust!(modules);

mod conflict;
mod effect;
pub mod given;
pub mod hooks;
pub mod image_file;
mod list;
mod one_sun;
mod stack;
pub mod text;
mod words;

pub use self::{
    conflict::Conflict,
    effect::{BuiltIn, EMBEDDED_IMAGE, Effect, EffectSource, HookFunctions, constant_name, read},
    hooks::{Surface, SurfaceEffect, SurfaceInput},
    list::EFFECTS,
    stack::{EnabledEffect, MAX_IMAGE_PASSES, Stack},
    words::Words,
};
