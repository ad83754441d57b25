//! The kernel key: everything that decides which shader text runs and with which constants. Equal
//! keys, equal pipelines.
//!
//! What each member means for the shader files, the overrides, the label and the passes is one
//! table: `super::features`.

use std::sync::Arc;

use crate::{
    accuracy::{AccuracyOptions, Culling, RenderScale, Visibility},
    effects::{
        Effect, EnabledEffect, Stack,
        dots::LineSource,
        draw_order,
        hooks::{Layers, Shape},
    },
};

/// Everything that decides which shader text runs and with which constants. Equal keys, equal
/// pipelines.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct KernelKey {
    /// One option on every accuracy axis.
    pub options: AccuracyOptions,
    /// How the scene stores vertices and indices.
    pub vertices: VertexInputs,
    /// Which vertices compute passes write before the frame is projected.
    pub generated: GeneratedVertices,
    /// Which samples a triangle draws.
    pub samples: SampleRules,
    /// Which raster paths the sizes of the triangles call for.
    pub paths: RasterPaths,
    /// How passes divide their work among invocations.
    pub work: WorkSharing,
    /// What a pixel holds.
    pub framebuffer: Framebuffer,
    /// What shading computes for the effects beyond the base color.
    pub surface: SurfaceInputs,
    /// From where and how the scene is projected.
    pub view: ViewKind,
    /// The effects, and the parameters that are constants of the text.
    pub effects: EffectList,
}

/// How the corners of triangles find their vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fetch {
    /// By their own number.
    Direct,
    /// Through index lists of any width.
    Indexed,
    /// Through index lists that are all tightly packed u32.
    IndexedU32,
}

/// In which formats the vertices of a scene may store an attribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AttributeFormat {
    /// All of them as f32.
    F32,
    /// Each draw in its own format.
    Any,
}

/// How the scene stores vertices and indices.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct VertexInputs {
    pub fetch: Fetch,
    pub positions: AttributeFormat,
    pub normals: AttributeFormat,
    /// Some vertices have colors.
    pub has_colors: bool,
    /// No primitive is a strip or a fan.
    pub only_triangle_lists: bool,
    /// There is one draw, so no triangle has to search for its own.
    pub is_single_draw: bool,
    /// Draws share what they say of their primitives.
    pub is_instanced: bool,
    /// The word at which attributes go on in a second buffer, where one binding does not hold them.
    pub split: Option<u32>,
}

/// Which vertices compute passes write before the frame is projected.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct GeneratedVertices {
    /// Joints deform some mesh.
    pub has_joints: bool,
    /// Morph targets deform some mesh.
    pub has_morph_targets: bool,
    /// Particles are simulated, each drawn as a disc.
    pub has_particles: bool,
}

/// Which samples a triangle draws.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct SampleRules {
    /// What a triangle covers.
    pub shape: Shape,
    /// Whose order counts where only a number of samples is drawn; none: all are drawn.
    pub draw_order: Option<draw_order::Mode>,
    /// The alpha of a texture discards samples.
    pub has_mask: bool,
    /// Some primitives are points or lines.
    pub has_points: bool,
    /// All primitives are points.
    pub only_points: bool,
}

/// Which raster paths the sizes of the triangles call for.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct RasterPaths {
    /// Some triangle may need clipping.
    pub has_clipping: bool,
    /// Some triangle may exceed what one invocation walks.
    pub has_medium: bool,
    /// Some triangle may exceed 128 px.
    pub has_large: bool,
    /// No disc of a point is larger than a pixel.
    pub only_pixels: bool,
    /// Most candidate samples of a triangle that one invocation walks.
    pub max_small_samples: u32,
    /// Most pixels per side of such a triangle's box.
    pub max_small_side: u32,
}

