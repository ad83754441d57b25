//! The image hook: passes over the whole picture, each of which may read what the one before it
//! wrote.

use std::sync::Arc;

use glam::{DVec2, DVec3, DVec4};

use super::Picture;
use crate::scene::{panorama::Panorama, view::View};

/// Depth of a pixel that shows nothing, meters.
pub const EMPTY_DEPTH_M: f64 = 1e9;

/// Farthest place in pixels, either way, that a bilinear read tells from others.
const FARTHEST_PX: f64 = 65_536.0;

/// How much a depth in meters may be off in f32, as a fraction of it.
const DEPTH_ERROR: f64 = 1.0 / (1 << 21) as f64;

/// RGBA in linear light, row-major, top row first.
#[derive(Clone, Debug)]
pub struct Image {
    /// Width and height, pixels; both at least 1.
    pub size: [u32; 2],
    pub colors: Vec<DVec4>,
}

impl Image {
    /// The color of a pixel; for one outside, that of the nearest.
    pub fn at(&self, x: i64, y: i64) -> DVec4 {
        let [width, height] = self.size.map(i64::from);
        let (x, y) = (x.clamp(0, width - 1), y.clamp(0, height - 1));
        self.colors[(y * width + x) as usize]
    }

    /// The color at a place, pixels from the top left corner, between the middles of four pixels.
    /// Weights are whole multiples of 1/256; `step_offset`, a fraction of the place, moves it.
    pub fn between(&self, at: DVec2, step_offset: f64) -> DVec4 {
        let grid = |place: f64| {
            let place = place.clamp(-FARTHEST_PX, FARTHEST_PX);
            let moved = (place + step_offset * (place.abs() + 1.0)) * 256.0 + 0.5;
            moved.floor() as i64 - 128
        };
        let [x, y] = [grid(at.x), grid(at.y)];
        let (right, down) = ((x & 255) as f64 / 256.0, (y & 255) as f64 / 256.0);
        let row = |y: i64| {
            let near = self.at(x >> 8, y);
            near + (self.at((x >> 8) + 1, y) - near) * right
        };
        let upper = row(y >> 8);
        upper + (row((y >> 8) + 1) - upper) * down
    }
}

/// What depths and pixels are in meters.
#[derive(Clone, Copy, Debug)]
pub struct Lens {
    depth: DepthScale,
    /// Side of a pixel, per meter of depth in a perspective view.
    pixel_m: f64,
    /// The vectors whose dot products with what is seen are its NDC x and y, per meter of depth in a
    /// perspective view, and the viewing direction.
    axes: [DVec3; 3],
}

/// What a reversed depth is along the viewing direction.
#[derive(Clone, Copy, Debug)]
enum DepthScale {
    /// The distance of the near plane over the depth.
    Perspective { near_m: f64 },
    /// Meters at depth 1 and at depth 0, evenly between them.
    Linear([f64; 2]),
}

impl Lens {
    pub fn of(view: &View) -> Self {
        let depth = match view.linear_depth_m {
            Some(ends) => DepthScale::Linear(ends),
            None => DepthScale::Perspective {
                near_m: view.clip_from_world.w_axis.z,
            },
        };
        let pixel_m = view.ndc_axes[1].length() * 2.0 / f64::from(view.height.max(1));
        let [across, up] = view.ndc_axes.map(|axis| axis / axis.length_squared());
        Self {
            depth,
            pixel_m,
            axes: [across, up, view.forward],
        }
    }

    /// Meters, given a reversed depth; [`EMPTY_DEPTH_M`] of 0 and less.
    pub fn meters(self, depth: f64) -> f64 {
        match self.depth {
            _ if depth <= 0.0 => EMPTY_DEPTH_M,
            DepthScale::Perspective { near_m } => (near_m / depth.max(1e-30)).min(EMPTY_DEPTH_M),
            DepthScale::Linear([near_m, far_m]) => far_m + depth * (near_m - far_m),
        }
    }

