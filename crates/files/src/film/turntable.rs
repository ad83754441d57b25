//! Turntables: one turn over the length of a film, without a change of the preset.

use std::f64::consts::TAU;

use crate::{
    math::rotation_y,
    preset::{Preset, turned_all_around},
    scene::{Bounds, Scene, camera::Camera},
};

/// What turns once about a vertical axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turntable {
    /// The camera goes around the point that it looks at; walls and light stay where they are in
    /// the scene.
    Camera,
    /// The scene turns about its own axis, in front of a camera and a light that stay.
    Scene,
}

impl Turntable {
    /// Turns `preset` to a moment of the film of the range `range_s`: `fraction` of one turn, from
    /// 0 to 1. The preset is at its time already; `around` is the automatic camera of the whole turn.
    pub fn turn(
        self,
        preset: &mut Preset,
        scene: &Scene,
        around: Option<Camera>,
        fraction: f64,
        range_s: [f64; 2],
    ) {
        match self {
            Self::Scene => preset.spin_deg_per_s += 360.0 / (range_s[1] - range_s[0]),
            Self::Camera => {
                let [width, height] = preset.output.size.map(|side| f64::from(side.max(1)));
                let camera = around.unwrap_or_else(|| preset.camera_for(scene, width / height));
                // Backwards, so that the scene seems to turn the way it does with a positive spin.
                let turn = rotation_y(-fraction.fract() * TAU);
                let eye = camera.target + turn.transform_vector3(camera.eye - camera.target);
                preset.camera = Some(Camera {
                    eye,
                    up: turn.transform_vector3(camera.up),
                    ..camera
                });
            }
        }
    }
}

/// The automatic camera from a distance that shows the scene from all sides; none if the preset or
/// the scene has a camera.
pub fn all_around(preset: &Preset, scene: &Scene) -> Option<Camera> {
    if preset.camera.is_some() || preset.camera_of(scene).is_some() {
        return None;
    }
    let [width, height] = preset.output.size.map(|side| f64::from(side.max(1)));
    let points = preset.framing_points(scene);
    let mut bounds = Bounds::EMPTY;
    points.iter().for_each(|point| bounds.include(*point));
    let center = bounds.center();
    let framed = Camera::around(
        &turned_all_around(&points, center),
        preset.looks_along(&points),
        preset.frame(width / height),
    );
    // The camera goes around the axis of the scene.
    let axis = center.with_y(framed.target.y);
    let around = Camera {
        eye: framed.eye + (axis - framed.target),
        target: axis,
        ..framed
    };
    Some(around.counted_from(preset.origin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    #[test]
    fn the_camera_goes_around_once_at_one_distance_and_shows_everything() {
        let scene = builtin::build("tentacle").expect("a built-in scene");
        let preset = Preset::default();
        let around = all_around(&preset, &scene).expect("the scene has no camera");
        let camera = |fraction: f64| {
            let mut turned = preset.clone();
            Turntable::Camera.turn(&mut turned, &scene, Some(around), fraction, [0.0, 1.0]);
            turned.camera.expect("a turntable has a camera")
        };
        let start = camera(0.0);
        assert_eq!(camera(1.0), start, "the film is a loop");
        assert!(
            camera(0.5).eye.distance(start.eye)
                > 1.9 * (start.eye - start.target).with_y(0.0).length()
        );
        for step in 0..16 {
            let camera = camera(f64::from(step) / 16.0);
            assert!(
                (camera.eye.distance(camera.target) - start.eye.distance(start.target)).abs()
                    < 1e-9
            );
            let view = crate::scene::view::View::new(
                &camera,
                320,
                240,
                &scene.bounds(),
                glam::DMat4::IDENTITY,
                [0.0; 4],
            );
            for point in preset.framing_points(&scene) {
                let clip = view.clip_from_world * point.extend(1.0);
                assert!(
                    clip.x.abs() < clip.w && clip.y.abs() < clip.w,
                    "step {step}: {clip}"
                );
            }
        }
    }

    #[test]
    fn the_scene_turns_once_over_the_range_on_top_of_its_own_spin() {
        let scene = builtin::build("teapot?tess=2").expect("a built-in scene");
        let own = Preset {
            spin_deg_per_s: 10.0,
            ..Preset::default()
        };
        let mut turned = own.clone();
        Turntable::Scene.turn(&mut turned, &scene, None, 0.25, [1.0, 3.0]);
        assert_eq!((turned.spin_deg_per_s, turned.camera), (190.0, None));
    }
}
