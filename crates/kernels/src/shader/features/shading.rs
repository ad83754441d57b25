//! Shading features: surface inputs, light, layers, dots, image effects and the size of the
//! picture.

use super::feature::{Feature, NO_STEP, Part, flag, step_if, word_if};
use crate::{
    accuracy::{DotCulling, Perspective, Transparency},
    effects::{dots::LineSource, hooks::Layers, shadow::MAX_SHADOW_SLOPE},
    shader::{image_passes::NUMBERS, key::KernelKey, pass::Pass},
};

pub(super) const FEATURES: &[Feature] = &[
    LAYERS,
    PLANES,
    COLORS,
    ATTRIBUTES,
    MATERIAL_ATLAS,
    FINISH,
    FINISH_MAPS,
    TRANSMISSION,
    NORMAL_MAPS,
    MASK,
    PUNCTUAL_LIGHTS,
    PANORAMA,
    LIGHT,
    DOTS,
    IMAGE_EFFECTS,
    IMAGE_PASSES,
    RENDER_SCALE,
    EFFECTS,
];

const LAYERS: Feature = Feature {
    label: |key| match key.framebuffer.layers {
        Some(Layers::Xray { bits }) if key.framebuffer.has_one64_sums => {
            format!("layers=xray/{bits}/one64")
        }
        Some(Layers::Xray { bits }) => format!("layers=xray/{bits}"),
        Some(Layers::Overdraw) => "layers=overdraw".into(),
        Some(Layers::Glass) if key.framebuffer.glass_bands > 1 => {
            format!("layers=glass/{}", key.framebuffer.glass_bands)
        }
        Some(Layers::Glass) => "layers=glass".into(),
        Some(Layers::Race) | None => String::new(),
    },
    variants: &[
        ("shading", |key, _| match key.framebuffer.layers {
            Some(Layers::Xray { .. }) => "xray",
            Some(Layers::Overdraw) => "overdraw",
            Some(Layers::Glass) => "glass",
            Some(Layers::Race) | None => "nearest",
        }),
        ("glass_composition", |key, _| {
            if key.options.transparency == Transparency::Weighted {
                "weighted"
            } else {
                "sorted"
            }
        }),
        ("store_step", |key, _| {
            step_if(key.framebuffer.layers == Some(Layers::Race), "race")
        }),
    ],
    constants: &[
        ("SUM_WORDS", |key, _| key.sum_words().into()),
        ("IS_ONE64", |key, _| flag(key.framebuffer.has_one64_sums)),
        ("SUM_BITS", |key, _| {
            if let Some(Layers::Xray { bits }) = key.framebuffer.layers {
                bits.into()
            } else {
                0.0
            }
        }),
        ("CLEARED_SUMS", |key, _| match key.framebuffer.layers {
            Some(Layers::Xray { .. }) => key.sum_words().into(),
            // The heads of lists.
            Some(Layers::Glass) if !key.view.is_light => 1.0,
            _ => 0.0,
        }),
        ("GLASS_BANDS", |key, _| {
            key.framebuffer.glass_bands.max(1).into()
        }),
        ("GLASS_DEEPEST", |key, _| key.work.deepest_glass.into()),
        ("GLASS_COMPOSED_LAYERS", |key, _| {
            let most = key.options.transparency.most_layers();
            most.unwrap_or(u32::MAX).into()
        }),
    ],
    ..Feature::NONE
};

const PLANES: Feature = Feature {
    label: |key| word_if(key.surface.has_planes, "planes"),
    part: Some(Part {
        name: "plane normals and centers",
        is_used: |key| key.surface.has_planes,
        why_omitted: |_| "no effect reads them and no normal needs a substitute".into(),
    }),
    constants: &[("HAS_PLANES", |key, _| flag(key.surface.has_planes))],
    ..Feature::NONE
};

const COLORS: Feature = Feature {
    label: |key| word_if(key.vertices.has_colors, "colors"),
    part: Some(Part {
        name: "vertex colors",
        is_used: |key| key.vertices.has_colors,
        why_omitted: |_| "no primitive has them".into(),
    }),
    constants: &[("HAS_COLORS", |key, _| flag(key.vertices.has_colors))],
    ..Feature::NONE
};