    /// The unit normal, towards the viewer's side, of a plane whose reversed depth is `depth` at
    /// `place` in NDC, and rises by `slope` per unit of NDC.
    fn normal(self, depth: f64, place: DVec2, slope: DVec2) -> DVec3 {
        let [across, up, forward] = self.axes;
        let along = slope.x * across + slope.y * up;
        match self.depth {
            DepthScale::Linear([near_m, far_m]) => {
                ((near_m - far_m) * along - forward).normalize_or_zero()
            }
            DepthScale::Perspective { .. } => {
                -(along + (depth - place.dot(slope)) * forward).normalize_or_zero()
            }
        }
    }

    /// The unit vector from the eye to a place in NDC.
    fn direction(self, place: DVec2) -> DVec3 {
        let [across, up, forward] = self.axes;
        match self.depth {
            DepthScale::Linear(_) => forward,
            DepthScale::Perspective { .. } => {
                let [right, up] = [across, up].map(|axis| axis / axis.length_squared());
                (forward + right * place.x + up * place.y).normalize()
            }
        }
    }

    /// Side of a pixel at a depth, meters.
    pub fn pixel_size_m(self, depth_m: f64) -> f64 {
        match self.depth {
            DepthScale::Perspective { .. } => self.pixel_m * depth_m,
            DepthScale::Linear(_) => self.pixel_m,
        }
    }
}

/// In which direction every pixel errs, where a picture is drawn at the edge of what f32 may do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Signs {
    /// Nothing errs.
    #[default]
    None,
    Up,
    Down,
    /// Up and down by turns, across and down.
    Checkered,
}

impl Signs {
    pub const fn at(self, x: i64, y: i64) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Up => 1.0,
            Self::Down => -1.0,
            Self::Checkered => ((x + y) & 1) as f64 * 2.0 - 1.0,
        }
    }
}

/// What all pixels of a pass read.
pub struct PassInput<'a> {
    /// Triangle ids, depths and draws.
    pub picture: &'a Picture<'a>,
    pub lens: Lens,
    /// The picture as the effects before this one left it.
    pub source: &'a Image,
    /// What the pass before this one wrote; `source` in the first pass of an effect.
    pub last: &'a Image,
    /// What the kept pass of the effect wrote in the previous frame; none in the first one.
    pub kept: Option<&'a Image>,
    /// In which direction depths in meters err.
    pub signs: Signs,
    /// The picture of what surrounds the scene.
    pub panorama: Option<&'a Panorama>,
}

/// The pixel that a pass writes, and what it may read.
#[derive(Clone, Copy)]
pub struct ImageAt<'a> {
    pub x: i64,
    pub y: i64,
    /// Width and height of what the pass writes, pixels.
    pub size: [u32; 2],
    /// Pixels of the picture for one of these, along a side: 1, 2 or 4.
    pub scale: u32,
    /// As the `step_offset` of a surface.
    pub step_offset: f64,
    pub input: &'a PassInput<'a>,
}

