//! Explanation: why each part of a plan is as it is, and what its frame omits. Built only when
//! asked for.

use super::{
    AccuracyRequest, Note, Plan, PlanError, StackTraits, Tuning, costs, options::Cause,
    predict::predict,
};
use crate::{
    accuracy::{AXES, Axis, AxisOption, Culling, Transparency},
    effects::{
        Stack,
        dots::LineSource,
        hooks::{Layers, Shape},
        xray,
    },
};

fn note(name: &str, why: impl Into<String>) -> Note {
    Note {
        name: name.into(),
        why: why.into(),
    }
}

impl Plan {
    /// Why each part of the key is as it is.
    pub fn reasons(&self) -> Vec<Note> {
        let options = AXES
            .iter()
            .enumerate()
            .filter_map(|(index, axis)| self.option_reason(index, axis));
        let parts = [
            self.shape_reason(),
            Some(self.fetch_reason()),
            Some(self.small_reason()),
            self.culling_reason(),
            self.vertex_effects_reason(),
            self.scopes_reason(),
            self.material_reason(),
            self.finish_reason(),
            self.maps_reason(),
            self.mask_reason(),
            self.image_reason(),
            self.passes_reason(),
            self.dots_reason(),
            self.layers_reason(),
        ];
        options.chain(parts.into_iter().flatten()).collect()
    }

    /// Which option an axis is on, and why; none where the picture has nothing that it decides
    /// about.
    pub fn reason(&self, axis: &Axis) -> Option<String> {
        self.option_reason(axis.index(), axis).map(|note| note.why)
    }

    /// The plan of the same picture under another request.
    pub fn under(
        &self,
        stack: &Stack,
        tuning: &Tuning,
        request: &AccuracyRequest,
    ) -> Result<Self, PlanError> {
        super::plan(
            &self.needs,
            &StackTraits::of(stack, request)?,
            &self.caps,
            tuning,
            request,
        )
    }

    /// The parts of the frame that the key omits, each with the reason.
    pub fn omissions(&self) -> Vec<Note> {
        self.key
            .omissions(&self.needs)
            .into_iter()
            .map(|(name, why)| note(name, why))
            .collect()
    }

    /// Why an axis is on its option; none where the picture has nothing that it decides about.
    fn option_reason(&self, index: usize, axis: &Axis) -> Option<Note> {
        let option = self.key.options.get(axis);
        let word = axis.words[option];
        let why = match self.causes[index] {
            Cause::Unused => return None,
            Cause::Pinned => format!("{word}: pinned by the preset"),
            Cause::Default => {
                let about = axis.option_abouts[option].trim().trim_end_matches('.');
                format!("{word}: {}", lowercase_first(about))
            }
            Cause::Cheaper => {
                let fraction = costs::of(axis, option, &self.needs, &self.caps, &self.measured);
                let own = predict(index, option, &self.needs);
                let measured = if self.measured.fraction(index, option).is_some() {
                    " as measured here"
                } else {
                    ""
                };
                format!(
                    "{word}: it takes {fraction:.2} of the default's time{measured}; its error is predicted as {:.0} of a million pixels, of {:.0} allowed, and {:.1} in color, of {} allowed",
                    own.wrong_ppm, self.tolerance.wrong_ppm, own.channel, self.tolerance.channel
                )
            }
            Cause::FarFromOrigin(stored) => format!(
                "relative: so far from the origin, rounding moves a stored corner by up to {:.2} px, predicted to cost {:.0} of {:.0} ppm",
                self.needs.rounding_px[0], stored.wrong_ppm, self.tolerance.wrong_ppm
            ),
            Cause::Limited { asked, why } => format!(
                "{} instead of {}: {why}",
                Culling::from_index(option).name(),
                asked.name()
            ),
        };
        Some(note(axis.name, why))
    }

    fn shape_reason(&self) -> Option<Note> {
        match (self.key.samples.shape, self.key.framebuffer.layers) {
            (Shape::Boxes, _) => Some(note("shape", "boxes: an effect fills the bounding boxes")),
            (Shape::Points, _) => Some(note("shape", "points: an effect draws corners as discs")),
            (Shape::Triangles, Some(Layers::Race)) => Some(note(
                "visibility",
                "the effect race takes the slot: one pass of plain loads and stores, which lose samples",
            )),
            (Shape::Triangles, _) => None,
        }
    }

    fn fetch_reason(&self) -> Note {
        note(
            "fetch",
            if self.needs.indexed {
                "the scene has index lists"
            } else {
                "no primitive has indices"
            },
        )
    }

    fn small_reason(&self) -> Note {
        let why = match (self.has_default_tuning, self.caps.software) {
            (false, _) => "as the tuning says",
            (true, true) => "a CPU adapter runs invocations one after another",
            (true, false) => "a workgroup takes over early on a GPU",
        };
        note(
            "small",
            format!(
                "one invocation walks up to {} samples: {why}",
                self.key.paths.max_small_samples
            ),
        )
    }

    fn culling_reason(&self) -> Option<Note> {
        let why = "deformed meshes have no bounds per meshlet, so they are culled by instance";
        (self.key.culls() && self.key.deforms()).then(|| note("culling of deformed meshes", why))
    }

