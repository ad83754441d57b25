//! Views: a camera, a picture size and a scene's bounds as the matrices that a renderer needs, in
//! f64.

use std::sync::Arc;

use glam::{DMat4, DVec3, DVec4};

use super::{
    background::Background,
    bounds::Bounds,
    camera::{Camera, Projection},
    model::Scene,
    particle_discs::ParticleTimeline,
    pose::Pose,
    punctual::PlacedLight,
    shadow_resolution::ShadowResolution,
};
use crate::math::{SUBPIXEL_BITS, view_from_world};

/// A camera, the size of the picture that it takes, and the moment and the precision in which it
/// takes it: all that a renderer needs beside a scene and a stack.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Size of the picture in pixels; either may be 0.
    pub width: u32,
    pub height: u32,
    pub clip_from_world: DMat4,
    /// World space, meters.
    pub eye: DVec3,
    /// Unit vector along the viewing direction, world space.
    pub forward: DVec3,
    /// The world-space vectors of one unit of normalized device x and y: per meter of depth for a
    /// perspective.
    pub ndc_axes: [DVec3; 2],
    /// Meters at depth 1 and at depth 0 of a linear (orthographic) depth; none for a perspective,
    /// whose w is meters.
    pub linear_depth_m: Option<[f64; 2]>,
    /// Nearest and farthest distance along `forward` of the scene's box; in a perspective not
    /// nearer than the near plane.
    pub depth_range_m: [f64; 2],
    /// The same of what the scene shows without a ground: the range over which effects shade.
    pub content_depth_m: [f64; 2],
    /// What pixels without a triangle show.
    pub background: Background,
    /// Positions in the picture for which this view, a light's, draws a shadow map; none in a
    /// picture itself. A light sees back faces too, since they stop it as well.
    pub picture_from_world: Option<DMat4>,
    pub scene_state: SceneState,
    pub precision: ViewPrecision,
}

/// How the scene stands at the moment of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneState {
    /// Placement of the whole scene: its spin, about the point from which the world counts.
    pub world_from_scene: DMat4,
    /// The point of the scene from which the world of the picture counts, so that patterns in the
    /// world are the same wherever a model lies.
    pub origin: DVec3,
    /// The pose of its nodes, joints and morph targets; none: the rest pose.
    pub pose: Option<Arc<Pose>>,
    /// The lights that come with the scene, where they are.
    pub lights: Arc<[PlacedLight]>,
    /// The preset's own line for dots, in the scene before its spin.
    pub polyline: Arc<[[f32; 3]]>,
    /// The steps that particles have taken; none: they are where they begin.
    pub particles: Option<Arc<ParticleTimeline>>,
}

impl SceneState {
    /// Placement of what does not spin: walls.
    pub fn world_from_walls(&self) -> DMat4 {
        // Not the negative, which is -0 of 0.
        DMat4::from_translation(DVec3::ZERO - self.origin)
    }

    /// Placement of particles, which spin with the scene and count from the same point as the world.
    pub fn world_from_particles(&self) -> DMat4 {
        self.world_from_scene * DMat4::from_translation(self.origin)
    }
}

/// How finely a view resolves positions and shadows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewPrecision {
    /// Vertices snap to 2^-bits px: 4, 8 (the default) or 12.
    pub subpixel_bits: u32,
    /// Positions are taken relative to the eye before they meet a matrix.
    pub is_relative: bool,
    pub shadow: ShadowResolution,
}

impl Default for ViewPrecision {
    fn default() -> Self {
        Self {
            subpixel_bits: SUBPIXEL_BITS,
            is_relative: false,
            shadow: ShadowResolution::default(),
        }
    }
}

