//! The list of effects.

use std::sync::{Arc, LazyLock};

use super::{effect::Effect, hooks::Slot, text::built_in};
use crate::shaders::Library;

/// The canonical order: that in which a preset without a `stack` setting applies effects. A file of
/// `shaders/effects` that does not stand here comes after all of them, by name.
const ORDER: [&str; 48] = [
    "boxes",
    "points",
    "draw_order",
    "particles",
    "explode",
    "inflate",
    "wobble",
    "psx",
    "dissolve",
    "stipple",
    "facet",
    "triangle_id",
    "normals",
    "depth",
    "matcap",
    "lambert",
    "studio",
    "shadow",
    "toon",
    "hatch",
    "wireframe",
    "fog",
    "tonemap",
    "glass",
    "xray",
    "overdraw",
    "race",
    "dots",
    "posterize",
    "smear",
    "outline",
    "dither",
    "sky",
    "ambient",
    "sharpen",
    "paint",
    "depth_of_field",
    "blur",
    "bloom",
    "glow_edges",
    "halftone",
    "pixelate",
    "palette",
    "aberration",
    "grain",
    "vignette",
    "glitch",
    "crt",
];

/// Every effect, in canonical order: the embedded ones, and those that the folder of shaders of this
/// process has more, without faulty ones.
pub static EFFECTS: LazyLock<Vec<Arc<Effect>>> = LazyLock::new(|| {
    let files = Library::effects();
    let others = files.iter().map(String::as_str);
    let others = others.filter(|name| !ORDER.contains(name));
    let others = others.filter_map(|name| built_in(name).ok().map(Arc::new));
    ORDER.into_iter().map(effect).chain(others).collect()
});

macro_rules! in_rust {
    ($($name:ident),* $(,)?) => {
        /// The effect that the module of this name makes.
        fn in_rust(name: &str) -> Option<Arc<Effect>> {
            match name {
                $(stringify!($name) => Some((*super::$name::EFFECT).clone()),)*
                _ => None,
            }
        }
    };
}

for_each_in_rust!(in_rust);

fn effect(name: &str) -> Arc<Effect> {
    in_rust(name).unwrap_or_else(|| {
        let read = built_in(name).unwrap_or_else(|error| panic!("{error}"));
        Arc::new(match name {
            "boxes" => read.in_slot(Slot::Coverage),
            "race" => read.in_slot(Slot::Visibility).repeatable_if(|_| false),
            _ => read,
        })
    })
}

impl Effect {
    /// The effect called `name`.
    pub fn find(name: &str) -> Option<&'static Arc<Self>> {
        EFFECTS.iter().find(|effect| effect.name == name)
    }

    /// The built-in effect called `name`, which there must be.
    pub fn named(name: &str) -> &'static Arc<Self> {
        Self::find(name).unwrap_or_else(|| panic!("{name} is built in"))
    }

    /// Index in [`EFFECTS`]; an effect of a file comes after all of them.
    pub fn rank(&self) -> usize {
        let original = self.base.as_deref().unwrap_or(self);
        EFFECTS
            .iter()
            .position(|effect| **effect == *original)
            .unwrap_or(EFFECTS.len())
    }
}
