//! Warnings about scopes: patterns that match no part of the scene.

use super::Preset;
use crate::{
    params::did_you_mean,
    scene::{
        Scene,
        particle_discs::PARTICLES,
        parts::{PartPattern, Scope, parts},
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

impl Preset {
    /// Lets effects whose scope matches no part of `scene`, on which the preset has landed, act on
    /// the whole scene. A sentence for each says so.
    pub fn map_missing_parts(&mut self, scene: &Scene) -> Vec<String> {
        // Ground, room and particles join the scene.
        let joined: Vec<&str> = [
            (self.ground.is_some(), "ground"),
            (self.room > 0.0, "room"),
            (self.stack.particle_settings().is_some(), PARTICLES),
        ]
        .into_iter()
        .filter_map(|(is_there, name)| is_there.then_some(name))
        .collect();
        let mut notes = Vec::new();
        for enabled in &mut self.stack.0 {
            let patterns = enabled.on.patterns();
            let missing = enabled.on.unmatched(scene);
            let is_joined = |pattern: &PartPattern| joined.iter().any(|name| pattern.matches(name));
            if patterns.is_empty()
                || missing.len() < patterns.len()
                || patterns.iter().any(is_joined)
            {
                continue;
            }
            notes.push(format!(
                "effects.{}.on: the scene has none of its parts, so the effect acts on the whole scene",
                enabled.effect.name
            ));
            enabled.on = Scope::default();
        }
        notes
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
