//! Triangle sizes: how large the triangles of a scene are on the screen, estimated in f64 from a bounded sample of them.

use std::sync::Arc;

use glam::{DVec2, DVec3, DVec4};

use super::{draw::Draw, model::Scene, triangle_rows::TriangleRows, view::View};
use crate::math::hash_unit;

/// The most triangles that are sampled. Fractions are then known to within a few percent at a constant cost.
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
    /// The sampled triangles that lie behind the near plane, face the viewer and are inside the picture.
    pub(super) visible: Arc<[VisibleTriangle]>,
    /// What the near plane leaves of sampled triangles that cross it, where that reaches the picture.
    pub(super) cut: Arc<[VisibleTriangle]>,
    /// Rows of the sampled triangles of which the near plane cuts nothing and whose box has a sample, whichever way they face.
    pub(super) rows: Arc<[TriangleRows]>,
    /// The same of what the near plane leaves of the others.
    pub(super) cut_rows: Arc<[TriangleRows]>,
}

/// A sampled triangle that is visible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct VisibleTriangle {
    /// The larger of the width and the height of its bounding box, pixels.
    pub(super) extent_px: f32,
    /// Sample columns and rows inside the picture that its bounding box covers.
    pub(super) samples: [u32; 2],
    /// The first of those columns and rows.
    first: [u32; 2],
    /// The part of its area inside the picture, square pixels.
    pub(super) area: f32,
    /// The part of its perimeter inside the picture, pixels.
    perimeter: f32,
    /// How many of its corners lie in the picture.
    pub(super) corners: u32,
    /// Its material has images.
    pub(super) has_texture: bool,
}

/// How a triangle is drawn: by one invocation, by one workgroup, or divided into tiles.
pub(super) enum RasterPath {
    Small,
    Medium,
    Large,
}

impl VisibleTriangle {
    pub(super) fn path(&self, max_small_samples: u32, max_small_side: u32, large_px: f64) -> RasterPath {
        let [columns, rows] = self.samples;
        match () {
            () if f64::from(self.extent_px) > large_px => RasterPath::Large,
            () if columns * rows > max_small_samples || columns.max(rows) > max_small_side => RasterPath::Medium,
            () => RasterPath::Small,
        }
    }
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
    /// Error of each number: three standard deviations of the sampling, 0 if all triangles were sampled.
    pub error_bound: f64,
}

impl TriangleSizes {
    /// Samples triangles of `scene` as `view` sees it through `draws`, spread evenly over their list.
    pub fn of(scene: &Scene, draws: &[Draw], view: &View) -> Self {
        Self::of_corners(scene, draws, view, |index, triangle| {
            let draw = &draws[index];
            let primitive = &scene.primitives[draw.primitive];
            let position = |vertex: u32| match &draw.deform {
                Some(deform) => deform.position(scene, primitive, vertex),
                None => DVec3::from_array(primitive.position(scene, vertex).map(f64::from)),
            };
            primitive.corners(scene, triangle).map(|vertex| draw.clip_point(position(vertex)))
        })
    }

