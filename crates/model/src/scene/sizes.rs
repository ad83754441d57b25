//! Triangle sizes: how large the triangles of a scene are on the screen, estimated in f64 from a
//! bounded sample of them.

use std::sync::Arc;

use glam::{DVec2, DVec3, DVec4};

use super::{draw::Draw, model::Scene, view::View};
use crate::math::hash_unit;

/// The most triangles that are sampled. Fractions are then known to within a few percent at a
/// constant cost.
const MAX_SAMPLES: u64 = 2048;

/// A sample of the triangles of a picture with their sizes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleSizes {
    /// Triangles of the scene.
    pub triangles: u64,
    /// The number of sampled triangles.
    pub sampled: u32,
    /// How many of the sampled triangles cross the near plane; their size is not known.
    pub near_clipped: u32,
    /// The sampled triangles that lie behind the near plane, face the viewer and are inside the
    /// picture.
    visible: Arc<[VisibleTriangle]>,
}

/// A sampled triangle that is visible.
#[derive(Clone, Copy, Debug, PartialEq)]
struct VisibleTriangle {
    /// The larger of the width and the height of its bounding box, pixels.
    extent_px: f32,
    /// Sample columns and rows inside the picture that its bounding box covers.
    samples: [u32; 2],
    /// The part of its area inside the picture, square pixels.
    area: f32,
    /// The part of its perimeter inside the picture, pixels.
    perimeter: f32,
}

/// Estimated numbers of triangles for each raster path.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct SizeClasses {
    /// Drawn by one invocation.
    pub small: f64,
    /// Drawn by one workgroup.
    pub medium: f64,
    /// Divided into tiles.
    pub large: f64,
    /// Error of each number: three standard deviations of the sampling, 0 if all triangles were
    /// sampled.
    pub error_bound: f64,
}

impl TriangleSizes {
    /// Samples triangles of `scene` as `view` sees it through `draws`, spread evenly over their
    /// list.
    pub fn of(scene: &Scene, draws: &[Draw], view: &View) -> Self {
        let triangles: u64 = draws
            .iter()
            .map(|draw| u64::from(scene.primitives[draw.primitive].triangle_count()))
            .sum();
        let count = triangles.min(MAX_SAMPLES);
        let (mut visible, mut near_clipped) = (Vec::new(), 0);
        for k in 0..count {
            // One random position per stratum: a fixed step would alias with the order of a strip.
            let within = if triangles > MAX_SAMPLES {
                hash_unit(k as u32)
            } else {
                0.0
            };
            let id = ((k as f64 + within) * triangles as f64 / count as f64) as u64;
            let draw =
                &draws[draws.partition_point(|draw| u64::from(draw.first_triangle) <= id) - 1];
            let primitive = &scene.primitives[draw.primitive];
            let position = |vertex: u32| match &draw.deform {
                Some(deform) => deform.position(scene, primitive, vertex),
                None => DVec3::from_array(primitive.position(scene, vertex).map(f64::from)),
            };
            let corners = primitive.corners(scene, id as u32 - draw.first_triangle);
            match classify(
                draw,
                view,
                corners.map(|vertex| draw.clip_point(position(vertex))),
            ) {
                Sampled::Visible(triangle) => visible.push(triangle),
                Sampled::CrossesNear => near_clipped += 1,
                Sampled::Hidden => {}
            }
        }
        Self {
            triangles,
            sampled: count as u32,
            near_clipped,
            visible: visible.into(),
        }
    }

    /// The number of sampled triangles that are visible and not cut by the near plane.
    pub fn visible(&self) -> u32 {
        self.visible.len() as u32
    }

    /// A histogram of [`Self::visible`] by powers of two: the upper end in pixels and the count,
    /// from the first to the last non-empty bin.
    pub fn bins(&self) -> Vec<(f64, u32)> {
        let of = |visible: &VisibleTriangle| {
            libm::floor(libm::log2(f64::from(visible.extent_px.max(1.0 / 256.0)))) as i32 + 1
        };
        let (Some(first), Some(last)) = (
            self.visible.iter().map(of).min(),
            self.visible.iter().map(of).max(),
        ) else {
            return Vec::new();
        };
        let mut bins: Vec<(f64, u32)> = (first..=last)
            .map(|power| (libm::exp2(power.into()), 0))
            .collect();
        self.visible
            .iter()
            .for_each(|visible| bins[(of(visible) - first) as usize].1 += 1);
        bins
    }

