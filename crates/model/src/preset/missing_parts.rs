//! Warnings about scopes: patterns that match no part of the scene.

use super::Preset;
use crate::{
    params::did_you_mean,
    scene::{
        Scene,
        particle_discs::PARTICLES,
        parts::{MAX_PATTERNS, Part, PartKind, PartPattern, Scope, parts, scope_masks},
    },
};

/// Names of the ground and of the room, as a node and as a material.
const GROUND: &str = "ground";
const ROOM: &str = "room";

/// Most names in a warning.
const MAX_NAMES: usize = 12;

impl Preset {
    /// A sentence for every pattern in the scope of an effect that matches no part of `scene`, with
    /// names that it could match.
    pub fn missing_parts(&self, scene: &Scene) -> Vec<String> {
        let joining = self.joining_parts();
        let unmatched = self.stack.0.iter().flat_map(|enabled| {
            enabled
                .on
                .unmatched(scene)
                .into_iter()
                .map(move |pattern| (enabled, pattern))
        });
        let missing =
            unmatched.filter(|(_, pattern)| !joining.iter().any(|name| pattern.matches(name)));
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

    /// Leaves out of each scope what matches no part of `scene`, on which the preset has landed.
    /// Effects to which nothing is left act on all of it, but not on the ground and the room that
    /// the preset brings. A sentence for each effect says so.
    pub fn map_missing_parts(&mut self, scene: &Scene) -> Vec<String> {
        let joining = self.joining_parts();
        let own_parts = own_parts(scene, &joining);
        let mut notes = Vec::new();
        for enabled in &mut self.stack.0 {
            let is_missing =
                |pattern: &&PartPattern| !joining.iter().any(|name| pattern.matches(name));
            let all = enabled.on.patterns();
            let missing: Vec<&PartPattern> = enabled
                .on
                .unmatched(scene)
                .into_iter()
                .filter(is_missing)
                .collect();
            if missing.is_empty() {
                continue;
            }
            let name = &enabled.effect.name;
            let (note, on) = if missing.len() == all.len() {
                (
                    format!(
                        "effects.{name}.on: the scene has none of its parts, so the effect acts on the whole scene"
                    ),
                    own_parts.clone(),
                )
            } else {
                let there = all.iter().filter(|pattern| !missing.contains(pattern));
                (
                    format!(
                        "effects.{name}.on: {} of its {} parts are not in the scene and were left out",
                        missing.len(),
                        all.len()
                    ),
                    Scope::new(there.cloned()),
                )
            };
            notes.push(note);
            enabled.on = on;
        }
        notes
    }

    /// Names of the parts that join the scene when it is drawn: ground, room and particles.
    fn joining_parts(&self) -> Vec<&'static str> {
        [
            (self.ground.is_some(), GROUND),
            (self.room > 0.0, ROOM),
            (self.stack.particle_settings().is_some(), PARTICLES),
        ]
        .into_iter()
        .filter_map(|(is_there, name)| is_there.then_some(name))
        .collect()
    }
}

/// A scope of all of `scene` without its ground and its room, which are named in `joining`. The
/// whole scene where neither joins it, or where no few names tell them apart.
fn own_parts(scene: &Scene, joining: &[&str]) -> Scope {
    if !joining.iter().any(|name| [GROUND, ROOM].contains(name)) {
        return Scope::default();
    }
    let parts = parts(scene);
    let own = scene.instances.len() - scene.walls - scene.grounds;
    [PartKind::Node, PartKind::Mesh, PartKind::Material]
        .into_iter()
        .filter_map(|kind| {
            let named: Vec<PartPattern> = parts
                .iter()
                .filter(|part| part.kind == kind && part.depth == 0)
                .map(Part::pattern)
                .filter(|pattern| !joining.iter().any(|name| pattern.matches(name)))
                .collect();
            (named.len() <= MAX_PATTERNS).then(|| Scope::new(named))
        })
        .find(|scope| {
            let masks = scope_masks(scene, std::slice::from_ref(scope));
            !scope.is_whole_scene() && masks[..own].iter().all(|mask| *mask != 0)
        })
        .unwrap_or_default()
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
