//! Camera moves: pure functions of a pose. Every result is finite for any input.

use glam::DVec3;

use crate::scene::camera::{Camera, Frame, MIN_NEAR_M, Projection};

/// Range of the distance between eye and target, meters: keeps poses below the 2^40 that the
/// kernels' arithmetic allows.
const DISTANCE_M: [f64; 2] = [1e-5, 1e8];

/// Largest coordinate of a target that is panned, meters.
const MAX_COORDINATE_M: f64 = 1e8;

/// Least angle between the direction of view and straight up or down, radians. Beyond the pole,
/// left and right would swap.
const POLE_RAD: f64 = 1e-3;

/// Directions of view of the numbered views.
pub const FRONT: DVec3 = DVec3::NEG_Z;
pub const SIDE: DVec3 = DVec3::NEG_X;
pub const TOP: DVec3 = DVec3::NEG_Y;

fn distance(camera: &Camera) -> f64 {
    let distance = (camera.eye - camera.target).length();
    if distance.is_finite() {
        distance.clamp(DISTANCE_M[0], DISTANCE_M[1])
    } else {
        1.0
    }
}

/// True if every coordinate of the pose is finite.
pub fn is_finite(camera: &Camera) -> bool {
    camera.eye.is_finite() && camera.target.is_finite() && camera.up.is_finite()
}

/// Right and up of the picture, unit vectors.
pub fn axes(camera: &Camera) -> (DVec3, DVec3) {
    let forward = camera.forward();
    let right = [camera.up, DVec3::Y, DVec3::X]
        .into_iter()
        .find_map(|up| forward.cross(up).try_normalize())
        .unwrap_or(DVec3::X);
    (right, right.cross(forward))
}

/// `forward` turned by angles about +y and up, kept off the poles.
fn turn_direction(forward: DVec3, yaw_rad: f64, pitch_rad: f64) -> DVec3 {
    let limit = std::f64::consts::FRAC_PI_2 - POLE_RAD;
    let yaw = if forward.x == 0.0 && forward.z == 0.0 {
        yaw_rad
    } else {
        forward.x.atan2(-forward.z) + yaw_rad
    };
    let pitch = (forward.y.clamp(-1.0, 1.0).asin() + pitch_rad).clamp(-limit, limit);
    DVec3::new(
        yaw.sin() * pitch.cos(),
        pitch.sin(),
        -yaw.cos() * pitch.cos(),
    )
}

/// Turns the eye round the target; the picture moves right and down by these angles.
pub fn orbit(camera: &mut Camera, right_rad: f64, down_rad: f64) {
    let distance = distance(camera);
    camera.up = DVec3::Y;
    camera.eye = camera.target - turn_direction(camera.forward(), right_rad, -down_rad) * distance;
}

/// Turns the view round the eye.
pub fn turn(camera: &mut Camera, right_rad: f64, down_rad: f64) {
    let distance = distance(camera);
    camera.up = DVec3::Y;
    camera.target = camera.eye + turn_direction(camera.forward(), right_rad, -down_rad) * distance;
}

/// Shifts the picture by `right` and `down`, in heights of the picture.
pub fn pan(camera: &mut Camera, right: f64, down: f64) {
    let height_m = match camera.projection {
        Projection::Perspective { fov_y_deg } => {
            2.0 * distance(camera) * (fov_y_deg.to_radians() * 0.5).tan()
        }
        Projection::Orthographic { height_m } => height_m,
    };
    let (x, y) = axes(camera);
    shift(camera, (y * down - x * right) * height_m);
}

/// Moves eye and target together by meters right, up and forward.
pub fn fly(camera: &mut Camera, right_m: f64, up_m: f64, forward_m: f64) {
    let (x, y) = axes(camera);
    shift(
        camera,
        x * right_m + y * up_m + camera.forward() * forward_m,
    );
}

fn shift(camera: &mut Camera, by: DVec3) {
    let target = camera.target + by;
    if target.is_finite() && target.abs().max_element() <= MAX_COORDINATE_M {
        camera.target = target;
        camera.eye += by;
    }
}

/// Scales the distance to the target (and the height of an orthographic view); below 1 comes
/// closer.
pub fn zoom(camera: &mut Camera, factor: f64) {
    let factor = if factor.is_finite() {
        factor.clamp(0.1, 10.0)
    } else {
        1.0
    };
    let to = (distance(camera) * factor).clamp(DISTANCE_M[0], DISTANCE_M[1]);
    camera.eye = camera.target - camera.forward() * to;
    // Otherwise the near plane would cut off what the eye comes close to.
    camera.near_m = camera.near_m.min(to * 0.05).max(MIN_NEAR_M);
    if let Projection::Orthographic { height_m } = &mut camera.projection {
        *height_m = (*height_m * factor).clamp(DISTANCE_M[0], DISTANCE_M[1]);
    }
}

