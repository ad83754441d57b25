//! Effects: pure functions with parameters, written twice. Here in f64, the reference; in
//! `shaders/effects/` in f32, in a file of the same name. Panel, preset settings, `--set`, uniform
//! bytes, layout test, golden and bench row are loops over [`EFFECTS`].

/// THE list. Adding an effect is its two files and one word here, at its place in the canonical
/// order.
macro_rules! for_each_effect {
    ($callback:ident) => {
        $callback![
            boxes,
            points,
            draw_order,
            particles,
            explode,
            inflate,
            wobble,
            psx,
            dissolve,
            stipple,
            facet,
            triangle_id,
            normals,
            depth,
            matcap,
            lambert,
            studio,
            shadow,
            toon,
            hatch,
            wireframe,
            fog,
            tonemap,
            glass,
            xray,
            overdraw,
            race,
            dots,
            posterize,
            smear,
            outline,
            dither,
            sky,
            ambient,
            sharpen,
            paint,
            depth_of_field,
            blur,
            bloom,
            glow_edges,
            halftone,
            pixelate,
            palette,
            aberration,
            grain,
            vignette,
            glitch,
            crt,
        ];
    };
}

macro_rules! modules {
    ($($name:ident),* $(,)?) => { $(pub mod $name;)* };
}

for_each_effect!(modules);

mod conflict;
mod effect;
pub mod hooks;
pub mod image_file;
mod list;
mod one_sun;
mod stack;

pub use self::{
    conflict::Conflict,
    effect::{BuiltIn, EMBEDDED_IMAGE, Effect, EffectSource, HookFunctions, constant_name, read},
    hooks::{Surface, SurfaceEffect, SurfaceInput},
    list::EFFECTS,
    stack::{EnabledEffect, MAX_IMAGE_PASSES, Stack},
};
