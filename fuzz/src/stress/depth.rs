//! Depth: eleven decades, layers one key apart, and large ratios of w within a triangle.

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, equal},
    context::CaseContext,
    scenes::{pixel_view, scene_of_meshes, triangle_soup_in_units},
};
use crate::frame::NO_TRIANGLE;

pub const CASES: &[Case] = &[Case {
    number: 15,
    name: "coplanar-layers",
    about: "layers one depth key apart: the nearest wins; of equal keys the smaller id wins",
    expectation: Expectation::Exact,
    run: coplanar_layers,
}];

fn coplanar_layers(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let view = pixel_view(64, 64);
    let mut rng = context.rng(5);
    // Layers in random order, one float apart: small triangles, and large ones.
    for (what, corners) in [
        ("small", [[0, 0], [24 * 256, 0], [0, 24 * 256]]),
        ("large", [[-60_000, -90_000], [90_000, 0], [0, 90_000]]),
    ] {
        let mut steps: Vec<u32> = (0..40).chain(10..20).collect();
        rng.shuffle(&mut steps);
        let layers: Vec<_> = steps
            .iter()
            .map(|step| (corners, f32::from_bits(0.5f32.to_bits() + step)))
            .collect();
        let capture = context.exact_on_all(
            &scene_of_meshes(&[triangle_soup_in_units(&layers)]),
            &view,
            &format!("{what} layers"),
        )?;
        let nearest = steps
            .iter()
            .position(|&step| step == 39)
            .unwrap_or_default();
        let mut triangle_ids: Vec<u32> = capture
            .frame
            .triangle_id
            .iter()
            .copied()
            .filter(|&o| o != NO_TRIANGLE)
            .collect();
        triangle_ids.dedup();
        equal(
            &triangle_ids,
            &vec![nearest as u32],
            &format!("{what} layers: triangle ids"),
        )?;
        let top = 0.5f32.to_bits() + 39;
        check!(
            capture
                .frame
                .depth_key
                .iter()
                .all(|&key| key == 0 || key == top),
            "{what} layers: a depth key is not the nearest's"
        );

        // The nearest layer twice more: of equal keys the smaller id wins.
        let again: Vec<_> = layers
            .iter()
            .chain([&layers[nearest]; 2])
            .copied()
            .collect();
        let equals = context.exact_on_all(
            &scene_of_meshes(&[triangle_soup_in_units(&again)]),
            &view,
            &format!("equal {what} layers"),
        )?;
        check!(
            equals.frame.triangle_id == capture.frame.triangle_id,
            "equal {what} layers: a larger id wins"
        );
    }
    Ok(())
}
