//! What a camera frames: a few points of the surface, with about the convex hull of all its
//! triangles, found once for each clip.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};

use glam::{DMat4, DVec3};

use super::{
    bounds::Bounds,
    model::Scene,
    pose::{Motion, Pose},
};

/// Most vertices that are looked at, of all poses together.
const MAX_VERTICES: usize = 200_000;
/// Farther places cannot be drawn (`DrawError::Matrix`), nor can those that are not finite.
const MAX_PLACE_M: f64 = (1u64 << 40) as f64;
/// Directions in which the farthest points are kept.
const DIRECTIONS: usize = 256;
/// Places that are looked at in all directions before the next ones.
const BLOCK: usize = 1024;
/// Times of a clip at which the scene is looked at.
const TIMES: usize = 8;
/// A part is a sheet if it is so flat, as a fraction of its width.
const THIN: f64 = 0.03;
/// A sheet is left out if it is so many times as wide as all that stands on it.
const DOMINATES: f64 = 2.0;

/// The points of a scene for each clip, as far as they have been asked for. Two are always equal.
#[derive(Debug, Default)]
pub struct FramingPoints(Mutex<BTreeMap<Option<usize>, Arc<[DVec3]>>>);

impl Clone for FramingPoints {
    fn clone(&self) -> Self {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        Self(Mutex::new(known.clone()))
    }
}

impl PartialEq for FramingPoints {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Scene {
    /// The points that a camera frames, before the scene's spin: of the rest pose, or of a clip
    /// from its begin to its end. Ground and walls of the preset do not count, nor does a thin
    /// sheet that is much wider than all that stands on it. Empty for an empty scene.
    pub fn framing_points(&self, clip: Option<usize>) -> Arc<[DVec3]> {
        let known = &self.framing.0;
        let lock = || known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(points) = lock().get(&clip) {
            return points.clone();
        }
        let points: Arc<[DVec3]> = hull(without_sheets(&parts(self, clip))).into();
        lock().insert(clip, points.clone());
        points
    }

    /// The box that the lengths of a look are measured by: [`Scene::content_bounds`], but only what
    /// stands on a sheet where [`Scene::framing_points`] of `clip` leave that out.
    pub fn subject_bounds(&self, clip: Option<usize>) -> Bounds {
        let all = self.content_bounds();
        let framed = bounds_of(self.framing_points(clip).iter());
        if framed.is_empty() || all.radius() < DOMINATES * framed.radius() {
            all
        } else {
            framed
        }
    }
}

/// The places of each instance's corners, in all poses.
fn parts(scene: &Scene, clip: Option<usize>) -> Vec<Vec<DVec3>> {
    let count = scene.instances.len() - scene.walls - scene.grounds;
    let instances = &scene.instances[..count];
    let duration_s = clip
        .and_then(|clip| scene.rig.clips.get(clip))
        .map_or(0.0, |clip| clip.duration_s);
    let times = if clip.is_some() { TIMES } else { 1 };
    let poses: Vec<Option<Pose>> = (0..times)
        .map(|time| {
            let motion = Motion {
                clip,
                time_s: duration_s * time as f64 / times as f64,
                ..Motion::default()
            };
            (!scene.rig.is_empty()).then(|| Pose::at(scene, &motion))
        })
        .collect();
    let corners =
        |index: usize| 3 * scene.primitives[instances[index].primitive].triangle_count() as usize;
    let all: usize = (0..count).map(corners).sum();
    let stride = (all * times).div_ceil(MAX_VERTICES).max(1);
    (0..count)
        .filter(|&index| Some(instances[index].primitive) != scene.particle_discs)
        .map(|index| {
            let primitive = &scene.primitives[instances[index].primitive];
            let mut places = Vec::new();
            for pose in &poses {
                let transform = pose.as_ref().map_or_else(
                    || instances[index].world_from_object,
                    |pose| pose.instance_transform(index),
                );
                let deform = pose.as_ref().and_then(|pose| pose.deform(index));
                // A part has at least its first triangle.
                for corner in (0..corners(index)).step_by(stride) {
                    let vertex = primitive.corners(scene, corner as u32 / 3)[corner % 3];
                    let position = deform.map_or_else(
                        || DVec3::from(primitive.position(scene, vertex).map(f64::from)),
                        |deform| deform.position(scene, primitive, vertex),
                    );
                    let place = transform.transform_point3(position);
                    if place.abs().max_element() < MAX_PLACE_M {
                        places.push(place);
                    }
                }
            }
            places
        })
        .collect()
}

fn bounds_of<'a>(places: impl IntoIterator<Item = &'a DVec3>) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    places.into_iter().for_each(|place| bounds.include(*place));
    bounds
}