    /// As [`Self::of`], where `corners` returns the positions in clip space of a triangle, given the index of its draw and its own within the
    /// draw.
    pub fn of_corners(scene: &Scene, draws: &[Draw], view: &View, corners: impl Fn(usize, u32) -> [DVec4; 3]) -> Self {
        let triangles: u64 = draws.iter().map(|draw| u64::from(scene.primitives[draw.primitive].triangle_count())).sum();
        let count = triangles.min(MAX_SAMPLES);
        let (mut visible, mut cut, mut near_clipped) = (Vec::new(), Vec::new(), 0);
        let (mut rows, mut cut_rows) = (Vec::new(), Vec::new());
        for k in 0..count {
            // One random position per stratum: a fixed step would alias with the order of a strip.
            let within = if triangles > MAX_SAMPLES { hash_unit(k as u32) } else { 0.0 };
            let id = ((k as f64 + within) * triangles as f64 / count as f64) as u64;
            let index = draws.partition_point(|draw| u64::from(draw.first_triangle) <= id) - 1;
            let draw = &draws[index];
            let has_texture = scene.materials[scene.primitives[draw.primitive].material].textures() != [None, None];
            match classify(draw, view, corners(index, id as u32 - draw.first_triangle), has_texture) {
                Sampled::Seen { triangle, rows: own } => {
                    visible.extend(triangle);
                    rows.extend(own);
                }
                Sampled::CrossesNear(rest) => {
                    near_clipped += 1;
                    cut_rows.extend(rest.iter().map(VisibleTriangle::usual_rows));
                    cut.extend(rest);
                }
                Sampled::Outside => {}
            }
        }
        let [visible, cut] = [visible, cut].map(Arc::from);
        let [rows, cut_rows] = [rows, cut_rows].map(Arc::from);
        Self { triangles, sampled: count as u32, near_clipped, visible, cut, rows, cut_rows }
    }

    /// The number of sampled triangles that are visible and not cut by the near plane.
    pub fn visible(&self) -> u32 {
        self.visible.len() as u32
    }

    /// A histogram of [`Self::visible`] by powers of two: the upper end in pixels and the count, from the first to the last non-empty bin.
    pub fn bins(&self) -> Vec<(f64, u32)> {
        let of = |visible: &VisibleTriangle| libm::floor(libm::log2(f64::from(visible.extent_px.max(1.0 / 256.0)))) as i32 + 1;
        let (Some(first), Some(last)) = (self.visible.iter().map(of).min(), self.visible.iter().map(of).max()) else { return Vec::new() };
        let mut bins: Vec<(f64, u32)> = (first..=last).map(|power| (libm::exp2(power.into()), 0)).collect();
        self.visible.iter().for_each(|visible| bins[(of(visible) - first) as usize].1 += 1);
        bins
    }

    /// Triangles of the scene for which a sampled one stands.
    pub(super) fn each(&self) -> f64 {
        self.triangles as f64 / f64::from(self.sampled.max(1))
    }

    /// Estimates how many triangles are drawn by one invocation (small), by one workgroup (medium), and how many exceed
    /// `large_px` (large).
    pub fn classes(&self, max_small_samples: u32, max_small_side: u32, large_px: f64) -> SizeClasses {
        let mut classes = SizeClasses::default();
        for visible in self.visible.iter().filter(|visible| visible.samples.iter().all(|count| *count > 0)) {
            let class = match visible.path(max_small_samples, max_small_side, large_px) {
                RasterPath::Small => &mut classes.small,
                RasterPath::Medium => &mut classes.medium,
                RasterPath::Large => &mut classes.large,
            };
            *class += 1.0;
        }
        let each = self.each();
        let deviation = |count: f64| (count * (1.0 - count / f64::from(self.sampled.max(1)))).sqrt();
        let most = deviation(classes.small).max(deviation(classes.medium)).max(deviation(classes.large));
        // One more, for classes too rare to be sampled. The numbers are exact where all triangles were sampled.
        let error_bound = if u64::from(self.sampled) == self.triangles { 0.0 } else { each * (3.0 * most + 1.0) };
        SizeClasses { small: classes.small * each, medium: classes.medium * each, large: classes.large * each, error_bound }
    }

