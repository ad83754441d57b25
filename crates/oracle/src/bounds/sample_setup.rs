//! How far a float renderer may be from the center of a triangle, from which sample setups follow.

use super::{super::shot::Shot, deform};
use crate::effects::hooks::{ROUNDING, TriangleSetup};

/// The setup of a triangle with the bound of its center's error.
pub fn with_center_error(shot: &Shot, setup: TriangleSetup) -> TriangleSetup {
    let error = center_error_m(shot, setup.triangle);
    TriangleSetup {
        center_error_m: error.unwrap_or(f64::INFINITY),
        ..setup
    }
}

/// Bound along any axis, in meters; none for a triangle with a rejected corner.
fn center_error_m(shot: &Shot, id: u32) -> Option<f64> {
    let draw = shot.draw_of(id)?;
    let vertices =
        shot.scene.primitives[draw.primitive].corners(shot.scene, id - draw.first_triangle);
    let [Ok(a), Ok(b), Ok(c)] = vertices.map(|vertex| deform::position(shot.scene, draw, vertex))
    else {
        return None;
    };
    let m = draw.world_from_object;
    // Rounding errors are proportional to the sums of magnitudes, however much cancels.
    let magnitude = [a, b, c].map(|p| {
        let p = p.value.abs();
        (m.x_axis.abs() * p.x + m.y_axis.abs() * p.y + m.z_axis.abs() * p.z + m.w_axis.abs())
            .truncate()
            .max_element()
    });
    let deformed = [a, b, c].map(|p| {
        (m.x_axis.abs() * p.error.x + m.y_axis.abs() * p.error.y + m.z_axis.abs() * p.error.z)
            .max_element()
    });
    let largest = |values: [f64; 3]| values.into_iter().fold(0.0, f64::max);
    Some(8.0 * ROUNDING * largest(magnitude) + largest(deformed))
}
