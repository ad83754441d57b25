//! Effects: pure functions with parameters, written twice. Here in f64, the reference; in `shaders/effects/` in f32,
//! in a file of the same name. Panel, preset keys, `--set`, uniform bytes, layout test, golden and bench row are
//! loops over [`EFFECTS`].

use crate::{
    params::{Field, Params},
    scene::{Scene, light::light_view, particle_discs::ParticleSettings, view::View},
};

pub mod hooks;

use hooks::{Hooks, ImageEffect, ImageHook, Layers, Picture, Pixel, SampleEffect, SampleHook, Shape, Slot, VertexEffect, VertexHook};
pub use hooks::{Surface, SurfaceEffect, SurfaceInput};

/// THE list. Adding an effect is its two files and one word here.
macro_rules! effects {
    ($($name:ident),* $(,)?) => {
        $(pub mod $name;)*
        /// Every effect, in the order in which a preset without a `stack` key applies them.
        pub const EFFECTS: &[&Effect] = &[$(&$name::EFFECT),*];
    };
}

effects![
    boxes,
    points,
    draw_order,
    particles,
    explode,
    inflate,
    wobble,
    dissolve,
    stipple,
    facet,
    triangle_id,
    normals,
    depth,
    lambert,
    shadow,
    toon,
    hatch,
    wireframe,
    fog,
    xray,
    overdraw,
    race,
    dots,
    posterize,
    smear,
    outline,
    dither
];

/// One entry of the catalogue.
pub struct Effect {
    /// File stem, WGSL function, uniform member, preset table, `--set` prefix.
    pub name: &'static str,
    /// One line for listings and tooltips.
    pub about: &'static str,
    pub hooks: Hooks,
    pub fields: &'static [Field],
    /// Parameter words with every default.
    pub defaults: fn() -> Vec<u32>,
    /// Name of the WGSL struct.
    pub wgsl_struct: &'static str,
    /// Does every frame come out the same with these parameter words?
    pub is_repeatable: fn(&[u32]) -> bool,
}

impl Effect {
    /// An effect with parameters `P` and no hook yet.
    pub const fn new<P: Params>(name: &'static str, wgsl_struct: &'static str, about: &'static str) -> Self {
        Self { name, about, hooks: Hooks::NONE, fields: P::FIELDS, defaults: defaults::<P>, wgsl_struct, is_repeatable: |_| true }
    }

    /// An effect on the surface hook alone.
    pub const fn surface<P: SurfaceEffect>(name: &'static str, wgsl_struct: &'static str, about: &'static str) -> Self {
        Self::new::<P>(name, wgsl_struct, about).on_surface::<P>()
    }

    /// The same effect, also on the surface hook.
    pub const fn on_surface<P: SurfaceEffect>(mut self) -> Self {
        self.hooks.surface = Some(|surface, words| P::apply(surface, &read(words)));
        self.hooks.surface_inputs = P::INPUTS;
        self
    }

    /// The same effect, also on the vertex hook.
    pub const fn on_vertex<P: VertexEffect>(mut self) -> Self {
        self.hooks.vertex = Some(VertexHook {
            needs_triangle: P::NEEDS_TRIANGLE,
            moved: |vertex, words| P::moved(vertex, &read(words)),
            error_bound: |vertex, error_bound, words| P::error_bound(vertex, error_bound, &read(words)),
            max_displacement_m: |radius_m, words| P::max_displacement_m(radius_m, &read(words)),
        });
        self
    }

    /// The same effect, also on the sample hook.
    pub const fn on_sample<P: SampleEffect>(mut self) -> Self {
        self.hooks.sample = Some(SampleHook {
            has_setup: P::HAS_SETUP,
            error_bound: |setup, words| P::error_bound(setup, &read(words)),
            is_from_floats: |words| P::is_from_floats(&read(words)),
            decide: |setup, words, first| P::decide(setup, &read(words), first),
            is_drawn: |sample, words| P::is_drawn(sample, &read(words)),
        });
        self
    }

