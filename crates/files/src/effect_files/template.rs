//! Templates: the commented file that a new effect begins with.

use super::declaration::type_name;
use crate::params::did_you_mean;

/// The hook of a new effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hook {
    Vertex,
    Sample,
    Surface,
    Pixel,
    Image,
}

impl Hook {
    pub const ALL: [Self; 5] = [
        Self::Surface,
        Self::Vertex,
        Self::Sample,
        Self::Pixel,
        Self::Image,
    ];

    /// The word for it on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::Sample => "sample",
            Self::Surface => "surface",
            Self::Pixel => "pixel",
            Self::Image => "image",
        }
    }

    /// The hook called `name`.
    ///
    /// # Errors
    /// Names all hooks.
    pub fn parse(name: &str) -> Result<Self, String> {
        let names = Self::ALL.map(Self::name);
        let found = Self::ALL.into_iter().find(|hook| hook.name() == name);
        found.ok_or_else(|| {
            format!(
                "{name:?} is no hook; hooks are {}{}",
                names.join(", "),
                did_you_mean(name, names.into_iter())
            )
        })
    }
}

/// The text of a new effect called `name`.
pub fn template(name: &str, hook: Hook) -> String {
    let text = match hook {
        Hook::Surface => include_str!("templates/surface.wgsl"),
        Hook::Vertex => include_str!("templates/vertex.wgsl"),
        Hook::Sample => include_str!("templates/sample.wgsl"),
        Hook::Pixel => include_str!("templates/pixel.wgsl"),
        Hook::Image => include_str!("templates/image.wgsl"),
    };
    text.replace("NAME", name).replace("Type", &type_name(name))
}
