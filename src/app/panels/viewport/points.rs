//! Points of effects in the picture: where a point is seen, and the point that a place in the
//! picture stands for.

use glam::{DMat4, DVec2, DVec3};

use crate::{
    app::editing::session::Session,
    effects::{Effect, particles},
    preset::Fit,
    scene::view::View,
};

/// From the point parameters of an effect to world space and back.
pub struct PointSpace {
    /// From the preset's unit to meters.
    fit: Option<Fit>,
    world_from_point: DMat4,
}

impl PointSpace {
    /// Particles turn with the scene; the points of other effects lie in world space.
    pub fn of(effect: &Effect, session: &Session, view: &View) -> Self {
        let is_of_scene = effect.name == particles::EFFECT.name;
        Self {
            fit: session.unit_fit(),
            world_from_point: if is_of_scene {
                view.scene_state.world_from_particles()
            } else {
                DMat4::IDENTITY
            },
        }
    }

    /// Where a value in the preset's unit lies, meters.
    pub fn world(&self, value: DVec3) -> DVec3 {
        self.world_from_point
            .transform_point3(self.fit.map_or(value, |fit| fit.point(value)))
    }

    /// The value of a point in world space.
    pub fn value(&self, world: DVec3) -> DVec3 {
        let point = self.world_from_point.inverse().transform_point3(world);
        self.fit.map_or(point, |fit| fit.inverse().point(point))
    }
}

/// Where a point in world space is seen: 0 to 1 right and down inside the picture. None if it is
/// not in front of the eye.
pub fn seen_at(view: &View, world: DVec3) -> Option<DVec2> {
    let clip = view.clip_from_world * world.extend(1.0);
    let ndc = DVec2::new(clip.x, -clip.y) / clip.w;
    (clip.w > 0.0 && ndc.is_finite()).then(|| (ndc + 1.0) * 0.5)
}

/// Where the ray through `uv` of the picture meets the plane through `through` that faces the
/// viewer; both points in world space. None if the plane is not in front of the eye.
pub fn facing_point(view: &View, through: DVec3, uv: DVec2) -> Option<DVec3> {
    let depth = (through - view.eye).dot(view.forward);
    let offset = view.ndc_axes[0] * (2.0 * uv.x - 1.0) + view.ndc_axes[1] * (1.0 - 2.0 * uv.y);
    let point = match view.linear_depth_m {
        None if depth <= 0.0 => return None,
        None => view.eye + (view.forward + offset) * depth,
        Some(_) => view.eye + offset + view.forward * depth,
    };
    Some(point).filter(|point| point.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{
        Bounds,
        camera::{Camera, Projection},
    };

    #[test]
    fn the_ray_through_a_point_that_is_seen_returns_that_point() {
        for projection in [
            Projection::Perspective { fov_y_deg: 50.0 },
            Projection::Orthographic { height_m: 3.0 },
        ] {
            let camera = Camera {
                eye: DVec3::new(1.0, 2.0, 5.0),
                target: DVec3::new(0.2, 0.0, 0.0),
                projection,
                ..Camera::default()
            };
            let bounds = Bounds {
                min: DVec3::NEG_ONE,
                max: DVec3::ONE,
            };
            let view = View::new(
                &camera,
                300,
                200,
                &bounds,
                crate::math::rotation_y(0.7),
                [0.0; 4],
            );
            let through = DVec3::new(0.3, -0.4, 0.1);
            let uv = seen_at(&view, through).expect("in front of the eye");
            let point = facing_point(&view, through, uv).expect("in front of the eye");
            assert!(point.distance(through) < 1e-9, "{projection:?}: {point}");
            let target = seen_at(&view, camera.target).expect("the camera looks at it");
            assert!(
                target.distance(DVec2::splat(0.5)) < 1e-9,
                "{projection:?}: {target}"
            );
        }
    }

    #[test]
    fn a_point_behind_the_eye_is_not_seen_and_not_dragged() {
        let camera = Camera {
            eye: DVec3::new(0.0, 0.0, 5.0),
            ..Camera::default()
        };
        let bounds = Bounds {
            min: DVec3::NEG_ONE,
            max: DVec3::ONE,
        };
        let view = View::new(&camera, 300, 200, &bounds, DMat4::IDENTITY, [0.0; 4]);
        let behind = DVec3::new(0.0, 0.0, 6.0);
        assert_eq!(
            (
                seen_at(&view, behind),
                facing_point(&view, behind, DVec2::splat(0.5))
            ),
            (None, None)
        );
    }

    #[test]
    fn a_value_in_radii_of_a_turned_scene_reads_back() {
        let bounds = Bounds {
            min: DVec3::new(1.0, 0.0, 0.0),
            max: DVec3::new(3.0, 1.0, 4.0),
        };
        for fit in [None, Fit::of_scene_unit(&bounds)] {
            let space = PointSpace {
                fit,
                world_from_point: crate::math::rotation_y(0.4),
            };
            let value = DVec3::new(0.2, 0.5, -0.7);
            assert!(space.value(space.world(value)).distance(value) < 1e-12);
        }
    }
}