impl View {
    /// The view of `camera` with `width` x `height` pixels, given the scene's world-space box
    /// before its spin.
    pub fn new(
        camera: &Camera,
        width: u32,
        height: u32,
        bounds: &Bounds,
        world_from_scene: DMat4,
        background: impl Into<Background>,
    ) -> Self {
        let aspect = if height == 0 || width == 0 {
            1.0
        } else {
            f64::from(width) / f64::from(height)
        };
        let forward = camera.forward();
        let [nearest, farthest] = distances_m(camera, bounds, &world_from_scene);
        let margin = margin_m([nearest, farthest]);
        let (clip_from_view, linear_depth_m) = match camera.projection {
            Projection::Perspective { fov_y_deg } => {
                let focal = 1.0 / libm::tan(fov_y_deg.to_radians() * 0.5);
                (infinite_reverse(focal / aspect, focal, camera.near_m), None)
            }
            Projection::Orthographic { height_m } => {
                let (near, far) = (nearest - margin, farthest + margin);
                let y = 2.0 / height_m;
                (
                    orthographic_reverse(y / aspect, y, near, far),
                    Some([near, far]),
                )
            }
        };
        let clip_from_world =
            clip_from_view * view_from_world(camera.eye, camera.target, camera.up);
        // A row of the matrix is an axis times its scale, so the inverse axis is the row over its
        // squared length.
        let ndc_axes = [0, 1]
            .map(|i| clip_from_world.row(i).truncate())
            .map(|row| row / row.length_squared());
        let depth_range_m = depth_range_m(camera, [nearest, farthest]);
        Self {
            width,
            height,
            clip_from_world,
            eye: camera.eye,
            forward,
            ndc_axes,
            linear_depth_m,
            depth_range_m,
            content_depth_m: depth_range_m,
            background: background.into(),
            picture_from_world: None,
            scene_state: SceneState {
                world_from_scene,
                ..SceneState::default()
            },
            precision: ViewPrecision::default(),
        }
    }

    /// The same view, in which effects shade over the depths of another box than the scene's.
    #[must_use]
    pub fn with_content(self, camera: &Camera, bounds: &Bounds) -> Self {
        let distances = distances_m(camera, bounds, &self.scene_state.world_from_scene);
        Self {
            content_depth_m: depth_range_m(camera, distances),
            ..self
        }
    }

    /// Units of snapped positions in a pixel.
    pub const fn units_per_pixel(&self) -> i32 {
        1 << self.precision.subpixel_bits
    }

    /// The same view in `factor` times as many pixels to a side, at least one.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let side = |side: u32| {
            if side == 0 {
                0
            } else {
                (f64::from(side) * factor)
                    .ceil()
                    .min(f64::from(u32::MAX))
                    .max(1.0) as u32
            }
        };
        Self {
            width: side(self.width),
            height: side(self.height),
            ..self.clone()
        }
    }

    /// The same view with everything moved by a part of a pixel, to the right and down.
    #[must_use]
    pub fn shifted(&self, [right, down]: [f64; 2]) -> Self {
        let shift = DVec4::new(
            2.0 * right / f64::from(self.width),
            -2.0 * down / f64::from(self.height),
            0.0,
            1.0,
        );
        let clip_from_world =
            DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::Z, shift) * self.clip_from_world;
        Self {
            clip_from_world,
            ..self.clone()
        }
    }

    /// The same view on another grid of snapped positions, relative to the eye or not.
    #[must_use]
    pub fn with_grid(&self, subpixel_bits: u32, is_relative: bool) -> Self {
        Self {
            precision: ViewPrecision {
                subpixel_bits,
                is_relative,
                ..self.precision
            },
            ..self.clone()
        }
    }

    /// The same view with shadows of another resolution.
    #[must_use]
    pub fn with_shadow(&self, shadow: ShadowResolution) -> Self {
        Self {
            precision: ViewPrecision {
                shadow,
                ..self.precision
            },
            ..self.clone()
        }
    }

    /// Distance from the eye along `forward`, in meters, of a reversed depth above 0.
    pub fn depth_m(&self, depth: f64) -> f64 {
        match self.linear_depth_m {
            Some([near, far]) => far + depth * (near - far),
            // The third row of the matrix is (0, 0, 0, near).
            None => self.clip_from_world.w_axis.z / depth,
        }
    }

    /// The transform of an instance of `scene`, in its pose if it has one.
    pub fn world_from_instance(&self, scene: &Scene, index: usize, pose: Option<&Pose>) -> DMat4 {
        let (state, instance) = (&self.scene_state, &scene.instances[index]);
        let own = pose.map_or(instance.world_from_object, |pose| {
            pose.instance_transform(index)
        });
        if index >= scene.instances.len() - scene.walls {
            state.world_from_walls() * own
        } else if Some(instance.primitive) == scene.particle_discs {
            state.world_from_particles() * own
        } else {
            state.world_from_scene * own
        }
    }

    /// Is it a light's view?
    pub const fn is_light(&self) -> bool {
        self.picture_from_world.is_some()
    }

    /// Pixels of the picture.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }
}

