//! Stack traits: what planning reads of a stack. A parameter that is not among them changes uniform
//! bytes alone.

use std::{borrow::Cow, sync::Arc};

use crate::{
    accuracy::Parameters,
    effects::{
        Effect, EnabledEffect, Stack,
        dots::LineSource,
        draw_order,
        hooks::{Layers, Shape, Slot},
        overdraw, read,
        xray::{self, Reach, Xray},
    },
    shader::image_files::kernel_words,
};

use super::{AccuracyRequest, error::PlanError};

/// What planning reads of a stack. Equal traits have equal plans.
#[derive(Clone, Debug, PartialEq)]
pub struct StackTraits {
    /// The enabled effects, in order.
    pub effects: Vec<Arc<Effect>>,
    /// Parameter words of every effect, where the request bakes them into the text.
    pub baked: Vec<Vec<u32>>,
    /// The bit of every effect in the scopes of a draw; empty where no effect has a scope.
    pub scope_bits: Vec<Option<u32>>,
    pub shape: Shape,
    /// Whose order counts where only a number of samples is drawn.
    pub draw_order: Option<draw_order::Mode>,
    /// The lines along which dots are drawn.
    pub dots: Option<LineSource>,
    /// An effect adds particles to the scene.
    pub has_particles: bool,
    /// The xray, with its choices alone: what its other parameters say is zero.
    pub xray: Option<Xray>,
    /// The first effect whose samples depend on floats or on chance, and how.
    pub inexact_effect: Option<InexactEffect>,
}

/// An effect that a strict picture cannot hold.
#[derive(Clone, Debug, PartialEq)]
pub struct InexactEffect {
    pub name: String,
    pub why: &'static str,
}

impl StackTraits {
    pub fn of(stack: &Stack, request: &AccuracyRequest) -> Result<Self, PlanError> {
        stack.check()?;
        let is_baked = request.pins.option() == Some(Parameters::Baked);
        let baked = match is_baked {
            true => kernel_words(&stack.0).map(Cow::into_owned).collect(),
            false => Vec::new(),
        };
        let xray = stack
            .get(&xray::EFFECT.name)
            .map(|enabled| read::<Xray>(&enabled.words));
        Ok(Self {
            effects: stack
                .0
                .iter()
                .map(|enabled| enabled.effect.clone())
                .collect(),
            baked,
            scope_bits: if stack.scopes().is_empty() {
                Vec::new()
            } else {
                stack.scope_bits().collect()
            },
            shape: stack.shape(),
            draw_order: stack
                .draw_order()
                .map(|order| draw_order::Mode::of(order.mode)),
            dots: stack.dots().map(|dots| LineSource::of(dots.lines)),
            has_particles: stack.particle_settings().is_some(),
            xray: xray.map(|xray| Xray {
                window: 0,
                opacity: 0.0,
                ..xray
            }),
            inexact_effect: stack.0.iter().find_map(inexact),
        })
    }

    /// What becomes of the samples of a pixel in a scene of so many triangles; none: the nearest is
    /// shown.
    pub fn layers(&self, triangles: u64) -> Option<Layers> {
        let effect = self
            .effects
            .iter()
            .find(|effect| effect.hooks.slot == Some(Slot::Visibility))?;
        Some(match self.xray {
            Some(xray) => Layers::Xray {
                bits: xray.first_bits(triangles),
            },
            None if effect.hooks.makes_glass => Layers::Glass,
            None if *effect == *overdraw::EFFECT => Layers::Overdraw,
            None => Layers::Race,
        })
    }

    /// Does an x-ray count every layer, whatever lies in front of it?
    pub fn sums_all_layers(&self) -> bool {
        self.xray
            .is_some_and(|xray| Reach::of(xray.layers) == Reach::All)
    }

    /// The first effect that moves vertices.
    pub fn vertex_effect(&self) -> Option<&Arc<Effect>> {
        self.effects
            .iter()
            .find(|effect| effect.hooks.vertex.is_some())
    }

    /// Does an effect move corners by their triangle?
    pub fn moves_triangles(&self) -> bool {
        let mut hooks = self
            .effects
            .iter()
            .filter_map(|effect| effect.hooks.vertex.as_ref());
        hooks.any(|hook| hook.needs_triangle)
    }

    /// Does an effect finish pixels?
    pub fn finishes_pixels(&self) -> bool {
        self.effects
            .iter()
            .any(|effect| effect.hooks.image.is_some())
    }

    /// Does an effect ask how materials reflect?
    pub fn reads_finish(&self) -> bool {
        self.effects
            .iter()
            .any(|effect| effect.hooks.reads_finish())
    }

    /// Does an effect ask where normals point?
    pub fn reads_normals(&self) -> bool {
        self.effects
            .iter()
            .any(|effect| effect.hooks.reads_normals())
    }

    /// Do the lights that come with a scene shine on an effect?
    pub fn is_lit(&self) -> bool {
        self.effects.iter().any(|effect| effect.hooks.lit.is_some())
    }

    /// Does an effect show what surrounds the scene?
    pub fn shows_surroundings(&self) -> bool {
        self.effects
            .iter()
            .any(|effect| effect.hooks.shows_surroundings)
    }

    /// Does an effect ask how much of a light arrives?
    pub fn reads_light(&self) -> bool {
        self.effects.iter().any(|effect| effect.hooks.casts_shadows)
    }

    /// Does an effect read what only the plane of a triangle tells? The taps of a shadow map do.
    pub fn reads_planes(&self) -> bool {
        let reads_planes = |effect: &Arc<Effect>| {
            effect
                .hooks
                .surface_inputs
                .iter()
                .any(|input| input.needs_planes())
        };
        self.reads_light() || self.effects.iter().any(reads_planes)
    }
}

/// How the samples of an effect depend on floats or on chance, if they do.
fn inexact(EnabledEffect { effect, words, .. }: &EnabledEffect) -> Option<InexactEffect> {
    let uses_floats = effect
        .hooks
        .sample
        .as_ref()
        .is_some_and(|hook| hook.has_setup && (hook.is_from_floats)(words));
    let why = match () {
        () if effect.hooks.vertex.is_some() => "moves vertices in floats",
        () if uses_floats => "moves a front in floats",
        () if effect.hooks.has_lines => "places its dots in floats",
        () if !(effect.is_repeatable)(words) => "leaves its picture to chance",
        () => return None,
    };
    Some(InexactEffect {
        name: effect.name.clone(),
        why,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{effects::EFFECTS, params::ValueType};

    /// A slider touches only bytes.
    #[test]
    fn no_slider_changes_the_traits() {
        let request = AccuracyRequest::default();
        for effect in EFFECTS.iter() {
            let stack = Stack(vec![EnabledEffect::new(effect)]);
            let before = StackTraits::of(&stack, &request).expect("one effect has no rival");
            // A scene with particles has other triangles than one without.
            let is_structural = |field: &crate::params::Field| {
                matches!(field.value_type, ValueType::Choice(_) | ValueType::Bool)
                    || (effect.name.as_str(), field.name.as_str()) == ("particles", "count")
            };
            for field in effect.fields.iter().filter(|field| !is_structural(field)) {
                for value in field.hard {
                    let mut moved = stack.clone();
                    let words = &mut moved.0[0].words;
                    let components = field.get(words).len();
                    field
                        .set(words, &vec![value; components])
                        .expect("inside the range");
                    let after = StackTraits::of(&moved, &request).expect("one effect has no rival");
                    assert_eq!(before, after, "{}.{} = {value}", effect.name, field.name);
                }
            }
        }
    }
}