    /// The same effect, also on the image hook.
    pub const fn on_image<P: ImageEffect>(mut self) -> Self {
        self.hooks.image =
            Some(ImageHook { reads_previous: P::READS_PREVIOUS, finish: |pixel, picture, words| P::finish(pixel, picture, &read(words)) });
        self
    }

    /// The same effect, with steps in its colour: a judge then accepts either side of a step that is very near.
    pub const fn in_steps(mut self) -> Self {
        self.hooks.has_steps = true;
        self
    }

    /// The same effect, which reads members of the surface in passes of its slot.
    pub const fn reading(mut self, inputs: &'static [SurfaceInput]) -> Self {
        self.hooks.surface_inputs = inputs;
        self
    }

    /// The same effect, also in a slot of the rasterizer.
    pub const fn in_slot(mut self, slot: Slot) -> Self {
        self.hooks.slot = Some(slot);
        self
    }

    /// The same effect, which draws along lines.
    pub const fn with_lines(mut self) -> Self {
        self.hooks.has_lines = true;
        self
    }

    /// The same effect, which puts a cloud beside the scene.
    pub const fn with_particles(mut self, particle_settings: fn(&[u32]) -> ParticleSettings) -> Self {
        self.hooks.particle_settings = Some(particle_settings);
        self
    }

    /// The same effect, which leaves something to the hardware's own order unless `is_repeatable` says otherwise.
    pub const fn repeatable_if(mut self, is_repeatable: fn(&[u32]) -> bool) -> Self {
        self.is_repeatable = is_repeatable;
        self
    }

    /// The effect called `name`.
    pub fn find(name: &str) -> Option<&'static Self> {
        EFFECTS.iter().copied().find(|effect| effect.name == name)
    }

    /// The field called `name`.
    pub fn field(&self, name: &str) -> Option<&'static Field> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// Place in [`EFFECTS`].
    pub fn rank(&self) -> usize {
        EFFECTS.iter().position(|effect| effect.name == self.name).expect("every effect is listed")
    }
}

impl std::fmt::Debug for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

impl PartialEq for Effect {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Effect {}

impl std::hash::Hash for Effect {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.name.hash(state);
    }
}

/// Parameter words as the struct they were made from.
pub fn read<P: Params>(words: &[u32]) -> P {
    bytemuck::pod_read_unaligned(bytemuck::cast_slice(words))
}

fn defaults<P: Params>() -> Vec<u32> {
    bytemuck::pod_collect_to_vec(&[P::default()])
}

/// An effect with its values.
#[derive(Clone, Debug, PartialEq)]
pub struct EnabledEffect {
    pub effect: &'static Effect,
    /// Parameter words, laid out by `effect.fields`.
    pub words: Vec<u32>,
}

impl EnabledEffect {
    pub fn new(effect: &'static Effect) -> Self {
        Self { effect, words: (effect.defaults)() }
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
        self.0.iter_mut().find(|enabled| enabled.effect.name == name)
    }

    /// Puts `effect` in with defaults, in front of the first one that follows it in [`EFFECTS`]; keeps one already there.
    pub fn enable(&mut self, effect: &'static Effect) -> &mut EnabledEffect {
        let at = match self.0.iter().position(|enabled| enabled.effect == effect) {
            Some(at) => at,
            None => {
                let at = self.0.iter().position(|enabled| enabled.effect.rank() > effect.rank()).unwrap_or(self.0.len());
                self.0.insert(at, EnabledEffect::new(effect));
                at
            }
        };
        &mut self.0[at]
    }