    /// Estimated fraction of the picture that lies in squares of `side` pixels or more which the box of some triangle touches; 0 without triangles.
    pub fn touched_fraction(&self, [width, height]: [u32; 2], side: u32) -> f64 {
        if self.triangles == 0 {
            return 0.0;
        }
        // Where triangles are sampled, squares must be large enough that each holds a sampled one.
        let spared = self.each();
        let side = f64::from(side.max(1)).max((f64::from(width) * f64::from(height) * 1e-5).sqrt()) * spared.sqrt();
        let squares = |pixels: u32| (f64::from(pixels) / side).ceil().max(1.0) as usize;
        let (columns, rows) = (squares(width), squares(height));
        let mut touched = vec![false; columns * rows];
        for visible in self.visible.iter().chain(self.cut.iter()).filter(|visible| visible.samples.iter().all(|count| *count > 0)) {
            let [x, y] = [0, 1].map(|axis| {
                let (first, count) = (visible.first[axis], visible.samples[axis]);
                (f64::from(first) / side) as usize..=(f64::from(first + count - 1) / side) as usize
            });
            y.for_each(|row| x.clone().for_each(|column| touched[row.min(rows - 1) * columns + column.min(columns - 1)] = true));
        }
        touched.iter().filter(|is_touched| **is_touched).count() as f64 / touched.len() as f64
    }

    /// Estimated fraction of the picture's pixels that show another triangle when every edge moves by `shift_px`. An edge
    /// passes over samples in proportion to its length, and two triangles share it.
    pub fn changed_fraction(&self, shift_px: f64, pixels: f64) -> f64 {
        if self.visible.is_empty() {
            // No sampled triangle is visible; triangles that were not sampled may be small.
            return if u64::from(self.sampled) == self.triangles && self.near_clipped == 0 { 0.0 } else { (7.0 * shift_px).min(1.0) };
        }
        let area: f64 = self.visible.iter().map(|visible| f64::from(visible.area)).sum();
        let passed: f64 =
            self.visible.iter().map(|visible| (f64::from(visible.perimeter) * shift_px * 0.5).min(f64::from(visible.area))).sum();
        let each = self.each();
        let covered = if self.near_clipped > 0 { 1.0 } else { (area * each / pixels.max(1.0)).min(1.0) };
        if area > 0.0 { passed / area * covered } else { 0.0 }
    }
}

/// What is known of a sampled triangle.
enum Sampled {
    /// Inside the picture: the triangle, where it faces the viewer, and its rows, where its box has a sample.
    Seen { triangle: Option<VisibleTriangle>, rows: Option<TriangleRows> },
    /// Crosses the near plane; with what is left of it in the picture.
    CrossesNear(Option<VisibleTriangle>),
    /// Without an area, outside the picture, or with a corner that is refused.
    Outside,
}

impl VisibleTriangle {
    /// Rows of a triangle of which only the box is known.
    fn usual_rows(&self) -> TriangleRows {
        let [columns, rows] = self.samples.map(f64::from);
        TriangleRows::of([0.0, 0.5 * rows, rows], columns, [0.0, rows])
    }
}

/// What lies behind the near plane of a triangle that crosses it, as the box of its corners; none outside the picture.
fn behind_near(clip: [DVec4; 3], view: &View, has_texture: bool) -> Option<VisibleTriangle> {
    let depth = |c: DVec4| c.w - c.z;
    let mut corners = Vec::with_capacity(4);
    for (a, b) in [(clip[0], clip[1]), (clip[1], clip[2]), (clip[2], clip[0])] {
        if depth(a) >= 0.0 {
            corners.push(a);
        }
        if (depth(a) >= 0.0) != (depth(b) >= 0.0) {
            corners.push(a + (b - a) * (depth(a) / (depth(a) - depth(b))));
        }
    }
    let size = DVec2::new(view.width.into(), view.height.into());
    let points = corners.iter().filter(|c| c.w > 0.0).map(|c| DVec2::new(0.5 + 0.5 * c.x / c.w, 0.5 - 0.5 * c.y / c.w) * size);
    let (low, high) = points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), point| (low.min(point), high.max(point)));
    if !low.is_finite() || !high.is_finite() || high.x <= 0.0 || high.y <= 0.0 || low.x >= size.x || low.y >= size.y {
        return None;
    }
    let (inside_low, inside_high) = (low.max(DVec2::ZERO), high.min(size));
    let inside = inside_high - inside_low;
    Some(VisibleTriangle {
        extent_px: (high - low).max_element() as f32,
        samples: [inside.x.ceil() as u32, inside.y.ceil() as u32],
        first: [inside_low.x as u32, inside_low.y as u32],
        // A triangle has half the area of its box, as a rule.
        area: (0.5 * inside.x * inside.y) as f32,
        perimeter: (2.0 * (inside.x + inside.y)) as f32,
        // Discs are not drawn at the corners of a triangle that is cut.
        corners: 0,
        has_texture,
    })
}