const ATTRIBUTES: Feature = Feature {
    constants: &[("IS_AFFINE", |key, _| {
        flag(key.options.perspective == Perspective::Affine)
    })],
    ..Feature::NONE
};

const MATERIAL_ATLAS: Feature = Feature {
    label: |key| word_if(key.surface.has_material_atlas, "material_atlas"),
    part: Some(Part {
        name: "material atlas",
        is_used: |key| key.surface.has_material_atlas,
        why_omitted: |_| "no material is more than a base color".into(),
    }),
    variants: &[
        ("shade_step", |key, _| {
            step_if(key.surface.has_material_atlas, "textures")
        }),
        ("shade_step", |key, _| {
            step_if(
                key.surface.has_material_atlas && key.surface.has_alpha,
                "alpha",
            )
        }),
    ],
    ..Feature::NONE
};

const FINISH: Feature = Feature {
    label: |key| word_if(key.surface.has_finish, "finish"),
    part: Some(Part {
        name: "finish",
        is_used: |key| key.surface.has_finish,
        why_omitted: |_| "no effect reads how materials reflect".into(),
    }),
    variants: &[("shade_step", |key, _| {
        step_if(key.surface.has_finish, "finish")
    })],
    ..Feature::NONE
};

const FINISH_MAPS: Feature = Feature {
    label: |key| word_if(key.surface.has_finish_maps, "finish_maps"),
    part: Some(Part {
        name: "finish maps",
        is_used: |key| key.surface.has_finish_maps,
        why_omitted: |needs| match needs.finish_maps {
            0 => "no texture tells how a material reflects".into(),
            _ => "no effect reads how materials reflect".into(),
        },
    }),
    variants: &[("shade_step", |key, _| {
        step_if(key.surface.has_finish_maps, "finish_maps")
    })],
    ..Feature::NONE
};

const TRANSMISSION: Feature = Feature {
    label: |key| word_if(key.surface.has_transmission, "transmission"),
    part: Some(Part {
        name: "transmission",
        is_used: |key| key.surface.has_transmission,
        why_omitted: |needs| match needs.transmitting {
            0 => "no material lets light through".into(),
            _ => "nothing is seen through glass".into(),
        },
    }),
    variants: &[("shade_step", |key, _| {
        step_if(key.surface.has_transmission, "transmission")
    })],
    ..Feature::NONE
};

const NORMAL_MAPS: Feature = Feature {
    label: |key| word_if(key.surface.has_normal_maps, "normal_maps"),
    part: Some(Part {
        name: "normal maps",
        is_used: |key| key.surface.has_normal_maps,
        why_omitted: |needs| match needs.normal_maps {
            0 => "no texture turns normals".into(),
            _ => "no effect reads normals".into(),
        },
    }),
    variants: &[("shade_step", |key, _| {
        step_if(key.surface.has_normal_maps, "normal_map")
    })],
    ..Feature::NONE
};

const MASK: Feature = Feature {
    label: |key| word_if(key.samples.has_mask, "mask"),
    part: Some(Part {
        name: "mask",
        is_used: |key| key.samples.has_mask,
        why_omitted: |_| "no texture's alpha discards samples".into(),
    }),
    ..Feature::NONE
};

const PUNCTUAL_LIGHTS: Feature = Feature {
    label: |key| match key.surface.lights {
        0 => String::new(),
        lights => format!("lights={lights}"),
    },
    part: Some(Part {
        name: "lights of the scene",
        is_used: |key| key.surface.lights > 0,
        why_omitted: |needs| match needs.lights {
            0 => "the scene brings none".into(),
            _ => "no effect is lit by them".into(),
        },
    }),
    constants: &[("PUNCTUAL_LIGHTS", |key, _| key.surface.lights.into())],
    ..Feature::NONE
};

