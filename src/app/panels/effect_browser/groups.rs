//! Groups of effects by what they do, derived from their hooks, and the search among them.

use std::sync::Arc;

use glam::{DVec2, DVec3, DVec4};

use crate::{
    app::widgets::fuzzy,
    effects::{
        Effect, Surface,
        hooks::{Finish, Slot},
    },
};

/// What effects of a group do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    Surface,
    Vertex,
    Sample,
    Layers,
    Lines,
    Image,
    Scene,
    Inspect,
}

impl Group {
    pub const ALL: [Self; 8] = [
        Self::Surface,
        Self::Vertex,
        Self::Sample,
        Self::Layers,
        Self::Lines,
        Self::Image,
        Self::Scene,
        Self::Inspect,
    ];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Surface => "Surface",
            Self::Vertex => "Vertex",
            Self::Sample => "Sample",
            Self::Layers => "Layers",
            Self::Lines => "Lines",
            Self::Image => "Image",
            Self::Scene => "Scene",
            Self::Inspect => "Inspect",
        }
    }

    pub const fn about(self) -> &'static str {
        match self {
            Self::Surface => "color what is visible",
            Self::Vertex => "move vertices",
            Self::Sample => "decide which samples are drawn",
            Self::Layers => "combine all layers of a pixel",
            Self::Lines => "draw along lines",
            Self::Image => "change the finished picture",
            Self::Scene => "add to the scene",
            Self::Inspect => "show how the picture is made",
        }
    }

    /// The group of an effect: that of the earliest stage that it changes.
    pub fn of(effect: &Effect) -> Self {
        let hooks = &effect.hooks;
        match hooks.slot {
            Some(Slot::Visibility) => return Self::Layers,
            Some(Slot::Order) => return Self::Inspect,
            Some(Slot::Coverage) => return Self::Sample,
            None => {}
        }
        if hooks.has_lines {
            Self::Lines
        } else if hooks.particle_settings.is_some() {
            Self::Scene
        } else if hooks.vertex.is_some() {
            Self::Vertex
        } else if hooks.sample.is_some() {
            Self::Sample
        } else if hooks.image.is_some() || hooks.passes.is_some() {
            Self::Image
        } else if shows_data(effect) {
            Self::Inspect
        } else {
            Self::Surface
        }
    }
}

/// Does a built-in effect paint the same color whatever the material's is? Then it shows something
/// else than the material.
fn shows_data(effect: &Effect) -> bool {
    let Some(apply) = effect
        .hooks
        .surface
        .as_ref()
        .filter(|_| effect.source.is_none())
    else {
        return false;
    };
    let words = &effect.defaults;
    // Lines and dots are somewhere in the picture, so several pixels are asked.
    (0..32).all(|index| {
        let [dark, bright] =
            [0.0, 1.0].map(|tone| apply(surface(f64::from(index), tone), words).color);
        dark == bright
    })
}

/// Some sample with a base color of `tone`, at another pixel for every `index`.
fn surface(index: f64, tone: f64) -> Surface {
    Surface {
        color: DVec4::new(tone, tone, tone, 1.0),
        glow: DVec3::ZERO,
        position: DVec3::new(0.1, 0.2, 0.3),
        normal: DVec3::new(0.6, 0.0, 0.8),
        flat_normal: DVec3::Z,
        view: DVec3::Z,
        center: DVec3::ZERO,
        center_screen: DVec2::splat(0.5),
        screen: DVec2::splat(0.5),
        pixel: DVec2::new(100.0 + 3.0 * index, 100.0 + index),
        barycentrics: DVec3::splat(1.0 / 3.0),
        edge_distance_px: DVec3::splat(20.0),
        depth_m: 2.0,
        pixel_size_m: 0.001,
        flat_depth_m: 2.0,
        depth_range_m: DVec2::new(1.0, 4.0),
        triangle_id: 7,
        rank: 0.5,
        lit: 0.5,
        finish: Finish::default(),
        passed: DVec3::ZERO,
        step_offset: 0.0,
    }
}

/// The effects that answer `search` and `is_kept`, in their groups. Within a group the best answers
/// come first.
pub fn group_effects<'a>(
    effects: &[&'a Arc<Effect>],
    search: &str,
    is_kept: impl Fn(&Effect) -> bool,
) -> Vec<(Group, Vec<&'a Arc<Effect>>)> {
    let about = |effect: &Effect| {
        format!(
            "{} {} {}",
            effect.about,
            Group::of(effect).name(),
            effect.hooks.names()
        )
    };
    let mut found: Vec<(Group, i32, &Arc<Effect>)> = effects
        .iter()
        .filter(|effect| is_kept(effect))
        .filter_map(|effect| {
            Some((
                Group::of(effect),
                -fuzzy::score(search, &effect.name, &about(effect))?,
                *effect,
            ))
        })
        .collect();
    found.sort_by_key(|(group, score, _)| (*group, *score));
    let of = |group: Group| {
        found
            .iter()
            .filter(move |(other, ..)| *other == group)
            .map(|(.., effect)| *effect)
            .collect::<Vec<_>>()
    };
    Group::ALL
        .into_iter()
        .map(|group| (group, of(group)))
        .filter(|(_, effects)| !effects.is_empty())
        .collect()
}