fn width(bounds: &Bounds) -> f64 {
    let extent = bounds.max - bounds.min;
    extent.x.max(extent.z)
}

/// All places but those of sheets that dominate.
fn without_sheets(parts: &[Vec<DVec3>]) -> Vec<DVec3> {
    let is_sheet = |part: &&Vec<DVec3>| {
        let bounds = bounds_of(*part);
        bounds.max.y - bounds.min.y <= THIN * width(&bounds)
    };
    let rest = bounds_of(parts.iter().filter(|part| !is_sheet(part)).flatten());
    let size = (rest.max - rest.min).max_element();
    let dominates = |width: f64, size: f64| size > 0.0 && width >= DOMINATES * size;
    let kept: Vec<DVec3> = parts
        .iter()
        .filter(|part| !(is_sheet(part) && dominates(width(&bounds_of(*part)), size)))
        .flatten()
        .copied()
        .collect();
    // A sheet that is one part with what stands on it.
    let all = bounds_of(&kept);
    let top = all.min.y + THIN * (all.max.y - all.min.y);
    let standing: Vec<DVec3> = kept.iter().filter(|place| place.y > top).copied().collect();
    let above = bounds_of(&standing);
    if standing.len() < 3 || !dominates(width(&all), (above.max - above.min).max_element()) {
        return kept;
    }
    let feet = standing.iter().map(|place| place.with_y(all.min.y));
    standing.iter().copied().chain(feet).collect()
}