/// Looks at the target along `direction` from the same distance; where it does already, from the other
/// side.
pub fn look_along(camera: &mut Camera, mut direction: DVec3) {
    let distance = distance(camera);
    if camera.forward().dot(direction) > 1.0 - 1e-9 {
        direction = -direction;
    }
    camera.up = if direction.y.abs() > 0.999 {
        DVec3::NEG_Z
    } else {
        DVec3::Y
    };
    camera.eye = camera.target - direction * distance;
}

/// Switches between perspective and orthographic; an object at the target keeps its size.
pub fn toggle_orthographic(camera: &mut Camera) {
    let distance = distance(camera);
    camera.projection = match camera.projection {
        Projection::Perspective { fov_y_deg } => Projection::Orthographic {
            height_m: 2.0 * distance * (fov_y_deg.to_radians() * 0.5).tan(),
        },
        Projection::Orthographic { height_m } => {
            let fov_y_deg: f64 = 45.0;
            let away = height_m * 0.5 / (fov_y_deg.to_radians() * 0.5).tan();
            camera.eye =
                camera.target - camera.forward() * away.clamp(DISTANCE_M[0], DISTANCE_M[1]);
            camera.near_m = camera.near_m.min(away * 0.05).max(MIN_NEAR_M);
            Projection::Perspective { fov_y_deg }
        }
    };
}

/// The pose with the same direction and projection that frames `points`.
pub fn framing(camera: &Camera, points: &[DVec3], frame: Frame) -> Camera {
    let mut framed = Camera::around(points, camera.forward(), frame);
    framed.up = camera.up;
    if matches!(camera.projection, Projection::Orthographic { .. }) {
        let ((right, up), [across, down]) = (axes(&framed), frame.filled(1.0));
        let reach = points
            .iter()
            .map(|point| *point - framed.target)
            .map(|from| (from.dot(right).abs() / across).max(from.dot(up).abs() / down))
            .fold(0.0, f64::max);
        let reach = if reach > 0.0 { reach } else { 1.0 };
        framed.projection = Projection::Orthographic {
            height_m: 2.0 * reach,
        };
    }
    framed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: DVec3::new(1.0, 2.0, 5.0),
            target: DVec3::new(0.0, 0.5, 0.0),
            ..Camera::default()
        }
    }

    #[test]
    fn orbit_keeps_distance_and_target() {
        let mut moved = camera();
        orbit(&mut moved, 0.7, -0.4);
        assert_eq!(moved.target, camera().target);
        assert!((distance(&moved) - distance(&camera())).abs() < 1e-12);
        orbit(&mut moved, -0.7, 0.4);
        assert!((moved.eye - camera().eye).length() < 1e-12);
    }

    #[test]
    fn orbit_stops_at_the_poles() {
        let mut moved = camera();
        orbit(&mut moved, 0.0, 100.0);
        assert!(moved.forward().y < -0.999_99 && moved.eye.is_finite());
        let (right, _) = axes(&moved);
        assert!((right.y).abs() < 1e-9 && right.is_finite());
    }

    #[test]
    fn pan_moves_a_point_at_the_target_with_the_pointer() {
        let mut moved = camera();
        pan(&mut moved, 0.5, 0.0);
        let (right, _) = axes(&camera());
        let height = 2.0 * distance(&camera()) * 22.5f64.to_radians().tan();
        assert!(((camera().target - moved.target).dot(right) - height * 0.5).abs() < 1e-12);
    }

    #[test]
    fn zoom_out_and_in_for_ever_stays_finite() {
        let mut moved = camera();
        for factor in [9.0, 0.11] {
            (0..500).for_each(|_| zoom(&mut moved, factor));
            assert!(
                moved.eye.is_finite() && moved.near_m >= MIN_NEAR_M && distance(&moved) > 0.0,
                "{moved:?}"
            );
        }
    }

    #[test]
    fn orthographic_and_back_is_the_same_pose() {
        let mut moved = camera();
        toggle_orthographic(&mut moved);
        toggle_orthographic(&mut moved);
        assert!(
            (moved.eye - camera().eye).length() < 1e-9 && moved.projection == camera().projection
        );
    }

    #[test]
    fn top_view_is_not_degenerate() {
        let mut moved = camera();
        look_along(&mut moved, TOP);
        let (right, up) = axes(&moved);
        assert!((right - DVec3::X).length() < 1e-12 && (up - DVec3::NEG_Z).length() < 1e-12);
        for direction in [FRONT, SIDE, TOP] {
            for side in [1.0, -1.0] {
                look_along(&mut moved, direction);
                assert!((moved.forward() - side * direction).length() < 1e-12);
            }
        }
    }
}
