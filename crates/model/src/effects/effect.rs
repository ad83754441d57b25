//! One effect: its names, parameters and hooks, built from its functions.

use std::{
    borrow::Cow,
    sync::{Arc, LazyLock},
};

use base64::{Engine as _, engine::general_purpose::STANDARD};

use super::{
    given::GivenMember,
    hooks::{Hooks, SampleEffect, SampleHook, Slot, SurfaceInput},
    image_file::ImageInput,
    text::built_in,
};
use crate::{
    effects::Words,
    params::{Field, Param, ValueType, WgslType},
    scene::particle_discs::ParticleSettings,
};

/// One entry of the list of effects. Everything that names an effect shares it, so that the effect
/// of a file lives as long as it is used.
#[derive(Clone)]
pub struct Effect {
    /// File stem, WGSL function, uniform member, preset table, `--set` prefix.
    pub name: String,
    /// One line for listings and tooltips.
    pub about: String,
    pub hooks: Hooks,
    pub fields: Vec<Arc<Field>>,
    /// What it is given beside its parameters.
    pub given: Vec<GivenMember>,
    /// Parameter words with every default.
    pub defaults: Vec<u32>,
    /// Name of the WGSL struct.
    pub wgsl_struct: String,
    /// The WGSL text of an effect that a file brings; none for a built-in effect, whose text is in
    /// `shaders/effects`.
    pub source: Option<Arc<EffectSource>>,
    /// The effect that this is another instance of, under a name of its own.
    pub base: Option<Arc<Effect>>,
    /// Is every frame the same with these parameter words?
    pub is_repeatable: fn(&[u32]) -> bool,
}

/// An effect of the list, made when it is first used.
pub type BuiltIn = LazyLock<Arc<Effect>>;

impl Effect {
    /// The effect whose parameter words `P` holds, as its file declares it: with the hooks that its
    /// functions are on.
    pub fn declared<P: Words>() -> Self {
        let effect = built_in(P::EFFECT).unwrap_or_else(|error| panic!("{error}"));
        // Members that are structs are no fields.
        for (name, offset) in P::MEMBERS {
            let field = effect.field(name);
            let is_there = field.is_none_or(|field| field.offset == *offset);
            assert!(is_there, "{}.{name} lies elsewhere in its file", P::EFFECT);
        }
        assert!(size_of::<P>() <= 4 * effect.defaults.len(), "{}", P::EFFECT);
        effect
    }

    /// The same effect, also on the sample hook.
    pub fn on_sample<P: SampleEffect>(mut self) -> Self {
        self.hooks.sample = Some(SampleHook {
            has_setup: P::HAS_SETUP,
            error_bound: Arc::new(|setup, words| P::error_bound(setup, &read(words))),
            is_from_floats: Arc::new(|words| P::is_from_floats(&read(words))),
            sample_setup: Arc::new(|setup, words, first| {
                P::sample_setup(setup, &read(words), first)
            }),
            is_drawn: Arc::new(|samples, words, drawn| {
                let params = read(words);
                for (sample, drawn) in samples.iter().zip(drawn) {
                    *drawn &= P::is_drawn(sample, &params);
                }
            }),
        });
        self
    }

    /// The same effect, which is a light that casts shadows.
    pub fn with_shadows(mut self) -> Self {
        self.hooks.casts_shadows = true;
        self
    }

    /// The same effect, which reads members of the surface in passes of its slot.
    pub fn reading(mut self, inputs: &[SurfaceInput]) -> Self {
        self.hooks.surface_inputs = inputs.to_vec();
        self
    }

    /// The same effect, also in a slot of the rasterizer.
    pub fn in_slot(mut self, slot: Slot) -> Self {
        self.hooks.slot = Some(slot);
        self
    }

    /// The same effect, which turns the parts on which it acts into glass.
    pub fn with_glass(mut self) -> Self {
        self.hooks.makes_glass = true;
        self.in_slot(Slot::Visibility)
    }

    /// The same effect, which draws along lines.
    pub fn with_lines(mut self) -> Self {
        self.hooks.has_lines = true;
        self
    }

    /// The same effect, which adds particles to the scene.
    pub fn with_particles(mut self, particle_settings: fn(&[u32]) -> ParticleSettings) -> Self {
        self.hooks.particle_settings = Some(particle_settings);
        self
    }

    /// The same effect, whose pictures depend on the order of the hardware unless `is_repeatable`
    /// holds.
    pub fn repeatable_if(mut self, is_repeatable: fn(&[u32]) -> bool) -> Self {
        self.is_repeatable = is_repeatable;
        self
    }

    /// Another instance of `base`, so that it can stand in a stack more than once.
    pub fn instance(name: &str, base: &Arc<Self>) -> Self {
        Self {
            name: name.into(),
            base: Some(base.clone()),
            ..Self::clone(base)
        }
    }

    /// Can it stand in a stack more than once? Effects that the frame has one place for cannot.
    pub fn has_instances(&self) -> bool {
        let hooks = &self.hooks;
        let is_alone = hooks.slot.is_some()
            || hooks.has_lines
            || hooks.particle_settings.is_some()
            || hooks.casts_shadows
            || self.keeps_pass();
        !is_alone && !hooks.image.as_ref().is_some_and(|hook| hook.reads_previous)
    }