/// How passes divide their work among invocations.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct WorkSharing {
    /// Invocations in a workgroup of the passes over vertices and triangles.
    pub group_size: u32,
    /// Among how many invocations the discs of one triangle are divided, at least 1.
    pub invocations_per_triangle: u32,
    /// The resolve visits only tiles that a triangle's box touches, without branches.
    pub listed_tiles: bool,
    /// Load before the depth atomic.
    pub early_load: bool,
    /// The largest word of a pixel is kept by compare and exchange instead of the atomic maximum.
    pub exchanges_maximum: bool,
    /// Workgroups of every pass over a queue, which share its entries; 0: as many as it has
    /// entries, by an indirect dispatch.
    pub queue_groups: u32,
    /// Workgroups among which few runs of dots are divided.
    pub dot_groups: u32,
    /// Workgroups take runs of neighboring triangles in turn instead of one long run each.
    pub interleaves_triangles: bool,
    /// The first pass clears counters and pixels beside its own work.
    pub clears_in_passes: bool,
    /// And what a draw order counts, which takes two more storage buffers.
    pub clears_order: bool,
    /// Triangles that cover a block of pixels hide what lies behind.
    pub hides_blocks: bool,
    /// What conditions read of draws, effects and particles lies in storage buffers instead of
    /// uniforms; see `plan::Tuning`.
    pub stored_uniforms: bool,
    /// The resolve gathers two words at a time; see `plan::Tuning`.
    pub wide_loads: bool,
    /// A shadow map is read from the buffer that the light's passes wrote, not from a texture; see
    /// `plan::Tuning`.
    pub buffered_shadow_map: bool,
    /// Points are projected where they are drawn and shaded, and no pass writes their records.
    pub projects_points: bool,
    /// Most layers of glass of a pixel that are sorted.
    pub deepest_glass: u32,
    /// The sums of an x-ray are added two words at a time, as 64-bit integers.
    pub paired_sums: bool,
    /// They are added by the passes that find the nearest, instead of passes of their own.
    pub sums_with_nearest: bool,
}

/// What a pixel holds.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Framebuffer {
    /// What an effect makes of the samples of a pixel; without one the nearest is shown.
    pub layers: Option<Layers>,
    /// The sums of an x-ray share one 64-bit integer, which holds [`ONE64_LAYERS`] layers.
    pub has_one64_sums: bool,
    /// Bands of pixels whose layers of glass are drawn one after another; 0 without glass.
    pub glass_bands: u32,
    /// Bits of a triangle's id where it shares a word with its depth, else 0.
    pub triangle_id_bits: u32,
}

/// How depth and triangle id of the pixels lie in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FramebufferLayout {
    /// A buffer of depth keys and one of complemented triangle ids.
    Split32,
    /// One word for both.
    Packed32,
    /// Complemented triangle id and depth key side by side.
    Packed64,
}

/// What shading computes for the effects beyond the base color.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct SurfaceInputs {
    /// Some material is more than a base color.
    pub has_material_atlas: bool,
    /// The alpha of a texture tells how much some glass covers.
    pub has_alpha: bool,
    /// How materials reflect: an effect reads it, or light passes through some.
    pub has_finish: bool,
    /// Light passes through some material.
    pub has_transmission: bool,
    /// Textures tell how some material reflects, and an effect reads it.
    pub has_finish_maps: bool,
    /// Textures turn the normals of some material, and an effect reads normals.
    pub has_normal_maps: bool,
    /// Plane normals and triangle centers: an effect reads them, or a normal may need a
    /// substitute.
    pub has_planes: bool,
    /// Lights that come with the scene and shine on some effect.
    pub lights: u32,
    /// A picture of what surrounds the scene comes with it, and an effect shows it.
    pub has_panorama: bool,
}

/// How a view maps depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ProjectionKind {
    /// w is meters.
    Perspective,
    /// Depth is linear and w is 1.
    Orthographic,
}

/// From where and how the scene is projected.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ViewKind {
    pub projection: ProjectionKind,
    /// The view is a light's: effects read positions in the picture for which it draws a shadow
    /// map.
    pub is_light: bool,
}

/// The effects of a stack, in order, and the parameters that are constants of the text.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct EffectList {
    pub list: Vec<Arc<Effect>>,
    /// Parameter words of each that are constants of the text; empty where a uniform holds them.
    pub baked: Vec<Vec<u32>>,
    /// The bit of every effect in the scopes of a draw, none for an effect on the whole scene;
    /// empty where no effect has a scope.
    pub scope_bits: Vec<Option<u32>>,
    /// The lines along which an effect draws dots.
    pub dots: Option<LineSource>,
}

/// Points in a block, which a workgroup draws.
pub const POINT_BLOCK: u32 = 1024;