    fn vertex_effects_reason(&self) -> Option<Note> {
        let effects = self
            .key
            .effects
            .list
            .iter()
            .filter(|effect| effect.hooks.vertex.is_some());
        let names: Vec<_> = effects.map(|effect| effect.name.as_str()).collect();
        let why = if self.key.unshares_vertices() {
            "triangles move apart, with three projected vertices each"
        } else {
            "triangles keep sharing vertices"
        };
        (!names.is_empty()).then(|| {
            note(
                "vertex effects",
                format!("{} move vertices: {why}", names.join(", ")),
            )
        })
    }

    fn scopes_reason(&self) -> Option<Note> {
        let effects = &self.key.effects;
        let names: Vec<_> = effects
            .list
            .iter()
            .filter(|effect| effects.scope(effect).is_some())
            .map(|effect| effect.name.as_str())
            .collect();
        let why = "limited to parts of the scene: one bit per draw decides";
        (!names.is_empty()).then(|| note("scopes", format!("{}: {why}", names.join(", "))))
    }

    fn material_reason(&self) -> Option<Note> {
        let count = self.needs.material_count;
        let why = match self.needs.textured {
            0 => format!("{count} materials emit light or are unlit, which the atlas stores"),
            textured => format!(
                "{textured} of {count} materials have textures, read texel by texel and filtered in linear light"
            ),
        };
        (count > 0).then(|| note("material atlas", why))
    }

    fn finish_reason(&self) -> Option<Note> {
        let readers: Vec<_> = self
            .key
            .effects
            .list
            .iter()
            .filter(|effect| effect.hooks.reads_finish())
            .map(|effect| effect.name.as_str())
            .collect();
        let why = "metallic, roughness and reflectance of every primitive stand in the atlas";
        let transmission = "light passes through materials";
        let readers = match (readers.is_empty(), self.key.surface.has_transmission) {
            (true, false) => return None,
            (true, true) => transmission.to_owned(),
            (false, false) => readers.join(", "),
            (false, true) => format!("{} and {transmission}", readers.join(", ")),
        };
        Some(note("finish", format!("{readers}: {why}")))
    }

    fn maps_reason(&self) -> Option<Note> {
        let (finish, normals) = (self.needs.finish_maps, self.needs.normal_maps);
        let why = match (
            self.key.surface.has_finish_maps,
            self.key.surface.has_normal_maps,
        ) {
            (false, false) => return None,
            (true, false) => format!("textures tell how {finish} materials reflect"),
            (false, true) => format!("textures turn the normals of {normals} materials"),
            (true, true) => format!(
                "textures tell how {finish} materials reflect, and turn the normals of {normals}"
            ),
        };
        Some(note("maps", why))
    }

    fn mask_reason(&self) -> Option<Note> {
        let why = "a texture's alpha discards samples: its corners are snapped once, to 1/256 of a texel, and integers decide";
        self.key.samples.has_mask.then(|| note("mask", why))
    }

    fn image_reason(&self) -> Option<Note> {
        let why = "an image effect finishes every pixel, empty ones too, so no tile is skipped";
        self.key
            .finishes_pixels()
            .then(|| note("image effects", why))
    }

    fn passes_reason(&self) -> Option<Note> {
        let count = self.key.image_steps().len();
        let why = format!(
            "{count} of them read the finished picture in linear light, 16 bytes a pixel, and the last one writes what is shown"
        );
        (count > 0).then(|| note("image passes", why))
    }

    fn dots_reason(&self) -> Option<Note> {
        let lines = match self.key.effects.dots? {
            LineSource::Edges => "the edges of all meshes",
            LineSource::Creases => "the creases of all meshes",
            LineSource::Polyline => "the preset's polyline",
        };
        Some(note(
            "dots",
            format!("an effect draws them along {lines}, over every pixel, so no tile is skipped"),
        ))
    }

    /// Why the samples of a pixel are summed or counted, and in how many bits.
    fn layers_reason(&self) -> Option<Note> {
        Some(match self.key.framebuffer.layers? {
            Layers::Xray { bits } => {
                let (most, triangles) = (xray::capacity(bits), self.needs.triangles);
                note(
                    "layers",
                    format!(
                        "xray: sums of {bits} bits a channel hold {most} full weights; the scene has {triangles} triangles"
                    ),
                )
            }
            Layers::Overdraw => note(
                "layers",
                "overdraw: one more raster pass counts every covered sample",
            ),
            Layers::Glass => note(
                "layers",
                format!(
                    "glass: {} of {} draws are seen through; their layers are listed pixel by pixel, {}{}",
                    self.needs.glass_draws,
                    self.needs.draws,
                    match self.key.options.transparency {
                        Transparency::Weighted => "and summed with weights, in integers",
                        Transparency::Nearest4 => {
                            "sorted in integers, and the nearest four composed"
                        }
                        Transparency::Opaque | Transparency::Exact => {
                            "sorted in integers and composed"
                        }
                    },
                    match self.key.framebuffer.glass_bands {
                        0 | 1 => String::new(),
                        bands => format!(
                            ", in {bands} bands of pixels one after another: all at once take too much memory"
                        ),
                    }
                ),
            ),
            Layers::Race => note(
                "layers",
                "race: the picture depends on chance, so it is not reproducible",
            ),
        })
    }
}

/// The sentence as it continues after a colon.
fn lowercase_first(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_lowercase().chain(letters).collect()
    })
}
