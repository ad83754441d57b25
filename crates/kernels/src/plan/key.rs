//! The key of a plan: which paths, formats and limits the kernel of a picture takes.

use super::{
    caps::{Caps, MANY_STORAGE_BUFFERS, Tuning},
    loops,
    traits::StackTraits,
};
use crate::{
    accuracy::{
        AccuracyOptions, Clipping, Culling, Parameters, PositionFormat, Visibility, XraySums,
    },
    effects::hooks::{Layers, Shape},
    math::SMALL_EXTENT,
    scene::needs::Needs,
    shader::key::{
        AttributeFormat, EffectList, Fetch, Framebuffer, GeneratedVertices, KernelKey, ONE64_BITS,
        ProjectionKind, RasterPaths, SampleRules, SurfaceInputs, VertexInputs, ViewKind,
        WorkSharing,
    },
};

/// Less than the radius of the least disc of a point, which stands for its pixel.
const LEAST_DISC_PX: f64 = 0.69;

/// Bytes of the record of a projected vertex.
const RECORD_BYTES: u64 = 16;

/// The key of a kernel with these options and layers.
pub(super) fn key_of(
    options: AccuracyOptions,
    layers: Option<Layers>,
    needs: &Needs,
    stack: &StackTraits,
    (caps, tuning): (&Caps, &Tuning),
) -> KernelKey {
    // Boxes and discs show all of a material.
    let has_mask = needs.masked && stack.shape == Shape::Triangles;
    let loops = loops::of_a_sample(has_mask, layers, &options);
    let paired_sums = adds_pairs(&options, layers, caps);
    let is_culled = options.culling != Culling::None;
    let is_cloud = needs.only_points || needs.clouds && !stack.moves_triangles();
    // The judge reads what a light's pass writes, where that has room.
    let has_room = needs.vertices * RECORD_BYTES <= caps.max_storage_binding_bytes;
    let is_asked_for = needs.is_light && has_room;
    let projects_points = tuning.projects_points && is_cloud && !is_culled && !is_asked_for;
    // The pass that clears is the one that projects.
    let clears_in_passes = tuning.clears_in_passes && !is_culled && !projects_points;
    let has_transmission = layers == Some(Layers::Glass) && needs.transmitting > 0;
    let has_finish = stack.reads_finish() || has_transmission;
    let has_finish_maps = needs.finish_maps > 0 && has_finish;
    let has_normal_maps = needs.normal_maps > 0 && stack.reads_normals();
    KernelKey {
        options,
        vertices: vertex_inputs(needs, &options, caps),
        generated: GeneratedVertices {
            has_joints: needs.skinning.is_some(),
            has_morph_targets: needs.morph_targets,
            has_particles: needs.particle_discs,
        },
        samples: SampleRules {
            shape: stack.shape,
            draw_order: stack.draw_order,
            has_mask,
            has_points: needs.points,
            only_points: needs.only_points,
        },
        paths: raster_paths(&options, needs, tuning, loops::samples(caps, loops)),
        work: WorkSharing {
            group_size: tuning.group_size,
            invocations_per_triangle: loops::invocations_per_triangle(
                caps,
                stack.shape,
                needs.triangles,
                loops,
            ),
            listed_tiles: tuning.listed_tiles,
            early_load: stack.shape == Shape::Points
                || projects_points
                || tuning.early_load && options.visibility == Visibility::Split32,
            exchanges_maximum: tuning.exchanges_maximum,
            queue_groups: if is_culled {
                0
            } else {
                tuning.queue_groups.min(65_535)
            },
            dot_groups: tuning.dot_groups,
            interleaves_triangles: tuning.interleaves_triangles,
            hides_blocks: tuning.hides_blocks,
            stored_uniforms: tuning.stored_uniforms,
            wide_loads: tuning.wide_loads,
            buffered_shadow_map: tuning.buffered_shadow_map && stack.reads_light(),
            projects_points,
            deepest_glass: if caps.software {
                loops::DEEPEST_GLASS
            } else {
                loops::DEEPEST_GLASS_OF_CARDS
            },
            paired_sums,
            sums_with_nearest: paired_sums
                && !options.culling.occludes()
                && stack.sums_all_layers()
                && caps.max_storage_buffers >= MANY_STORAGE_BUFFERS,
            clears_in_passes,
            clears_order: clears_in_passes
                && stack.draw_order.is_some()
                && caps.max_storage_buffers >= MANY_STORAGE_BUFFERS,
        },
        framebuffer: Framebuffer {
            layers,
            glass_bands: u32::from(layers == Some(Layers::Glass)),
            has_one64_sums: paired_sums && has_one64_sums(&options, layers, stack),
            triangle_id_bits: if options.visibility == Visibility::Packed32 {
                bit_length(needs.triangles)
            } else {
                0
            },
        },
        surface: SurfaceInputs {
            has_material_atlas: needs.material_count > 0 || has_finish_maps || has_normal_maps,
            has_alpha: layers == Some(Layers::Glass) && needs.has_blended_textures,
            has_finish,
            has_transmission,
            has_finish_maps,
            has_normal_maps,
            has_planes: stack.reads_planes() || !needs.normals_agree,
            lights: if stack.is_lit() { needs.lights } else { 0 },
            has_panorama: needs.has_panorama && stack.shows_surroundings(),
        },
        view: ViewKind {
            projection: if needs.perspective {
                ProjectionKind::Perspective
            } else {
                ProjectionKind::Orthographic
            },
            is_light: needs.is_light,
        },
        effects: EffectList {
            list: stack.effects.clone(),
            baked: if options.parameters == Parameters::Baked {
                stack.baked.clone()
            } else {
                Vec::new()
            },
            scope_bits: stack.scope_bits.clone(),
            dots: stack.dots,
        },
    }
}