    /// Triangles of the scene for which a sampled one stands.
    fn each(&self) -> f64 {
        self.triangles as f64 / f64::from(self.sampled.max(1))
    }

    /// Estimates how many triangles are drawn by one invocation (small), by one workgroup (medium),
    /// and how many exceed `large_px` (large).
    pub fn classes(
        &self,
        max_small_samples: u32,
        max_small_side: u32,
        large_px: f64,
    ) -> SizeClasses {
        let mut classes = SizeClasses::default();
        for visible in self
            .visible
            .iter()
            .filter(|visible| visible.samples.iter().all(|count| *count > 0))
        {
            let [columns, rows] = visible.samples;
            let class = match () {
                () if f64::from(visible.extent_px) > large_px => &mut classes.large,
                () if columns * rows > max_small_samples || columns.max(rows) > max_small_side => {
                    &mut classes.medium
                }
                () => &mut classes.small,
            };
            *class += 1.0;
        }
        let each = self.each();
        let deviation =
            |count: f64| (count * (1.0 - count / f64::from(self.sampled.max(1)))).sqrt();
        let most = deviation(classes.small)
            .max(deviation(classes.medium))
            .max(deviation(classes.large));
        // One more, for classes too rare to be sampled. The numbers are exact where all triangles
        // were sampled.
        let error_bound = if u64::from(self.sampled) == self.triangles {
            0.0
        } else {
            each * (3.0 * most + 1.0)
        };
        SizeClasses {
            small: classes.small * each,
            medium: classes.medium * each,
            large: classes.large * each,
            error_bound,
        }
    }

    /// Estimated fraction of the picture's pixels that show another triangle when every edge moves
    /// by `shift_px`. An edge passes over samples in proportion to its length, and two
    /// triangles share it.
    pub fn changed_fraction(&self, shift_px: f64, pixels: f64) -> f64 {
        if self.visible.is_empty() {
            // No sampled triangle is visible; triangles that were not sampled may be small.
            return if u64::from(self.sampled) == self.triangles && self.near_clipped == 0 {
                0.0
            } else {
                (7.0 * shift_px).min(1.0)
            };
        }
        let area: f64 = self
            .visible
            .iter()
            .map(|visible| f64::from(visible.area))
            .sum();
        let passed: f64 = self
            .visible
            .iter()
            .map(|visible| {
                (f64::from(visible.perimeter) * shift_px * 0.5).min(f64::from(visible.area))
            })
            .sum();
        let each = self.each();
        let covered = if self.near_clipped > 0 {
            1.0
        } else {
            (area * each / pixels.max(1.0)).min(1.0)
        };
        if area > 0.0 {
            passed / area * covered
        } else {
            0.0
        }
    }
}

/// What is known of a sampled triangle.
enum Sampled {
    Visible(VisibleTriangle),
    /// Its size is not known.
    CrossesNear,
    /// Without an area, turned away, outside the picture, or with a corner that is refused.
    Hidden,
}

