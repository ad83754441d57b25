//! Picking: the nearest point of the scene under a position of the picture.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{
    draw::{Draw, draws},
    model::Scene,
    view::View,
};

/// The world-space point nearest to the eye on the ray through `screen` (0 to 1, right and down).
/// `None` if the ray hits nothing or the scene cannot be drawn. Effects are ignored, and both sides
/// of triangles are hit.
pub fn pick(scene: &Scene, view: &View, screen: DVec2) -> Option<DVec3> {
    let ray = Ray::through(view, screen);
    let draws = draws(scene, view).ok()?;
    let nearest = draws
        .iter()
        .filter_map(|draw| ray.nearest(scene, draw, Sides::Both))
        .fold(f64::INFINITY, f64::min);
    nearest.is_finite().then(|| ray.from + ray.along * nearest)
}

/// The index of the instance that is seen at `screen` (0 to 1, right and down). `None` if nothing
/// is there or the scene cannot be drawn. Effects and alpha masks are ignored.
pub fn pick_instance(scene: &Scene, view: &View, screen: DVec2) -> Option<usize> {
    let ray = Ray::through(view, screen);
    let draws = draws(scene, view).ok()?;
    let hits = draws
        .iter()
        .enumerate()
        .filter_map(|(index, draw)| Some((index, ray.nearest(scene, draw, Sides::Drawn)?)));
    hits.min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(index, _)| index)
}

/// Which sides of triangles a ray hits.
#[derive(Clone, Copy, PartialEq)]
enum Sides {
    Both,
    /// Those that the draw shows.
    Drawn,
}

/// Starts at the eye, or in the eye's plane where all rays are parallel.
struct Ray {
    from: DVec3,
    along: DVec3,
    /// Side of a pixel at the eye and what a distance of 1 adds, meters.
    pixel_m: [f64; 2],
}

impl Ray {
    fn through(view: &View, screen: DVec2) -> Self {
        let aside =
            view.ndc_axes[0] * (2.0 * screen.x - 1.0) + view.ndc_axes[1] * (1.0 - 2.0 * screen.y);
        let pixel_m = view.ndc_axes[1].length() * 2.0 / f64::from(view.height.max(1));
        match view.linear_depth_m {
            None => Self {
                from: view.eye,
                along: view.forward + aside,
                pixel_m: [0.0, pixel_m],
            },
            Some(_) => Self {
                from: view.eye + aside,
                along: view.forward,
                pixel_m: [pixel_m, 0.0],
            },
        }
    }

    /// Distance along the ray to the nearest triangle of a draw, in lengths of `along`.
    fn nearest(&self, scene: &Scene, draw: &Draw, sides: Sides) -> Option<f64> {
        let primitive = &scene.primitives[draw.primitive];
        let corner = |vertex: u32| {
            let position = match &draw.deform {
                Some(deform) => deform.position(scene, primitive, vertex),
                None => primitive.position(scene, vertex).map(f64::from).into(),
            };
            draw.world_from_object.transform_point3(position)
        };
        let radius = f64::from(draw.point_radius_px);
        let hit = |triangle: u32| {
            if primitive.is_points() {
                return self.passes(corner(primitive.corners(scene, triangle)[0]), radius);
            }
            if primitive.is_lines() {
                let [a, _, b] = primitive.corners(scene, triangle).map(corner);
                return self.passes(self.nearest_of_segment(a, b), 0.0);
            }
            let (distance, is_front) =
                self.meets(primitive.corners(scene, triangle).map(corner))?;
            let is_shown = sides == Sides::Both || draw.double_sided || is_front != draw.mirrored;
            is_shown.then_some(distance)
        };
        (0..primitive.triangle_count())
            .into_par_iter()
            .filter_map(hit)
            .reduce_with(f64::min)
    }

    /// Distance along the ray to a point whose disc it meets, which is at least two pixels wide and
    /// has so many pixels as its radius at a distance of 1.
    fn passes(&self, point: DVec3, radius: f64) -> Option<f64> {
        let t = (point - self.from).dot(self.along) / self.along.length_squared();
        let [at_eye, further] = self.pixel_m;
        let reach = (radius * (at_eye + further)).max(at_eye + further * t);
        let aside = point - self.from - self.along * t;
        (t > 0.0 && aside.length_squared() <= reach * reach).then_some(t)
    }