fn classify(draw: &Draw, view: &View, clip: [DVec4; 3], has_texture: bool) -> Sampled {
    if clip.iter().any(|c| !c.is_finite()) {
        return Sampled::Outside;
    }
    let is_before_near = |c: &&DVec4| c.w <= 0.0 || c.z > c.w;
    match clip.iter().filter(is_before_near).count() {
        0 => {}
        3 => return Sampled::Outside,
        _ => return Sampled::CrossesNear(behind_near(clip, view, has_texture)),
    }
    let size = DVec2::new(view.width.into(), view.height.into());
    let [a, b, c] = clip.map(|c| DVec2::new(0.5 + 0.5 * c.x / c.w, 0.5 - 0.5 * c.y / c.w) * size);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    // y points down, so clockwise on the screen is a back face.
    let doubled = (b - a).perp_dot(c - a);
    let is_back = (doubled > 0.0) != draw.mirrored;
    let is_outside = high.x <= 0.0 || high.y <= 0.0 || low.x >= size.x || low.y >= size.y;
    if is_outside || doubled == 0.0 {
        return Sampled::Outside;
    }
    let first = [0, 1].map(|axis| (low[axis] - 0.5).ceil().max(0.0));
    let samples = [0, 1].map(|axis| ((high[axis] - 0.5).floor().min(size[axis] - 1.0) - first[axis] + 1.0).max(0.0) as u32);
    let inside = (high.min(size) - low.max(DVec2::ZERO)) / (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
    let fraction = inside.x * inside.y;
    let mut heights = [a.y, b.y, c.y];
    heights.sort_by(f64::total_cmp);
    let rows = samples.iter().all(|count| *count > 0).then(|| {
        let shown = [first[1], first[1] + f64::from(samples[1])];
        TriangleRows::of(heights, doubled.abs() / (high.y - low.y), shown)
    });
    let triangle = VisibleTriangle {
        extent_px: (high - low).max_element() as f32,
        samples,
        first: first.map(|first| first as u32),
        area: (0.5 * doubled.abs() * fraction) as f32,
        perimeter: ((a.distance(b) + b.distance(c) + c.distance(a)) * fraction.sqrt()) as f32,
        corners: [a, b, c].iter().filter(|at| at.cmpge(DVec2::ZERO).all() && at.cmplt(size).all()).count() as u32,
        has_texture,
    };
    Sampled::Seen { triangle: (!is_back || draw.double_sided).then_some(triangle), rows }
}

#[cfg(test)]
mod tests {
    use glam::DMat4;

    use super::*;
    use crate::scene::{builtin, camera::Camera, draw::draws, triangle_rows::RowWork};

    fn framed(scene: &Scene, [width, height]: [u32; 2]) -> Camera {
        Camera::framing(&scene.bounds(), DVec3::new(-0.4, -0.4, -1.0), f64::from(width) / f64::from(height))
    }

    fn sizes(query: &str, [width, height]: [u32; 2]) -> TriangleSizes {
        let scene = builtin::build(query).expect("a builtin");
        let camera = framed(&scene, [width, height]);
        let view = View::new(&camera, width, height, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
        TriangleSizes::of(&scene, &draws(&scene, &view).expect("it fits"), &view)
    }

    #[test]
    fn half_of_a_sphere_is_seen_and_covers_its_disc() {
        let few = sizes("sphere?triangles=2000", [640, 480]);
        let fraction = f64::from(few.visible()) / f64::from(few.sampled);
        assert!((0.35..0.5).contains(&fraction), "{fraction} of the triangles face the viewer");
        assert_eq!(few.near_clipped, 0);
        // All pixels of the disc change when edges move as far as triangles are wide. The disc is that of a sphere of this radius
        // at this distance, with 45 degrees from the bottom of the picture to its top.
        let scene = builtin::build("sphere?triangles=2000").expect("a builtin");
        let (radius, camera) = (scene.bounds().max.y, framed(&scene, [640, 480]));
        let disc_px =
            240.0 / libm::tan(22.5f64.to_radians()) * radius / (camera.eye.distance_squared(camera.target) - radius * radius).sqrt();
        let disc = std::f64::consts::PI * disc_px * disc_px / (640.0 * 480.0);
        let moved = few.changed_fraction(1e3, 640.0 * 480.0);
        assert!((0.8 * disc..1.1 * disc).contains(&moved), "{moved} of the picture, where {disc} is covered");
    }

    #[test]
    fn a_look_at_some_tells_what_a_look_at_all_does() {
        let many = sizes("sphere?triangles=200000", [640, 480]);
        assert_eq!((many.sampled, many.triangles / 1000), (2048, 200));
        let typical = many.bins().into_iter().max_by_key(|(_, count)| *count).expect("some are seen").0;
        // 100,000 triangles on 150,000 pixels are some two pixels wide.
        assert!((2.0..=4.0).contains(&typical), "most are up to {typical} px wide: {:?}", many.bins());
        let small = many.changed_fraction(1.0 / 256.0, 640.0 * 480.0);
        let large = many.changed_fraction(1.0 / 64.0, 640.0 * 480.0);
        assert!((large / small - 4.0).abs() < 0.2, "what moves is in proportion to how far: {small} {large}");
    }

    #[test]
    fn the_work_of_the_paths_adds_up_to_what_is_seen() {
        let sizes = sizes("teapot?tess=4", [640, 480]);
        let (classes, work) = (sizes.classes(32, 32, 128.0), sizes.work(32, 32, 128.0));
        assert_eq!([classes.small, classes.medium], [work.small.triangles, work.medium.triangles]);
        assert!(work.medium.covered < work.medium.candidates && work.medium.candidates > 32.0 * work.medium.triangles, "{work:?}");
        // The teapot fills the middle of the picture, and no corner.
        let touched = sizes.touched_fraction([640, 480], 8);
        let covered = (work.small.covered + work.medium.covered) / (640.0 * 480.0);
        assert!((0.2..0.8).contains(&touched) && touched > 0.4 * covered, "{touched} touched, {covered} covered");
        assert_eq!(TriangleSizes::default().touched_fraction([640, 480], 8), 0.0, "a scene of no triangles");
    }

    #[test]
    fn rows_of_triangles_that_face_away_count_too() {
        let work = sizes("sphere?triangles=2000", [640, 480]).work(32, 32, 128.0);
        let seen = work.small.triangles + work.medium.triangles;
        assert!(work.rows.all > 10.0 * seen && work.rows.first < 6.0 * 2000.0, "{work:?}");
        assert!(work.rows.most >= work.rows.most_first && work.rows.most_first >= 1.0, "{work:?}");
        assert_eq!(work.cut_rows, RowWork::default());
    }

    #[test]
    fn classes_hold_all_that_is_seen() {
        let sizes = sizes("teapot?tess=4", [640, 480]);
        assert_eq!(u64::from(sizes.sampled), sizes.triangles);
        let classes = sizes.classes(32, 32, 128.0);
        assert!(classes.medium > 100.0 && classes.large == 0.0 && classes.error_bound == 0.0, "{classes:?}");
        assert!(classes.small + classes.medium <= f64::from(sizes.visible()));
        assert_eq!(sizes.classes(1 << 20, 1 << 20, 1e9).small, classes.small + classes.medium);
    }
}
