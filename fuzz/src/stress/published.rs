//! Published fixtures of fill rules, whose answers share no code with this project.

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, equal},
    context::CaseContext,
    scenes::{pixel_view, scene_of_meshes, triangle_soup},
};

pub const CASES: &[Case] = &[Case {
    number: 3,
    name: "d3d-snap",
    about: "positions halfway between two units snap to the even one",
    expectation: Expectation::Exact,
    run: d3d_snap,
}];

/// Direct3D 11.3 functional specification, "coordinate snapping": 16.8 fixed point, to the nearest
/// and ties to even.
fn d3d_snap(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let ties: Vec<i32> = (-6..6).chain([2047, 2048, 8190, 16_381, 32_766]).collect();
    // Halves of units, exact in f32 and through the matrix.
    let half = |unit: i32| (unit as f32 + 0.5) / 256.0;
    let even = |unit: i32| if unit % 2 == 0 { unit } else { unit + 1 };
    let corners: Vec<[f32; 3]> = ties
        .iter()
        .flat_map(|&k| {
            [
                [half(k), half(k), 0.5],
                [40.0 + half(k), 3.0, 0.5],
                [3.0, 40.0 + half(k), 0.5],
            ]
        })
        .collect();
    let scene = scene_of_meshes(&[triangle_soup(corners)]);
    let capture = context.exact_on_all(&scene, &pixel_view(128, 128), "ties of the snap")?;
    for (vertex, tie) in capture
        .geometry
        .vertices
        .as_chunks::<3>()
        .0
        .iter()
        .zip(ties)
    {
        let found = [
            [vertex[0].x, vertex[0].y],
            [vertex[1].x, vertex[1].y],
            [vertex[2].x, vertex[2].y],
        ];
        let expected = [
            [even(tie); 2],
            [40 * 256 + even(tie), 3 * 256],
            [3 * 256, 40 * 256 + even(tie)],
        ];
        equal(&found, &expected, &format!("{tie} and a half units"))?;
    }
    Ok(())
}
