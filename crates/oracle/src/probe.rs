//! Why a sample shows what it shows: every triangle whose box holds it, with the integers that
//! decide.

use super::{
    arithmetic::depth_key::depth_key,
    render::{
        coverage::{EdgeAtSample, Sample},
        draw_order::limited,
        particles::{check_particles, scene_with_particles},
        sample_rules::{LeftOut, SampleTests},
        triangles::{OrientedTriangle, triangles},
    },
    shot::{Shot, drawn_view},
};
use crate::{
    effects::Stack,
    frame::{Geometry, SnappedVertex},
    scene::{
        Scene,
        draw::{Draw, DrawError},
        view::View,
    },
};

/// A sample with every triangle whose box holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbedSample {
    /// Column and row of its pixel in the drawn picture.
    pub pixel: [u32; 2],
    /// By rising id, which is the order of drawing.
    pub triangles: Vec<ProbedTriangle>,
    /// What follows: the nearest triangle, its key, the number of drawn layers.
    pub decided: Sample,
}

/// A triangle at a sample.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbedTriangle {
    /// Global id; a clipped triangle has its parent's.
    pub id: u32,
    /// Name of its primitive, for instance `mesh "Fox" primitive 0`.
    pub primitive: String,
    /// Wound clockwise on the screen.
    pub corners: [SnappedVertex; 3],
    /// It is one of the triangles into which clipping cut its parent.
    pub is_clipped: bool,
    /// The edges opposite the corners.
    pub edges: [EdgeAtSample; 3],
    /// Of a triangle that covers the sample, whether it is drawn or not.
    pub depth_key: Option<u32>,
    pub outcome: Outcome,
}

/// What becomes of a triangle at a sample.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It is the nearest: of equal keys the one with the smallest id.
    Shown,
    /// It is drawn, but another is nearer.
    Hidden,
    /// It does not cover the sample.
    Outside,
    /// It shows the back of a single-sided material.
    FacesAway,
    /// The draw order has ended before it.
    AfterDrawOrder,
    /// The sample lies outside the disc of a particle.
    OutsideDisc,
    /// The mask of its material cuts it out.
    CutByMask,
    /// The effect of this name leaves it out.
    LeftOutBy(String),
}

impl From<LeftOut<'_>> for Outcome {
    fn from(left_out: LeftOut<'_>) -> Self {
        match left_out {
            LeftOut::DrawOrder => Self::AfterDrawOrder,
            LeftOut::Disc => Self::OutsideDisc,
            LeftOut::Mask => Self::CutByMask,
            LeftOut::Effect(name) => Self::LeftOutBy(name.into()),
        }
    }
}

/// Looks into the samples of `pixels` (column and row in the drawn picture) of a picture that an
/// adapter or the oracle drew with this geometry, as a judge does; pixels outside the picture have
/// no triangles.
pub fn probe(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    geometry: &Geometry,
    pixels: &[[u32; 2]],
) -> Result<Vec<ProbedSample>, DrawError> {
    let (view, stack) = (&drawn_view(view, geometry), &stack.scaled(geometry.scale));
    let words = geometry
        .particle_readback
        .as_ref()
        .map(|readback| readback.words.as_slice());
    if words.is_none() {
        check_particles(view, stack)?;
    }
    let scene = &*scene_with_particles(scene, view, stack, words)?;
    let draws = stack.draws(scene, view)?;
    let shot = Shot::new(scene, &draws, view, stack);
    let (drawn, _) = triangles(&shot, geometry)?;
    let tests = limited(SampleTests::new(&shot, geometry), stack, &drawn, view)?;
    // By id and entry, as those that are drawn.
    let both_sided: Vec<Draw> = draws
        .iter()
        .map(|draw| Draw {
            double_sided: true,
            ..draw.clone()
        })
        .collect();
    let (all, _) = triangles(&Shot::new(scene, &both_sided, view, stack), geometry)?;
    let is_drawn = |triangle: &OrientedTriangle| {
        let key = |t: &OrientedTriangle| (t.id, t.entry);
        drawn.binary_search_by_key(&key(triangle), key).is_ok()
    };
    let sample = |&[x, y]: &[u32; 2]| {
        let (x, y) = (x as usize, y as usize);
        let mut decided = Sample::EMPTY;
        let near = all.iter().filter(|triangle| {
            let (columns, rows) = triangle.bounds(view, &tests);
            columns.contains(&x) && rows.contains(&y)
        });
        let mut probed: Vec<ProbedTriangle> = near
            .map(|triangle| {
                let edges = triangle.edges(x, y, tests.unit);
                let hit = triangle.covers(x, y, &edges, &tests);
                let outcome = match hit {
                    None => Outcome::Outside,
                    Some(_) if !is_drawn(triangle) => Outcome::FacesAway,
                    Some(hit) => {
                        let weights = edges.map(|edge| edge.value);
                        match tests.left_out_by(triangle, x as u32, y as u32, weights) {
                            Some(left_out) => left_out.into(),
                            None => {
                                decided.add(triangle.id, hit.depth);
                                Outcome::Hidden
                            }
                        }
                    }
                };
                let draw = shot
                    .draw_of(triangle.id)
                    .expect("a triangle belongs to a draw");
                ProbedTriangle {
                    id: triangle.id,
                    primitive: scene.primitives[draw.primitive].name.clone(),
                    corners: triangle.corners,
                    is_clipped: triangle.is_clipped(),
                    edges,
                    depth_key: hit.map(|hit| depth_key(hit.depth)),
                    outcome,
                }
            })
            .collect();
        if let Some(nearest) = probed.iter_mut().find(|triangle| {
            triangle.outcome == Outcome::Hidden
                && triangle.id == decided.triangle_id
                && triangle.depth_key == Some(decided.depth_key)
        }) {
            nearest.outcome = Outcome::Shown;
        }
        ProbedSample {
            pixel: [x as u32, y as u32],
            triangles: probed,
            decided,
        }
    };
    Ok(pixels.iter().map(sample).collect())
}