    /// Does what one of its passes writes live to the next frame?
    pub fn keeps_pass(&self) -> bool {
        let passes = self.hooks.passes.as_ref();
        passes.is_some_and(|hook| hook.kept().is_some())
    }

    /// Does it move with the clock?
    pub fn is_given_time(&self) -> bool {
        self.given.iter().any(|member| member.given.is_of_clock())
    }

    /// Is it the effect of a file, or an instance of one?
    pub const fn is_of_file(&self) -> bool {
        self.source.is_some()
    }

    /// Can it be limited to parts of a scene? Pixels, lines, slots of the rasterizer and particles
    /// belong to no draw; glass is told from what is opaque draw by draw.
    pub const fn has_scope(&self) -> bool {
        let hooks = &self.hooks;
        if hooks.makes_glass {
            return true;
        }
        let is_elsewhere = hooks.image.is_some()
            || hooks.passes.is_some()
            || hooks.slot.is_some()
            || hooks.has_lines
            || hooks.particle_settings.is_some();
        !is_elsewhere
            && (hooks.vertex.is_some() || hooks.sample.is_some() || hooks.surface.is_some())
    }

    /// Name of the WGSL file below `effects`.
    pub fn file_stem(&self) -> &str {
        match (&self.source, &self.base) {
            (Some(source), _) => &source.stem,
            (None, Some(base)) => &base.name,
            (None, None) => &self.name,
        }
    }

    /// The pictures that it takes as inputs.
    pub fn images(&self) -> &[ImageInput] {
        self.source
            .as_ref()
            .map_or(&[], |source| source.images.as_slice())
    }

    /// Every member of its struct of parameters, in order: its fields, its pictures by number, and
    /// what it is given.
    pub fn members(&self) -> Vec<Arc<Field>> {
        let number = |image: &ImageInput| {
            let param = Param::new(&image.name, "", ValueType::U32);
            Arc::new(Field::new(param, WgslType::U32, image.offset))
        };
        let given = |member: &GivenMember| {
            let param = Param::new(&member.name, "", ValueType::U32);
            Arc::new(Field::new(param, member.given.wgsl(), member.offset))
        };
        let mut members = self.fields.clone();
        members.extend(self.images().iter().map(number));
        members.extend(self.given.iter().map(given));
        members.sort_by_key(|member| member.offset);
        members
    }

    /// The field called `name`.
    pub fn field(&self, name: &str) -> Option<&Arc<Field>> {
        self.fields.iter().find(|field| field.name == name)
    }
}

impl std::fmt::Debug for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name)
    }
}

impl PartialEq for Effect {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && self.source == other.source && self.base == other.base
    }
}

impl Eq for Effect {}

impl std::hash::Hash for Effect {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.name.hash(state);
        // Kernel keys are hashed for every pass; equal texts have equal lengths.
        self.source
            .as_ref()
            .map(|source| source.written.len())
            .hash(state);
        self.base.as_ref().map(|base| &base.name).hash(state);
    }
}

/// The WGSL text of an effect that a file brings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EffectSource {
    /// Name of the file without `.wgsl`.
    pub stem: String,
    /// The file as its author wrote it.
    pub written: String,
    /// The text that is linked: without attributes, its names made unique, its loops bounded.
    pub linked: String,
    /// A loop has neither `break` nor `return`.
    pub has_endless_loop: bool,
    /// The function on each hook.
    pub functions: HookFunctions,
    /// The pictures that it takes as inputs, in the order of the struct.
    pub images: Vec<ImageInput>,
}

/// The WGSL constant of one word of a choice: `HATCH_SPACE_SURFACE`.
pub fn constant_name(stem: &str, field: &str, word: &str) -> String {
    format!("{stem}_{field}_{word}")
        .to_uppercase()
        .replace('-', "_")
}

/// What an image begins with that stands in the text of an effect file, as base64.
pub const EMBEDDED_IMAGE: &str = "data:image/png;base64,";

impl EffectSource {
    /// The file with its pictures inside its text, so that it can be read anywhere.
    pub fn shared(&self) -> Cow<'_, str> {
        if self.images.is_empty() {
            return Cow::Borrowed(&self.written);
        }
        let (mut text, mut copied) = (String::new(), 0);
        for image in &self.images {
            // The marks of quotation stay.
            text.push_str(&self.written[copied..=image.named.start]);
            text.push_str(EMBEDDED_IMAGE);
            STANDARD.encode_string(&image.file.png, &mut text);
            copied = image.named.end - 1;
        }
        Cow::Owned(text + &self.written[copied..])
    }

    /// The name that `declared` of the file `stem` has in a linked module. A stem has no `__`, so
    /// that no two files share a name.
    pub fn unique(stem: &str, declared: &str) -> String {
        format!("custom_{stem}__{declared}")
    }
}

/// Names of an effect's WGSL functions in its linked text.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct HookFunctions {
    pub vertex: Option<String>,
    pub sample: Option<String>,
    pub sample_setup: Option<String>,
    pub surface: Option<String>,
    pub image: Option<String>,
    /// Of every pass over the finished picture, in order.
    pub passes: Vec<String>,
}

/// Parameter words as the struct they were made from.
pub fn read<P: Words>(words: &[u32]) -> P {
    // A struct of WGSL may end with room that the one in Rust does not have.
    bytemuck::pod_read_unaligned(&bytemuck::cast_slice(words)[..size_of::<P>()])
}
