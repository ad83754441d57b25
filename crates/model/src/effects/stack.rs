//! Stacks: the enabled effects with their values, in the order in which they apply.

use std::sync::Arc;

use super::{
    conflict::Conflict,
    dots, draw_order,
    effect::{Effect, read},
    given::Given,
    glass::GlassDraws,
    hooks::{self, EarlierFrames, Hooks, Layers, Lighting, Picture, Pixel, Shape, Slot, Surface},
    points, shadow, xray,
};
use crate::{
    effects::Words,
    scene::{
        Scene,
        draw::{Draw, DrawError, scoped_draws},
        light::light_view,
        particle_discs::ParticleSettings,
        parts::{MAX_SCOPES, Scope},
        shadow_resolution::ShadowResolution,
        view::View,
    },
};

/// Most passes over the finished picture that the effects of a stack have together.
pub const MAX_IMAGE_PASSES: usize = 32;

/// The effect that remembers previous pictures.
const SMEAR: &str = "smear";

/// An effect with its values.
#[derive(Clone, Debug, PartialEq)]
pub struct EnabledEffect {
    pub effect: Arc<Effect>,
    /// Parameter words, laid out by `effect.fields`.
    pub words: Vec<u32>,
    /// The parts of the scene that it changes.
    pub on: Scope,
}

impl EnabledEffect {
    pub fn new(effect: &Arc<Effect>) -> Self {
        Self {
            effect: effect.clone(),
            words: effect.defaults.clone(),
            on: Scope::default(),
        }
    }

    /// The components of the parameter called `name`, which it must have.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        self.effect
            .field(name)
            .map_or_else(Vec::new, |field| field.get(&self.words))
    }

    /// The same of a parameter with one.
    pub fn number(&self, name: &str) -> f64 {
        self.numbers(name).first().copied().unwrap_or_default()
    }

    /// Gives a parameter that it must have these components, where they are allowed.
    pub fn set(&mut self, name: &str, components: &[f64]) -> &mut Self {
        let set = self
            .effect
            .field(name)
            .map(|field| field.set(&mut self.words, components));
        debug_assert!(matches!(set, Some(Ok(()))), "{name}: {set:?}");
        self
    }

    /// Gives it these values; `P` must be the effect's own.
    pub fn put<P: Words>(&mut self, values: &P) {
        let words = bytemuck::cast_slice(std::slice::from_ref(values));
        self.words[..words.len()].copy_from_slice(words);
    }
}

/// The enabled effects, in the order in which they apply.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stack(pub Vec<EnabledEffect>);

impl Stack {
    pub fn get(&self, name: &str) -> Option<&EnabledEffect> {
        self.0.iter().find(|enabled| enabled.effect.name == name)
    }

    pub fn get_mut(&mut self, name: &str) -> Option<&mut EnabledEffect> {
        self.0
            .iter_mut()
            .find(|enabled| enabled.effect.name == name)
    }

    /// Enables `effect` with its defaults, before the first one that follows it in the canonical
    /// order; keeps one already there.
    pub fn enable(&mut self, effect: &Arc<Effect>) -> &mut EnabledEffect {
        let at = match self.0.iter().position(|enabled| enabled.effect == *effect) {
            Some(at) => at,
            None => {
                let at = self
                    .0
                    .iter()
                    .position(|enabled| enabled.effect.rank() > effect.rank())
                    .unwrap_or(self.0.len());
                self.0.insert(at, EnabledEffect::new(effect));
                at
            }
        };
        &mut self.0[at]
    }

    /// The stack with the words of what its effects are given, where `words` has any.
    #[must_use]
    pub fn with_given(mut self, words: impl Fn(Given) -> Option<Vec<u32>>) -> Self {
        for EnabledEffect {
            effect, words: own, ..
        } in &mut self.0
        {
            for member in &effect.given {
                if let Some(words) = words(member.given) {
                    own[member.offset / 4..][..words.len()].copy_from_slice(&words);
                }
            }
        }
        self
    }

