//! Picking: the nearest point of the scene under a position of the picture.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{
    draw::{Draw, draws},
    model::Scene,
    view::View,
};

/// The world-space point nearest to the eye on the ray through `screen` (0 to 1, right and down). `None` if the ray hits
/// nothing or the scene cannot be drawn. Effects are ignored, and both sides of triangles are hit.
pub fn pick(scene: &Scene, view: &View, screen: DVec2) -> Option<DVec3> {
    let ray = Ray::through(view, screen);
    let draws = draws(scene, view).ok()?;
    let nearest = draws.iter().filter_map(|draw| ray.nearest(scene, draw)).fold(f64::INFINITY, f64::min);
    nearest.is_finite().then(|| ray.from + ray.along * nearest)
}

/// Starts at the eye, or in the eye's plane where all rays are parallel.
struct Ray {
    from: DVec3,
    along: DVec3,
}

impl Ray {
    fn through(view: &View, screen: DVec2) -> Self {
        let aside = view.ndc_axes[0] * (2.0 * screen.x - 1.0) + view.ndc_axes[1] * (1.0 - 2.0 * screen.y);
        match view.linear_depth_m {
            None => Self { from: view.eye, along: view.forward + aside },
            Some(_) => Self { from: view.eye + aside, along: view.forward },
        }
    }

    /// Distance along the ray to the nearest triangle of a draw, in lengths of `along`.
    fn nearest(&self, scene: &Scene, draw: &Draw) -> Option<f64> {
        let primitive = &scene.primitives[draw.primitive];
        let corner = |vertex: u32| {
            let position = match &draw.deform {
                Some(deform) => deform.position(scene, primitive, vertex),
                None => primitive.position(scene, vertex).map(f64::from).into(),
            };
            draw.world_from_object.transform_point3(position)
        };
        let hit = |triangle: u32| self.meets(primitive.corners(scene, triangle).map(corner));
        (0..primitive.triangle_count()).into_par_iter().filter_map(hit).reduce_with(f64::min)
    }

    /// Distance along the ray to a triangle (Möller and Trumbore 1997).
    fn meets(&self, [a, b, c]: [DVec3; 3]) -> Option<f64> {
        let (ab, ac) = (b - a, c - a);
        let across = self.along.cross(ac);
        let determinant = ab.dot(across);
        let from_a = self.from - a;
        let u = from_a.dot(across) / determinant;
        let turned = from_a.cross(ab);
        let v = self.along.dot(turned) / determinant;
        let t = ac.dot(turned) / determinant;
        // Comparisons with NaN, which a ray in the triangle's plane produces, are false.
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t.is_finite()).then_some(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat4;

    use crate::scene::{builtin, camera::Camera};

    #[test]
    fn the_middle_of_a_sphere_is_picked_in_front_of_its_center_and_its_corner_of_the_picture_is_empty() {
        let scene = builtin::build("sphere?triangles=2000").unwrap();
        let camera = Camera::framing(&scene.bounds(), DVec3::new(-0.4, -0.4, -1.0), 4.0 / 3.0);
        let view = View::new(&camera, 64, 48, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
        let point = pick(&scene, &view, DVec2::splat(0.5)).expect("something is there");
        let (near, far) = (view.eye.distance(point), view.eye.distance(scene.bounds().center()));
        assert!(near < far && point.distance(scene.bounds().center()) < scene.bounds().radius() * 1.01);
        // It projects to the position that was picked.
        let clip = view.clip_from_world * point.extend(1.0);
        assert!((clip.x / clip.w).abs() < 1e-9 && (clip.y / clip.w).abs() < 1e-9);
        assert_eq!(pick(&scene, &view, DVec2::ZERO), None);
    }
}