    /// The point of a segment that is nearest to the ray's line.
    fn nearest_of_segment(&self, a: DVec3, b: DVec3) -> DVec3 {
        let (segment, to_a) = (b - a, a - self.from);
        let aside = |v: DVec3| v - self.along * (v.dot(self.along) / self.along.length_squared());
        let (across, from) = (aside(segment), aside(to_a));
        let t = -from.dot(across) / across.length_squared();
        a + segment
            * if t.is_finite() {
                t.clamp(0.0, 1.0)
            } else {
                0.0
            }
    }

    /// Distance along the ray to a triangle, and whether its corners run counterclockwise as seen
    /// from the ray's beginning (Möller and Trumbore 1997).
    fn meets(&self, [a, b, c]: [DVec3; 3]) -> Option<(f64, bool)> {
        let (ab, ac) = (b - a, c - a);
        let across = self.along.cross(ac);
        let determinant = ab.dot(across);
        let from_a = self.from - a;
        let u = from_a.dot(across) / determinant;
        let turned = from_a.cross(ab);
        let v = self.along.dot(turned) / determinant;
        let t = ac.dot(turned) / determinant;
        // Comparisons with NaN, which a ray in the triangle's plane produces, are false.
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t.is_finite())
            .then_some((t, determinant > 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat4;

    use crate::scene::{builtin, camera::Camera};

    #[test]
    fn the_middle_of_a_sphere_is_picked_in_front_of_its_center_and_its_corner_of_the_picture_is_empty()
     {
        let scene = builtin::build("sphere?triangles=2000").unwrap();
        let camera = Camera::framing(&scene.bounds(), DVec3::new(-0.4, -0.4, -1.0), 4.0 / 3.0);
        let view = View::new(&camera, 64, 48, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
        let point = pick(&scene, &view, DVec2::splat(0.5)).expect("something is there");
        let (near, far) = (
            view.eye.distance(point),
            view.eye.distance(scene.bounds().center()),
        );
        assert!(
            near < far && point.distance(scene.bounds().center()) < scene.bounds().radius() * 1.01
        );
        // It projects to the position that was picked.
        let clip = view.clip_from_world * point.extend(1.0);
        assert!((clip.x / clip.w).abs() < 1e-9 && (clip.y / clip.w).abs() < 1e-9);
        assert_eq!(pick(&scene, &view, DVec2::ZERO), None);
    }

    /// The rays through the centers of 12 x 12 pixels of a picture of 48 x 48.
    fn rays() -> impl Iterator<Item = DVec2> {
        (0..144).map(|i| DVec2::new(f64::from(i % 12) + 0.5, f64::from(i / 12) + 0.5) / 12.0)
    }

    #[test]
    fn the_instance_that_is_seen_is_picked_through_the_back_of_a_wall() {
        let scene = builtin::build("cube-wall?columns=2&rows=1")
            .unwrap()
            .in_room(1.0);
        // From outside the room, whose walls show their insides alone.
        let camera = Camera {
            eye: DVec3::new(0.0, 1.0, 12.0),
            target: DVec3::ZERO,
            ..Camera::default()
        };
        let view = View::new(&camera, 48, 48, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
        let mut picked = [0; 3];
        rays()
            .filter_map(|at| pick_instance(&scene, &view, at))
            .for_each(|index| picked[index] += 1);
        assert!(picked.iter().all(|&pixels| pixels > 0), "{picked:?}");
    }

    #[test]
    fn a_closed_mesh_is_picked_where_it_is_hit_and_so_is_its_mirror_image() {
        for x in [1.0, -1.0] {
            let mut scene = builtin::build("sphere?triangles=200").unwrap();
            scene.instances[0].world_from_object = DMat4::from_scale(DVec3::new(x, 1.0, 1.0));
            let camera = Camera::framing(&scene.bounds(), DVec3::NEG_Z, 1.0);
            let view = View::new(&camera, 48, 48, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
            let mut hits = 0;
            for at in rays() {
                assert_eq!(
                    pick_instance(&scene, &view, at).is_some(),
                    pick(&scene, &view, at).is_some(),
                    "{at}"
                );
                hits += usize::from(pick(&scene, &view, at).is_some());
            }
            assert!((40..140).contains(&hits), "{hits}");
        }
    }
}