const PANORAMA: Feature = Feature {
    label: |key| word_if(key.surface.has_panorama, "panorama"),
    part: Some(Part {
        name: "picture of the surroundings",
        is_used: |key| key.surface.has_panorama,
        why_omitted: |needs| match needs.has_panorama {
            false => "the scene has none".into(),
            true => "no effect shows it".into(),
        },
    }),
    variants: &[("surroundings", |key, _| {
        if key.surface.has_panorama {
            "picture"
        } else {
            "formulas"
        }
    })],
    ..Feature::NONE
};

const LIGHT: Feature = Feature {
    variants: &[
        ("shade_step", |key, _| {
            step_if(key.reads_light(), "shadow_map")
        }),
        ("shadow_map", |key, _| {
            if key.work.buffered_shadow_map {
                "buffer"
            } else {
                "texture"
            }
        }),
    ],
    constants: &[
        ("SHADOW_TAPS_SIDE", |key, _| {
            key.options.shadow_taps.side().into()
        }),
        ("MAX_SHADOW_SLOPE", |_, _| MAX_SHADOW_SLOPE),
    ],
    ..Feature::NONE
};

const DOTS: Feature = Feature {
    label: |key| word_if(key.effects.dots.is_some(), "dots"),
    part: Some(Part {
        name: "dots",
        is_used: |key| key.effects.dots.is_some(),
        why_omitted: |_| "no effect draws dots".into(),
    }),
    variants: &[
        ("finish_step", |key, _| {
            step_if(key.effects.dots.is_some(), "dots")
        }),
        ("dot_segments", |key, _| {
            if key.effects.dots == Some(LineSource::Polyline) {
                "polyline"
            } else {
                "edges"
            }
        }),
        ("dot_list", |key, _| {
            if key.options.dot_culling == DotCulling::Brute {
                "all"
            } else {
                "listed"
            }
        }),
    ],
    ..Feature::NONE
};

const IMAGE_EFFECTS: Feature = Feature {
    label: |key| word_if(key.finishes_pixels(), "image"),
    part: Some(Part {
        name: "image effects",
        is_used: KernelKey::finishes_pixels,
        why_omitted: |_| "no effect of the stack finishes pixels".into(),
    }),
    variants: &[("finish_step", |key, _| {
        step_if(key.finishes_pixels(), "effects")
    })],
    ..Feature::NONE
};

const IMAGE_PASSES: Feature = Feature {
    label: |key| word_if(key.has_passes(), "passes"),
    part: Some(Part {
        name: "image passes",
        is_used: KernelKey::has_passes,
        why_omitted: |_| "no effect of the stack has passes over the finished picture".into(),
    }),
    variants: &[
        ("image_pass", |_, pass| match pass {
            Pass::Image(number) => NUMBERS[usize::from(number)],
            _ => NO_STEP,
        }),
        ("image_store", |key, pass| match key.image_step(pass) {
            Some(step) if step.target.is_some() => "between",
            Some(_) => "finished",
            None => NO_STEP,
        }),
    ],
    constants: &[
        ("IMAGE_SCALE", |key, pass| {
            key.image_step(pass).map_or(1.0, |step| step.scale.into())
        }),
        ("IMAGE_LAST_SCALE", |key, pass| {
            key.image_step(pass)
                .map_or(1.0, |step| step.last_scale.into())
        }),
        ("IMAGE_KEPT_SCALE", |key, _| {
            key.kept_pass().map_or(1.0, |pass| pass.scale.into())
        }),
    ],
};

const RENDER_SCALE: Feature = Feature {
    constants: &[("SCALE_SIDE", |key, _| {
        key.options.render_scale.factor().max(1.0)
    })],
    ..Feature::NONE
};

const EFFECTS: Feature = Feature {
    label: |key| {
        let scope = |effect| {
            key.effects
                .scope(effect)
                .map_or_else(String::new, |bit| format!("@{bit}"))
        };
        key.effects
            .list
            .iter()
            .map(|effect| format!("+{}{}", effect.name, scope(effect)))
            .collect::<Vec<_>>()
            .join(" ")
    },
    part: Some(Part {
        name: "effects uniform",
        is_used: |key| !key.effects.list.is_empty(),
        why_omitted: |_| "the stack is empty".into(),
    }),
    ..Feature::NONE
};
