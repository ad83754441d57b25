//! Vertex stage in f64: positions gated by their bits, projected, and snapped once to 1/256 px.

use rayon::prelude::*;

use super::{
    clip,
    deform::{self, place},
    moved::VertexEvaluator,
    strict::project_strict,
};
use crate::{
    effects::Stack,
    frame::{Exactness, Geometry, SnappedVertex, vertex_flags},
    math::GUARD_BAND,
    scene::{Accessor, ComponentType, Scene, draw::Draw, view::View},
};

/// Homogeneous clip-space position (WebGPU: y up, z from 0 to w, reversed).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clip {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

/// [`project_moved`] with no effect that moves anything.
pub fn project(scene: &Scene, draws: &[Draw], view: &View) -> Geometry {
    project_moved(scene, draws, view, &Stack::default())
}

/// Everything between the stored scene and integer coverage: one record per vertex of each draw, or three per triangle
/// where the stack parts them, and the pieces of every triangle that the near plane or the guard band cuts, folded ones
/// included.
pub fn project_moved(scene: &Scene, draws: &[Draw], view: &View, stack: &Stack) -> Geometry {
    let movers: Vec<VertexEvaluator> = draws.iter().map(|draw| VertexEvaluator::new(scene, draw, view, stack)).collect();
    let snapped = |vertex_evaluator: &VertexEvaluator| {
        let snapped = |corner| match vertex_evaluator.clip(corner) {
            Ok(position) => snap(&position, view),
            Err(flags) => SnappedVertex { flags, ..Default::default() },
        };
        vertex_evaluator.corners().into_par_iter().map(snapped).collect::<Vec<_>>()
    };
    let vertices = movers.iter().flat_map(snapped).collect();
    let deformed = draws.iter().flat_map(|draw| deform::vertices(scene, draw)).collect();
    let (has_unshared_vertices, subpixel_bits) = (stack.unshares_vertices(), view.precision.subpixel_bits);
    let particle_discs = scene.particle_disc_ids();
    let mut geometry = Geometry { vertices, has_unshared_vertices, deformed, particle_discs, subpixel_bits, ..Geometry::default() };
    let pieces = |vertex_evaluator: &VertexEvaluator| {
        clip::pieces(scene, vertex_evaluator.draw, view, &geometry, |corner| {
            vertex_evaluator.clip(corner).expect("a cut triangle has no rejected corner")
        })
    };
    geometry.pieces = movers.iter().flat_map(pieces).collect();
    geometry
}

/// The geometry that one with such promises is held against.
pub(super) fn project_as(exact: Exactness, scene: &Scene, draws: &[Draw], view: &View, stack: &Stack) -> Geometry {
    let geometry = if exact.vertices { project_strict(scene, draws, view) } else { project_moved(scene, draws, view, stack) };
    Geometry { exact, ..geometry }
}

/// Value of an f32 by its bits: subnormals are 0; NaN, infinities and magnitudes of 2^40 or more are refused with the
/// flag that says why.
pub(super) fn gate(bits: u32) -> Result<f64, u32> {
    match bits >> 23 & 255 {
        255 => Err(vertex_flags::NONFINITE),
        167.. => Err(vertex_flags::OUT_OF_RANGE),
        0 => Ok(0.0),
        _ => Ok(f32::from_bits(bits).into()),
    }
}

/// A lane of any attribute through the [`gate`]; integers always pass.
pub(super) fn gated_lane(bytes: &[u8], accessor: &Accessor, element: u32, lane: u32) -> Result<f64, u32> {
    match accessor.component_type {
        ComponentType::F32 => gate(accessor.f32_bits(bytes, element, lane)),
        _ => Ok(accessor.value(bytes, element, lane)),
    }
}

/// Clip-space position of a vertex of `draw` before any effect, from the bits of its rounded matrix.
pub(super) fn clip_position(scene: &Scene, draw: &Draw, vertex: u32) -> Result<Clip, u32> {
    let [x, y, z] = (place(scene, draw, vertex)? - draw.origin()).to_array();
    let row = |r: usize| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|column| f64::from(draw.clip_from_object[column][r]));
        a * x + b * y + c * z + d
    };
    Ok(Clip { x: row(0), y: row(1), z: row(2), w: row(3) })
}

/// The record of a vertex: flags alone in front of the near plane, otherwise position, depth and 1/w.
///
/// The rounding is relative to the centre of the picture and to even, so mirror images snap to mirror images.
pub(super) fn snap(position: &Clip, view: &View) -> SnappedVertex {
    if position.z <= position.w && position.w > 0.0 {
        snap_inside(position, view)
    } else {
        SnappedVertex { flags: vertex_flags::NEAR, ..Default::default() }
    }
}

/// The record of a position that the near plane keeps.
pub(super) fn snap_inside(&Clip { x, y, z, w }: &Clip, view: &View) -> SnappedVertex {
    let [half_x, half_y] = half_size(view);
    let offset = |ndc: f64, half: i32| (ndc * f64::from(half)).round_ties_even().clamp(-16_777_216.0, 16_777_216.0) as i32;
    placed(half_x + offset(x / w, half_x), half_y - offset(y / w, half_y), (z / w) as f32, (1.0 / w) as f32)
}

/// A record with its guard flags.
pub(super) fn placed(x: i32, y: i32, depth: f32, inv_w: f32) -> SnappedVertex {
    let beyond = [x < -GUARD_BAND, x > GUARD_BAND, y < -GUARD_BAND, y > GUARD_BAND];
    let flags = (0..4).filter(|&side| beyond[side]).fold(0, |flags, side| flags | vertex_flags::GUARD[side]);
    SnappedVertex { x, y, depth, inv_w, flags }
}

/// Half the picture in units: the place of its centre, and units per unit of NDC.
pub(super) fn half_size(view: &View) -> [i32; 2] {
    [view.width, view.height].map(|pixels| view.units_per_pixel() / 2 * pixels as i32)
}
