//! Light views: the orthographic view from a directional light in which its shadow map is drawn.
//! The matrices are f64, and renderers and the oracle start from the same bits.

use glam::{DVec2, DVec3};

use super::{
    bounds::Bounds,
    camera::{Camera, Projection},
    model::Scene,
    pose::Pose,
    view::{SceneState, View, ViewPrecision},
};

/// Empty texels along every border: half the widest filter, and one for rounding.
const BORDER: f64 = 3.0;

/// The view from a light in direction `toward` (a unit vector that points to the light) of `scene`
/// as `view` shows it: a square orthographic picture of the shadow casters' box, grown by
/// `reach_m`, the largest displacement by effects in meters.
///
/// The side of the square is rounded up to 1/32 of a power of two and its position to whole texels,
/// so that shadows do not flicker while their casters move slowly.
pub fn light_view(toward: DVec3, scene: &Scene, view: &View, max_displacement_m: f64) -> View {
    let at_rest = if view.scene_state.pose.is_none() {
        Pose::at_rest(scene)
    } else {
        None
    };
    let (pose, shadow_casters) = (
        view.scene_state.pose.as_deref().or(at_rest.as_ref()),
        scene.shadow_casters(),
    );
    let mut bounds = pose.map_or_else(
        || scene.bounds_of(shadow_casters),
        |pose| pose.bounds_of(scene, shadow_casters),
    );
    if bounds.is_empty() {
        bounds = Bounds {
            min: DVec3::ZERO,
            max: DVec3::ZERO,
        };
    }
    // Of a scene that does not move, the casters are all of it.
    let content = match scene.rig.is_empty() {
        true => bounds,
        false => scene.content_bounds(),
    };
    (bounds.min, bounds.max) = (
        bounds.min - max_displacement_m,
        bounds.max + max_displacement_m,
    );
    let axes = Axes::of(toward);
    let corners = bounds
        .corners()
        .map(|corner| axes.plane(view.scene_state.world_from_scene.transform_point3(corner)));
    let low = corners.into_iter().fold(DVec2::INFINITY, DVec2::min);
    let high = corners.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
    let side = view.precision.shadow.side.max(16);
    let needed_m = (high - low)
        .max_element()
        .max(1e-3 * bounds.radius())
        .max(1e-6);
    let side_m = rounded_up(needed_m * f64::from(side) / (f64::from(side) - 2.0 * BORDER));
    let texel_m = side_m / f64::from(side);
    // Whole texels from the scene, where it does not stand about the origin.
    let anchor = Scene::mesh_origin(&content, content.center(), content.radius());
    let anchor = anchor - view.scene_state.origin;
    let origin = axes.plane(anchor);
    let middle = origin + (((low + high) * 0.5 - origin) / texel_m).round() * texel_m;
    let eye = axes.right * middle.x + axes.up * middle.y + toward * toward.dot(anchor);
    let projection = Projection::Orthographic { height_m: side_m };
    let camera = Camera {
        eye,
        target: eye - toward,
        up: axes.up,
        projection,
        near_m: 1.0,
    };
    let light = View::new(
        &camera,
        side,
        side,
        &bounds,
        view.scene_state.world_from_scene,
        [0.0; 4],
    );
    View {
        scene_state: SceneState {
            pose: view.scene_state.pose.clone(),
            origin: view.scene_state.origin,
            ..light.scene_state.clone()
        },
        picture_from_world: Some(view.clip_from_world),
        precision: ViewPrecision {
            subpixel_bits: light.precision.subpixel_bits,
            ..view.precision
        },
        ..light
    }
}

/// Rounded up to a multiple of 1/32 of the power of two above it.
fn rounded_up(length: f64) -> f64 {
    let step = libm::exp2(libm::ceil(libm::log2(length)) - 5.0);
    (length / step).ceil() * step
}

/// Two unit vectors perpendicular to a direction and to each other.
struct Axes {
    right: DVec3,
    up: DVec3,
}

impl Axes {
    fn of(toward: DVec3) -> Self {
        // A vertical light has no natural up direction.
        let vertical = if toward.y.abs() > 0.999_999 {
            DVec3::NEG_Z
        } else {
            DVec3::Y
        };
        let right = vertical.cross(toward).normalize();
        Self {
            right,
            up: toward.cross(right),
        }
    }

    fn plane(&self, point: DVec3) -> DVec2 {
        DVec2::new(self.right.dot(point), self.up.dot(point))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{builtin, shadow_resolution::ShadowResolution};

    #[test]
    fn every_corner_of_the_scene_lies_inside_the_map_and_its_border_is_empty() {
        let scene = builtin::build("knot?tess=4").unwrap();
        for side in [256, 1024, 4096] {
            for toward in [
                DVec3::Y,
                DVec3::NEG_Y,
                DVec3::X,
                DVec3::new(0.3, 0.9, -0.2).normalize(),
                DVec3::new(1e-9, 1.0, 0.0),
            ] {
                let picture = View::new(
                    &Camera::default(),
                    8,
                    8,
                    &scene.bounds(),
                    glam::DMat4::IDENTITY,
                    [0.0; 4],
                );
                let picture = picture.with_shadow(ShadowResolution { side, taps: 3 });
                let light = light_view(toward, &scene, &picture, 0.0);
                let border = 1.0 - 2.0 * (BORDER - 1.0) / f64::from(side);
                for corner in scene.bounds().corners() {
                    let clip = light.clip_from_world * corner.extend(1.0);
                    assert!(
                        clip.x.abs() <= border
                            && clip.y.abs() <= border
                            && (0.0..=1.0).contains(&clip.z),
                        "{toward}: {clip}"
                    );
                }
                assert!((light.forward + toward).length() < 1e-9, "{toward}");
            }
        }
    }

    #[test]
    fn a_scene_that_creeps_keeps_its_texels() {
        let toward = DVec3::new(0.4, 0.8, 0.3).normalize();
        let scene = builtin::build("sphere?triangles=500").unwrap();
        let picture = View::new(
            &Camera::default(),
            8,
            8,
            &scene.bounds(),
            glam::DMat4::IDENTITY,
            [0.0; 4],
        );
        let phase = |shift: f64| {
            let mut moved = picture.clone();
            moved.scene_state.world_from_scene = glam::DMat4::from_translation(DVec3::X * shift);
            let light = light_view(toward, &scene, &moved, 0.0);
            let texels = (light.clip_from_world * DVec3::ZERO.extend(1.0))
                .truncate()
                .truncate()
                * 0.5
                * f64::from(light.width);
            (texels - texels.round()).abs().max_element()
        };
        for step in 0..20 {
            assert!(
                phase(f64::from(step) * 0.000_37) < 1e-6,
                "the grid slides with the scene"
            );
        }
    }
}
