//! Explanation: why each part of a kernel key is as it is, and what a picture does without.

use super::{Caps, Note};
use crate::{
    accuracy::Visibility,
    effects::{
        dots::LineSource,
        hooks::{Layers, Shape},
        xray,
    },
    scene::needs::Needs,
    shader::key::KernelKey,
};

pub(super) fn note(name: &str, why: impl Into<String>) -> Note {
    Note { name: name.into(), why: why.into() }
}

pub(super) fn explain(needs: &Needs, is_default: bool, caps: &Caps, key: &KernelKey) -> (Vec<Note>, Vec<Note>) {
    let mut reasons = Vec::new();
    match (key.samples.shape, key.framebuffer.layers) {
        (Shape::Boxes, _) => reasons.push(note("shape", "boxes: an effect fills the bounding boxes")),
        (Shape::Points, _) => reasons.push(note("shape", "points: an effect draws corners as discs")),
        (_, Some(Layers::Race)) => {
            reasons.push(note("visibility", "the effect race takes the slot: one pass of plain loads and stores, and what is lost is lost"))
        }
        _ => {}
    }
    reasons.extend([
        note("fetch", if needs.indexed { "the scene has index lists" } else { "no primitive has indices" }),
        note(
            "small",
            format!(
                "one invocation walks up to {} samples: {}",
                key.paths.max_small_samples,
                match (is_default, caps.software) {
                    (false, _) => "as the tuning asks",
                    (true, true) => "a CPU adapter runs lanes in turn",
                    (true, false) => "a workgroup takes over early on a GPU",
                }
            ),
        ),
    ]);
    if key.options.visibility == Visibility::Tiled && key.work.max_list_entries < u32::MAX {
        let most = key.work.max_list_entries;
        reasons
            .push(note("lists of tiles", format!("a list of more than {most} triangles takes another dispatch: drivers end long loops")));
    }
    if key.culls() && key.deforms() {
        reasons
            .push(note("culling of what bends", "its meshlets have no bounds of their own: they are left out with their whole instance"));
    }
    if key.moves() {
        let why = if key.unshares_vertices() { "triangles part, three projected records each" } else { "triangles keep sharing vertices" };
        let movers: Vec<_> = key.effects.list.iter().filter(|effect| effect.hooks.vertex.is_some()).map(|effect| effect.name).collect();
        reasons.push(note("movement", format!("vertices are moved by {}: {why}", movers.join(", "))));
    }
    if key.surface.has_material_atlas {
        let why = match needs.textured {
            0 => format!("atlas: {} materials shine or stay unlit, which the words of a texture tell", needs.material_count),
            textured => {
                format!(
                    "atlas: {textured} of {} materials look up an image, texel by texel and mixed in linear light",
                    needs.material_count
                )
            }
        };
        reasons.push(note("material atlas", why));
    }
    if key.samples.has_mask {
        let why = "the alpha of an image leaves samples out: corners are placed in it once, in 1/256 of a texel, and integers decide";
        reasons.push(note("mask", why));
    }
    if key.finishes_pixels() {
        reasons.push(note("finish", "an image effect finishes every pixel, empty ones too, so no tile is skipped"));
    }
    if let Some(line_source) = key.effects.dots {
        let lines = match line_source {
            LineSource::Edges => "the edges of all meshes",
            LineSource::Creases => "the creases of all meshes",
            LineSource::Polyline => "the preset's polyline",
        };
        reasons.push(note("dots", format!("an effect strings them along {lines}, over every pixel, so no tile is skipped")));
    }
    reasons.extend(layers_note(needs, key));
    let omitted = key.omissions(needs).into_iter().map(|(name, why)| note(name, why)).collect();
    (reasons, omitted)
}

/// Why the samples of a pixel are added up or counted, and in how many bits.
fn layers_note(needs: &Needs, key: &KernelKey) -> Option<Note> {
    Some(match key.framebuffer.layers? {
        Layers::Xray { bits } => {
            let most = xray::capacity(bits);
            note(
                "layers",
                format!("xray: sums of {bits} bits a channel hold {most} full weights; the scene has {} triangles", needs.triangles),
            )
        }
        Layers::Overdraw => note("layers", "overdraw: one more raster pass counts every covered sample"),
        Layers::Race => note("layers", "race: the picture depends on chance, so it is not reproducible"),
    })
}