    /// The stack for a picture of `factor` times as many pixels to a side: lengths in pixels scale
    /// with it, within their ranges and in whole pixels where they are whole.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut stack = self.clone();
        for EnabledEffect { effect, words, .. } in stack.0.iter_mut().filter(|_| factor != 1.0) {
            for field in effect.fields.iter().filter(|field| field.unit == "px") {
                let [low, high] = field.hard;
                let length = |v: f64| (v * factor).clamp(low, high);
                let components: Vec<f64> = field
                    .get(words)
                    .into_iter()
                    .map(|v| {
                        if !field.value_type.is_continuous() {
                            length(v).round()
                        } else {
                            length(v)
                        }
                    })
                    .collect();
                field.set(words, &components).expect("within its range");
            }
            for member in effect.given.iter().filter(|m| m.given == Given::Pointer) {
                for word in &mut words[member.offset / 4..][..2] {
                    *word = (f32::from_bits(*word) * factor as f32).to_bits();
                }
            }
        }
        stack
    }

    /// Moves the effect at index `from` in front of the one that is at index `to` now; an index of
    /// the length of the stack is its end. Indices beyond that change nothing.
    pub fn move_effect(&mut self, from: usize, to: usize) {
        if from < self.0.len() && to <= self.0.len() {
            let moved = self.0.remove(from);
            self.0.insert(if to > from { to - 1 } else { to }, moved);
        }
    }

    pub fn disable(&mut self, name: &str) {
        self.0.retain(|enabled| enabled.effect.name != name);
    }

    /// Are the effects in the canonical order? Several effects of files, or instances of one
    /// effect, have none.
    pub fn is_canonical(&self) -> bool {
        self.0
            .is_sorted_by(|a, b| a.effect.rank() < b.effect.rank())
    }

    /// Is an effect given this?
    pub fn is_given(&self, given: Given) -> bool {
        let mut members = self.0.iter().flat_map(|enabled| &enabled.effect.given);
        members.any(|member| member.given == given)
    }

    /// The scopes of the effects that have one, in order.
    pub fn scopes(&self) -> Vec<Scope> {
        self.0
            .iter()
            .filter(|enabled| !enabled.on.is_whole_scene())
            .map(|enabled| enabled.on.clone())
            .collect()
    }

    /// The bit of every effect in [`Draw::scopes`]; none for an effect on the whole scene.
    pub fn scope_bits(&self) -> impl Iterator<Item = Option<u32>> {
        let mut next = 0;
        self.0.iter().map(move |enabled| {
            let bit = (!enabled.on.is_whole_scene()).then_some(next);
            next += u32::from(bit.is_some());
            bit
        })
    }

    /// The draws of `scene` as `view` sees it, with the scopes of this stack.
    pub fn draws(&self, scene: &Scene, view: &View) -> Result<Vec<Draw>, DrawError> {
        let mut draws = scoped_draws(scene, view, &self.scopes())?;
        let glass = self.glass();
        for draw in &mut draws {
            draw.is_glass = glass.has(draw.is_glass, draw.scopes);
        }
        Ok(draws)
    }

    /// Which draws are glass. What other effects in the visibility slot and a draw order show is
    /// shown of every draw alike.
    pub fn glass(&self) -> GlassDraws {
        let is_glass = |enabled: &EnabledEffect| enabled.effect.hooks.makes_glass;
        if self.in_slot(Slot::Order).is_some() {
            return GlassDraws::Nothing;
        }
        match self.in_slot(Slot::Visibility) {
            None => GlassDraws::Blended,
            Some(enabled) if !is_glass(enabled) => GlassDraws::Nothing,
            Some(_) => self
                .0
                .iter()
                .zip(self.scope_bits())
                .find(|(enabled, _)| is_glass(enabled))
                .and_then(|(_, bit)| bit)
                .map_or(GlassDraws::Everything, GlassDraws::Scope),
        }
    }

    /// Applies every surface effect in order, as far as they act on a draw with these `scopes`
    /// ([`Draw::scopes`]), in the `light` that comes with the scene.
    pub fn shade(&self, mut surface: Surface, scopes: u32, light: &Lighting<'_>) -> Surface {
        self.shade_all(std::slice::from_mut(&mut surface), scopes, light);
        surface
    }

    /// The same for surfaces of draws with the same `scopes`, in place.
    pub fn shade_all(&self, surfaces: &mut [Surface], scopes: u32, light: &Lighting<'_>) {
        let each = self.each_on(scopes, |hooks| Some((hooks.surface.as_ref()?, &hooks.lit)));
        for ((apply, lit), words) in each {
            match lit {
                Some(lit) if !light.is_none() => lit(surfaces, light, words),
                _ => apply(surfaces, words),
            }
        }
    }

    /// Moves a vertex of a draw with these `scopes` by every vertex effect in order.
    pub fn moved(&self, mut vertex: hooks::Vertex, scopes: u32) -> hooks::Vertex {
        self.move_all(std::slice::from_mut(&mut vertex), scopes);
        vertex
    }

    /// The same for vertices of draws with the same `scopes`, in place.
    pub fn move_all(&self, vertices: &mut [hooks::Vertex], scopes: u32) {
        for (hook, words) in self.each_on(scopes, |hooks| hooks.vertex.as_ref()) {
            (hook.moved)(vertices, words);
        }
    }

    /// How far the f32 side of [`Stack::moved`] may err, given the error bound of what it starts
    /// from.
    pub fn error_bound(
        &self,
        mut vertex: hooks::Vertex,
        mut error_bound: hooks::ErrorBound,
        scopes: u32,
    ) -> hooks::ErrorBound {
        for (hook, words) in self.each_on(scopes, |hooks| hooks.vertex.as_ref()) {
            error_bound = (hook.error_bound)(&vertex, error_bound, words);
            (hook.moved)(std::slice::from_mut(&mut vertex), words);
        }
        error_bound
    }

    /// How far a vertex of a model of this radius may move.
    pub fn max_displacement_m(&self, radius_m: f64) -> f64 {
        self.each(|hooks| hooks.vertex.as_ref())
            .fold(0.0, |reach, (hook, words)| {
                reach + (hook.max_displacement_m)(radius_m + reach, words)
            })
    }

    /// Finishes a pixel by every image effect in order.
    pub fn finish(&self, mut pixel: Pixel, picture: &Picture) -> Pixel {
        self.finish_all(std::slice::from_mut(&mut pixel), picture);
        pixel
    }

    /// The same for pixels, in place.
    pub fn finish_all(&self, pixels: &mut [Pixel], picture: &Picture) {
        for (hook, words) in self.each(|hooks| hooks.image.as_ref()) {
            (hook.finish)(pixels, picture, words);
        }
    }

    /// Does an effect finish pixels?
    pub fn finishes(&self) -> bool {
        self.each(|hooks| hooks.image.as_ref()).next().is_some()
    }

    /// Does an effect have passes over the finished picture?
    pub fn has_passes(&self) -> bool {
        self.each(|hooks| hooks.passes.as_ref()).next().is_some()
    }

    /// Does an effect read the previous picture?
    pub fn reads_previous(&self) -> bool {
        self.each(|hooks| hooks.image.as_ref())
            .any(|(hook, _)| hook.reads_previous)
    }

    /// The effect with a pass whose result lives to the next frame.
    pub fn kept(&self) -> Option<&Arc<Effect>> {
        let keeps = |effect: &&Arc<Effect>| effect.keeps_pass();
        self.0.iter().map(|enabled| &enabled.effect).find(keeps)
    }

    /// The earlier frames that a picture follows, if an effect remembers them.
    pub fn earlier_frames(&self) -> Option<EarlierFrames> {
        let smeared = self.get(SMEAR).map(|smear| EarlierFrames {
            frames: smear.number("frames") as u32,
            step_s: smear.number("step_s"),
        });
        smeared.or_else(|| Some(self.kept()?.hooks.passes.as_ref()?.kept()?.1))
    }

    /// Does an effect's color have steps?
    pub fn has_steps(&self) -> bool {
        self.0.iter().any(|enabled| enabled.effect.hooks.has_steps)
    }

    /// Effects with a certain hook, in order: the hook and the parameter words.
    pub fn each<'a, H: 'a>(
        &'a self,
        hook: impl Fn(&'a Hooks) -> Option<H>,
    ) -> impl Iterator<Item = (H, &'a [u32])> {
        self.0.iter().filter_map(move |enabled| {
            Some((hook(&enabled.effect.hooks)?, enabled.words.as_slice()))
        })
    }

    /// Effects with a certain hook that act on a draw with these `scopes`, in order: the hook and
    /// the parameter words.
    fn each_on<'a, H: 'a>(
        &'a self,
        scopes: u32,
        hook: impl Fn(&'a Hooks) -> Option<H>,
    ) -> impl Iterator<Item = (H, &'a [u32])> {
        let acts = move |bit: Option<u32>| bit.is_none_or(|bit| scopes >> bit & 1 == 1);
        let active = self
            .0
            .iter()
            .zip(self.scope_bits())
            .filter(move |(_, bit)| acts(*bit));
        active.filter_map(move |(enabled, _)| {
            Some((hook(&enabled.effect.hooks)?, enabled.words.as_slice()))
        })
    }

    /// Does an effect move vertices?
    pub fn moves(&self) -> bool {
        self.each(|hooks| hooks.vertex.as_ref()).next().is_some()
    }

    /// Does an effect move corners by their triangle, so that triangles share none?
    pub fn unshares_vertices(&self) -> bool {
        self.each(|hooks| hooks.vertex.as_ref())
            .any(|(hook, _)| hook.needs_triangle)
    }

    /// The particles that an effect adds to the scene.
    pub fn particle_settings(&self) -> Option<ParticleSettings> {
        self.each(|hooks| hooks.particle_settings)
            .map(|(particle_settings, words)| particle_settings(words))
            .find(|particle_settings| particle_settings.count > 0)
    }

    /// The effect in a slot of the rasterizer.
    pub fn in_slot(&self, slot: Slot) -> Option<&EnabledEffect> {
        self.0
            .iter()
            .find(|enabled| enabled.effect.hooks.slot == Some(slot))
    }

    /// What triangles cover in this stack.
    pub fn shape(&self) -> Shape {
        match self.in_slot(Slot::Coverage) {
            None => Shape::Triangles,
            Some(enabled) if enabled.effect == *points::EFFECT => Shape::Points,
            Some(_) => Shape::Boxes,
        }
    }

    /// The light that casts shadows.
    pub fn light(&self) -> Option<shadow::Shadow> {
        self.params(&shadow::EFFECT.name)
    }

    /// Does an effect read how materials reflect?
    pub fn reads_finish(&self) -> bool {
        let reads = |enabled: &EnabledEffect| enabled.effect.hooks.reads_finish();
        self.0.iter().any(reads)
    }

    /// Does an effect read where normals point?
    pub fn reads_normals(&self) -> bool {
        self.0
            .iter()
            .any(|enabled| enabled.effect.hooks.reads_normals())
    }

    /// The view of that light, for its shadow map of `scene` in `view`.
    pub fn light_view(&self, scene: &Scene, view: &View) -> Option<View> {
        Some(light_view(
            self.light()?.toward(),
            scene,
            view,
            self.max_displacement_m(scene.bounds_of(scene.shadow_casters()).radius()),
        ))
    }

    /// The view of the light whose shadow map a picture of `scene` needs; none if no effect needs
    /// one, or if shadows are traced.
    pub fn shadow_map_view(&self, scene: &Scene, view: &View) -> Option<View> {
        if view.precision.shadow == ShadowResolution::TRACED {
            None
        } else {
            self.light_view(scene, view)
        }
    }

    /// The effects that decide which samples stop a light, and where they are. Light passes through
    /// glass.
    pub fn shadow_casters(&self) -> Self {
        let casts = |enabled: &&EnabledEffect| {
            let hooks = &enabled.effect.hooks;
            hooks.vertex.is_some() || hooks.sample.is_some() || hooks.makes_glass
        };
        Self(self.0.iter().filter(casts).cloned().collect())
    }

    /// Radius of discs about corners, units of 1/256 px; 0 without them.
    pub fn point_radius(&self) -> u32 {
        self.get(&points::EFFECT.name)
            .map_or(0, |enabled| read::<points::Points>(&enabled.words).radius())
    }

    /// The draw order of the stack, if it has one.
    pub fn draw_order(&self) -> Option<draw_order::DrawOrder> {
        self.in_slot(Slot::Order)
            .map(|enabled| read(&enabled.words))
    }

    /// Is every picture of this stack the same, to the bit, on one adapter?
    pub fn is_repeatable(&self) -> bool {
        self.0
            .iter()
            .all(|enabled| (enabled.effect.is_repeatable)(&enabled.words))
    }

    /// Parameters of the effect called `name`, if it is on; `P` must be its own.
    pub fn params<P: Words>(&self, name: &str) -> Option<P> {
        self.get(name).map(|enabled| read(&enabled.words))
    }

    /// The dots that are drawn along lines, if any are.
    pub fn dots(&self) -> Option<dots::Dots> {
        self.params(&dots::EFFECT.name)
    }

    /// What becomes of the samples of a pixel in a scene of so many triangles; none: the nearest is
    /// shown.
    pub fn layers(&self, triangles: u64) -> Option<Layers> {
        let EnabledEffect { effect, words, .. } = self.in_slot(Slot::Visibility)?;
        Some(match effect.name.as_str() {
            "xray" => Layers::Xray {
                bits: read::<xray::Xray>(words).first_bits(triangles),
            },
            "overdraw" => Layers::Overdraw,
            "glass" => Layers::Glass,
            _ => Layers::Race,
        })
    }

    /// Is the race on, in which the triangles of a pixel lose samples?
    pub fn is_racing(&self) -> bool {
        self.get("race").is_some()
    }

    /// Limits an effect to parts of the scene; enables it if it is off.
    /// Errors: too many effects have a scope; then nothing is changed.
    pub fn limit(&mut self, effect: &Arc<Effect>, on: Scope) -> Result<(), Conflict> {
        let mut limited = self.clone();
        limited.enable(effect).on = on;
        limited.check()?;
        *self = limited;
        Ok(())
    }

    /// The effect that enabling `effect` would conflict with: another one in its slot, or a draw
    /// order beside glass.
    pub fn rival_of(&self, effect: &Effect) -> Option<&Arc<Effect>> {
        let slot = effect.hooks.slot?;
        let other = |slot: Slot| self.in_slot(slot).map(|enabled| &enabled.effect);
        let beside_glass = match slot {
            Slot::Order => other(Slot::Visibility).filter(|first| first.hooks.makes_glass),
            _ if effect.hooks.makes_glass => other(Slot::Order),
            _ => None,
        };
        other(slot)
            .filter(|first| ***first != *effect)
            .or(beside_glass)
    }

    /// The conflict that enabling `effect` would cause.
    pub fn conflict_with(&self, effect: &Effect) -> Option<Conflict> {
        let slot = effect.hooks.slot?;
        let first = self.rival_of(effect)?;
        let [glass, order] = match first.hooks.slot {
            Some(Slot::Order) => [effect, first],
            _ => [first, effect],
        };
        if first.hooks.slot != Some(slot) {
            return Some(Conflict::GlassInOrder {
                order: order.name.clone(),
                glass: glass.name.clone(),
            });
        }
        Some(Conflict::Slot {
            slot: slot.name(),
            first: first.name.clone(),
            second: effect.name.clone(),
        })
    }

    /// Checks that no two effects take one slot or follow earlier frames, that at most
    /// [`MAX_SCOPES`] effects have a scope, and that there are at most [`MAX_IMAGE_PASSES`].
    /// Errors: names the effects.
    pub fn check(&self) -> Result<(), Conflict> {
        let scoped: Vec<&EnabledEffect> = self
            .0
            .iter()
            .filter(|enabled| !enabled.on.is_whole_scene())
            .collect();
        if let Some(last) = scoped.get(MAX_SCOPES) {
            return Err(Conflict::Scopes {
                count: scoped.len(),
                last: last.effect.name.clone(),
            });
        }
        let mut passes = 0;
        for EnabledEffect { effect, .. } in &self.0 {
            passes += effect
                .hooks
                .passes
                .as_ref()
                .map_or(0, |hook| hook.passes.len());
            if passes > MAX_IMAGE_PASSES {
                return Err(Conflict::Passes {
                    last: effect.name.clone(),
                });
            }
        }
        let mut remembering = self
            .0
            .iter()
            .map(|enabled| &enabled.effect)
            .filter(|effect| effect.keeps_pass() || effect.name == SMEAR);
        if let (Some(first), Some(second)) = (remembering.next(), remembering.next()) {
            return Err(Conflict::EarlierFrames {
                first: first.name.clone(),
                second: second.name.clone(),
            });
        }
        if let (Some(glass), Some(order)) = (
            self.0
                .iter()
                .find(|enabled| enabled.effect.hooks.makes_glass),
            self.in_slot(Slot::Order),
        ) {
            return Err(Conflict::GlassInOrder {
                order: order.effect.name.clone(),
                glass: glass.effect.name.clone(),
            });
        }
        for slot in Slot::ALL {
            let mut takers = self
                .0
                .iter()
                .map(|enabled| &enabled.effect)
                .filter(|effect| effect.hooks.slot == Some(slot));
            if let (Some(first), Some(second)) = (takers.next(), takers.next()) {
                return Err(Conflict::Slot {
                    slot: slot.name(),
                    first: first.name.clone(),
                    second: second.name.clone(),
                });
            }
        }
        Ok(())
    }
}
