//! Warnings about scopes: patterns that match no part of the scene.

use super::Preset;
use crate::{
    params::did_you_mean,
    scene::{
        Scene,
        particle_discs::PARTICLES,
        parts::{PartPattern, parts},
    },
};

/// Most names in a warning.
const MAX_NAMES: usize = 12;

impl Preset {
    /// A sentence for every pattern in the scope of an effect that matches no part of `scene`, with
    /// names that it could match.
    pub fn missing_parts(&self, scene: &Scene) -> Vec<String> {
        // The discs of particles join the scene when it is drawn.
        let is_disc = |pattern: &PartPattern| {
            self.stack.particle_settings().is_some() && pattern.matches(PARTICLES)
        };
        let unmatched = self.stack.0.iter().flat_map(|enabled| {
            enabled
                .on
                .unmatched(scene)
                .into_iter()
                .map(move |pattern| (enabled, pattern))
        });
        let missing = unmatched.filter(|(_, pattern)| !is_disc(pattern));
        missing
            .map(|(enabled, pattern)| {
                format!(
                    "effects.{}.on: {}",
                    enabled.effect.name,
                    sentence(pattern, scene)
                )
            })
            .collect()
    }
}

fn sentence(pattern: &PartPattern, scene: &Scene) -> String {
    let kind = pattern.kind;
    let names: Vec<String> = parts(scene)
        .into_iter()
        .filter(|part| part.kind == kind)
        .map(|part| part.name)
        .collect();
    let missing = format!(
        "the scene has no {} that matches {:?}",
        kind.name(),
        pattern.glob()
    );
    if names.is_empty() {
        return format!("{missing}; it has no {}", kind.plural());
    }
    let more = names.len().saturating_sub(MAX_NAMES);
    let shown: Vec<String> = names
        .iter()
        .take(MAX_NAMES)
        .map(|name| format!("{name:?}"))
        .collect();
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    format!(
        "{missing}; its {} are {}{more}{}",
        kind.plural(),
        shown.join(", "),
        did_you_mean(pattern.glob(), names.iter().map(String::as_str))
    )
}