/// Layers of equal weight that x-ray sums in one 64-bit integer hold.
pub const ONE64_LAYERS: u32 = 127;

/// Most bits per channel in such sums.
pub const ONE64_BITS: u32 = 12;

/// Records of an alpha mask among the sample setups of a triangle: where its corners lie in the
/// image.
pub const MASK_SETUPS: u32 = 2;

impl EffectList {
    /// The bit of an effect in the scopes of a draw; none for an effect on the whole scene.
    pub fn scope(&self, effect: &Effect) -> Option<u32> {
        let at = self
            .list
            .iter()
            .position(|other| other.name == effect.name)?;
        self.scope_bits.get(at).copied().flatten()
    }

    /// Effects whose sample test needs a setup per triangle.
    pub fn setup_count(&self) -> u32 {
        self.list
            .iter()
            .filter(|effect| {
                effect
                    .hooks
                    .sample
                    .as_ref()
                    .is_some_and(|hook| hook.has_setup)
            })
            .count() as u32
    }
}

impl KernelKey {
    /// A key that omits nothing, for a stack on a portable adapter.
    pub fn complete(fetch: Fetch, visibility: Visibility, effects: Vec<Arc<Effect>>) -> Self {
        let stack = Stack(effects.iter().map(EnabledEffect::new).collect());
        let layers = stack.layers(u64::MAX);
        Self {
            options: AccuracyOptions {
                visibility,
                ..AccuracyOptions::default()
            },
            vertices: VertexInputs {
                fetch,
                positions: AttributeFormat::Any,
                normals: AttributeFormat::Any,
                has_colors: true,
                only_triangle_lists: false,
                is_single_draw: false,
                is_instanced: false,
                split: None,
            },
            generated: GeneratedVertices {
                has_joints: true,
                has_morph_targets: true,
                has_particles: true,
            },
            samples: SampleRules {
                shape: Shape::Triangles,
                draw_order: None,
                has_mask: false,
                has_points: false,
                only_points: false,
            },
            paths: RasterPaths {
                has_clipping: true,
                has_medium: true,
                has_large: true,
                only_pixels: false,
                max_small_samples: 64,
                max_small_side: 32,
            },
            work: WorkSharing {
                group_size: 64,
                invocations_per_triangle: 1,
                listed_tiles: true,
                early_load: true,
                exchanges_maximum: true,
                queue_groups: 0,
                dot_groups: 1,
                interleaves_triangles: true,
                clears_in_passes: true,
                clears_order: false,
                hides_blocks: true,
                stored_uniforms: false,
                wide_loads: false,
                buffered_shadow_map: false,
                projects_points: false,
                deepest_glass: u32::MAX,
                paired_sums: false,
                sums_with_nearest: false,
            },
            framebuffer: Framebuffer {
                layers,
                has_one64_sums: false,
                glass_bands: u32::from(layers == Some(Layers::Glass)),
                triangle_id_bits: if visibility == Visibility::Packed32 {
                    24
                } else {
                    0
                },
            },
            surface: SurfaceInputs {
                has_material_atlas: true,
                has_alpha: layers == Some(Layers::Glass),
                has_finish: true,
                has_transmission: layers == Some(Layers::Glass),
                has_finish_maps: true,
                has_normal_maps: true,
                has_planes: true,
                lights: 2,
                // Effects are read alone, too, without a scene.
                has_panorama: false,
            },
            view: ViewKind {
                projection: ProjectionKind::Perspective,
                is_light: false,
            },
            effects: EffectList {
                dots: effects
                    .iter()
                    .any(|effect| effect.hooks.has_lines)
                    .then_some(LineSource::Edges),
                baked: Vec::new(),
                scope_bits: Vec::new(),
                list: effects,
            },
        }
    }

    /// Does an effect move vertices?
    pub fn moves(&self) -> bool {
        self.effects
            .list
            .iter()
            .any(|effect| effect.hooks.vertex.is_some())
    }

    /// Does an effect move corners by their triangle, so that every triangle has three projected
    /// vertices to itself?
    pub fn unshares_vertices(&self) -> bool {
        self.effects.list.iter().any(|effect| {
            effect
                .hooks
                .vertex
                .as_ref()
                .is_some_and(|hook| hook.needs_triangle)
        })
    }