fn classify(draw: &Draw, view: &View, clip: [DVec4; 3]) -> Sampled {
    if clip.iter().any(|c| !c.is_finite()) {
        return Sampled::Hidden;
    }
    let is_before_near = |c: &&DVec4| c.w <= 0.0 || c.z > c.w;
    match clip.iter().filter(is_before_near).count() {
        0 => {}
        3 => return Sampled::Hidden,
        _ => return Sampled::CrossesNear,
    }
    let size = DVec2::new(view.width.into(), view.height.into());
    let [a, b, c] = clip.map(|c| DVec2::new(0.5 + 0.5 * c.x / c.w, 0.5 - 0.5 * c.y / c.w) * size);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    // y points down, so clockwise on the screen is a back face.
    let doubled = (b - a).perp_dot(c - a);
    let is_back = (doubled > 0.0) != draw.mirrored && !draw.double_sided;
    let is_outside = high.x <= 0.0 || high.y <= 0.0 || low.x >= size.x || low.y >= size.y;
    if is_back || is_outside || doubled == 0.0 {
        return Sampled::Hidden;
    }
    let samples = [0, 1].map(|axis| {
        let (first, last) = (
            (low[axis] - 0.5).ceil().max(0.0),
            (high[axis] - 0.5).floor().min(size[axis] - 1.0),
        );
        (last - first + 1.0).max(0.0) as u32
    });
    let inside =
        (high.min(size) - low.max(DVec2::ZERO)) / (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
    let fraction = inside.x * inside.y;
    Sampled::Visible(VisibleTriangle {
        extent_px: (high - low).max_element() as f32,
        samples,
        area: (0.5 * doubled.abs() * fraction) as f32,
        perimeter: ((a.distance(b) + b.distance(c) + c.distance(a)) * fraction.sqrt()) as f32,
    })
}

#[cfg(test)]
mod tests {
    use glam::DMat4;

    use super::*;
    use crate::scene::{builtin, camera::Camera, draw::draws};

    fn framed(scene: &Scene, [width, height]: [u32; 2]) -> Camera {
        Camera::framing(
            &scene.bounds(),
            DVec3::new(-0.4, -0.4, -1.0),
            f64::from(width) / f64::from(height),
        )
    }

    fn sizes(query: &str, [width, height]: [u32; 2]) -> TriangleSizes {
        let scene = builtin::build(query).expect("a builtin");
        let camera = framed(&scene, [width, height]);
        let view = View::new(
            &camera,
            width,
            height,
            &scene.bounds(),
            DMat4::IDENTITY,
            [0.0; 4],
        );
        TriangleSizes::of(&scene, &draws(&scene, &view).expect("it fits"), &view)
    }

    #[test]
    fn half_of_a_sphere_is_seen_and_covers_its_disc() {
        let few = sizes("sphere?triangles=2000", [640, 480]);
        let fraction = f64::from(few.visible()) / f64::from(few.sampled);
        assert!(
            (0.35..0.5).contains(&fraction),
            "{fraction} of the triangles face the viewer"
        );
        assert_eq!(few.near_clipped, 0);
        // All pixels of the disc change when edges move as far as triangles are wide. The disc is
        // that of a sphere of this radius at this distance, with 45 degrees from the bottom
        // of the picture to its top.
        let scene = builtin::build("sphere?triangles=2000").expect("a builtin");
        let (radius, camera) = (scene.bounds().max.y, framed(&scene, [640, 480]));
        let disc_px = 240.0 / libm::tan(22.5f64.to_radians()) * radius
            / (camera.eye.distance_squared(camera.target) - radius * radius).sqrt();
        let disc = std::f64::consts::PI * disc_px * disc_px / (640.0 * 480.0);
        let moved = few.changed_fraction(1e3, 640.0 * 480.0);
        assert!(
            (0.8 * disc..1.1 * disc).contains(&moved),
            "{moved} of the picture, where {disc} is covered"
        );
    }

    #[test]
    fn a_look_at_some_tells_what_a_look_at_all_does() {
        let many = sizes("sphere?triangles=200000", [640, 480]);
        assert_eq!((many.sampled, many.triangles / 1000), (2048, 200));
        let typical = many
            .bins()
            .into_iter()
            .max_by_key(|(_, count)| *count)
            .expect("some are seen")
            .0;
        // 100,000 triangles on 150,000 pixels are some two pixels wide.
        assert!(
            (2.0..=4.0).contains(&typical),
            "most are up to {typical} px wide: {:?}",
            many.bins()
        );
        let small = many.changed_fraction(1.0 / 256.0, 640.0 * 480.0);
        let large = many.changed_fraction(1.0 / 64.0, 640.0 * 480.0);
        assert!(
            (large / small - 4.0).abs() < 0.2,
            "what moves is in proportion to how far: {small} {large}"
        );
    }

    #[test]
    fn classes_hold_all_that_is_seen() {
        let sizes = sizes("teapot?tess=4", [640, 480]);
        assert_eq!(u64::from(sizes.sampled), sizes.triangles);
        let classes = sizes.classes(32, 32, 128.0);
        assert!(
            classes.medium > 100.0 && classes.large == 0.0 && classes.error_bound == 0.0,
            "{classes:?}"
        );
        assert!(classes.small + classes.medium <= f64::from(sizes.visible()));
        assert_eq!(
            sizes.classes(1 << 20, 1 << 20, 1e9).small,
            classes.small + classes.medium
        );
    }
}
