//! Geometry features: vertex formats, generated vertices, vertex effects, culling and clipping.

use super::feature::{Feature, Part, flag, step_if, variant_if, word_if};
use crate::{
    accuracy::{Clipping, Culling, PositionFormat, VertexTransform},
    frame::vertex_flags,
    scene::meshlets::MESHLET_TRIANGLES,
    shader::{
        key::{AttributeFormat, Fetch, KernelKey, ProjectionKind},
        pass::{CullPhase, Pass},
    },
};

pub(super) const FEATURES: &[Feature] = &[
    PARTICLES,
    JOINTS,
    MORPH_TARGETS,
    DEFORMATION,
    VERTEX_EFFECTS,
    UNSHARED_VERTICES,
    CULLING,
    CLIPPING,
    VERTEX_FORMATS,
    TRANSFORM,
    PROJECTION,
    LIGHT_VIEW,
];

const PARTICLES: Feature = Feature {
    label: |key| word_if(key.generated.has_particles, "particles"),
    part: Some(Part {
        name: "particles",
        is_used: |key| key.generated.has_particles,
        why_omitted: |_| "no effect puts particles into the scene".into(),
    }),
    variants: &[
        ("curl", |key, _| key.options.curl_noise.name()),
        ("particle_state", |key, _| {
            key.options.particle_storage.name()
        }),
    ],
    ..Feature::NONE
};

const JOINTS: Feature = Feature {
    label: |key| word_if(key.generated.has_joints, "joints"),
    variants: &[("skinning", |key, _| {
        variant_if(key.generated.has_joints, key.options.skinning.name())
    })],
    ..Feature::NONE
};

const MORPH_TARGETS: Feature = Feature {
    label: |key| word_if(key.generated.has_morph_targets, "morph_targets"),
    variants: &[("morph_targets", |key, _| {
        variant_if(key.generated.has_morph_targets, "weighted")
    })],
    ..Feature::NONE
};

const DEFORMATION: Feature = Feature {
    part: Some(Part {
        name: "deform",
        is_used: KernelKey::deforms,
        why_omitted: |_| "no mesh has joints or morph targets".into(),
    }),
    ..Feature::NONE
};

const VERTEX_EFFECTS: Feature = Feature {
    label: |key| word_if(key.moves(), "vertex_effects"),
    part: Some(Part {
        name: "vertex effects",
        is_used: KernelKey::moves,
        why_omitted: |_| "no effect of the stack moves a vertex".into(),
    }),
    variants: &[
        ("vertex_effects", |key, _| {
            variant_if(key.moves(), "applied")
        }),
        ("corner_step", |key, _| {
            step_if(key.unshares_vertices(), "triangle")
        }),
    ],
    ..Feature::NONE
};

const UNSHARED_VERTICES: Feature = Feature {
    label: |key| word_if(key.unshares_vertices(), "unshared_vertices"),
    part: Some(Part {
        name: "unshared vertices",
        is_used: KernelKey::unshares_vertices,
        why_omitted: |_| {
            "no effect moves triangles apart, so neighbors share projected vertices".into()
        },
    }),
    variants: &[("vertex_records", |key, _| {
        variant_if(key.unshares_vertices(), "unshared")
    })],
    constants: &[("UNSHARES_VERTICES", |key, _| flag(key.unshares_vertices()))],
};

const CULLING: Feature = Feature {
    part: Some(Part {
        name: "culling",
        is_used: KernelKey::culls,
        why_omitted: |_| "culling = none, so each triangle is tested on its own".into(),
    }),
    variants: &[
        ("triangle_source", |key, _| match () {
            () if key.culls() => "meshlets",
            () => variant_if(key.draws_cloud(), "beside_points"),
        }),
        ("occlusion", |_, pass| match pass {
            Pass::Cull(CullPhase::PreviousFrame) => "previous_frame",
            Pass::Cull(CullPhase::Early) => "early",
            Pass::Cull(CullPhase::Late) => "late",
            _ => "default",
        }),
    ],
    constants: &[
        ("IS_TWO_PASS", |key, _| {
            flag(key.options.culling == Culling::TwoPass)
        }),
        ("COUNTS_CULLED", |_, pass| {
            flag(pass != Pass::Cull(CullPhase::Early))
        }),
        ("REOPENS_QUEUES", |_, pass| {
            flag(
                pass == Pass::AdvanceQueues {
                    reopens_queues: true,
                },
            )
        }),
        ("MESHLET_TRIANGLES", |_, _| MESHLET_TRIANGLES as f64),
    ],
    ..Feature::NONE
};

