//! Hooks: where in the pipeline an effect acts. The same signatures in WGSL and here, where they
//! are f64 or integers.

pub mod environment;
mod front;
mod image;
mod passes;
mod sample;
mod slot;
mod surface;
pub mod tone;
mod vertex;

pub use front::{Front, Pattern};
pub use image::{FinishFunction, ImageHook, Picture, Pixel};
pub use passes::{
    EMPTY_DEPTH_M, EarlierFrames, Image, ImageAt, ImagePass, Lens, PassFunction, PassHook,
    PassInput, Signs,
};
pub use sample::{Sample, SampleEffect, SampleHook, SetupFunction, TriangleSetup};
pub use slot::{Layers, Shape, Slot};
pub use surface::{
    Finish, Lighting, LitEffect, Surface, SurfaceEffect, SurfaceInput, Transmission,
};
pub use vertex::{ErrorBound, ROUNDING, Vertex, VertexFunction, VertexHook};

use std::sync::Arc;

use crate::scene::particle_discs::ParticleSettings;

/// A surface effect's function over its parameter words, which changes every surface in place.
pub type SurfaceFunction = dyn Fn(&mut [Surface], &[u32]) + Send + Sync;

/// The same where the scene brings light.
pub type LitFunction = dyn Fn(&mut [Surface], &Lighting<'_>, &[u32]) + Send + Sync;

/// Every hook of one effect, each with its function over the parameter words.
#[derive(Clone, Default)]
pub struct Hooks {
    /// Where is it?
    pub vertex: Option<VertexHook>,
    /// Is this sample drawn?
    pub sample: Option<SampleHook>,
    /// What color is it?
    pub surface: Option<Arc<SurfaceFunction>>,
    /// The same in the light that comes with the scene, in place of `surface` where there is any.
    pub lit: Option<Arc<LitFunction>>,
    /// Finish the pixel.
    pub image: Option<ImageHook>,
    /// Passes over the finished picture.
    pub passes: Option<PassHook>,
    /// The part of the rasterizer that the effect replaces.
    pub slot: Option<Slot>,
    /// It shows what surrounds the scene.
    pub shows_surroundings: bool,
    /// It turns the parts on which it acts into glass.
    pub makes_glass: bool,
    /// It draws along lines, in separate passes before pixels are shaded.
    pub has_lines: bool,
    /// It adds particles to the scene.
    pub particle_settings: Option<fn(&[u32]) -> ParticleSettings>,
    /// Its color has steps, decided by a value plus [`Surface::step_offset`].
    pub has_steps: bool,
    /// It is the light that casts shadows, so that the scene is drawn from the light as well.
    pub casts_shadows: bool,
    /// The members of the surface that it reads.
    pub surface_inputs: Vec<SurfaceInput>,
}

impl Hooks {
    /// Does it read how materials reflect?
    pub fn reads_finish(&self) -> bool {
        self.surface_inputs.contains(&SurfaceInput::Finish)
    }

    /// Does it read where normals point?
    pub fn reads_normals(&self) -> bool {
        self.surface_inputs.contains(&SurfaceInput::Normal)
    }

    /// Names for listings: `sample + surface`.
    pub fn names(&self) -> String {
        let hooks = [
            (self.slot.is_some(), self.slot.map_or("", Slot::name)),
            (self.particle_settings.is_some(), "scene"),
            (self.vertex.is_some(), "vertex"),
            (self.sample.is_some(), "sample"),
            (self.surface.is_some(), "surface"),
            (self.has_lines, "lines"),
            (self.image.is_some(), "pixel"),
            (self.passes.is_some(), "image"),
        ];
        let names: Vec<&str> = hooks
            .iter()
            .filter(|(is_there, _)| *is_there)
            .map(|(_, name)| *name)
            .collect();
        names.join(" + ")
    }
}