/// Nearest and farthest distance of a box from the eye along the viewing direction, meters.
fn distances_m(camera: &Camera, bounds: &Bounds, world_from_scene: &DMat4) -> [f64; 2] {
    let forward = camera.forward();
    let distances = bounds
        .corners()
        .map(|c| (world_from_scene.transform_point3(c) - camera.eye).dot(forward));
    let (nearest, farthest) = distances
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(n, f), d| {
            (n.min(*d), f.max(*d))
        });
    if bounds.is_empty() || !(nearest.is_finite() && farthest.is_finite()) {
        [camera.near_m, camera.near_m + 1.0]
    } else {
        [nearest, farthest]
    }
}

fn margin_m([nearest, farthest]: [f64; 2]) -> f64 {
    ((farthest - nearest) * 0.01)
        .max(1e-3 * farthest.abs())
        .max(1e-6)
}

fn depth_range_m(camera: &Camera, distances: [f64; 2]) -> [f64; 2] {
    let from = match camera.projection {
        Projection::Perspective { .. } => distances[0].max(camera.near_m),
        Projection::Orthographic { .. } => distances[0],
    };
    [from, distances[1].max(from + margin_m(distances))]
}

/// z_c = near, w_c = -z_view: depth is near / w, 1 on the near plane and 0 at infinity.
fn infinite_reverse(x: f64, y: f64, near: f64) -> DMat4 {
    DMat4::from_cols(
        DVec4::X * x,
        DVec4::Y * y,
        DVec4::new(0.0, 0.0, 0.0, -1.0),
        DVec4::new(0.0, 0.0, near, 0.0),
    )
}

/// Depth falls linearly from 1 at `near` to 0 at `far`; w is 1.
fn orthographic_reverse(x: f64, y: f64, near: f64, far: f64) -> DMat4 {
    let depth = 1.0 / (far - near);
    DMat4::from_cols(
        DVec4::X * x,
        DVec4::Y * y,
        DVec4::Z * depth,
        DVec4::new(0.0, 0.0, far * depth, 1.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box() -> Bounds {
        Bounds {
            min: DVec3::NEG_ONE,
            max: DVec3::ONE,
        }
    }

    #[test]
    fn framing_shows_every_corner_of_the_box() {
        for (aspect, width, height) in [(2.0, 200, 100), (0.5, 100, 200)] {
            let camera = Camera::framing(&unit_box(), DVec3::new(-1.0, -0.5, -2.0), aspect);
            let view = View::new(
                &camera,
                width,
                height,
                &unit_box(),
                DMat4::IDENTITY,
                [0.0; 4],
            );
            for corner in unit_box().corners() {
                let clip = view.clip_from_world * corner.extend(1.0);
                assert!(
                    clip.x.abs() < clip.w && clip.y.abs() < clip.w && clip.z < clip.w,
                    "{clip}"
                );
            }
        }
    }

    #[test]
    fn orthographic_depth_runs_from_one_to_zero_through_the_scene() {
        let camera = Camera {
            projection: Projection::Orthographic { height_m: 4.0 },
            ..Camera::default()
        };
        let view = View::new(&camera, 64, 64, &unit_box(), DMat4::IDENTITY, [0.0; 4]);
        let depths = unit_box()
            .corners()
            .map(|c| (view.clip_from_world * c.extend(1.0)).z);
        assert!(depths.iter().all(|d| (0.0..=1.0).contains(d)), "{depths:?}");
    }
}