const CLIPPING: Feature = Feature {
    label: |key| word_if(key.paths.has_clipping, "clip"),
    part: Some(Part {
        name: "clip",
        is_used: |key| key.paths.has_clipping,
        why_omitted: |needs| match needs.clipping {
            true => "clipping = drop, so triangles that would be clipped are not drawn".into(),
            false => "the scene's box lies beyond the near plane and inside the guard band".into(),
        },
    }),
    variants: &[],
    constants: &[
        ("HAS_CLIPPING", |key, _| flag(key.paths.has_clipping)),
        // Flags of a corner for which a triangle is dropped instead of clipped.
        ("DROPPED_FLAGS", |key, _| match key.options.clipping {
            Clipping::Drop => vertex_flags::CLIPPED.into(),
            Clipping::Near => vertex_flags::NEAR.into(),
            Clipping::Exact => 0.0,
        }),
    ],
};

const VERTEX_FORMATS: Feature = Feature {
    label: |key| word_if(key.vertices.is_instanced, "instanced"),
    part: Some(Part {
        name: "index fetch",
        is_used: |key| key.vertices.fetch != Fetch::Direct,
        why_omitted: |_| "no primitive has indices".into(),
    }),
    variants: &[
        ("loads", |key, pass| match key.vertices.split {
            Some(_) => "split",
            None => variant_if(key.work.wide_loads && pass.resolves(), "wide"),
        }),
        ("corner_records", |key, _| {
            variant_if(key.work.projects_points, "projected")
        }),
        ("draw_records", |key, _| {
            variant_if(key.vertices.is_instanced, "instanced")
        }),
    ],
    constants: &[
        ("ONLY_TRIANGLE_LISTS", |key, _| {
            flag(key.vertices.only_triangle_lists)
        }),
        ("ONLY_POINTS", |key, _| flag(key.samples.only_points)),
        ("SPLIT_WORD", |key, _| {
            key.vertices.split.unwrap_or(0).into()
        }),
        ("HAS_INDICES", |key, _| {
            flag(key.vertices.fetch != Fetch::Direct)
        }),
        ("U32_INDICES", |key, _| {
            flag(key.vertices.fetch == Fetch::IndexedU32)
        }),
        ("F32_POSITIONS", |key, _| {
            flag(key.vertices.positions == AttributeFormat::F32)
        }),
        ("F32_NORMALS", |key, _| {
            flag(key.vertices.normals == AttributeFormat::F32)
        }),
        ("PACKED_POSITION_BITS", |key, _| {
            key.options
                .position_format
                .packed_bits()
                .unwrap_or(0)
                .into()
        }),
    ],
};

const TRANSFORM: Feature = Feature {
    variants: &[("projection", |key, _| {
        if key.options.vertex_transform == VertexTransform::Strict {
            "strict"
        } else {
            "float"
        }
    })],
    constants: &[
        ("IS_RELATIVE", |key, _| {
            flag(key.options.position_format == PositionFormat::Relative)
        }),
        ("FLOAT_VIEWPORT", |key, _| {
            flag(key.options.vertex_transform == VertexTransform::Viewport)
        }),
        ("GROUP_SIZE", |key, _| key.work.group_size.into()),
    ],
    ..Feature::NONE
};

const PROJECTION: Feature = Feature {
    label: |key| {
        word_if(
            key.view.projection == ProjectionKind::Orthographic,
            "orthographic",
        )
    },
    constants: &[("IS_PERSPECTIVE", |key, _| {
        flag(key.view.projection == ProjectionKind::Perspective)
    })],
    ..Feature::NONE
};

const LIGHT_VIEW: Feature = Feature {
    label: |key| word_if(key.view.is_light, "light"),
    constants: &[("IS_SHADOW_MAP", |key, _| flag(key.view.is_light))],
    ..Feature::NONE
};
