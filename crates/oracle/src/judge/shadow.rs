//! Judges the shadow map of an adapter, and measures how far its shadows are from traced ones.

use super::{
    super::{
        arithmetic::depth_key::key_fits,
        bounds::coverage::nearest_intervals,
        perturbation::Perturbation,
        render::{
            project::project,
            rays::Rays,
            sample_rules::SampleTests,
            shading::each_surface,
            shadow::{Light, leaves_samples_out},
            triangles::triangles,
            work_limits::check_samples,
        },
        shot::{Shot, drawn_view},
    },
    sample_setups::wrong_setups,
    vertices::{bounded_errors, count_vertices},
};
use crate::{
    effects::Stack,
    frame::{DepthRounding, Geometry, ShadowMap},
    measure::{ErrorReport, ShadowErrors},
    scene::{Scene, draw::DrawError, view::View},
};

/// Compares the depths of a shadow map with those of the adapter's own records, and these records
/// with their bounds.
///
/// # Panics
/// If the map is of another scene or stack.
pub fn judge_shadow_map(
    report: &mut ErrorReport,
    shot: &Shot,
    map: &ShadowMap,
) -> Result<(), DrawError> {
    let Some(view) = shot.stack.light_view(shot.scene, shot.view) else {
        return Ok(());
    };
    let is_relative = map.geometry.is_relative || view.precision.is_relative;
    let view = view.with_grid(view.precision.subpixel_bits, is_relative);
    let casting = shot.stack.shadow_casters();
    let draws = casting.draws(shot.scene, &view)?;
    let shot = Shot::new(shot.scene, &draws, &view, &casting);
    let own = project(&shot)?;
    assert_eq!(
        map.geometry.vertices.len(),
        own.vertices.len(),
        "the shadow map is of another scene or stack"
    );
    let (triangles, _) = triangles(&shot, &map.geometry)?;
    let tests = SampleTests::new(&shot, &map.geometry);
    check_samples("shadow map", &triangles, &tests, &view)?;
    let intervals = nearest_intervals(&tests, &triangles, &view)?;
    for (interval, &key) in intervals.iter().zip(&map.depth_keys) {
        let is_covered = interval[1] > f64::NEG_INFINITY;
        report.holes += u64::from(is_covered && key == 0);
        report.double_hits += u64::from(!is_covered && key != 0);
        report.key_outside_bound += u64::from(
            is_covered && key != 0 && !key_fits(key, &DepthRounding::default(), *interval),
        );
    }
    count_vertices(report, &bounded_errors(&shot, &map.geometry, &own)?);
    report.sample_setups_wrong += wrong_setups(&shot, &map.geometry);
    Ok(())
}

/// How far the light that arrives by the map of `geometry` is from what rays find, over all pixels
/// with a triangle that faces the light. None without a light, or if effects leave samples out, of
/// which rays know nothing.
pub fn shadow_errors(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    triangle_ids: &[u32],
    geometry: &Geometry,
) -> Result<Option<ShadowErrors>, DrawError> {
    let (view, stack) = (&drawn_view(view, geometry), &stack.scaled(geometry.scale));
    let draws = stack.draws(scene, view)?;
    let shot = Shot::new(scene, &draws, view, stack);
    let (Some(mapped), false) = (Light::of(&shot, geometry), leaves_samples_out(stack)) else {
        return Ok(None);
    };
    let (Some(rays), Some(light)) = (Rays::of(&shot), stack.light()) else {
        return Ok(None);
    };
    let toward = light.toward();
    let errors = each_surface(
        &shot,
        triangle_ids,
        geometry,
        &Perturbation::default(),
        |_, found| {
            let (triangle, surface) =
                found.filter(|(_, surface)| surface.normal.dot(toward) > 0.0)?;
            let point = triangle.lit_point(&surface);
            let reference = f64::from(u8::from(rays.reach(point.on_triangle, surface.triangle_id)));
            Some(mapped.arrives(&point, surface.triangle_id, 0.0) - reference)
        },
    )?;
    let errors: Vec<f64> = errors.into_iter().flatten().collect();
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    Ok(Some(ShadowErrors {
        pixels: errors.len() as u64,
        wrong: errors.iter().filter(|error| error.abs() > 0.5).count() as u64,
        rms: (squares / (errors.len() as f64).max(1.0)).sqrt(),
    }))
}