/// The effect of `groups` that answers `search` best; none if nothing does.
pub fn best<'a>(groups: &[(Group, Vec<&'a Arc<Effect>>)], search: &str) -> Option<&'a Arc<Effect>> {
    // Of a group the first answers best.
    let first = groups.iter().filter_map(|(_, effects)| effects.first());
    first
        .max_by_key(|effect| fuzzy::score(search, &effect.name, &effect.about))
        .copied()
}

/// The other effects of `stack` for which the place of `effect` in the stack matters: both change
/// vertices, surfaces, or the picture. Tests of samples may stand in any order.
pub fn depends_on_order<'a>(effect: &Effect, stack: &[&'a Arc<Effect>]) -> Vec<&'a str> {
    let shares = |other: &&&Arc<Effect>| {
        let (a, b) = (&effect.hooks, &other.hooks);
        (a.vertex.is_some() && b.vertex.is_some())
            || (a.surface.is_some() && b.surface.is_some())
            || (a.image.is_some() && b.image.is_some())
            || (a.passes.is_some() && b.passes.is_some())
    };
    stack
        .iter()
        .filter(|other| other.name != effect.name)
        .filter(shares)
        .map(|other| other.name.as_str())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::EFFECTS;

    fn effect(name: &str) -> &'static Arc<Effect> {
        Effect::find(name).expect("a built-in effect")
    }

    #[test]
    fn every_built_in_effect_is_in_the_group_of_what_it_does() {
        let of = |group: Group| -> Vec<&str> {
            EFFECTS
                .iter()
                .filter(|effect| Group::of(effect) == group)
                .map(|effect| effect.name.as_str())
                .collect()
        };
        assert_eq!(
            of(Group::Inspect),
            ["draw_order", "triangle_id", "normals", "depth"]
        );
        assert_eq!(of(Group::Layers), ["glass", "xray", "overdraw", "race"]);
        assert_eq!(of(Group::Lines), ["dots"]);
        assert_eq!(of(Group::Scene), ["particles"]);
        assert_eq!(of(Group::Vertex), ["explode", "inflate", "wobble", "psx"]);
        assert_eq!(
            of(Group::Sample),
            ["boxes", "points", "dissolve", "stipple", "wireframe"]
        );
        assert_eq!(
            of(Group::Surface),
            [
                "facet", "matcap", "lambert", "studio", "shadow", "toon", "hatch", "fog", "tonemap"
            ]
        );
        assert_eq!(
            of(Group::Image),
            [
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
                "crt"
            ]
        );
        assert_eq!(Group::ALL.map(of).concat().len(), EFFECTS.len());
    }

    #[test]
    fn search_finds_names_descriptions_and_groups() {
        let all: Vec<&'static Arc<Effect>> = EFFECTS.iter().collect();
        let names = |search: &str| -> Vec<&str> {
            group_effects(&all, search, |_| true)
                .into_iter()
                .flat_map(|(_, e)| e)
                .map(|e| e.name.as_str())
                .collect()
        };
        assert_eq!(names("toon"), ["toon"]);
        assert_eq!(
            names("layers")
                .into_iter()
                .collect::<std::collections::BTreeSet<_>>()
                .into_iter()
                .collect::<Vec<_>>(),
            ["glass", "overdraw", "race", "xray"]
        );
        assert!(names("vertex").contains(&"wobble") && names("ink").contains(&"hatch"));
        assert_eq!(names("").len(), EFFECTS.len());
        let only = group_effects(&all, "", |effect| effect.name == "fog");
        assert_eq!(only, [(Group::Surface, vec![effect("fog")])]);
    }

    #[test]
    fn order_matters_among_effects_of_one_hook() {
        let stack = ["dissolve", "facet", "toon", "outline", "wobble"].map(effect);
        assert_eq!(
            depends_on_order(effect("toon"), &stack),
            ["dissolve", "facet"]
        );
        assert!(depends_on_order(effect("wobble"), &stack).is_empty());
        assert_eq!(depends_on_order(effect("posterize"), &stack), ["outline"]);
        assert!(depends_on_order(effect("stipple"), &stack).is_empty());
    }
}