impl ImageAt<'_> {
    /// Color of a pixel of the picture that the effect began with.
    pub fn color(&self, x: i64, y: i64) -> DVec4 {
        self.input.source.at(x, y)
    }

    /// The same at a place between pixels.
    pub fn color_at(&self, at: DVec2) -> DVec4 {
        self.input.source.between(at, self.step_offset / 128.0)
    }

    /// What the last pass wrote, by its own pixels.
    pub fn last(&self, x: i64, y: i64) -> DVec4 {
        self.input.last.at(x, y)
    }

    /// The same at a place between its pixels.
    pub fn last_at(&self, at: DVec2) -> DVec4 {
        self.input.last.between(at, self.step_offset / 128.0)
    }

    /// What the kept pass wrote in the previous frame, by its own pixels; zeros in the first one.
    pub fn kept(&self, x: i64, y: i64) -> DVec4 {
        self.input.kept.map_or(DVec4::ZERO, |kept| kept.at(x, y))
    }

    /// The same at a place between its pixels.
    pub fn kept_at(&self, at: DVec2) -> DVec4 {
        self.input.kept.map_or(DVec4::ZERO, |kept| {
            kept.between(at, self.step_offset / 128.0)
        })
    }

    /// Depth of a pixel of the picture along the viewing direction, meters; [`EMPTY_DEPTH_M`]
    /// where nothing is drawn.
    pub fn depth_m(&self, x: i64, y: i64) -> f64 {
        let (_, key, _) = self.input.picture.at(x, y);
        self.input.lens.meters(f64::from(f32::from_bits(key)))
            * (1.0 + DEPTH_ERROR * self.input.signs.at(x, y))
    }

    /// How many meters farther a pixel of reversed depth `depth + by` is than one of `depth`.
    pub fn meters_apart(&self, depth: f64, by: f64) -> f64 {
        let [here, there] = [depth, depth + by].map(|depth| self.input.lens.meters(depth));
        (there - here) * (1.0 + DEPTH_ERROR * self.input.signs.at(self.x, self.y))
    }

    /// The normal of what a pixel of the picture shows, from its depth and those of its neighbors:
    /// world space, unit length, towards the viewer's side; zero where nothing is drawn.
    pub fn normal(&self, x: i64, y: i64) -> DVec3 {
        let size = self.picture_size();
        let (x, y) = (x.clamp(0, size.x as i64 - 1), y.clamp(0, size.y as i64 - 1));
        let depth_at = |x: i64, y: i64| f64::from(f32::from_bits(self.input.picture.at(x, y).1));
        let depth = depth_at(x, y);
        if depth <= 0.0 {
            return DVec3::ZERO;
        }
        let slope = |right: i64, down: i64| {
            let ahead = depth_at(x + right, y + down) - depth;
            let behind = depth - depth_at(x - right, y - down);
            if ahead.abs() < behind.abs() {
                ahead
            } else {
                behind
            }
        };
        let half = size * 0.5;
        let place = (DVec2::new(x as f64, y as f64) + 0.5 - half) / half * DVec2::new(1.0, -1.0);
        let slope = DVec2::new(slope(1, 0), -slope(0, 1)) * half;
        self.input.lens.normal(depth, place, slope)
    }

    /// The unit vector from the eye, world space, to a place in pixels from the top left corner.
    pub fn direction(&self, at: DVec2) -> DVec3 {
        let place = at / self.picture_size() * DVec2::new(2.0, -2.0) + DVec2::new(-1.0, 1.0);
        self.input.lens.direction(place)
    }

    /// The middle of the pixel, in pixels of the picture from its top left corner.
    pub fn middle(&self) -> DVec2 {
        (DVec2::new(self.x as f64, self.y as f64) + 0.5) * f64::from(self.scale)
    }

    /// Width and height of the picture, pixels.
    pub fn picture_size(&self) -> DVec2 {
        let picture = self.input.picture;
        DVec2::new(picture.width.into(), picture.height.into())
    }
}

/// Earlier frames that a picture follows: those from which an effect remembers something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EarlierFrames {
    /// How many are drawn before a single picture, at most [`Self::MOST`].
    pub frames: u32,
    /// Time from one of them to the next, seconds.
    pub step_s: f64,
}

impl EarlierFrames {
    /// Most frames that are drawn before a single picture.
    pub const MOST: u32 = 32;
    /// Longest time from one frame to the next, seconds.
    pub const LONGEST_STEP_S: f64 = 60.0;
}

/// One pass of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct ImagePass {
    /// Its WGSL function; in a built-in effect, what follows the effect's name in it.
    pub name: String,
    /// Pixels of the picture for one that it writes, along a side: 1, 2 or 4.
    pub scale: u32,
    /// What it writes lives to the next frame, and a single picture follows so many frames. At most
    /// one pass of a stack, and never the last one of its effect.
    pub kept: Option<EarlierFrames>,
}

