//! Particle discs: discs beside a scene's meshes. Each is a triangle that faces the viewer, of
//! which only the ellipse is drawn that touches the middles of its sides; a pass writes the corners
//! for every picture.

use std::{borrow::Cow, sync::Arc};

use glam::{DMat4, DVec3};

use super::{
    accessor::{Accessor, ComponentType},
    bounds::Bounds,
    deformation::Deformation,
    material::Material,
    model::{Instance, Primitive, Scene, Topology},
};

/// Name of the material, mesh and node of the discs.
pub const PARTICLES: &str = "particles";

/// Bytes of a corner: position as three floats, color as three normalized u16, normal as three
/// normalized i16.
pub const CORNER_BYTES: u32 = 24;

/// Words of a disc.
pub const PARTICLE_DISC_WORDS: usize = 3 * CORNER_BYTES as usize / 4;

/// How many particles there are, and their bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParticleSettings {
    pub count: u32,
    /// They hold the center of every disc, in the scene before its spin.
    pub bounds: Bounds,
    /// Largest radius of a disc.
    pub radius_m: f64,
}

impl ParticleSettings {
    /// Box that holds every corner.
    pub fn disc_bounds(&self) -> Bounds {
        // Corners lie two radii away; the other term covers the rounding of floats.
        let margin = 2.0 * self.radius_m
            + 1e-5
                * (self
                    .bounds
                    .min
                    .abs()
                    .max(self.bounds.max.abs())
                    .max_element()
                    + self.radius_m);
        Bounds {
            min: self.bounds.min - margin,
            max: self.bounds.max + margin,
        }
    }
}

/// The steps that particles have taken up to a frame, and the parameters of every step.
#[derive(Clone, Debug, PartialEq)]
pub struct ParticleTimeline {
    /// Steps since the beginning.
    pub frame: u32,
    /// Parameter words of every step from the first on, `stride` each; the last hold for all later
    /// ones.
    pub step_params: Arc<Vec<u32>>,
    pub stride: usize,
}

impl ParticleTimeline {
    /// Parameter words of the step that leads to frame `step`, counted from 1.
    pub fn words(&self, step: u32) -> &[u32] {
        let last = self.step_params.len() / self.stride - 1;
        let index = (step.max(1) as usize - 1).min(last);
        &self.step_params[index * self.stride..][..self.stride]
    }

    /// Steps that have words.
    pub fn len(&self) -> usize {
        self.step_params.len() / self.stride
    }

    pub fn is_empty(&self) -> bool {
        self.step_params.is_empty()
    }

    /// Do both take the same first `frames` steps?
    pub fn shares_steps_with(&self, other: &Self, frames: u32) -> bool {
        let steps = self.len().max(other.len()).min(frames.max(1) as usize) as u32;
        self.stride == other.stride && (1..=steps).all(|step| self.words(step) == other.words(step))
    }
}

impl Scene {
    /// The scene with particles beside its meshes, as its last instance but for ground and walls.
    /// Their bytes are zeros until a pass writes them.
    pub fn with_particles(&self, particle_settings: Option<&ParticleSettings>) -> Cow<'_, Self> {
        let Some(particle_settings) =
            particle_settings.filter(|particle_settings| particle_settings.count > 0)
        else {
            return Cow::Borrowed(self);
        };
        let mut scene = self.clone();
        let first = scene.vertex_bytes.len();
        let corners = 3 * particle_settings.count as usize;
        scene
            .vertex_bytes
            .resize(first + corners * CORNER_BYTES as usize, 0);
        let accessor = |offset: usize, component_type, normalized| Accessor {
            offset: (first + offset) as u32,
            stride: CORNER_BYTES,
            component_type,
            components: 3,
            normalized,
            count: corners as u32,
        };
        scene.particle_discs = Some(scene.primitives.len());
        // Ground and walls come last, since they cast no shadows.
        let index = scene.shadow_casters().len();
        let named_node = Some(scene.add_named_node(PARTICLES));
        scene.instances.insert(
            index,
            Instance {
                named_node,
                ..Instance::fixed(scene.primitives.len(), DMat4::IDENTITY)
            },
        );
        scene.primitives.push(Primitive {
            name: PARTICLES.into(),
            mesh: PARTICLES.into(),
            topology: Topology::List,
            indices: None,
            positions: accessor(0, ComponentType::F32, false),
            normals: accessor(18, ComponentType::I16, true),
            colors: Some(accessor(12, ComponentType::U16, true)),
            texcoords: Default::default(),
            tangents: None,
            material: scene.materials.len(),
            bounds: particle_settings.disc_bounds(),
            longest_edge: 2.0 * 3f64.sqrt() * particle_settings.radius_m * (1.0 + 1e-5)
                + 1e-5 * particle_settings.disc_bounds().radius(),
            is_faceted: false,
            normals_agree: true,
            deformation: Deformation::default(),
        });
        scene.materials.push(Material {
            name: PARTICLES.into(),
            double_sided: true,
            ..Material::default()
        });
        if !scene.rig.is_empty() {
            let bounds = particle_settings.disc_bounds();
            [bounds.min, bounds.max]
                .into_iter()
                .for_each(|corner: DVec3| scene.rig.motion_bounds.include(corner));
        }
        Cow::Owned(scene)
    }

    /// Range of the discs among the scene's bytes; empty where there are none.
    pub fn particle_disc_bytes(&self) -> std::ops::Range<usize> {
        self.particle_discs.map_or(0..0, |primitive| {
            let positions = &self.primitives[primitive].positions;
            let first = positions.offset as usize;
            first..first + positions.count as usize * CORNER_BYTES as usize
        })
    }

    /// Ids of the triangles that are discs; empty where there are none.
    pub fn particle_disc_ids(&self) -> std::ops::Range<u32> {
        let count = |instance: &Instance| self.primitives[instance.primitive].triangle_count();
        let mut first = 0;
        for instance in &self.instances {
            if self.particle_discs == Some(instance.primitive) {
                return first..first + count(instance);
            }
            first += count(instance);
        }
        0..0
    }
}