/// Are the sums of an x-ray added two words at a time?
fn adds_pairs(options: &AccuracyOptions, layers: Option<Layers>, caps: &Caps) -> bool {
    let has_pairs =
        options.visibility == Visibility::Packed64 && options.xray_sums.words().is_multiple_of(2);
    caps.int64_additions && has_pairs && matches!(layers, Some(Layers::Xray { .. }))
}

/// Do the sums of an x-ray share one 64-bit integer? Layers of equal weight, and colors of few
/// enough bits; where more layers lie on a pixel than that holds, the renderer takes a word for
/// each sum instead.
fn has_one64_sums(options: &AccuracyOptions, layers: Option<Layers>, stack: &StackTraits) -> bool {
    let fits = matches!(layers, Some(Layers::Xray { bits }) if bits <= ONE64_BITS);
    fits && options.xray_sums == XraySums::Four32 && stack.xray.is_some_and(|xray| xray.unit() == 1)
}

fn vertex_inputs(needs: &Needs, options: &AccuracyOptions, caps: &Caps) -> VertexInputs {
    let format = |is_f32: bool| {
        if is_f32 {
            AttributeFormat::F32
        } else {
            AttributeFormat::Any
        }
    };
    VertexInputs {
        fetch: match (needs.indexed, needs.u32_indices) {
            (false, _) => Fetch::Direct,
            (true, false) => Fetch::Indexed,
            (true, true) => Fetch::IndexedU32,
        },
        positions: format(needs.f32_positions),
        normals: format(needs.f32_normals),
        has_colors: needs.colors,
        only_triangle_lists: !needs.has_strips_or_fans,
        is_single_draw: needs.draws == 1,
        // Positions relative to the eye have an origin of their own in each draw.
        is_instanced: needs.instanced
            && needs.draws > 1
            && options.position_format != PositionFormat::Relative,
        split: caps.attribute_split(needs.attribute_bytes),
    }
}

/// The paths that triangles of these sizes take, where one invocation may walk so many samples.
fn raster_paths(
    options: &AccuracyOptions,
    needs: &Needs,
    tuning: &Tuning,
    walkable_samples: u32,
) -> RasterPaths {
    // With `clipping = drop` no clip pass is needed; the triangles that are drawn may still be
    // large.
    let has_clipping = needs.clipping && options.clipping != Clipping::Drop;
    let max_small_samples = tuning.max_small_samples.min(walkable_samples).max(1);
    let max_small_side = tuning.max_small_side.clamp(1, 128);
    // A box of n px touches at most n + 1 sample columns.
    let widest = needs.largest_px.floor() + 1.0;
    RasterPaths {
        has_clipping,
        has_medium: has_clipping
            || widest > f64::from(max_small_side)
            || widest * widest > f64::from(max_small_samples),
        has_large: needs.largest_px >= large_px(options),
        only_pixels: needs.largest_disc_px < LEAST_DISC_PX,
        max_small_samples,
        max_small_side,
    }
}

/// Extent in pixels from which a triangle takes the path of large ones.
pub(super) fn large_px(options: &AccuracyOptions) -> f64 {
    f64::from(SMALL_EXTENT >> options.coverage.subpixel_bits())
}

/// Bits that tell so many triangles apart, and each from none.
const fn bit_length(triangles: u64) -> u32 {
    64 - (triangles | 1).leading_zeros()
}