    /// Does an effect discard samples?
    pub fn has_sample_effects(&self) -> bool {
        self.effects
            .list
            .iter()
            .any(|effect| effect.hooks.sample.is_some())
    }

    /// Records per triangle that sample tests read: one of every effect that needs a setup, and
    /// those of an alpha mask.
    pub fn sample_setups(&self) -> u32 {
        self.effects.setup_count()
            + if self.samples.has_mask {
                MASK_SETUPS
            } else {
                0
            }
    }

    /// Does an effect finish pixels? Then the resolve visits all of them, empty ones too.
    pub fn finishes_pixels(&self) -> bool {
        self.effects
            .list
            .iter()
            .any(|effect| effect.hooks.image.is_some())
    }

    /// Are the tiles that no triangle touches listed too, because dots or image effects finish the
    /// background?
    pub fn lists_background(&self) -> bool {
        self.work.listed_tiles && (self.finishes_pixels() || self.effects.dots.is_some())
    }

    /// Do tiles that no triangle touches keep the background that was copied over the picture?
    pub fn keeps_background(&self) -> bool {
        self.work.listed_tiles && !self.lists_background()
    }

    /// Does an effect ask how much of a light arrives?
    pub fn reads_light(&self) -> bool {
        self.effects
            .list
            .iter()
            .any(|effect| effect.hooks.casts_shadows)
    }

    /// Does an effect read the previous picture?
    pub fn reads_previous(&self) -> bool {
        self.effects.list.iter().any(|effect| {
            effect
                .hooks
                .image
                .as_ref()
                .is_some_and(|hook| hook.reads_previous)
        })
    }

    /// Does the picture that is drawn have another size than the one that is shown?
    pub fn is_scaled(&self) -> bool {
        self.options.render_scale != RenderScale::Full
    }

    /// Does it skip meshlets that cannot be seen?
    pub fn culls(&self) -> bool {
        self.options.culling != Culling::None
    }

    /// Does some mesh deform?
    pub const fn deforms(&self) -> bool {
        self.generated.has_joints || self.generated.has_morph_targets
    }

    /// Is something seen through layers of glass?
    pub fn has_glass(&self) -> bool {
        self.framebuffer.layers == Some(Layers::Glass)
    }

    /// Are particles drawn as discs? Boxes and points show no triangles.
    pub fn has_discs(&self) -> bool {
        self.generated.has_particles && self.samples.shape == Shape::Triangles
    }

    /// Does a triangle that covers a block of pixels hide what lies behind? Only where every
    /// covered sample is drawn.
    pub fn hides_blocks(&self) -> bool {
        let draws_all = !self.has_sample_effects()
            && !self.has_discs()
            && !self.samples.has_points
            && !self.samples.has_mask
            && !self.has_glass()
            && self.samples.draw_order.is_none();
        self.work.hides_blocks && draws_all && self.samples.shape == Shape::Triangles
    }

    /// Do workgroups of the medium and the large path share entries of their queues, or look for
    /// hidden blocks first?
    pub fn shares_entries(&self) -> bool {
        self.work.queue_groups > 0 || self.hides_blocks()
    }

    /// Does a pass of their own draw points, beside those of triangles?
    pub fn draws_cloud(&self) -> bool {
        self.work.projects_points && self.samples.shape == Shape::Triangles
    }

    /// Are there queues of triangles for another path than the first?
    pub const fn has_queues(&self) -> bool {
        self.paths.has_clipping || self.paths.has_medium || self.paths.has_large
    }

    /// Side of the pixel square that a workgroup of the resolve visits; listed tiles are the
    /// smaller ones.
    pub const fn tile_side(&self) -> u32 {
        if self.work.listed_tiles { 8 } else { 16 }
    }

    /// Words per pixel in which an x-ray sums up layers.
    pub const fn sum_words(&self) -> u32 {
        if self.framebuffer.has_one64_sums {
            2
        } else {
            self.options.xray_sums.words()
        }
    }

    /// How depth and triangle id lie in memory.
    pub const fn framebuffer_layout(&self) -> FramebufferLayout {
        match self.options.visibility {
            Visibility::Split32 => FramebufferLayout::Split32,
            Visibility::Packed32 => FramebufferLayout::Packed32,
            Visibility::Race | Visibility::Packed64 => FramebufferLayout::Packed64,
        }
    }
}