    /// The stack for a picture of `factor` times as many pixels to a side: lengths in pixels keep their share of it, as far as
    /// their ranges and whole pixels go.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut stack = self.clone();
        for EnabledEffect { effect, words } in stack.0.iter_mut().filter(|_| factor != 1.0) {
            for field in effect.fields.iter().filter(|field| field.unit == "px") {
                let [low, high] = field.hard;
                let length = |v: f64| (v * factor).clamp(low, high);
                let lanes: Vec<f64> = field
                    .get(words)
                    .into_iter()
                    .map(|v| if !field.value_type.is_continuous() { length(v).round() } else { length(v) })
                    .collect();
                field.set(words, &lanes).expect("within its range");
            }
        }
        stack
    }

    pub fn disable(&mut self, name: &str) {
        self.0.retain(|enabled| enabled.effect.name != name);
    }

    /// Do the effects stand in the order of [`EFFECTS`]?
    pub fn is_canonical(&self) -> bool {
        self.0.is_sorted_by_key(|enabled| enabled.effect.rank())
    }

    /// Applies every surface effect in order.
    pub fn shade(&self, surface: Surface) -> Surface {
        self.each(|hooks| hooks.surface).fold(surface, |surface, (apply, words)| apply(surface, words))
    }

    /// Moves a vertex by every vertex effect in order.
    pub fn moved(&self, vertex: hooks::Vertex) -> hooks::Vertex {
        self.each(|hooks| hooks.vertex).fold(vertex, |vertex, (hook, words)| (hook.moved)(vertex, words))
    }

    /// How far an f32 twin of [`Stack::moved`] may err, given the slack of what it starts from.
    pub fn error_bound(&self, vertex: hooks::Vertex, error_bound: hooks::ErrorBound) -> hooks::ErrorBound {
        let each = self.each(|hooks| hooks.vertex);
        each.fold((vertex, error_bound), |(vertex, error_bound), (hook, words)| {
            ((hook.moved)(vertex, words), (hook.error_bound)(&vertex, error_bound, words))
        })
        .1
    }

    /// How far a vertex of a model of this radius may move.
    pub fn max_displacement_m(&self, radius_m: f64) -> f64 {
        self.each(|hooks| hooks.vertex).fold(0.0, |reach, (hook, words)| reach + (hook.max_displacement_m)(radius_m + reach, words))
    }

    /// Finishes a pixel by every image effect in order.
    pub fn finish(&self, pixel: Pixel, picture: &Picture) -> Pixel {
        self.each(|hooks| hooks.image).fold(pixel, |pixel, (hook, words)| (hook.finish)(pixel, picture, words))
    }

    /// Does an effect finish pixels?
    pub fn finishes(&self) -> bool {
        self.each(|hooks| hooks.image).next().is_some()
    }

    /// Does an effect read the picture before this one?
    pub fn reads_previous(&self) -> bool {
        self.each(|hooks| hooks.image).any(|(hook, _)| hook.reads_previous)
    }

    /// Does an effect's colour have steps?
    pub fn has_steps(&self) -> bool {
        self.0.iter().any(|enabled| enabled.effect.hooks.has_steps)
    }

    /// Effects with a certain hook, in order: the hook and the parameter words.
    pub fn each<H>(&self, hook: impl Fn(&Hooks) -> Option<H>) -> impl Iterator<Item = (H, &[u32])> {
        self.0.iter().filter_map(move |enabled| Some((hook(&enabled.effect.hooks)?, enabled.words.as_slice())))
    }

    /// Does an effect move vertices?
    pub fn moves(&self) -> bool {
        self.each(|hooks| hooks.vertex).next().is_some()
    }

    /// Does an effect move corners by their triangle, so that triangles share none?
    pub fn unshares_vertices(&self) -> bool {
        self.each(|hooks| hooks.vertex).any(|(hook, _)| hook.needs_triangle)
    }

    /// The cloud that an effect puts beside the scene.
    pub fn particle_settings(&self) -> Option<ParticleSettings> {
        self.each(|hooks| hooks.particle_settings)
            .map(|(particle_settings, words)| particle_settings(words))
            .find(|particle_settings| particle_settings.count > 0)
    }

    /// The effect in a slot of the rasterizer.
    pub fn in_slot(&self, slot: Slot) -> Option<&EnabledEffect> {
        self.0.iter().find(|enabled| enabled.effect.hooks.slot == Some(slot))
    }

    /// What triangles cover in this stack.
    pub fn shape(&self) -> Shape {
        match self.in_slot(Slot::Coverage) {
            None => Shape::Triangles,
            Some(enabled) if enabled.effect == &points::EFFECT => Shape::Points,
            Some(_) => Shape::Boxes,
        }
    }

    /// The light that casts shadows.
    pub fn light(&self) -> Option<shadow::Shadow> {
        self.params(shadow::EFFECT.name)
    }

    /// What that light sees of `scene` as `view` shows it.
    pub fn light_view(&self, scene: &Scene, view: &View) -> Option<View> {
        Some(light_view(self.light()?.toward(), scene, view, self.max_displacement_m(scene.bounds_of(scene.shadow_casters()).radius())))
    }

    /// What of the stack decides which samples stop a light, and where they are.
    pub fn casting(&self) -> Self {
        let casts = |enabled: &&EnabledEffect| enabled.effect.hooks.vertex.is_some() || enabled.effect.hooks.sample.is_some();
        Self(self.0.iter().filter(casts).cloned().collect())
    }

    /// Radius of discs about corners, units of 1/256 px; 0 without them.
    pub fn point_radius(&self) -> u32 {
        self.get(points::EFFECT.name).map_or(0, |enabled| read::<points::Points>(&enabled.words).radius())
    }

    /// The draw order that the stack keeps.
    pub fn draw_order(&self) -> Option<draw_order::DrawOrder> {
        self.in_slot(Slot::Order).map(|enabled| read(&enabled.words))
    }

    /// Is every picture of this stack the same, to the bit, on one adapter?
    pub fn is_repeatable(&self) -> bool {
        self.0.iter().all(|enabled| (enabled.effect.is_repeatable)(&enabled.words))
    }

    /// Parameters of the effect called `name`, if it is on; `P` must be its own.
    pub fn params<P: Params>(&self, name: &str) -> Option<P> {
        self.get(name).map(|enabled| read(&enabled.words))
    }

    /// The dots that are strung on lines, if any are.
    pub fn dots(&self) -> Option<dots::Dots> {
        self.params(dots::EFFECT.name)
    }

    /// What becomes of the samples of a pixel in a scene of so many triangles; none: the nearest is shown.
    pub fn layers(&self, triangles: u64) -> Option<Layers> {
        let EnabledEffect { effect, words } = self.in_slot(Slot::Visibility)?;
        Some(match effect.name {
            "xray" => Layers::Xray { bits: read::<xray::Xray>(words).first_bits(triangles) },
            "overdraw" => Layers::Overdraw,
            _ => Layers::Race,
        })
    }

    /// Do the triangles of a pixel race for it?
    pub fn is_racing(&self) -> bool {
        self.get(race::EFFECT.name).is_some()
    }

    /// What stands against switching `effect` on: another one in its slot.
    pub fn rival(&self, effect: &Effect) -> Option<Conflict> {
        let slot = effect.hooks.slot?;
        let first = self.in_slot(slot).map(|enabled| enabled.effect).filter(|first| *first != effect)?;
        Some(Conflict { slot: slot.name(), first: first.name, second: effect.name })
    }

    /// Checks that no two effects take one slot.
    ///
    /// # Errors
    /// Names the first two that do.
    pub fn check(&self) -> Result<(), Conflict> {
        for slot in Slot::ALL {
            let mut takers = self.0.iter().map(|enabled| enabled.effect).filter(|effect| effect.hooks.slot == Some(slot));
            if let (Some(first), Some(second)) = (takers.next(), takers.next()) {
                return Err(Conflict { slot: slot.name(), first: first.name, second: second.name });
            }
        }
        Ok(())
    }
}

/// Two effects that take one slot of the rasterizer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{first} and {second} both take the {slot} slot of the rasterizer; switch one of them off")]
pub struct Conflict {
    pub slot: &'static str,
    pub first: &'static str,
    pub second: &'static str,
}
