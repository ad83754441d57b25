//! Features: one table says what every part of the kernel key means: which sections of shader files
//! it selects, which overrides it sets, how it reads in the key's label, and which part of the
//! frame is omitted without it.

mod feature;
mod geometry;
mod raster;
mod shading;

use std::fmt;

use self::feature::{Feature, NO_STEP};
use super::{key::KernelKey, pass::Pass};
use crate::scene::needs::Needs;

/// Every feature, in the order of the frame.
fn features() -> impl Iterator<Item = &'static Feature> {
    raster::BASIS
        .iter()
        .chain(geometry::FEATURES)
        .chain(raster::FEATURES)
        .chain(shading::FEATURES)
}

impl KernelKey {
    /// The section that a pass takes of each file of `shaders/variants`. A function of steps has an
    /// entry for each step, in the order in which they are called.
    pub fn variants(&self, pass: Pass) -> Vec<(&'static str, &'static str)> {
        let all = features().flat_map(|feature| {
            feature
                .variants
                .iter()
                .map(|(file, section)| (*file, section(self, pass)))
        });
        all.filter(|(_, section)| *section != NO_STEP).collect()
    }

    /// Values of the overrides. Those that a pass does not declare are dropped by the pipeline
    /// builder.
    pub fn constants(&self, pass: Pass) -> Vec<(&'static str, f64)> {
        features()
            .flat_map(|feature| {
                feature
                    .constants
                    .iter()
                    .map(|(name, value)| (*name, value(self, pass)))
            })
            .collect()
    }

    /// Parts of the frame that this key omits, each with the reason.
    pub fn omissions(&self, needs: &Needs) -> Vec<(&'static str, String)> {
        let omitted = features()
            .filter_map(|feature| feature.part.as_ref())
            .filter(|part| !(part.is_used)(self));
        omitted
            .map(|part| (part.name, (part.why_omitted)(needs)))
            .collect()
    }
}

impl fmt::Display for KernelKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words: Vec<String> = features()
            .map(|feature| (feature.label)(self))
            .filter(|words| !words.is_empty())
            .collect();
        write!(f, "raster[{}]", words.join(" "))
    }
}