impl ImagePass {
    /// Width and height of what it writes for a picture of so many pixels, at least 1.
    pub fn size(&self, picture: [u32; 2]) -> [u32; 2] {
        picture.map(|side| side.div_ceil(self.scale).max(1))
    }
}

/// What the pass of this index writes at pixels, given the effect's parameter words.
pub type PassFunction = dyn Fn(usize, &[ImageAt<'_>], &[u32]) -> Vec<DVec4> + Send + Sync;

/// The passes of an effect, and their function over its parameter words.
#[derive(Clone)]
pub struct PassHook {
    pub passes: Vec<ImagePass>,
    pub run: Arc<PassFunction>,
}

impl PassHook {
    /// The pass whose result lives to the next frame, and how many frames a picture follows.
    pub fn kept(&self) -> Option<(&ImagePass, EarlierFrames)> {
        self.passes.iter().find_map(|pass| Some((pass, pass.kept?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_pixels_colors_change_by_256ths() {
        let image = Image {
            size: [2, 1],
            colors: vec![DVec4::ZERO, DVec4::ONE],
        };
        let at = |x: f64| image.between(DVec2::new(x, 0.5), 0.0).x;
        assert_eq!(
            [at(-9.0), at(0.5), at(1.0), at(1.5), at(9e9)],
            [0.0, 0.0, 0.5, 1.0, 1.0]
        );
        assert_eq!(at(0.5 + 1.0 / 256.0), 1.0 / 256.0);
        assert_eq!(at(0.5 + 0.4 / 256.0), 0.0, "a weight is a whole multiple");
    }

    #[test]
    fn depths_are_meters_from_the_eye() {
        let lens = |depth| Lens {
            depth,
            pixel_m: 0.01,
            axes: [DVec3::X, DVec3::Y, DVec3::NEG_Z],
        };
        let perspective = lens(DepthScale::Perspective { near_m: 0.5 });
        assert_eq!(perspective.meters(0.25), 2.0);
        assert_eq!(perspective.meters(0.0), EMPTY_DEPTH_M);
        assert_eq!(perspective.pixel_size_m(2.0), 0.02);
        let linear = lens(DepthScale::Linear([1.0, 9.0]));
        assert_eq!([1.0, 0.5].map(|depth| linear.meters(depth)), [1.0, 5.0]);
        assert_eq!(linear.pixel_size_m(2.0), 0.01);
    }

    #[test]
    fn a_plane_has_one_normal_at_every_place() {
        let normal = DVec3::new(0.6, -0.3, 0.8).normalize();
        for depth in [
            DepthScale::Perspective { near_m: 0.5 },
            DepthScale::Linear([1.0, 9.0]),
        ] {
            let axes = [DVec3::X / 0.7, DVec3::Y / 0.5, DVec3::NEG_Z];
            let lens = Lens {
                depth,
                pixel_m: 0.01,
                axes,
            };
            // Reversed depth of the plane through (0, 0, -4), seen from the origin.
            let depth_at = |x: f64, y: f64| {
                let [right, up] = [0.7 * x, 0.5 * y];
                let distance = -4.0 * normal.z;
                match depth {
                    DepthScale::Perspective { near_m } => {
                        let ray = DVec3::new(right, up, -1.0);
                        near_m * normal.dot(ray) / distance
                    }
                    DepthScale::Linear([near_m, far_m]) => {
                        let meters = -(distance - normal.x * right - normal.y * up) / normal.z;
                        (meters - far_m) / (near_m - far_m)
                    }
                }
            };
            for [x, y] in [[0.0, 0.0], [0.3, -0.6], [-0.9, 0.2]] {
                let here = depth_at(x, y);
                let slope = DVec2::new(depth_at(x + 1.0, y) - here, depth_at(x, y + 1.0) - here);
                let found = lens.normal(here, DVec2::new(x, y), slope);
                assert!((found - normal).length() < 1e-9, "{found} for {normal}");
            }
        }
    }
}