/// The farthest of the places in many directions, which are about the corners of their hull.
fn hull(places: Vec<DVec3>) -> Vec<DVec3> {
    if places.len() <= DIRECTIONS {
        return places;
    }
    let golden = 1.0 / 1.618_033_988_749_895;
    let direction = |i: usize| {
        let y = 1.0 - (2 * i + 1) as f64 / DIRECTIONS as f64;
        let turns = (i as f64 * golden).fract();
        let turned = DMat4::from_rotation_y(turns * std::f64::consts::TAU);
        turned.transform_vector3(DVec3::new((1.0 - y * y).sqrt(), y, 0.0))
    };
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| [axis, -axis]);
    let directions = (0..DIRECTIONS).map(direction).chain(axes.concat());
    let mut found: Vec<(DVec3, DVec3)> = directions.map(|axis| (axis, places[0])).collect();
    // Block by block, since all places are more than a cache holds.
    for block in places.chunks(BLOCK) {
        for (axis, farthest) in &mut found {
            let mut most = farthest.dot(*axis);
            for place in block {
                let along = place.dot(*axis);
                if along.total_cmp(&most).is_ge() {
                    (most, *farthest) = (along, *place);
                }
            }
        }
    }
    let mut found: Vec<DVec3> = found.into_iter().map(|(_, farthest)| farthest).collect();
    found.dedup();
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{
        builtin,
        camera::{Camera, FILLED, FRAMED, Frame},
        mesh_builder::MeshBuilder,
        model::Instance,
        view::View,
    };

    const DIRECTION: DVec3 = DVec3::new(-0.45, -0.42, -1.0);

    /// Width and height of the picture's part that all corners of `scene` fill, pixels.
    fn filled(
        scene: &Scene,
        points: &[DVec3],
        [width, height]: [u32; 2],
        frame: fn(f64) -> Frame,
    ) -> [f64; 2] {
        let camera = Camera::around(
            points,
            DIRECTION,
            frame(f64::from(width) / f64::from(height)),
        );
        let view = View::new(
            &camera,
            width,
            height,
            &scene.bounds(),
            DMat4::IDENTITY,
            [0.0; 4],
        );
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for place in parts(scene, None).concat() {
            let clip = view.clip_from_world * place.extend(1.0);
            let at = [
                clip.x / clip.w * f64::from(width),
                clip.y / clip.w * f64::from(height),
            ];
            for axis in 0..2 {
                low[axis] = low[axis].min(at[axis] / 2.0);
                high[axis] = high[axis].max(at[axis] / 2.0);
            }
        }
        [high[0] - low[0], high[1] - low[1]]
    }

    #[test]
    fn a_framed_scene_fills_four_fifths_of_the_smaller_side() {
        for query in [
            "teapot?tess=4",
            "knot?tess=8",
            "walker?tess=1",
            "sphere?triangles=9000",
        ] {
            let scene = builtin::build(query).expect("a scene");
            for size in [[320, 240], [240, 320], [1920, 1080]] {
                let [across, down] =
                    filled(&scene, &scene.framing_points(None), size, Frame::square);
                let part = across.max(down) / f64::from(size[0].min(size[1]));
                assert!(
                    (part / FRAMED - 1.0).abs() < 0.02,
                    "{query} {size:?}: {part}"
                );
            }
        }
    }

    #[test]
    fn a_framed_model_fills_the_picture_however_flat_or_tall_it_is() {
        for stretch in [
            DVec3::ONE,
            DVec3::new(6.0, 0.5, 6.0),
            DVec3::new(0.3, 4.0, 0.3),
        ] {
            let mut scene = builtin::build("sphere?triangles=9000").expect("a scene");
            for instance in &mut scene.instances {
                instance.world_from_object = DMat4::from_scale(stretch);
            }
            scene.framing = FramingPoints::default();
            for size in [[320, 240], [240, 320], [1920, 1080]] {
                let [across, down] =
                    filled(&scene, &scene.framing_points(None), size, Frame::whole);
                let part = (across / f64::from(size[0])).max(down / f64::from(size[1]));
                assert!(
                    (part / FILLED - 1.0).abs() < 0.02,
                    "{stretch} {size:?}: {part}"
                );
            }
        }
    }

    #[test]
    fn a_wide_sheet_under_a_thing_is_not_framed() {
        let alone = builtin::build("sphere?triangles=500").expect("a scene");
        let bounds = alone.bounds();
        let mut scene = alone.clone();
        let mut mesh = MeshBuilder::default();
        let corner = |x: f64, z: f64| DVec3::new(x * 40.0, bounds.min.y, z * 40.0);
        mesh.quad(
            [
                corner(-1.0, 1.0),
                corner(1.0, 1.0),
                corner(1.0, -1.0),
                corner(-1.0, -1.0),
            ],
            [0.1; 3],
        );
        scene.materials.push(Default::default());
        let material = scene.materials.len() - 1;
        let primitive = mesh.append(&mut scene, "sheet", material);
        scene
            .instances
            .push(Instance::fixed(primitive, DMat4::IDENTITY));
        scene.framing = FramingPoints::default();
        let [with, without] =
            [&scene, &alone].map(|scene| bounds_of(scene.framing_points(None).iter()));
        assert_eq!(with, without);
        assert_eq!(scene.subject_bounds(None), without);
        assert_eq!(alone.subject_bounds(None), bounds);
        // As one part, too.
        let merged = without_sheets(&[parts(&scene, None).concat()]);
        assert!(width(&bounds_of(&merged)) <= width(&without) * 1.001);
        // Alone it is what is shown.
        assert_eq!(without_sheets(&[parts(&scene, None).remove(1)]).len(), 6);
    }
}
