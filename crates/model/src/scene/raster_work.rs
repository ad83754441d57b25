//! The work of the raster paths of a picture, estimated from a sample of its triangles.

use super::{
    sizes::{RasterPath, TriangleSizes, VisibleTriangle},
    triangle_rows::RowWork,
};

/// Estimated work of a raster path.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct PathWork {
    /// Triangles that cover a box with a sample.
    pub triangles: f64,
    /// Samples in the boxes of those triangles.
    pub candidates: f64,
    /// Samples that the triangles cover, also where others hide them.
    pub covered: f64,
    /// The most samples in the box of one of them.
    pub longest: f64,
    /// The most samples that one of them covers.
    pub most_covered: f64,
}

/// Estimated work of all raster paths.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct SizeWork {
    pub small: PathWork,
    pub medium: PathWork,
    pub large: PathWork,
    /// Triangles that cross the near plane and reach the picture, as the near plane cuts them. They are counted in `medium` or `large` too.
    pub cut: PathWork,
    /// Rows of triangles that are not cut, also of those that face away.
    pub rows: RowWork,
    /// Rows of those that are.
    pub cut_rows: RowWork,
    /// Corners inside the picture of triangles that are not cut, each once for every triangle.
    pub corners: f64,
    /// The most such corners of one triangle.
    pub most_corners: f64,
    /// Samples that triangles with images in their materials cover; samples that other triangles hide count too.
    pub textured: f64,
    /// Corners inside the picture of triangles with images in their materials.
    pub textured_corners: f64,
}

impl PathWork {
    fn add(&mut self, triangle: &VisibleTriangle, times: f64) {
        let [columns, rows] = triangle.samples;
        self.triangles += times;
        self.candidates += times * f64::from(columns) * f64::from(rows);
        self.covered += times * f64::from(triangle.area);
        self.longest = self.longest.max(f64::from(columns) * f64::from(rows));
        self.most_covered = self.most_covered.max(triangle.area.into());
    }
}

impl TriangleSizes {
    /// Estimated work of each raster path, with the limits of [`Self::classes`].
    pub fn work(&self, max_small_samples: u32, max_small_side: u32, large_px: f64) -> SizeWork {
        let each = self.each();
        let [rows, cut_rows] = [&self.rows, &self.cut_rows].map(|rows| RowWork::of(rows, each));
        let mut work = SizeWork { rows, cut_rows, ..SizeWork::default() };
        for visible in self.visible.iter().filter(|visible| visible.samples.iter().all(|count| *count > 0)) {
            let path = match visible.path(max_small_samples, max_small_side, large_px) {
                RasterPath::Small => &mut work.small,
                RasterPath::Medium => &mut work.medium,
                RasterPath::Large => &mut work.large,
            };
            path.add(visible, each);
        }
        for visible in self.visible.iter() {
            work.corners += each * f64::from(visible.corners);
            work.most_corners = work.most_corners.max(visible.corners.into());
        }
        for textured in self.visible.iter().chain(self.cut.iter()).filter(|triangle| triangle.has_texture) {
            work.textured += each * f64::from(textured.area);
            work.textured_corners += each * f64::from(textured.corners);
        }
        // What was cut is queued by its size, and no invocation draws it alone.
        for rest in self.cut.iter() {
            work.cut.add(rest, each);
            let path = if f64::from(rest.extent_px) > large_px { &mut work.large } else { &mut work.medium };
            path.add(rest, each);
        }
        work
    }
}
